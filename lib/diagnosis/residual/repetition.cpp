// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "diagnosis/residual/repetition.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Where a sample lies on the way of the shaft, turnings back included, and on which pass.
struct OnTheWay {
  double way_rad;
  std::uint32_t pass;
};

/// A pass ends where the shaft is `far` from where it began, and where it turns back by a cell. One
/// that rests, or dithers about the border of a place, goes no way and does not pass it again.
std::vector<OnTheWay> way_of(const Observations &data, double far_rad, double cell_rad) {
  std::vector<OnTheWay> out(data.size());
  double began = data.alpha.empty() ? 0.0 : data.alpha.front(), furthest = began, before = 0.0;
  std::uint32_t pass = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double at = data.alpha[i];
    if (std::abs(at - began) > std::abs(furthest - began))
      furthest = at;
    if (std::abs(furthest - at) > cell_rad) { // it has turned back
      before += std::abs(furthest - began);
      began = std::exchange(furthest, at);
      ++pass;
    } else if (std::abs(at - began) >= far_rad) {
      before += std::abs(at - began);
      began = furthest = at;
      ++pass;
    }
    out[i] = {before + std::abs(furthest - began), pass};
  }
  return out;
}

/// One pass through one place: how many samples, and sums of their residuals and ways.
struct Visit {
  double n = 0.0, sin = 0.0, cos = 0.0, way_rad = 0.0;
};

/// Residuals beyond so many times their usual size count as that: a spike is no matter of the
/// place.
std::vector<double> without_spikes(std::vector<double> r) {
  constexpr double kMost = 10.0;
  std::vector<double> sizes(r);
  for (double &x : sizes)
    x = std::abs(x);
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  const double most = kMost * *middle;
  if (most > 0.0)
    for (double &x : r)
      x = std::clamp(x, -most, most);
  return r;
}

} // namespace

std::optional<Repeated> repeated_v2(const Observations &data, const ResidualColumns &rest,
                                    double turn_rad, double cell_rad) {
  constexpr double kFarInCells = 4.0, kApartInCells = 2.0;
  constexpr double kMostTurns = 24.0; // of the way, evenly over the record: more tell no more
  constexpr std::size_t kArcs = 8;    // of a turn
  if (data.size() == 0)
    return std::nullopt;
  const auto cells = static_cast<std::size_t>(std::ceil(turn_rad / cell_rad));
  const std::vector<OnTheWay> way = way_of(data, kFarInCells * cell_rad, cell_rad);
  const std::vector<double> sin = without_spikes(rest.sin), cos = without_spikes(rest.cos);
  // Of those that there are samples in: of a shaft that leaps most are none.
  const auto turn_of = [&](std::size_t i) { return std::floor(way[i].way_rad / turn_rad); };
  double turns = 1.0;
  for (std::size_t i = 1; i < data.size(); ++i)
    turns += turn_of(i) != turn_of(i - 1);
  const double thinned = std::min(1.0, kMostTurns / turns);
  std::vector<std::map<std::uint32_t, Visit>> visits(cells);
  double turn = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    turn += i > 0 && turn_of(i) != turn_of(i - 1);
    if (std::floor((turn + 1.0) * thinned) == std::floor(turn * thinned))
      continue;
    const double place = data.alpha[i] / turn_rad;
    const auto cell = std::min(cells - 1, static_cast<std::size_t>((place - std::floor(place)) *
                                                                   static_cast<double>(cells)));
    Visit &v = visits[cell][way[i].pass];
    v.n += 1.0;
    v.sin += sin[i];
    v.cos += cos[i];
    v.way_rad += way[i].way_rad;
  }
  // A rest is one visit, however long it is.
  std::vector<double> counts;
  for (const auto &cell : visits)
    for (const auto &[pass, v] : cell)
      counts.push_back(v.n);
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::ranges::nth_element(counts, middle);
  const double usual = *middle;
  // Two passes of an arc that is long beside what noise remembers: their product over its places.
  // Of two that are independent the sign is chance.
  std::map<std::array<std::size_t, 3>, double> products;
  double weights = 0.0;
  std::size_t passed = 0, twice = 0;
  for (std::size_t k = 0; k < cells; ++k) {
    const auto &cell = visits[k];
    bool again = false;
    for (auto a = cell.begin(); a != cell.end(); ++a)
      for (auto b = std::next(a); b != cell.end(); ++b) {
        const Visit &one = a->second, &other = b->second;
        if (other.way_rad / other.n - one.way_rad / one.n < kApartInCells * cell_rad)
          continue;
        const double weight = std::min(one.n, usual) * std::min(other.n, usual);
        products[{k * kArcs / cells, a->first, b->first}] +=
            weight * (one.sin * other.sin + one.cos * other.cos) / (one.n * other.n);
        weights += 2.0 * weight;
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

namespace {

/// Sums over so many stretches of rows, each as long as the others.
std::vector<double> in_stretches(const std::vector<double> &gain,
                                 std::span<const std::uint32_t> rows, std::size_t stretches) {
  std::vector<double> out(stretches, 0.0);
  for (std::size_t k = 0; k < rows.size(); ++k)
    out[k * stretches / rows.size()] += gain[rows[k]];
  return out;
}

/// A sum in its standard errors, by how its parts scatter.
double in_errors(std::span<const double> parts) {
  const double n = static_cast<double>(parts.size()),
               sum = std::accumulate(parts.begin(), parts.end(), 0.0);
  double squares = 0.0;
  for (double part : parts)
    squares += std::pow(part - sum / n, 2);
  return sum / std::max(std::sqrt(squares * n / (n - 1.0)), 1e-300);
}

} // namespace

bool takes_throughout(const Observations &data, const ResidualColumns &with,
                      const ResidualColumns &without, bool clearly) {
  constexpr std::size_t kStretches = 32, kTrimmed = 4; // at either end
  constexpr std::size_t kSpeeds = 8, kOfSpeed = 16, kFewest = 512;
  constexpr double kOneSpeed = 0.02; // of their range: no more than that is one speed
  const std::size_t n = data.size();
  if (n < kFewest)
    return true;
  std::vector<double> gain(n);
  for (std::size_t i = 0; i < n; ++i)
    gain[i] = without.sin[i] * without.sin[i] + without.cos[i] * without.cos[i] -
              with.sin[i] * with.sin[i] - with.cos[i] * with.cos[i];
  std::vector<std::uint32_t> rows(n);
  std::iota(rows.begin(), rows.end(), 0u);
  std::vector<double> stretches = in_stretches(gain, rows, kStretches);
  std::ranges::sort(stretches);
  const std::span<const double> middle(stretches.data() + kTrimmed, kStretches - 2 * kTrimmed);
  if (!(in_errors(middle) > (clearly ? criteria::kClearErrors : 0.0)))
    return false;
  std::ranges::stable_sort(rows, {}, [&](std::uint32_t i) { return data.omega[i]; });
  const double alike = kOneSpeed * (data.omega[rows.back()] - data.omega[rows.front()]);
  for (std::size_t first = 0, end = 0; first < n; first = end) {
    end = std::min(n, first + n / kSpeeds);
    while (end < n && data.omega[rows[end]] - data.omega[rows[first]] <= alike)
      ++end;
    if (n - end < n / (2 * kSpeeds)) // the rest is too few for a group of its own
      end = n;
    std::vector<std::uint32_t> group(rows.begin() + static_cast<std::ptrdiff_t>(first),
                                     rows.begin() + static_cast<std::ptrdiff_t>(end));
    std::ranges::sort(group); // in time: what has a memory is in one part
    if (in_errors(in_stretches(gain, group, kOfSpeed)) < -criteria::kClearErrors)
      return false;
  }
  return true;
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
