// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "diagnosis/repetition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <vector>

#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Sums of the residuals of one pass through one place.
struct Visit {
  double sin = 0.0, cos = 0.0, n = 0.0;
};

/// Which pass each sample belongs to: a new one begins wherever the shaft is `far` from where the
/// last one began. One that rests, or dithers about the border of a place, does not pass it again.
std::vector<std::size_t> passes_of(const Observations &data, double far_rad) {
  std::vector<std::size_t> out(data.size());
  double began = data.alpha.empty() ? 0.0 : data.alpha.front();
  std::size_t pass = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (std::abs(data.alpha[i] - began) >= far_rad) {
      began = data.alpha[i];
      ++pass;
    }
    out[i] = pass;
  }
  return out;
}

} // namespace

std::optional<Repeated> repeated_v2(const Observations &data, const ResidualColumns &rest,
                                    double turn_rad, double cell_rad) {
  const auto cells = static_cast<std::size_t>(std::ceil(turn_rad / cell_rad));
  constexpr double kFarInCells = 4.0;
  const std::vector<std::size_t> pass = passes_of(data, kFarInCells * cell_rad);
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
  // Two passes of an arc that is long beside what noise remembers: their product over its places.
  // Of two that are independent the sign is chance.
  constexpr std::size_t kArcs = 8; // a turn
  std::map<std::array<std::size_t, 3>, double> products;
  double weights = 0.0;
  std::size_t passed = 0, twice = 0;
  for (std::size_t k = 0; k < cells; ++k) {
    const auto &cell = visits[k];
    const std::size_t arc = k * kArcs / cells;
    bool again = false;
    for (auto a = cell.begin(); a != cell.end(); ++a)
      for (auto b = std::next(a); b != cell.end(); ++b) {
        if (b->first - a->first < 2)
          continue;
        products[{arc, a->first, b->first}] +=
            a->second.sin * b->second.sin + a->second.cos * b->second.cos;
        weights += 2.0 * a->second.n * b->second.n;
        again = true;
      }
    passed += !cell.empty();
    twice += again;
  }
  if (2 * twice < passed || !(weights > 0.0))
    return std::nullopt;
  double sum = 0.0, squares = 0.0;
  for (const auto &[passes, product] : products) {
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
