// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/view.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "conversion/angle_solver.h"
#include "diagnosis/fit.h"
#include "diagnosis/search.h"
#include "report/spectrum.h"

namespace ada {

namespace {

constexpr std::size_t kMostSamples = 60000, kMostSolved = 20000;
constexpr double kRpmPerRad = 60.0 / kTwoPi;

PlotAxis axis_of(const char *name, const char *label, std::vector<double> key, std::size_t bins,
             bool continuous) {
  PlotAxis a{name, label, 0.0, 0.0, bins, continuous, std::move(key)};
  if (!a.key.empty()) {
    const auto [low, high] = std::minmax_element(a.key.begin(), a.key.end());
    a.from = *low;
    a.to = *high;
  }
  return a;
}

void make_axes(const Observations &data, View &view) {
  std::vector<double> turn, rpm;
  for (std::size_t i = 0; i < data.size(); ++i) {
    turn.push_back(wrap(data.alpha[i], kTwoPi) * kDegPerRad);
    rpm.push_back(data.omega[i] * kRpmPerRad);
  }
  view.axes.push_back(axis_of("angle", "shaft angle, deg", std::move(turn), 72, true));
  view.axes.back().from = 0.0;
  view.axes.back().to = 360.0;
  view.axes.push_back(axis_of("time", "time, s", data.time, 72, true));
  if (view.scene.why_no_temperature.empty())
    view.axes.push_back(axis_of("temperature", "VTEMP, V", data.temp, 30, true));
  else
    view.missing.push_back("temperature: " + view.scene.why_no_temperature);
  if (view.scene.several_speeds || view.scene.both_directions)
    view.axes.push_back(axis_of("speed", "speed, rpm", std::move(rpm), 40, false));
  else
    view.missing.push_back("speed: one speed only");
}

/// The four components of a residual, in mV.
std::array<std::vector<double>, kComponents> components(const ResidualColumns &r, double mid_v) {
  std::array<std::vector<double>, kComponents> out;
  for (auto &v : out)
    v.resize(r.sin.size());
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double c = r.model_cos[i] - mid_v, s = r.model_sin[i] - mid_v;
    const double scale = 1e3 / std::max(std::hypot(c, s), 1e-9);
    out[kVsin][i] = 1e3 * r.sin[i];
    out[kVcos][i] = 1e3 * r.cos[i];
    out[kRadial][i] = (r.cos[i] * c + r.sin[i] * s) * scale;
    out[kTangential][i] = (r.sin[i] * c - r.cos[i] * s) * scale;
  }
  return out;
}

ResidualBins residual_bins(const Observations &data, const Model &model, const View &view) {
  const auto parts = components(residual_columns(data, model), 0.5 * view.scene.supply_v);
  ResidualBins out;
  for (const PlotAxis &axis : view.axes) {
    auto &bins = out.axis.emplace_back();
    for (std::size_t k = 0; k < kComponents; ++k)
      bins[k] = bin_means(axis.key, parts[k], axis.from, axis.to, axis.bins, 12);
  }
  return out;
}

/// Speeds that fill their range are a curve; a few held speeds are points.
void settle_continuity(View &view) {
  for (std::size_t a = 0; a < view.axes.size(); ++a)
    if (!view.axes[a].continuous)
      view.axes[a].continuous = 10 * view.final.axis[a][0].size() >= 7 * view.axes[a].bins;
}

/// Whether the effect that a rung adds is this finding: several of one kind differ in what was
/// chosen for them (an order, a channel, a moment).
bool same(const EffectInstance &added, const Finding &finding) {
  if (added.effect != finding.effect)
    return false;
  const auto parameters = added.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].role == Role::chosen && !std::isnan(added.values[k]) &&
        added.values[k] != finding.values[k])
      return false;
  return true;
}

std::vector<int> match_rungs(const Diagnosis &d) {
  std::vector<int> out(d.findings.size(), -1);
  for (std::size_t m = 1; m < std::min(d.ladder.size(), kMaxRungs); ++m)
    for (std::size_t f = 0; f < out.size(); ++f)
      if (out[f] < 0 && !d.ladder[m].effects.empty() &&
          same(d.ladder[m].effects.back(), d.findings[f])) {
        out[f] = static_cast<int>(m);
        break;
      }
  return out;
}

/// About two turns from the middle of the record; over the angle where a turn has few samples.
Stretch stretch_of(const Observations &all, const Diagnosis &d) {
  Stretch out;
  const std::size_t middle = all.size() / 2;
  std::size_t first = middle, last = middle;
  while (last + 1 < all.size() && last - first < 3000 &&
         std::abs(all.alpha[last] - all.alpha[first]) < 1.2 * kTwoPi)
    ++last;
  out.over_angle = last - first < 60;
  if (out.over_angle)
    last = std::min(all.size() - 1, first + 400);
  std::vector<std::uint32_t> index;
  const std::size_t step = std::max<std::size_t>(1, (last - first) / 400);
  for (std::size_t i = first; i <= last; i += step)
    index.push_back(static_cast<std::uint32_t>(i));
  if (out.over_angle)
    std::sort(index.begin(), index.end(), [&](std::uint32_t a, std::uint32_t b) {
      return wrap(all.alpha[a], kTwoPi) < wrap(all.alpha[b], kTwoPi);
    });
  const Observations some = all.select(index);
  const ResidualColumns base = residual_columns(some, d.baseline);
  const ResidualColumns extended = residual_columns(some, d.extended);
  out.key = some.time;
  if (out.over_angle)
    for (std::size_t i = 0; i < some.size(); ++i)
      out.key[i] = wrap(some.alpha[i], kTwoPi) * kDegPerRad;
  out.vsin = some.vsin;
  out.vcos = some.vcos;
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

Locus locus_of(const Observations &data, const Diagnosis &d, const PlotAxis &angle) {
  const ResidualColumns b = residual_columns(data, d.baseline);
  const ResidualColumns e = residual_columns(data, d.extended);
  return {over_turn(angle, b.model_sin), over_turn(angle, b.model_cos),
          over_turn(angle, b.sin),       over_turn(angle, b.cos),
          over_turn(angle, e.model_sin), over_turn(angle, e.model_cos),
          over_turn(angle, e.sin),       over_turn(angle, e.cos)};
}

/// Angle of the sensor under a model minus the reference.
std::vector<Bin> angle_error(const Observations &data, const Model &model, int periods) {
  const AngleSolver solver(model);
  std::vector<double> alpha = data.alpha, radius(data.size()), error(data.size()), key;
  const double period = kTwoPi / periods;
  solver.start(data.vsin, data.vcos, alpha);
  for (std::size_t i = 0; i < alpha.size(); ++i)
    alpha[i] += period * std::round((data.alpha[i] - alpha[i]) / period);
  solver.solve(data.conditions(), data.vsin, data.vcos, alpha, radius);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    error[i] = wrap_centred(alpha[i] - data.alpha[i], period) * kDegPerRad;
    key.push_back(wrap(data.alpha[i], kTwoPi) * kDegPerRad);
  }
  return bin_means(key, error, 0.0, 360.0, 72, 8);
}

} // namespace

const char *component_name(int component) {
  constexpr const char *kNames[] = {"VSIN", "VCOS", "radial", "tangential"};
  return kNames[component];
}

View make_view(const Diagnosis &d, const Capture &capture) {
  View view;
  view.scene = prepare(capture, false);
  if (d.verdict == Verdict::insufficient_data || view.scene.all.size() == 0)
    return view;
  const Observations &all = view.scene.all;
  const Observations data = all.select(thin(view.scene.train, kMostSamples));
  make_axes(data, view);
  for (std::size_t m = 0; m < std::min(d.ladder.size(), kMaxRungs); ++m)
    view.rungs.push_back(residual_bins(data, d.ladder[m], view));
  view.rung_of_finding = match_rungs(d);
  view.final = residual_bins(data, d.extended, view);
  settle_continuity(view);
  view.stretch = stretch_of(all, d);
  view.locus = locus_of(data, d, view.axes.front());
  std::vector<const Model *> models;
  for (std::size_t m = 0; m < view.rungs.size(); ++m)
    models.push_back(&d.ladder[m]);
  models.push_back(&d.extended);
  view.spectrum = residual_spectrum(all, models);
  if (view.scene.has_reference) {
    const Observations some = all.select(thin(view.scene.train, kMostSolved));
    view.base_angle_error = angle_error(some, d.baseline, view.scene.periods);
    view.extended_angle_error = angle_error(some, d.extended, view.scene.periods);
  }
  return view;
}

} // namespace ada
