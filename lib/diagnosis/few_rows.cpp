// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/few_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "base/angle.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/criteria.h"
#include "diagnosis/fit.h"
#include "diagnosis/spectrum.h"

namespace ada {

namespace {

/// Radial and tangential part, V.
struct Part {
  const char *of;
  std::vector<double> value;
};

std::vector<Part> parts_of(const Scene &scene, const Observations &data, const ResidualColumns &r) {
  std::vector<Part> out{{"the radius", {}}};
  if (scene.has_reference)
    out.push_back({"the angle", {}});
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double s = r.model_sin[i] - data.centre_sin_v, c = r.model_cos[i] - data.centre_cos_v;
    const double inverse = 1.0 / std::max(std::hypot(s, c), 1e-9);
    out[0].value.push_back((r.sin[i] * s + r.cos[i] * c) * inverse);
    if (scene.has_reference)
      out[1].value.push_back((r.sin[i] * c - r.cos[i] * s) * inverse);
  }
  return out;
}

/// Turns that all rows stand for, each as far as from one to the next.
double turns_of(const Observations &data) {
  const double rows = static_cast<double>(data.size());
  return travel_of(data.alpha) / kTwoPi * rows / (rows - 1.0);
}

} // namespace

std::vector<Structure> find_lines_of_rows(const Scene &scene, const Observations &data,
                                          const ResidualColumns &residual, double least_rms_v) {
  std::vector<Structure> out;
  const double rows = static_cast<double>(data.size());
  const double turns = turns_of(data);
  for (const Part &part : parts_of(scene, data, residual)) {
    double squares = 0.0;
    for (double v : part.value)
      squares += v * v;
    for (const RowLine &line :
         standing_lines(part.value, criteria::kFewestPeriodsOfRows, criteria::kChanceOfLine)) {
      const double rms_v = std::sqrt(line.share * squares / rows / 2.0); // of a channel
      if (rms_v < least_rms_v)
        break;
      const std::string a_turn =
          turns > 0.5 ? fmt::format(", {:.3g} times a turn", line.periods / turns) : "";
      out.push_back({"frequency",
                     fmt::format("a line of {:.3g} mV rms in {} comes every {:.3g} readings{}",
                                 1e3 * rms_v, part.of, rows / line.periods, a_turn),
                     rms_v});
    }
  }
  return out;
}

double between_stops_v(const Scene &scene, const Observations &data,
                       const ResidualColumns &residual) {
  // Standard deviations of the logarithm of a ratio of variances: by chance once in 30,000.
  constexpr double kClear = 4.0;
  if (!scene.stops)
    return 0.0;
  // A drift has parts of a stop differ by less than neighbouring stops: of a random walk the
  // variances are one to four.
  constexpr double kOfWalk = 4.0;
  double steps2 = 0.0, halves2 = 0.0, stops = 0.0;
  std::array<double, 2> before{};
  for (std::size_t from = 0, to = 0; from < data.size(); from = to) {
    for (to = from + 1; to < data.size() &&
                        std::abs(data.alpha[to] - data.alpha[to - 1]) < criteria::kStopMovesRad;)
      ++to;
    if (static_cast<double>(to - from) < criteria::kFewestReadings)
      continue;
    // What the halves of a stop differ by holds a noise that remembers itself as well.
    const std::size_t middle = from + (to - from) / 2;
    for (std::size_t c = 0; c < before.size(); ++c) {
      const std::vector<double> &v = c == 0 ? residual.sin : residual.cos;
      const auto mean = [&](std::size_t begin, std::size_t end) {
        return std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(begin),
                               v.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
               static_cast<double>(end - begin);
      };
      const double here = mean(from, to);
      steps2 += stops > 0.0 ? 0.5 * std::pow(here - before[c], 2) : 0.0;
      halves2 += 0.25 * std::pow(mean(from, middle) - mean(middle, to), 2);
      before[c] = here;
    }
    stops += 1.0;
  }
  if (stops < static_cast<double>(criteria::kFewestStops) ||
      !(std::log(steps2 / std::max(kOfWalk * halves2, 1e-300)) > kClear * std::sqrt(2.0 / stops)))
    return 0.0;
  return std::sqrt((steps2 - halves2) / (2.0 * stops));
}

double share_of_lines_across(const Scene &scene, const Model &model) {
  const Observations &data = scene.all;
  if (!scene.has_reference || scene.stops || data.size() >= criteria::kFewestForMeans)
    return 0.0;
  double sum = 0.0;
  for (const RowLine &line :
       standing_lines(parts_of(scene, data, residual_columns(data, model)).back().value,
                      criteria::kFewestPeriodsOfRows, criteria::kChanceOfLine))
    sum += line.share;
  return sum;
}

} // namespace ada
