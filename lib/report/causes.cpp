// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/causes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/angle.h"
#include "diagnosis/anonymous/regression.h"

namespace ada {

namespace {

constexpr std::size_t kMostShared = 12000; ///< for the shares
constexpr int kOrders = 24;
constexpr double kNothingV = 1e-9;

/// Whether this part of a model is this finding: several of one kind differ in what was chosen for
/// them (an order, a channel, a moment).
bool same(const EffectInstance &instance, const Finding &finding) {
  if (instance.effect != finding.effect)
    return false;
  const auto parameters = instance.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].role == Role::chosen && !std::isnan(instance.values[k]) &&
        instance.values[k] != finding.values[k])
      return false;
  return true;
}

Axis axis_of(std::string_view name) {
  for (std::size_t k = 0; k < kAxes; ++k)
    if (axis_name(static_cast<Axis>(k)) == name)
      return static_cast<Axis>(k);
  return Axis::noise;
}

/// Regression of what a cause does on the generic shapes, axis by axis as in the budget. What none
/// of them takes (a tone, a step) belongs to the axis on which the effect says that it lies.
std::array<double, kAxes> shares(const Basis &baseline, const Basis &generic,
                                 const Observations &data, ResidualColumns does, Axis own) {
  const auto regress = [&](const Basis &basis) {
    const Eigen::MatrixXd gram = gram_of(basis, data, does);
    const double n = 2.0 * static_cast<double>(data.size());
    return select(basis, {gram, gram, n, n});
  };
  subtract(baseline, regress(baseline), data, does);
  const Selection by_axis = regress(generic);
  std::array<double, kAxes> out = by_axis.share_v2;
  out[static_cast<std::size_t>(own)] += by_axis.noise_v2;
  return out;
}

} // namespace

std::vector<CauseView> cause_views(const Diagnosis &d, const Scene &scene, const Observations &data,
                                   const ResidualColumns &final, const PlotAxes &axes) {
  std::vector<CauseView> out(d.findings.size());
  std::vector<std::uint32_t> every(data.size());
  std::iota(every.begin(), every.end(), 0u);
  const Observations some = data.select(thin(every, kMostShared));
  const ResidualColumns final_of_some = shown_residual(scene, some, d.extended);
  const double zero_rad = d.extended.baseline.angle_zero_deg * kRadPerDeg;
  Basis baseline(scene.periods, zero_rad);
  baseline.scale_to(some);
  baseline.add(Axis::angle, 1, 0);
  baseline.add(Axis::angle, 1, scene.periods);
  const Basis generic = generic_basis(scene, some, zero_rad, kOrders, {}, {}, {});
  std::vector<char> taken(d.extended.effects.size(), 0);
  for (std::size_t f = 0; f < out.size(); ++f) {
    CauseView &view = out[f];
    std::size_t at = 0;
    while (at < taken.size() && (taken[at] || !same(d.extended.effects[at], d.findings[f])))
      ++at;
    if (at == taken.size())
      continue;
    taken[at] = 1;
    view.without = d.extended.without(at);
    const auto minus = [](ResidualColumns a, const ResidualColumns &b) {
      for (std::size_t i = 0; i < a.sin.size(); ++i) {
        a.sin[i] -= b.sin[i];
        a.cos[i] -= b.cos[i];
      }
      return a;
    };
    const ResidualColumns left = shown_residual(scene, data, view.without);
    view.rms_v = std::sqrt(mean_square(minus(left, final)));
    view.drawn = view.rms_v > kNothingV && std::isfinite(view.rms_v);
    if (!view.drawn)
      continue;
    view.bins = residual_bins(data, left, axes);
    view.share_v2 = shares(baseline, generic, some,
                           minus(shown_residual(scene, some, view.without), final_of_some),
                           axis_of(d.findings[f].effect->info().axis));
  }
  return out;
}

std::vector<double> named_parts(const BudgetLine &line, const std::vector<Finding> &findings,
                                const std::vector<CauseView> &causes) {
  const auto axis = static_cast<std::size_t>(line.axis);
  const double named_v2 = line.named_rms_v * line.named_rms_v;
  std::vector<double> out(causes.size(), 0.0);
  double sum = 0.0, undrawn = 0.0;
  for (std::size_t f = 0; f < out.size(); ++f) {
    out[f] = causes[f].share_v2[axis];
    sum += out[f];
    undrawn += !causes[f].drawn && axis_of(findings[f].effect->info().axis) == line.axis;
  }
  if (undrawn > 0.0 && sum < named_v2) {
    for (std::size_t f = 0; f < out.size(); ++f)
      if (!causes[f].drawn && axis_of(findings[f].effect->info().axis) == line.axis)
        out[f] = (named_v2 - sum) / undrawn;
    sum = named_v2;
  }
  for (double &part : out)
    part = sum > 0.0 && std::isfinite(sum) ? std::sqrt(named_v2 * part / sum) : 0.0;
  return out;
}

} // namespace ada
