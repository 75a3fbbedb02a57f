// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/angle.h"
#include "base/pick.h"
#include "conversion/angle_solver.h"
#include "diagnosis/conditions/pair_alone.h"
#include "diagnosis/conditions/reference_course.h"
#include "diagnosis/search/fit.h"
#include "health/even_rows.h"

namespace ada {

namespace {

constexpr std::size_t kMostTrained = 60000, kMostSolved = 20000, kMostScattered = 20000;
constexpr std::size_t kMostSpectra = 12;

/// Speeds that fill their range are a curve; a few held speeds are points.
void settle_continuity(View &view) {
  for (std::size_t a = 0; a < view.axes.all.size(); ++a) {
    PlotAxis &axis = view.axes.all[a];
    if (!axis.continuous)
      axis.continuous = 10 * view.final.axis[a][0].size() >= 7 * axis.bins;
  }
}

/// About two turns from the middle of the record; over the angle where a turn has few samples.
Stretch stretch_of(const Scene &scene, const Diagnosis &d) {
  const Observations &all = scene.all;
  Stretch out;
  const std::size_t middle = all.size() / 2;
  std::size_t first = middle, last = middle;
  while (last + 1 < all.size() && last - first < 3000 &&
         std::abs(all.alpha[last] - all.alpha[first]) < 1.2 * kTwoPi)
    ++last;
  out.over_angle = last - first < 60;
  if (out.over_angle) {
    first = all.size() > 400 ? std::min(first, all.size() - 400) : 0;
    last = std::min(all.size() - 1, first + 400);
  }
  std::vector<std::uint32_t> index;
  const std::size_t step = std::max<std::size_t>(1, (last - first) / 400);
  for (std::size_t i = first; i <= last; i += step)
    index.push_back(static_cast<std::uint32_t>(i));
  if (out.over_angle)
    std::sort(index.begin(), index.end(), [&](std::uint32_t a, std::uint32_t b) {
      return wrap(all.alpha[a], kTwoPi) < wrap(all.alpha[b], kTwoPi);
    });
  const Observations some = all.select(index);
  const ResidualColumns base = shown_residual(scene, some, d.baseline);
  const ResidualColumns extended = shown_residual(scene, some, d.extended);
  for (std::size_t i = 0; i < some.size(); ++i)
    out.key.push_back(out.over_angle ? wrap(some.alpha[i], kTwoPi) * kDegPerRad
                                     : some.time[i] - all.time.front());
  out.vsin = as_doubles(some.vsin);
  out.vcos = as_doubles(some.vcos);
  out.base_sin = base.model_sin;
  out.base_cos = base.model_cos;
  out.extended_sin = extended.model_sin;
  out.extended_cos = extended.model_cos;
  return out;
}

/// Mean of a column in each of 180 parts of the turn; NaN where there is nothing.
std::vector<double> over_turn(const PlotAxis &angle, const std::vector<double> &column) {
  std::vector<double> out(180, kAbsent);
  for (const Bin &b : bin_means(angle.key, column, 0.0, 360.0, out.size(), 1))
    out[std::min<std::size_t>(179, static_cast<std::size_t>(b.x / 2.0))] = b.mean;
  return out;
}

Locus locus_of(const Observations &data, const ResidualColumns &b, const ResidualColumns &e,
               const PlotAxis &angle) {
  return {data.centre_sin_v,
          data.centre_cos_v,
          over_turn(angle, b.model_sin),
          over_turn(angle, b.model_cos),
          over_turn(angle, b.sin),
          over_turn(angle, b.cos),
          over_turn(angle, e.model_sin),
          over_turn(angle, e.model_cos),
          over_turn(angle, e.sin),
          over_turn(angle, e.cos)};
}

Scatter scatter_of(const Observations &data, const ResidualColumns &final) {
  const auto parts = components(data, final);
  const std::size_t step = data.size() / kMostScattered + 1;
  Scatter out;
  for (std::size_t i = 0; i < data.size(); i += step) {
    out.along.push_back(parts[kAlong][i]);
    out.across.push_back(parts[kAcross][i]);
  }
  return out;
}

RemainderView remainder_view(const Observations &data, const Model &model, const View &view) {
  const PeriodicRemainder &r = *model.remainder;
  constexpr std::size_t kPoints = 721;
  // From what the axis "angle" shows to the angle that the series are in.
  const int periods = view.scene.has_reference ? 1 : view.scene.periods;
  const double per_shown = r.electrical ? model.periods_per_turn : 1;
  RemainderView out;
  std::vector<double> x(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    out.angle_deg.push_back(360.0 * static_cast<double>(i) / (kPoints - 1));
    x[i] = (out.angle_deg[i] / periods + model.baseline.angle_zero_deg) * per_shown * kRadPerDeg;
  }
  out.sin_mv.assign(kPoints, 0.0);
  out.cos_mv.assign(kPoints, 0.0);
  add_fourier_pair(x.data(), kPoints, r.series(1e3 * model.baseline.amplitude_v), out.sin_mv.data(),
                   out.cos_mv.data());
  double turned = 0.0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double psi = x[i] * model.periods_per_turn / per_shown;
    const double across = out.sin_mv[i] * std::cos(psi) - out.cos_mv[i] * std::sin(psi);
    turned += across * across / kPoints;
  }
  out.angle_rms_deg =
      1e-3 * std::sqrt(turned) / model.baseline.amplitude_v / model.periods_per_turn * kDegPerRad;
  Model without = model;
  without.remainder.reset();
  out.without = residual_bins(data, shown_residual(view.scene, data, without), view.axes);
  return out;
}

/// Angle of the sensor under a model minus the reference.
std::vector<Bin> angle_error(const Observations &data, const Model &model, int periods) {
  const AngleSolver solver(model);
  const std::vector<double> vsin = as_doubles(data.vsin), vcos = as_doubles(data.vcos);
  std::vector<double> alpha = data.alpha, radius(data.size()), error(data.size()), key;
  const double period = kTwoPi / periods;
  solver.start(vsin, vcos, alpha);
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] += period * std::round((data.alpha[i] - alpha[i]) / period);
  solver.solve(data.conditions(), vsin, vcos, alpha, radius);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    error[i] = wrap_centred(alpha[i] - data.alpha[i], period) * kDegPerRad;
    key.push_back(wrap(data.alpha[i], kTwoPi) * kDegPerRad);
  }
  const std::size_t bins = std::clamp<std::size_t>(data.size() / 16, 6, 72);
  return bin_means(key, error, 0.0, 360.0, bins, 8);
}

/// A tone, and what the means over every axis all but miss, shows in the spectrum.
bool in_spectrum(const Finding &finding, const CauseView &cause, const ResidualBins &final) {
  if (finding.effect->info().axis == axis_name(Axis::frequency))
    return true;
  double most = 0.0;
  for (std::size_t a = 0; a < final.axis.size(); ++a)
    most = std::max(most, change_of_means(cause.bins, final, a));
  return most < 0.4e3 * cause.rms_v;
}

void add_spectra(const Diagnosis &d, View &view) {
  std::vector<const Model *> models{&d.baseline, &d.extended};
  view.spectrum_of.assign(view.causes.size(), 0);
  for (std::size_t f = 0; f < view.causes.size(); ++f)
    if (view.causes[f].drawn && models.size() < kMostSpectra &&
        in_spectrum(d.findings[f], view.causes[f], view.final)) {
      view.spectrum_of[f] = models.size();
      models.push_back(&view.causes[f].without);
    }
  view.spectrum = residual_spectrum(view.scene.all, models);
  if (view.spectrum.density.empty())
    view.spectrum_of.assign(view.causes.size(), 0);
}

bool has_part_in(const Diagnosis &d, Axis axis) {
  const auto on_axis = [&](const auto &line) { return line.axis == axis && line.rms_v > 0.0; };
  const auto is_of = [&](const Finding &f) { return f.effect->info().axis == axis_name(axis); };
  return std::any_of(d.budget.begin(), d.budget.end(), on_axis) ||
         std::any_of(d.findings.begin(), d.findings.end(), is_of);
}

/// Without a reference what is known of the sensor may have bent the motion or not, by how the
/// diagnosis went: the look that the extended model fits.
Scene scene_as_timed(const Diagnosis &d, const Capture &capture) {
  if (!d.reference_aside.empty() && capture.has_reference()) {
    const Capture pair = without_reference(capture);
    Scene out = scene_as_timed(d, pair);
    out.capture = &capture;
    return out;
  }
  if (d.reference_course)
    if (const auto followed = followed_reference(capture)) {
      Scene out = prepare(followed->mended, false, nullptr, d.extended.vdd_reference_v);
      out.capture = &capture;
      return out;
    }
  Scene out = prepare(capture, false, nullptr, d.extended.vdd_reference_v);
  if (d.by_reference() || d.verdict == Verdict::insufficient_data)
    return out;
  const auto misfit = [&](const Scene &scene) {
    const Observations data = scene.all.select(thin(scene.train, kMostScattered));
    return data.size() == 0 ? std::numeric_limits<double>::infinity()
                            : mean_square(shown_residual(scene, data, d.extended));
  };
  Model named = d.extended;
  named.remainder.reset();
  if (d.radius_only) {
    if (!out.radius_only) {
      out.all = at_own_angle(std::move(out.all), named);
      judge_radius_only(out);
    }
    return out;
  }
  Scene other = prepare(capture, false, &named, d.extended.vdd_reference_v);
  return misfit(other) < misfit(out) ? std::move(other) : std::move(out);
}

/// At the times that the diagnosis took.
Scene scene_of(const Diagnosis &d, const Capture &capture) {
  const auto even = even_rows(capture);
  Scene out = scene_as_timed(d, even ? even->capture : capture);
  out.capture = &capture;
  return out;
}

} // namespace

double noise_v(const Diagnosis &d) {
  for (const BudgetLine &line : d.budget)
    if (line.axis == Axis::noise && line.rms_v > 0.0)
      return line.rms_v;
  return d.noise_rms_v;
}

double shown_of_cause(const ResidualBins &without, const ResidualBins &with, std::size_t axis) {
  int component = 0;
  const double means = change_of_means(without, with, axis, &component);
  const auto &b = without.axis[axis][static_cast<std::size_t>(component)];
  const auto &a = with.axis[axis][static_cast<std::size_t>(component)];
  double within = 0.0;
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < n; ++i)
    within += std::max(0.0, b[i].spread * b[i].spread - a[i].spread * a[i].spread);
  const double all = means * means + (n == 0 ? 0.0 : within / static_cast<double>(n));
  return all > 0.0 ? means * means / all : 0.0;
}

double change_of_means(const ResidualBins &before, const ResidualBins &after, std::size_t axis,
                       int *component) {
  double most = 0.0;
  for (int k = 0; k < kComponents; ++k) {
    const auto &b = before.axis[axis][static_cast<std::size_t>(k)];
    const auto &a = after.axis[axis][static_cast<std::size_t>(k)];
    double sum = 0.0; // bins are the same ones, for the same samples
    const std::size_t n = std::min(a.size(), b.size());
    for (std::size_t i = 0; i < n; ++i)
      sum += (a[i].mean - b[i].mean) * (a[i].mean - b[i].mean);
    const double rms = n == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(n));
    if (rms > most) {
      most = rms;
      if (component)
        *component = k;
    }
  }
  return most;
}

View make_view(const Diagnosis &d, const Capture &capture) {
  View view;
  view.scene = scene_of(d, capture);
  const Observations &all = view.scene.all;
  if (d.verdict == Verdict::insufficient_data || all.size() < 2)
    return view;
  const Observations data = all.select(thin(view.scene.train, kMostTrained));
  view.axes = plot_axes(view.scene, data, all.time.front(), has_part_in(d, Axis::supply));
  const ResidualColumns base = shown_residual(view.scene, data, d.baseline);
  const ResidualColumns final = shown_residual(view.scene, data, d.extended);
  view.baseline = residual_bins(data, base, view.axes);
  view.final = residual_bins(data, final, view.axes);
  settle_continuity(view);
  view.causes = cause_views(d, view.scene, data, final, view.axes);
  if (d.extended.remainder)
    view.remainder = remainder_view(data, d.extended, view);
  view.scatter = scatter_of(data, final);
  view.stretch = stretch_of(view.scene, d);
  view.locus = locus_of(data, base, final, view.axes.all.front());
  view.record = record_of(view.scene, d.extended);
  add_spectra(d, view);
  if (view.scene.has_reference) {
    const Observations some = all.select(thin(view.scene.train, kMostSolved));
    view.base_angle_error = angle_error(some, d.baseline, view.scene.periods);
    view.extended_angle_error = angle_error(some, d.extended, view.scene.periods);
  }
  return view;
}

} // namespace ada
