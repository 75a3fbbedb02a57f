// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/angle.h"
#include "base/sincos.h"
#include "base/solve.h"
#include "diagnosis/lines/along_radius.h"
#include "diagnosis/lines/beside_pair.h"
#include "diagnosis/lines/rounds.h"
#include "model/residual.h"

namespace ada {

namespace {

/// Whether a line swings while the record goes on, and not from one stretch of it to the next: what
/// lies between two stretches nobody saw, and levels of a few stretches are on a tone of some
/// frequency by chance. It then keeps most of its power where each stretch has a mean of its own.
bool swings_within_stretches(const Residual &r, double frequency) {
  constexpr double kGap = 0.5;  // of a period
  constexpr double kMost = 0.5; // of power
  Eigen::Matrix4d all = Eigen::Matrix4d::Zero(), within = Eigen::Matrix4d::Zero();
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  double n = 0.0;
  std::size_t stretches = 0;
  const auto end_stretch = [&] {
    within += products - mean * mean.transpose() / std::max(1.0, n);
    all += products;
    mean.setZero();
    products.setZero();
    n = 0.0;
    ++stretches;
  };
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    if (i > 0 && (r.time[i] - r.time[i - 1]) * frequency > kGap)
      end_stretch();
    double s, c;
    sincos(kTwoPi * frequency * r.time[i], &s, &c);
    const Eigen::Vector4d row(s, c, r.sin_v[i], r.cos_v[i]);
    mean += row;
    products += row * row.transpose();
    n += 1.0;
  }
  end_stretch();
  if (stretches == 1)
    return true;
  const auto taken = [](const Eigen::Matrix4d &m) {
    const Eigen::MatrixXd a = m.topLeftCorner<2, 2>(), b = m.topRightCorner<2, 2>();
    return (b.array() * solved(a, b).array()).sum();
  };
  return taken(within) > kMost * taken(all);
}

/// Whether a line at a multiple of the period stands out of those at the multiples beside it: what
/// a converter makes of its channel has many of about one size.
bool stands_alone(const Residual &r, int order, const Line &line) {
  constexpr int kBeside = 6;
  constexpr double kOut = 4.0; // of power, of the strongest of them
  double strongest = 0.0;
  for (int k = 1; k <= kBeside; ++k)
    for (int beside : {order - k * r.periods, order + k * r.periods})
      if (beside > 0)
        strongest = std::max(
            strongest, line_along(r, [&](std::size_t i) { return beside * r.alpha[i]; }).power);
  return line.power > kOut * strongest;
}

/// Whether a cause that goes with the angle could make a line at an order of a steady rotation. To
/// the highest named order it could. Beyond, what a channel makes of its own value comes at
/// multiples of the period and may be in that channel alone, and an error of the angle, whatever
/// its order, turns the pair to and fro and so has a fellow. A line of both channels beyond those,
/// without one, is a tone, though it keeps step with the shaft as the mains do with a motor. `few`:
/// the shaft came round too seldom for a line to be at an order by more than chance. What a channel
/// makes of its own value there is the steps of its converter, of which there are many lines.
bool may_be_of_the_angle(const Residual &r, const MostlyAt &at, int order, double frequency,
                         const Line &line, bool few) {
  constexpr double kInBoth = 0.2;
  const auto &a = line.amplitudes;
  const double sin = std::hypot(a[0], a[1]), cos = std::hypot(a[2], a[3]);
  const bool of_channel =
      order % r.periods == 0 || std::min(sin, cos) < kInBoth * std::max(sin, cos);
  return order <= highest_named(r) || has_fellow(r, at, frequency) ||
         (of_channel && !(few && stands_alone(r, order, line)));
}

/// What the orders of the angle up to the highest named leave of the residual. Of a line between
/// them most is left, though the shaft came round but a few times; where it came round too seldom
/// for that, they take everything.
class WithoutOrders {
public:
  explicit WithoutOrders(const Residual &r)
      : r_(r), sin_(r.sin_v.begin(), r.sin_v.end()), cos_(r.cos_v.begin(), r.cos_v.end()) {
    const auto orders = static_cast<Eigen::Index>(highest_named(r));
    const Eigen::Index columns = 2 * orders + 1;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
    Eigen::MatrixXd onto = Eigen::MatrixXd::Zero(columns, 2);
    Eigen::VectorXd row(columns);
    const auto fill = [&](double s, double c) { // each order from the one before
      row[0] = 1.0;
      double sk = 0.0, ck = 1.0;
      for (Eigen::Index k = 1; k <= orders; ++k) {
        const double next = sk * c + ck * s;
        ck = ck * c - sk * s;
        sk = next;
        row[2 * k - 1] = sk;
        row[2 * k] = ck;
      }
    };
    const auto angle = [&](std::size_t i) { return r.alpha[i]; };
    for_each_sincos(r.time.size(), angle, [&](std::size_t i, double s, double c) {
      fill(s, c);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
      onto += row * Eigen::RowVector2d(r.sin_v[i], r.cos_v[i]);
    });
    normal = normal.selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd of = solved(normal, onto);
    for_each_sincos(r.time.size(), angle, [&](std::size_t i, double s, double c) {
      fill(s, c);
      sin_[i] -= row.dot(of.col(0));
      cos_[i] -= row.dot(of.col(1));
    });
  }

  Residual view() const {
    Residual left = r_;
    left.sin_v = sin_;
    left.cos_v = cos_;
    return left;
  }

  bool leave(double frequency, const Line &line) const {
    constexpr double kMost = 0.5; // of power
    return line_at(view(), frequency).power > kMost * line.power;
  }

private:
  const Residual &r_;
  std::vector<double> sin_, cos_;
};

} // namespace

std::vector<std::vector<double>> find_tones(const Residual &residual) {
  if (residual.time.size() < kFewestForTones)
    return {};
  Rounded rounded(residual);
  const Residual &r = rounded.view;
  const double span = r.time.back() - r.time.front(), apart_s = tells_apart_s(r);
  const double round = comes_round(r), back = comes_back(r);
  const bool few = too_few_rounds_for_lines(r);
  // Of a long record in few rounds, tones of up to so many half periods in all: there is one line
  // to look for, and many spectra to do it.
  constexpr double kMostHalfPeriods = 131072.0;
  if (few)
    rounded.view.sample_period_s = std::max(r.sample_period_s, span / kMostHalfPeriods);
  std::optional<MostlyAt> most;
  std::optional<AlongRadius> along;
  std::optional<WithoutOrders> between;
  // Of a ring of many poles there are more orders than a few rounds tell, or memory holds.
  constexpr double kMostOrders = 64.0, kRowsOfOrder = 4.0;
  const bool told_between = highest_named(r) <= kMostOrders &&
                            kRowsOfOrder * highest_named(r) < static_cast<double>(r.time.size());
  // At one speed, or a few, the orders reach no further than this.
  double ordered_hz = 0.0;
  if (few)
    for (double w : r.omega)
      ordered_hz = std::max(ordered_hz, std::abs(w) / kTwoPi * highest_named(r));
  std::vector<std::vector<double>> tones;
  const auto no_tone = [&](double frequency, const Line &line) {
    if (frequency < ordered_hz) {
      if (!told_between)
        return true;
      if (!between)
        between.emplace(r);
      if (!between->leave(frequency, line))
        return true;
    }
    if (!most)
      most = mostly_at(r);
    const int of_round = order_seen_at(r, round, frequency);
    const int of_speed = order_near(r, frequency, 1.0 / apart_s);
    const bool near_round = of_round >= 1 && std::abs(frequency - seen_at_hz(r, of_round * round)) <
                                                 kOrderWidth / apart_s;
    const bool at_round = near_round && !told_from_order(r, of_round, frequency);
    const bool at_speed = turns_with_shaft(r, of_speed, line) ||
                          (of_speed != 0 && !(near_round && of_speed == of_round) &&
                           !told_from_order(r, of_speed, frequency));
    if (((at_round || at_speed) &&
         may_be_of_the_angle(r, *most, near_round || !at_speed ? of_round : of_speed, frequency,
                             line, few)) ||
        of_way_there_and_back(r, back, frequency) || !swings_within_stretches(r, frequency))
      return true;
    // Near the pair's own frequency a gain, an angle or a mismatch that changes slowly is a line as
    // well, and of a shaft that turns on never one of a single channel without a fellow.
    const bool slow = slow_beside_pair(r, frequency);
    if (slow && (few || goes_to_and_fro(r)))
      return true;
    if (!along)
      along.emplace(r);
    if (along->is_most())
      return along->is_gain(frequency, slow);
    const bool turns = rotates_with_pair(r, *most, frequency, line),
               fellow = (turns || slow) && has_fellow(r, *most, frequency);
    return (slow && (turns || fellow)) ||
           (turns && (fellow || one_sided(r, *most, frequency)) && along->is_gain(frequency, slow));
  };
  auto lines = strongest_lines(r, 0.0, no_tone);
  if (few && told_between && !lines.empty()) {
    if (!between)
      between.emplace(r);
    keep_single_lines(between->view(), lines);
  } else if (few) {
    keep_single_lines(r, lines);
  }
  for (const auto &[frequency, line] : lines) {
    const auto a = line_at(residual, frequency).amplitudes;
    tones.push_back({frequency, std::hypot(a[0], a[1]), std::hypot(a[2], a[3]),
                     std::atan2(a[1], a[0]) * kDegPerRad, std::atan2(a[3], a[2]) * kDegPerRad});
  }
  return tones;
}

std::vector<double> find_modulations(const Residual &r) {
  if (too_few_rounds_for_lines(r))
    return {};
  std::vector<double> along(r.time.size()), across(r.time.size());
  for_each_sincos(
      r.time.size(), [&](std::size_t i) { return r.periods * r.alpha[i]; },
      [&](std::size_t i, double s, double c) {
        along[i] = r.cos_v[i] * c + r.sin_v[i] * s;
        across[i] = r.sin_v[i] * c - r.cos_v[i] * s;
      });
  Residual turned = r;
  turned.cos_v = along;
  turned.sin_v = across;
  std::vector<double> out;
  for (const auto &line : strongest_lines(turned, 0.0, [](double, const Line &) { return false; }))
    out.push_back(line.first);
  return out;
}

} // namespace ada
