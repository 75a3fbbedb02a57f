// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "diagnosis/repetition.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Sums of the residuals of one pass through one place.
struct Visit {
  double sin = 0.0, cos = 0.0, n = 0.0;
};

/// Which pass each sample belongs to: a new one begins after every half turn of way, so that a
/// shaft that dithers about the border of a place does not pass it again.
std::vector<std::size_t> passes_of(const Observations &data, double turn_rad) {
  std::vector<std::size_t> out(data.size());
  double way = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i > 0)
      way += std::abs(data.alpha[i] - data.alpha[i - 1]);
    out[i] = static_cast<std::size_t>(way / (0.5 * turn_rad));
  }
  return out;
}

} // namespace

std::optional<Repeated> repeated_v2(const Observations &data, const ResidualColumns &rest,
                                    double turn_rad, double cell_rad) {
  const auto cells = static_cast<std::size_t>(std::ceil(turn_rad / cell_rad));
  const std::vector<std::size_t> pass = passes_of(data, turn_rad);
  std::vector<std::map<std::size_t, Visit>> visits(cells);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double place = data.alpha[i] / turn_rad;
    const auto cell = std::min(cells - 1, static_cast<std::size_t>((place - std::floor(place)) *
                                                                   static_cast<double>(cells)));
    Visit &v = visits[cell][pass[i]];
    v.sin += rest.sin[i];
    v.cos += rest.cos[i];
    v.n += 1.0;
  }
  // Two passes, each with all of its places: their product over the places that both have. Of two
  // that are independent its sign is chance.
  std::map<std::pair<std::size_t, std::size_t>, double> products;
  double weights = 0.0;
  std::size_t twice = 0;
  for (const auto &cell : visits) {
    bool again = false;
    for (auto a = cell.begin(); a != cell.end(); ++a)
      for (auto b = std::next(a); b != cell.end(); ++b) {
        if (b->first - a->first < 2)
          continue;
        products[{a->first, b->first}] +=
            a->second.sin * b->second.sin + a->second.cos * b->second.cos;
        weights += 2.0 * a->second.n * b->second.n;
        again = true;
      }
    twice += again;
  }
  if (2 * twice < cells || !(weights > 0.0))
    return std::nullopt;
  double sum = 0.0, squares = 0.0;
  for (const auto &[pair, product] : products) {
    sum += product;
    squares += product * product;
  }
  return Repeated{sum / weights, std::sqrt(squares) / weights};
}

double goes_on_v(const ResidualColumns &r) {
  constexpr double kOfRest = 0.25; // of the power: 12 % of the rms
  const auto sign = [](double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; };
  double squares = 0.0, products = 0.0, signs = 0.0, scatter = 0.0;
  for (std::size_t i = 1; i < r.sin.size(); ++i) {
    const double of_sin = r.sin[i] * r.sin[i - 1], of_cos = r.cos[i] * r.cos[i - 1];
    squares += r.sin[i] * r.sin[i] + r.cos[i] * r.cos[i];
    products += of_sin + of_cos;
    const double both = sign(of_sin) + sign(of_cos); // of one row they may be the same noise
    signs += both;
    scatter += both * both;
  }
  return products > kOfRest * (squares - products) &&
                 signs > criteria::kClearErrors * std::sqrt(scatter)
             ? std::sqrt(products / (2.0 * static_cast<double>(r.sin.size())))
             : 0.0;
}

} // namespace ada
