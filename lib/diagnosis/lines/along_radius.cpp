// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/along_radius.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/angle.h"
#include "base/solve.h"
#include "diagnosis/lines/line.h"

namespace ada {

AlongRadius::AlongRadius(const Residual &r) : r_(r) {
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
    const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
    cos_.push_back(inverse * c);
    sin_.push_back(inverse * s);
    along_.push_back(r.cos_v[i] * cos_.back() + r.sin_v[i] * sin_.back());
    along_v2_ += along_.back() * along_.back();
    across_v2_ += std::pow(r.sin_v[i] * cos_.back() - r.cos_v[i] * sin_.back(), 2);
    fastest_hz_ = std::max(fastest_hz_, std::abs(double{r.omega[i]}) * r.periods / kTwoPi);
  }
  add_power_over_time(
      r.time, r.sample_period_s, [&](std::size_t i) { return along_[i]; }, spectrum_);
}

bool AlongRadius::is_most() const {
  constexpr double kLittle = 0.25; // of power
  return across_v2_ < kLittle * along_v2_;
}

/// What the columns take of the radius, V^2. `columns`: of sample i with the sine and cosine of
/// the phase there.
template <int N, class Columns>
double AlongRadius::taken(std::span<const double> sine, std::span<const double> cosine,
                          Columns columns) const {
  Eigen::Matrix<double, N, N> normal = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> onto = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t i = 0; i < along_.size(); ++i) {
    const Eigen::Matrix<double, N, 1> row = columns(i, sine[i], cosine[i]);
    normal += row * row.transpose();
    onto += along_[i] * row;
  }
  return onto.cwiseProduct(solved(normal, onto)).sum();
}

/// The most about a frequency that is known to half a line of the spectrum.
template <int N, class Columns>
double AlongRadius::most_taken(double frequency, Columns columns) const {
  constexpr int kSteps = 5; // on either side; half of one loses less than a hundredth
  const double half = 0.5 * spectrum_.bin_hz;
  double best = 0.0;
  for_each_frequency(r_.time, frequency - half, half / kSteps, 2 * kSteps + 1,
                     [&](int, const std::vector<double> &s, const std::vector<double> &c) {
                       best = std::max(best, taken<N>(s, c, columns));
                     });
  return best;
}

double AlongRadius::of_tone(double frequency) const {
  return most_taken<4>(frequency, [this](std::size_t i, double s, double c) {
    return Eigen::Vector4d(sin_[i] * s, sin_[i] * c, cos_[i] * s, cos_[i] * c);
  });
}

double AlongRadius::strongest_of_gain(double from_hz, double to_hz) const {
  const auto &power = spectrum_.power;
  const auto bin = [&](double hz) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::max(0.0, hz) / spectrum_.bin_hz),
                                   1, power.size() - 1);
  };
  const auto peak = std::max_element(power.begin() + static_cast<std::ptrdiff_t>(bin(from_hz)),
                                     power.begin() + static_cast<std::ptrdiff_t>(bin(to_hz)) + 1);
  return most_taken<2>(static_cast<double>(peak - power.begin()) * spectrum_.bin_hz,
                       [](std::size_t, double s, double c) { return Eigen::Vector2d(s, c); });
}

bool AlongRadius::is_gain(double frequency, bool slow) const {
  // What a tone takes beyond one line: of that, as no ellipse of the pair gives to a gain; of one
  // that is no line, as its fellow has by itself; and so that chance gives it to its two more
  // columns in no case that anybody meets.
  constexpr double kOfLine = 0.02, kOfSlow = 0.25, kNats = 10.0;
  const double wide = spectrum_.bin_hz; // the lines beside it, however slow the pair is
  double strongest = 0.0;
  for (const double side : {-1.0, 1.0}) {
    const double reach = side * (fastest_hz_ + wide);
    strongest = std::max(strongest, strongest_of_gain(std::min(frequency, frequency + reach),
                                                      std::max(frequency, frequency + reach)));
  }
  const double tone = of_tone(frequency), left = along_v2_ - tone;
  const double nats = 0.5 * static_cast<double>(along_.size()) *
                      std::log1p((tone - strongest) / std::max(left, 1e-30));
  return tone < (1.0 + (slow ? kOfSlow : kOfLine)) * strongest || nats < kNats;
}

} // namespace ada
