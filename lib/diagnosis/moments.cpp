// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/moments.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "diagnosis/fit.h"

namespace ada {

namespace {

/// Parts of the record to look at on either side: more than the thinned samples leave out, and more
/// where that is not enough.
constexpr double kReach[] = {0.03, 0.1, 0.3};

/// Samples about a moment, across what the training part leaves out there: a long standstill may
/// lie within one turn that is held back.
std::vector<std::uint32_t> samples_near(const Scene &scene, double moment, double part) {
  const std::vector<double> &time = scene.all.time;
  double first = moment, last = moment;
  const auto next = std::lower_bound(scene.train.begin(), scene.train.end(), moment,
                                     [&](std::uint32_t i, double t) { return time[i] < t; });
  if (next != scene.train.end())
    last = time[*next];
  if (next != scene.train.begin())
    first = time[*std::prev(next)];
  const double reach = part * (time.back() - time.front());
  const auto from = std::lower_bound(time.begin(), time.end(), first - reach);
  const auto to = std::upper_bound(from, time.end(), last + reach);
  std::vector<std::uint32_t> out(static_cast<std::size_t>(to - from));
  std::iota(out.begin(), out.end(), static_cast<std::uint32_t>(from - time.begin()));
  return out;
}

/// The moment that leaves the least sum of squares, with the size of the step as it is: a sample
/// before it is judged without the effect, one from it on with. It lies between two samples, which
/// are far apart where those between them are of no use. False when the end of what was looked at
/// is the best place.
bool set_exact_moment(const Scene &scene, Model &model, std::size_t effect, double part) {
  EffectInstance &e = model.effects[effect];
  const Observations near = scene.all.select(samples_near(scene, e.values[0], part));
  Model less = model, always = model;
  less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  always.effects[effect].values[0] = std::numeric_limits<double>::lowest();
  const ResidualColumns before = residual_columns(near, less);
  const ResidualColumns after = residual_columns(near, always);
  const auto square = [&](const ResidualColumns &r, std::size_t i) {
    double s = r.sin[i], c = r.cos[i];
    near.whiten(i, s, c);
    return s * s + c * c;
  };
  double sum = 0.0, least = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    sum += square(before, i) - square(after, i);
    if (sum < least) {
      least = sum;
      at = i + 1;
    }
  }
  if (at == 0 || at == near.size())
    return false;
  e.values[0] = 0.5 * (near.time[at - 1] + near.time[at]);
  e.std_errors.resize(e.values.size());
  e.std_errors[0] = (near.time[at] - near.time[at - 1]) / std::sqrt(12.0);
  return true;
}

} // namespace

bool has_moment(const Effect &effect) {
  const auto parameters = effect.info().parameters;
  return effect.info().evidence == Evidence::signal && !parameters.empty() &&
         parameters[0].name == "time_s" && parameters[0].role == Role::chosen;
}

Model with_exact_moments(const Scene &scene, Model model, std::size_t first) {
  for (std::size_t k = first; k < model.effects.size(); ++k)
    if (has_moment(*model.effects[k].effect))
      for (double part : kReach)
        if (set_exact_moment(scene, model, k, part))
          break;
  return model;
}

} // namespace ada
