// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

std::string_view axis_name(Axis axis) {
  constexpr std::array<std::string_view, kAxes> kNames{
      "angle", "speed", "temperature", "supply", "time", "frequency", "noise"};
  return kNames[static_cast<std::size_t>(axis)];
}

void Basis::add(Axis axis, int order, int exponent, Modulation modulation) {
  groups_.push_back({axis, order, columns(), 2, modulation.kind == Modulation::step});
  terms_.push_back({exponent, modulation});
}

Eigen::VectorXd Basis::stiffness() const {
  Eigen::VectorXd out = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(columns()));
  for (const Group &g : groups_)
    if (g.axis == Axis::time && !g.of_step)
      out.segment(static_cast<Eigen::Index>(g.first), static_cast<Eigen::Index>(g.count))
          .setConstant(static_cast<double>(g.order) * g.order);
  return out;
}

double Basis::of_top(double omega) const {
  constexpr double kMost = 1.5; // what is faster for a moment has no weight of its own
  return std::clamp(omega / top_speed_, -kMost, kMost);
}

void Basis::scale_to(const Observations &data) {
  std::vector<double> speed;
  for (double w : data.omega)
    speed.push_back(std::abs(w));
  top_speed_ = std::max(quantile(std::move(speed), 0.98), 1e-12);
  mean_sense_ = mean_velocity_ = mean_speed_ = mean_square_ = 0.0;
  const double part = 1.0 / static_cast<double>(std::max<std::size_t>(data.size(), 1));
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double velocity = of_top(data.omega[i]);
    mean_sense_ += part * static_cast<double>(data.direction[i]);
    mean_velocity_ += part * velocity;
    mean_speed_ += part * std::abs(velocity);
    mean_square_ += part * velocity * velocity;
  }
  time_from_ = data.time.front();
  time_span_ = std::max(data.time.back() - data.time.front(), 1e-12);
  if (!data.temp.empty()) {
    const double low = quantile(data.temp, 0.0), high = quantile(data.temp, 1.0);
    temp_middle_ = 0.5 * (low + high);
    temp_half_ = std::max(0.5 * (high - low), 1e-12);
  }
}

bool Basis::scaled_as(const Basis &other) const {
  return top_speed_ == other.top_speed_ && mean_sense_ == other.mean_sense_ &&
         mean_velocity_ == other.mean_velocity_ && mean_speed_ == other.mean_speed_ &&
         mean_square_ == other.mean_square_ && temp_middle_ == other.temp_middle_ &&
         temp_half_ == other.temp_half_ && time_from_ == other.time_from_ &&
         time_span_ == other.time_span_;
}

double Basis::function(const Modulation &g, const Observations &data, std::size_t i) const {
  switch (g.kind) {
  case Modulation::none:
  case Modulation::angle_cos:
  case Modulation::angle_sin:
    break;
  case Modulation::sense:
    return static_cast<double>(data.direction[i]) - mean_sense_;
  case Modulation::velocity:
    return of_top(data.omega[i]) - mean_velocity_;
  case Modulation::speed:
    return std::abs(of_top(data.omega[i])) - mean_speed_;
  case Modulation::square:
    return std::pow(of_top(data.omega[i]), 2) - mean_square_;
  case Modulation::temperature: {
    const double u =
        data.temp.empty() ? 0.0 : std::clamp((data.temp[i] - temp_middle_) / temp_half_, -1.0, 1.0);
    return g.order == 1 ? u : g.order == 2 ? 1.5 * u * u - 0.5 : 2.5 * u * u * u - 1.5 * u;
  }
  case Modulation::supply:
    return data.supply.empty() ? 0.0 : static_cast<double>(data.supply[i]);
  case Modulation::step:
    return data.time[i] < g.at ? -0.5 : 0.5;
  case Modulation::trend:
    return std::cos(0.5 * kTwoPi * g.order * (data.time[i] - time_from_) / time_span_);
  case Modulation::line_cos:
    return std::cos(kTwoPi * g.at * data.time[i]);
  case Modulation::line_sin:
    return std::sin(kTwoPi * g.at * data.time[i]);
  }
  return 1.0;
}

Basis Basis::part(const std::vector<Eigen::Index> &columns) const {
  std::vector<char> in(terms_.size());
  for (Eigen::Index column : columns)
    in[static_cast<std::size_t>(column / 2)] = 1;
  Basis out = *this;
  out.terms_.clear();
  out.groups_.clear();
  for (std::size_t q = 0; q < terms_.size(); ++q)
    if (in[q])
      out.add(groups_[q].axis, groups_[q].order, terms_[q].exponent, terms_[q].modulation);
  return out;
}

int Basis::unit() const {
  int out = 0;
  for (const Term &t : terms_)
    out = std::gcd(out, std::gcd(t.exponent, t.modulation.of_angle() ? t.modulation.order : 0));
  return std::max(out, 1);
}

void Basis::evaluate(const Observations &data, std::size_t first, std::size_t n,
                     Eigen::Ref<Eigen::MatrixXd> out) const {
  const int step = unit();
  int top = 0;
  for (const Term &t : terms_)
    top = std::max({top, std::abs(t.exponent), t.modulation.of_angle() ? t.modulation.order : 0});
  std::vector<std::complex<double>> power(static_cast<std::size_t>(top / step) + 1);
  std::vector<char> as_before(terms_.size()); // the modulation of the term before
  for (std::size_t q = 1; q < terms_.size(); ++q)
    as_before[q] = terms_[q].modulation == terms_[q - 1].modulation;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = first + k;
    power[0] = 1.0;
    const std::complex<double> unit = std::polar(1.0, step * angle(data, i));
    for (std::size_t m = 1; m < power.size(); ++m)
      power[m] = power[m - 1] * unit;
    const auto s = static_cast<Eigen::Index>(2 * k), c = s + 1;
    double g = 1.0;
    for (std::size_t q = 0; q < terms_.size(); ++q) {
      const Term &term = terms_[q];
      const Modulation &by = term.modulation;
      const std::complex<double> p =
          power[static_cast<std::size_t>(std::abs(term.exponent) / step)];
      const std::complex<double> of_angle =
          power[static_cast<std::size_t>(by.of_angle() ? by.order / step : 0)];
      if (!as_before[q])
        g = by.kind == Modulation::angle_cos   ? of_angle.real()
            : by.kind == Modulation::angle_sin ? of_angle.imag()
                                               : function(by, data, i);
      const double re = g * p.real(), im = g * (term.exponent < 0 ? -p.imag() : p.imag());
      const auto row = static_cast<Eigen::Index>(2 * q);
      out(row, s) = im; // c e^(jmx), c real: r_sin is the imaginary part
      out(row, c) = re;
      out(row + 1, s) = re; // c imaginary
      out(row + 1, c) = -im;
    }
  }
}

bool in_turns(const Scene &scene) {
  return (scene.has_reference && scene.periods <= criteria::kMostPeriodsInTurns) ||
         scene.periods == 1 || scene.turns >= criteria::kFewestTurnsToRepeat;
}

bool has_order(const Scene &scene, int n) {
  return scene.periods <= criteria::kMostPeriodsInTurns || n <= criteria::kLowOrders ||
         n % scene.periods == 0;
}

Basis generic_basis(const Scene &scene, const Observations &data, double zero_rad, int orders,
                    const std::vector<SpectralLine> &lines, const std::vector<double> &steps_s,
                    Asked asked) {
  const int p = scene.periods;
  Basis out(p, zero_rad);
  out.scale_to(data);
  // The baseline's own offsets, amplitude and zero: beside what has no name they are others.
  out.add(Axis::angle, kOfBaseline, 0);
  out.add(Axis::angle, kOfBaseline, p);
  // What turns with the angle: orders of the turn, or of the electrical period where turns cannot
  // be compared.
  const int step = in_turns(scene) ? 1 : p;
  // An order n is a modulation of the vector e^(jpx): along it (real coefficients) and across it
  // (imaginary ones). At n = p one side is the offset, and only the other is left.
  for (int n = step; n <= orders * step; n += step)
    if (step == 1 && !has_order(scene, n))
      continue;
    else if (n == p)
      out.add(Axis::angle, n / step, 2 * p);
    else
      for (auto kind : {Modulation::angle_cos, Modulation::angle_sin})
        out.add(Axis::angle, n / step, p, {kind, n});
  // Offsets; gain and angle; mismatch and quadrature. On a short arc they are hardly apart, and
  // each would seem as large as the sum of all is small: there the offsets stand for all.
  std::vector<int> pair{0};
  if (scene.seen_turns * p >= criteria::kPairOfArc)
    pair.insert(pair.end(), {p, -p});
  if (asked.speed && scene.both_directions)
    for (int m : pair)
      out.add(Axis::speed, 1, m, {Modulation::sense});
  if (asked.speed && scene.several_speeds) {
    for (int m : pair)
      out.add(Axis::speed, 2, m, {Modulation::speed});
    for (int m : pair)
      out.add(Axis::speed, 3, m, {Modulation::square});
  }
  if (asked.speed && scene.several_speeds && scene.both_directions)
    for (int m : pair)
      out.add(Axis::speed, 4, m, {Modulation::velocity});
  if (asked.others && scene.why_no_temperature.empty())
    for (int order : {1, 2, 3})
      for (int m : pair)
        out.add(Axis::temperature, order, m, {Modulation::temperature, order});
  if (asked.others && !data.supply.empty())
    for (int m : pair)
      out.add(Axis::supply, 1, m, {Modulation::supply});
  // Slow in time: half waves that each last two electrical periods or more, so that none of them
  // follows the shaft, and half of what repeats with the angle. Where no angle comes twice, time
  // and angle are one, but for what is faster than any angle: an edge, of which the gain and the
  // angle before and after it are all that is told (an offset that jumps has a name).
  const double rounds = scene.rounds(1.0 / step);
  const double waves =
      std::min({criteria::kMostTrends, scene.rounds(1.0 / p) / criteria::kPeriodsPerTrend,
                criteria::kTrendsPerRound * rounds});
  const bool comes_again = rounds >= criteria::kFewestTurnsToRepeat;
  if (asked.over_time)
    for (std::size_t k = 0; k < steps_s.size(); ++k)
      for (int m : comes_again ? pair : std::vector{p})
        out.add(Axis::time, static_cast<int>(k) + 1, m, {Modulation::step, 0, steps_s[k]});
  for (int order = 1; asked.over_time && comes_again && order <= static_cast<int>(waves); ++order)
    for (int m : pair)
      if (asked.speed || asked.others || m != -p) // a process moves offsets and gain
        out.add(Axis::time, order, m, {Modulation::trend, order});
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (auto kind : {Modulation::line_cos, Modulation::line_sin})
      out.add(Axis::frequency, static_cast<int>(k) + 1, lines[k].turns ? p : 0,
              {kind, 0, lines[k].frequency_hz});
  return out;
}

} // namespace ada
