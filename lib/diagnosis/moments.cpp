// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/moments.h"

#include <algorithm>

#include "diagnosis/candidates.h"
#include "diagnosis/fit.h"

namespace ada {

namespace {

/// Part of the record to look at on either side: more than the thinned samples leave out.
constexpr double kReach = 0.03;

std::vector<std::uint32_t> samples_near(const std::vector<double> &time, double moment) {
  const double reach = kReach * (time.back() - time.front());
  const auto from = std::lower_bound(time.begin(), time.end(), moment - reach);
  const auto to = std::upper_bound(from, time.end(), moment + reach);
  std::vector<std::uint32_t> out;
  for (auto it = from; it != to; ++it)
    out.push_back(static_cast<std::uint32_t>(it - time.begin()));
  return out;
}

} // namespace

bool has_moment(const Effect &effect) {
  const auto parameters = effect.info().parameters;
  return effect.info().evidence == Evidence::signal && !parameters.empty() &&
         parameters[0].name == "time_s" && parameters[0].role == Role::chosen;
}

Model with_exact_moments(const Scene &scene, Model model, std::size_t first) {
  for (std::size_t k = first; k < model.effects.size(); ++k) {
    EffectInstance &e = model.effects[k];
    if (!has_moment(*e.effect))
      continue;
    Model less = model;
    less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(k));
    const Observations near = scene.all.select(samples_near(scene.all.time, e.values[0]));
    const ResidualColumns columns = residual_columns(near, less);
    const Residual residual =
        residual_view(scene, near, columns, scene.white_noise_v, model.baseline.amplitude_v);
    const auto guesses = e.effect->guesses(residual);
    if (!guesses.empty())
      e.values[0] = guesses.front()[0];
  }
  return model;
}

} // namespace ada
