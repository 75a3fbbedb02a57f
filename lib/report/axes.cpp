// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/axes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/angle.h"
#include "base/pick.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

constexpr double kRpmPerRad = 60.0 / kTwoPi;
constexpr std::size_t kFewest = 12; ///< samples of a bin

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

/// Few samples get few bins: at least two of them hold enough.
std::size_t bins_for(std::size_t samples, std::size_t most) {
  return std::clamp<std::size_t>(samples / (2 * kFewest), 6, most);
}

} // namespace

const char *component_name(int component) {
  constexpr const char *kNames[] = {"VSIN", "VCOS", "along the vector", "across the vector"};
  return kNames[component];
}

std::size_t PlotAxes::find(std::string_view name) const {
  const auto at =
      std::find_if(all.begin(), all.end(), [&](const auto &a) { return a.name == name; });
  return static_cast<std::size_t>(at - all.begin());
}

PlotAxes plot_axes(const Scene &scene, const Observations &data, double start_s, bool with_supply) {
  PlotAxes out;
  const std::size_t n = data.size();
  const int periods = scene.has_reference ? 1 : scene.periods;
  std::vector<double> turn(n), time(n), rpm(n);
  for (std::size_t i = 0; i < n; ++i) {
    turn[i] = wrap(periods * data.alpha[i], kTwoPi) * kDegPerRad;
    time[i] = data.time[i] - start_s;
    rpm[i] = data.omega[i] * kRpmPerRad;
  }
  // Without a reference nobody knows which of its periods the shaft is in.
  out.all.push_back(axis_of("angle",
                            scene.has_reference ? "shaft angle, deg" : "electrical angle, deg",
                            std::move(turn), bins_for(n, 72), true));
  out.all.back().from = 0.0;
  out.all.back().to = 360.0;
  out.all.push_back(
      axis_of("time", "time since the start, s", std::move(time), bins_for(n, 72), true));
  if (scene.several_speeds || scene.both_directions)
    out.all.push_back(axis_of("speed", "speed, rpm", std::move(rpm), bins_for(n, 40), false));
  else
    out.missing.push_back("speed (one speed only)");
  if (scene.why_no_temperature.empty())
    out.all.push_back(
        axis_of("temperature", "VTEMP, V", as_doubles(data.temp), bins_for(n, 30), true));
  else
    out.missing.push_back("temperature (" + scene.why_no_temperature + ")");
  if (data.supply.empty())
    out.missing.push_back("supply (VDD is not recorded)");
  else if (with_supply) {
    std::vector<double> vdd(n);
    for (std::size_t i = 0; i < n; ++i)
      vdd[i] = 100.0 * scene.supply_rms * static_cast<double>(data.supply[i]);
    out.all.push_back(
        axis_of("supply", "VDD, % off its mean", std::move(vdd), bins_for(n, 30), true));
  }
  return out;
}

ResidualColumns shown_residual(const Scene &scene, const Observations &data, const Model &model) {
  if (scene.radius_only)
    return residual_columns(at_own_angle(data, model), model);
  // The motion that is read off a pair has a zero of its own, and the model that of a reference
  // which was set aside.
  return residual_columns(data, scene.has_reference ? model : as_seen_by(data, model));
}

double mean_square(const ResidualColumns &r) {
  double sum = 0.0;
  for (const auto *column : {&r.sin, &r.cos})
    sum = std::inner_product(column->begin(), column->end(), column->begin(), sum);
  return r.sin.empty() ? 0.0 : sum / (2.0 * static_cast<double>(r.sin.size()));
}

std::array<std::vector<double>, kComponents> components(const Observations &data,
                                                        const ResidualColumns &r) {
  std::array<std::vector<double>, kComponents> out;
  for (auto &v : out)
    v.resize(r.sin.size());
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double c = r.model_cos[i] - data.centre_cos_v, s = r.model_sin[i] - data.centre_sin_v;
    const double scale = 1e3 / std::max(std::hypot(c, s), 1e-9);
    out[kVsin][i] = 1e3 * r.sin[i];
    out[kVcos][i] = 1e3 * r.cos[i];
    out[kAlong][i] = (r.cos[i] * c + r.sin[i] * s) * scale;
    out[kAcross][i] = (r.sin[i] * c - r.cos[i] * s) * scale;
  }
  return out;
}

ResidualBins residual_bins(const Observations &data, const ResidualColumns &residual,
                           const PlotAxes &axes) {
  const auto parts = components(data, residual);
  ResidualBins out;
  for (const PlotAxis &axis : axes.all) {
    auto &bins = out.axis.emplace_back();
    for (std::size_t k = 0; k < kComponents; ++k)
      bins[k] = bin_means(axis.key, parts[k], axis.from, axis.to, axis.bins, kFewest);
  }
  return out;
}

} // namespace ada
