// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/residual/few_rows.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "base/angle.h"
#include "diagnosis/anonymous/basis.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/criteria.h"
#include "diagnosis/lines/spectrum.h"
#include "diagnosis/search/fit.h"

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

/// Without what goes with the angle: cosine and sine of each order up to `orders`, the angle
/// counted `times`. Read at places that come unevenly one order is many lines.
std::vector<double> without_orders(const std::vector<double> &value, const Observations &data,
                                   int orders, double times) {
  const auto rows = static_cast<Eigen::Index>(value.size());
  Eigen::MatrixXd x(rows, 2 * orders + 1);
  x.col(0).setOnes();
  for (Eigen::Index i = 0; i < rows; ++i)
    for (int k = 1; k <= orders; ++k) {
      const double at = k * times * data.alpha[static_cast<std::size_t>(i)];
      x(i, 2 * k - 1) = std::cos(at);
      x(i, 2 * k) = std::sin(at);
    }
  const Eigen::Map<const Eigen::VectorXd> y(value.data(), rows);
  const Eigen::VectorXd rest = y - x * x.colPivHouseholderQr().solve(y);
  return {rest.begin(), rest.end()};
}

/// Turns that all rows stand for, each as far as from one to the next.
double turns_of(const Observations &data) {
  const double rows = static_cast<double>(data.size());
  return travel_of(data.alpha) / kTwoPi * rows / (rows - 1.0);
}

} // namespace

std::vector<Structure> find_lines_of_rows(const Scene &scene, const Observations &data,
                                          const ResidualColumns &residual, double least_rms_v,
                                          int orders) {
  std::vector<Structure> out;
  const double rows = static_cast<double>(data.size());
  const double turns = turns_of(data);
  for (Part &part : parts_of(scene, data, residual)) {
    if (const int most = std::min(orders, static_cast<int>(rows / criteria::kSamplesPerOrder));
        most > 0)
      part.value = without_orders(part.value, data, most, in_turns(scene) ? 1 : scene.periods);
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
