// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/discrepancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "base/products.h"
#include "diagnosis/criteria.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

struct Power {
  double sum = 0.0, weight = 0.0, weight2 = 0.0;
  void add(double power, double w) {
    sum += w * power;
    weight += w;
    weight2 += w * w;
  }
  /// Of so many coefficients of one weight the mean would be as certain.
  double freedom() const { return weight2 > 0.0 ? weight * weight / weight2 : 0.0; }
  double mean() const { return weight > 0.0 ? std::max(0.0, sum / weight) : 0.0; }
};

/// Mean power of the orders next to one, without that of its own. `along`: and without the largest,
/// as the length of the vector has one that stands alone, once a turn, where a magnet runs out of
/// true; flaws of a magnet that turn the vector have a series of orders.
Power power_about(const std::map<int, Power> &orders, int order, bool along) {
  std::vector<std::pair<double, Power>> near; // mean power, and its part
  for (int d : {-2, -1, 1, 2})
    if (const auto at = orders.find(order + d); at != orders.end()) {
      const double w = criteria::kNeighbourWeight[static_cast<std::size_t>(std::abs(d)) - 1];
      const Power &p = at->second;
      near.push_back({p.mean(), {w * p.sum, w * p.weight, w * w * p.weight2}});
    }
  if (along && near.size() > 1)
    near.erase(std::max_element(near.begin(), near.end(),
                                [](const auto &a, const auto &b) { return a.first < b.first; }));
  Power out;
  for (const auto &[mean, p] : near) {
    out.sum += p.sum;
    out.weight += p.weight;
    out.weight2 += p.weight2;
  }
  return out;
}

} // namespace

Discrepancy discrepancy_of(const Basis &basis, const Selection &selection, const Products &from,
                           Stands alone) {
  Discrepancy out;
  if (selection.columns.empty())
    return out;
  out.basis = basis;
  // Causes live at low orders; what lies above counts as noise.
  double above = 0.0;
  const int named = std::max(criteria::kNamedOrders, criteria::kNamedPeriods * basis.periods());
  std::vector<Eigen::Index> place;
  for (std::size_t k = 0; k < selection.columns.size(); ++k) {
    const Group &g = basis.groups()[static_cast<std::size_t>(selection.columns[k] / 2)];
    const double value = selection.values[static_cast<Eigen::Index>(k)];
    if (g.order == kOfBaseline)
      continue; // no discrepancy: it is fitted
    if (g.axis == Axis::angle && g.order > named)
      above += 0.5 * value * value;
    else
      place.push_back(static_cast<Eigen::Index>(k));
  }
  for (Eigen::Index k : place)
    out.columns.push_back(selection.columns[static_cast<std::size_t>(k)]);
  out.noise_v2 = std::max(selection.train_v2 + above, criteria::kLeastMeanSquare);
  out.rest_v2 = selection.train_v2;
  const auto n = static_cast<Eigen::Index>(out.columns.size());
  const Eigen::VectorXd stiffness = basis.stiffness();
  const Eigen::MatrixXd gram = from.train(out.columns, out.columns);
  const Eigen::MatrixXd a = ridged(gram, selection.ridge, stiffness(out.columns), from.n_train);
  const Eigen::VectorXd variance =
      a.ldlt().solve(Eigen::MatrixXd::Identity(n, n)).diagonal() * out.noise_v2;
  const Eigen::VectorXd values = selection.values(place);
  // Power of each coefficient without what noise alone gives.
  const auto power = [&](Eigen::Index k) { return values[k] * values[k] - variance[k]; };
  // Angle, by order, along the vector and across it: flaws of a magnet turn the vector and leave
  // its length, so that what changes the length stands out of them.
  std::array<std::map<int, Power>, 2> own, met;             // the latter: as its neighbours meet it
  std::map<std::tuple<Axis, bool, int>, Power> of_function; // others, by axis and exponent
  const auto term_of = [&](Eigen::Index k) -> const Basis::Term & {
    return basis.terms()[static_cast<std::size_t>(out.columns[static_cast<std::size_t>(k)] / 2)];
  };
  const auto group_of = [&](Eigen::Index k) -> const Group & {
    return basis.groups()[static_cast<std::size_t>(out.columns[static_cast<std::size_t>(k)] / 2)];
  };
  // Real coefficients of a modulated vector lie along it, imaginary ones across; others are both.
  const auto parts_of = [&](Eigen::Index k) -> std::vector<std::size_t> {
    if (term_of(k).modulation.kind == Modulation::none)
      return {0, 1};
    return {static_cast<std::size_t>(out.columns[static_cast<std::size_t>(k)] % 2)};
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    const Group &g = group_of(k);
    if (g.axis == Axis::angle) {
      // The order of a period has one side only and cannot be split. It counts as across, as nearly
      // all does that repeats with the angle: a magnet's flaw there is no change of length.
      const std::vector<std::size_t> parts = parts_of(k);
      for (std::size_t part : parts) // of all its coefficients: where an angle is zero is no matter
        own[part][g.order].add(power(k), 1.0);
      for (std::size_t part : parts.size() == 1 ? parts : std::vector<std::size_t>{1})
        met[part][g.order].add(power(k), 1.0);
    } else
      of_function[{g.axis, g.of_step, term_of(k).exponent}].add(power(k), 1.0);
  }
  out.variance_v2.resize(n);
  // Orders above the highest that held-out data admit hold nothing.
  const int highest = selection.orders[static_cast<std::size_t>(Axis::angle)];
  for (auto &of_part : met)
    for (int order : {highest + 1, highest + 2})
      of_part[order].add(0.0, 2.0);
  // The sense and the speed of a shaft that has one look alike, and may be large and cancel each
  // other. All of that axis together are no larger than what they make. On the other axes functions
  // are orthogonal: lines that cancel before and after a burst add up in it.
  double together = 0.0, apart = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (group_of(k).axis != Axis::speed)
      continue;
    apart += values[k] * values[k] * gram(k, k);
    for (Eigen::Index j = 0; j < n; ++j)
      if (group_of(j).axis == Axis::speed)
        together += values[k] * values[j] * gram(std::max(k, j), std::min(k, j));
  }
  double freedom = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Group &g = group_of(k);
    double local = 0.0, from_so_many = 0.0;
    const auto take = [&](const Power &of, double part) {
      local += part * of.mean();
      from_so_many += part * of.freedom();
    };
    if (g.axis == Axis::angle)
      for (std::size_t part : parts_of(k))
        take(power_about(met[part], g.order, part == 0),
             1.0 / static_cast<double>(parts_of(k).size()));
    else
      take(of_function[{g.axis, g.of_step, term_of(k).exponent}],
           g.axis == Axis::speed && apart > 0.0 ? std::clamp(together / apart, 0.0, 1.0) : 1.0);
    if (g.axis == Axis::angle && alone == Stands::for_good)
      for (std::size_t part : parts_of(k))
        local = std::max(local, own[part][g.order].mean());
    out.variance_v2[k] = std::max(local, criteria::kLeastOfResolution * variance[k]);
    freedom += out.variance_v2[k] * from_so_many;
  }
  out.freedom = n > 0 ? freedom / out.variance_v2.sum() : 0.0;
  return out;
}

Coloured::Coloured(const Discrepancy &discrepancy, const Observations &data)
    : freedom_(discrepancy.freedom), rest_v2_(discrepancy.rest_v2) {
  const auto m = static_cast<Eigen::Index>(discrepancy.columns.size());
  rows_.resize(m, static_cast<Eigen::Index>(2 * data.size()));
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(m, m);
  const auto add = [&](Eigen::MatrixXd &sum, std::size_t first, std::size_t n) {
    const auto values = static_cast<Eigen::Index>(2 * n);
    Eigen::MatrixXd all(static_cast<Eigen::Index>(discrepancy.basis.columns()), values);
    discrepancy.basis.evaluate(data, first, n, all);
    Eigen::MatrixXd block = all(discrepancy.columns, Eigen::all);
    if (data.weight_along != 1.0)
      for (std::size_t i = 0; i < n; ++i) {
        const auto whiten = data.whitener_at(first + i, data.vsin[first + i], data.vcos[first + i]);
        for (Eigen::Index k = 0; k < m; ++k)
          whiten(block(k, static_cast<Eigen::Index>(2 * i)),
                 block(k, static_cast<Eigen::Index>(2 * i + 1)));
      }
    add_squares(block, sum);
    rows_.middleCols(static_cast<Eigen::Index>(2 * first), values) = block;
  };
  Eigen::MatrixXd inner = sum_over(data.size(), none, add);
  inner.triangularView<Eigen::StrictlyUpper>() = inner.transpose();
  inner.diagonal() += (discrepancy.noise_v2 / discrepancy.variance_v2.array()).matrix();
  inner_.compute(inner);
}

void Coloured::project(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd> &values,
                       Eigen::Ref<Eigen::MatrixXd> sum) const {
  add_products(rows_.middleCols(static_cast<Eigen::Index>(2 * first), values.cols()), values, sum);
}

Eigen::VectorXd Coloured::explained(const Eigen::Ref<const Eigen::VectorXd> &p) const {
  return rows_.transpose() * inner_.solve(p);
}

Eigen::VectorXd Coloured::unexplained(const Eigen::Ref<const Eigen::VectorXd> &values) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns());
  project(0, values.transpose(), sum);
  return values - explained(sum);
}

Eigen::MatrixXd Coloured::taken(const Eigen::Ref<const Eigen::MatrixXd> &p) const {
  return p.transpose() * inner_.solve(p);
}

void Crosses::add(const Eigen::Ref<const Eigen::MatrixXd> &rows, std::size_t first,
                  const Coloured *coloured) {
  add_squares(rows, products);
  if (coloured)
    coloured->project(first, rows, projected);
}

Crosses &Crosses::operator+=(const Crosses &other) {
  products += other.products;
  projected += other.projected;
  return *this;
}

} // namespace ada
