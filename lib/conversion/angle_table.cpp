// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/angle_table.h"

#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/error.h"
#include "conversion/angle_solver.h"
#include "model/forward.h"

namespace ada {

namespace {

[[noreturn]] void refuse(const char *why) {
  throw Error(ADA4571_ERROR_UNSUPPORTED,
              std::string("the model's periodic remainder, which has no name, ") + why +
                  ": convert frames");
}

/// Whether every order of the turn is a whole number of times in each electrical period.
bool same_in_every_period(const PeriodicRemainder &remainder, int periods) {
  if (remainder.electrical || periods == 1)
    return true;
  const auto orders = remainder.series(1.0);
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const FourierPair &k = orders[i];
    const bool present =
        k.cos_first != 0 || k.sin_first != 0 || k.cos_second != 0 || k.sin_second != 0;
    if (present && (i + 1) % static_cast<std::size_t>(periods) != 0)
      return false;
  }
  return true;
}

/// Everett's cubic through four nodes errs by up to 3/128 h^4 times the fourth derivative, which
/// multiplies order n of psi by n^4.
std::size_t table_size(const PeriodicRemainder &remainder, int periods) {
  const auto orders = remainder.series(1.0);
  double fourth = 0.0;
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const FourierPair &k = orders[i];
    const double n = static_cast<double>(i + 1) / (remainder.electrical ? 1 : periods);
    fourth += n * n * n * n *
              (std::hypot(k.cos_first, k.sin_first) + std::hypot(k.cos_second, k.sin_second));
  }
  std::size_t size = 256;
  const auto error = [&] {
    return 3.0 / 128.0 * std::pow(kTwoPi / static_cast<double>(size), 4) * fourth;
  };
  while (size < 65536 && error() > AngleTable::kInterpolationRad)
    size *= 2;
  return size;
}

/// The vector that the ellipse's inverse makes of the model's pair.
class SeenByEllipse {
public:
  SeenByEllipse(const Model &model, const EllipseInverse &inverse)
      : forward_(correctable_part(model)), inverse_(inverse), periods_(model.periods_per_turn) {}

  void at(const std::vector<double> &alpha, std::vector<double> &angle,
          std::vector<double> &radius) const {
    const std::size_t n = alpha.size();
    const std::vector<double> zeros(n);
    const std::vector<float> at_rest(n);
    std::vector<double> s(n), c(n);
    forward_.evaluate(
        {.n = n, .time = zeros.data(), .alpha = alpha.data(), .omega = at_rest.data()}, s.data(),
        c.data());
    for (std::size_t i = 0; i < n; ++i) {
      const double y = inverse_.sine(s[i], c[i]), x = inverse_.cosine(s[i], c[i]);
      angle[i] = std::atan2(y, x) / periods_;
      radius[i] = std::hypot(y, x);
    }
  }

private:
  ForwardModel forward_;
  EllipseInverse inverse_;
  int periods_;
};

double sixth_of_second_difference(const std::vector<double> &y, std::size_t i) {
  const std::size_t n = y.size();
  return (y[(i + n - 1) % n] - 2.0 * y[i] + y[(i + 1) % n]) / 6.0;
}

} // namespace

AngleTable::AngleTable(const Model &model, const EllipseInverse &inverse)
    : period_(kTwoPi / model.periods_per_turn) {
  const int p = model.periods_per_turn;
  if (!same_in_every_period(*model.remainder, p))
    refuse("differs between the parts of a turn that a pair cannot tell apart");
  const std::size_t n = table_size(*model.remainder, p);
  const SeenByEllipse seen(model, inverse);
  std::vector<double> alpha(n), shift(n), angle(n), radius(n), factor(n);
  const auto node = [&](std::size_t i) {
    return period_ * static_cast<double>(i) / static_cast<double>(n);
  };
  // To the angle that the ellipse takes for the node: contracts by the remainder's slope.
  constexpr double kExact = 1e-13;
  constexpr int kIterations = 200;
  double off = period_;
  for (int iteration = 0; iteration < kIterations && off > kExact; ++iteration) {
    for (std::size_t i = 0; i < n; ++i)
      alpha[i] = node(i) + shift[i];
    seen.at(alpha, angle, radius);
    off = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double step = wrap_centred(node(i) - angle[i], period_);
      shift[i] += step;
      off = std::max(off, std::abs(step));
    }
  }
  bool grows = off <= kExact;
  for (std::size_t i = 0; i < n; ++i)
    grows = grows && shift[(i + 1) % n] - shift[i] > -period_ / static_cast<double>(n);
  if (!grows)
    refuse("bends the curve so far that one angle of the ellipse stands for several");
  for (std::size_t i = 0; i < n; ++i)
    factor[i] = 1.0 / radius[i];
  for (std::size_t i = 0; i <= n; ++i) {
    const std::size_t k = i % n;
    nodes_.push_back({shift[k], sixth_of_second_difference(shift, k), factor[k],
                      sixth_of_second_difference(factor, k)});
    const Node<double> &d = nodes_.back();
    nodes_f32_.push_back({static_cast<float>(d.shift), static_cast<float>(d.shift_bend),
                          static_cast<float>(d.factor), static_cast<float>(d.factor_bend)});
  }
}

template <class T>
void AngleTable::correct(const std::vector<Node<T>> &nodes, std::size_t count, T *angle,
                         T *radius) const {
  const T period = static_cast<T>(period_);
  const T per_rad = static_cast<T>(static_cast<double>(nodes.size() - 1) / period_);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(angle[i] >= 0)) // no number
      continue;
    const T x = angle[i] * per_rad;
    const std::size_t k = std::min(static_cast<std::size_t>(x), nodes.size() - 2);
    const Node<T> &a = nodes[k], &b = nodes[k + 1];
    const T t = x - static_cast<T>(k), u = 1 - t;
    const T at = t * (t * t - 1), au = u * (u * u - 1);
    T corrected = angle[i] + (u * a.shift + t * b.shift + au * a.shift_bend + at * b.shift_bend);
    if (corrected < 0)
      corrected += period;
    if (corrected >= period) // also what the line above has rounded up
      corrected -= period;
    angle[i] = corrected;
    if (radius != nullptr)
      radius[i] *= u * a.factor + t * b.factor + au * a.factor_bend + at * b.factor_bend;
  }
}

void AngleTable::correct(std::size_t count, float *angle, float *radius) const {
  correct(nodes_f32_, count, angle, radius);
}

void AngleTable::correct(std::size_t count, double *angle, double *radius) const {
  correct(nodes_, count, angle, radius);
}

} // namespace ada
