// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effects/common.h"

#include <algorithm>
#include <cmath>

namespace ada {

void TransferError::apply(Values v, Wave &w) const {
  const bool at_offset = v[1] == 1.0;
  const double a = 1.0 / w.amplitude_v, size = v[0] * w.amplitude_v;
  const bool bow = order() == 2; // asked once: the loops are the model's most frequent ones
  const auto bend = [&](double *signal, const double *offset) {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = a * (signal[i] - (at_offset ? offset[i] : w.at.mid_shift_v));
      signal[i] += size * x * x * (bow ? 1.0 : x);
    }
  };
  bend(w.s, w.offset_s);
  bend(w.c, w.offset_c);
}

std::vector<std::vector<double>> TransferError::choices(Values v) const {
  return {{v[0], v[1] == 1.0 ? std::nan("") : 1.0}};
}

void ReferenceError::shaft_from_reference(Values v, const Conditions &,
                                          std::span<double> angle) const {
  const double e = v[amplitude_index()] * kRadPerDeg, phase = v[phase_index()] * kRadPerDeg;
  if (e == 0.0)
    return;
  const std::size_t n = angle.size();
  const double order = this->order(v), steepest = std::abs(e * order);
  double alpha[kWaveBlock], x[kWaveBlock], s[kWaveBlock], c[kWaveBlock];
  std::copy(angle.begin(), angle.end(), alpha);
  // Newton's method: each pass leaves the square of what there was, times half the second
  // derivative over the first.
  constexpr double kExact = 1e-12; // rad
  constexpr int kMostPasses = 20;
  double left = std::abs(e);
  for (int k = 0; k < kMostPasses && left > kExact; ++k) {
    for (std::size_t i = 0; i < n; ++i)
      x[i] = order * alpha[i] + phase;
    sincos_of(x, n, s, c);
    for (std::size_t i = 0; i < n; ++i) // never flatter than where it would turn back
      alpha[i] -= (alpha[i] + e * s[i] - angle[i]) / std::max(1.0 + e * order * c[i], 0.1);
    left *= 0.5 * steepest * std::abs(order) * left / std::max(1.0 - steepest, 0.1);
  }
  std::copy(alpha, alpha + n, angle.begin());
}

OrderRipple ReferenceError::reference_ripple(Values v) const {
  const double e = v[amplitude_index()] * kRadPerDeg, phase = v[phase_index()] * kRadPerDeg;
  return {order(v), e * std::sin(phase), e * std::cos(phase)};
}

void ReferenceError::record(Values v, Take &take) const {
  for (double &r : take.capture.reference_deg)
    r += v[amplitude_index()] * std::sin((order(v) * r + v[phase_index()]) * kRadPerDeg);
}

std::string ReferenceError::invisible(const Residual &r) const {
  return r.has_reference ? "" : "there is no reference";
}

std::string looks_like_ripple(const Residual &r, const std::string &of_order) {
  if (r.has_reference || slowest_speed(r) > 0.0)
    return "";
  return "without a reference and a range of speeds it looks like a speed ripple" + of_order;
}

std::string turns_with_poles(const Residual &r) {
  constexpr int kMostOfOneMagnet = 2;
  if (r.periods <= kMostOfOneMagnet)
    return "";
  return "at a ring of poles it comes with each pole, as offsets, mismatch and harmonics of the "
         "pair "
         "do";
}

void SlowCourse::draw(double duration_s, Rng &rng, std::vector<double> &numbers) {
  const double span = duration_s > 0.0 ? duration_s : kEndless;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> drawn{0.0};
  for (std::size_t k = 0; 3 * k + 1 < kNumbers; ++k) {
    const double cycles = 0.5 + 1.5 * (static_cast<double>(k) + unit(rng)); // below 10 in all
    drawn.insert(drawn.end(), {kTwoPi * cycles / span, kTwoPi * unit(rng), normal(rng) / cycles});
  }
  constexpr int kPoints = 2000;
  double mean = 0.0, square = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = SlowCourse(drawn)(span * (i + 0.5) / kPoints);
    mean += x / kPoints;
    square += x * x / kPoints;
  }
  const double scale = 1.0 / std::sqrt(square - mean * mean);
  drawn[0] = mean * scale;
  for (std::size_t k = 3; k < kNumbers; k += 3)
    drawn[k] *= scale;
  numbers.insert(numbers.end(), drawn.begin(), drawn.end());
}

double SlowCourse::operator()(double time_s) const {
  double sum = -numbers_[0];
  for (std::size_t k = 1; k < kNumbers; k += 3)
    sum += numbers_[k + 2] * std::cos(numbers_[k] * time_s + numbers_[k + 1]);
  return sum;
}

void turn_vector(Take &take, std::size_t i, double re, double im) {
  const double mid = 0.5 * take.model.supply_v;
  const double centre_s = mid + take.model.baseline.offset_sin_v;
  const double centre_c = mid + take.model.baseline.offset_cos_v;
  const double s = take.capture.vsin_v[i] - centre_s, c = take.capture.vcos_v[i] - centre_c;
  take.capture.vsin_v[i] = centre_s + s * re + c * im;
  take.capture.vcos_v[i] = centre_c + c * re - s * im;
}

std::vector<std::vector<double>> one_of_each(std::size_t parameters, std::size_t index, int first,
                                             int last) {
  std::vector<std::vector<double>> out;
  for (int value = first; value <= last; ++value) {
    std::vector<double> v(parameters, 0.0);
    v[index] = value;
    out.push_back(v);
  }
  return out;
}

void add_orders_seen(const Residual &residual, const ParameterInfo &order, Orders which,
                     std::vector<std::vector<double>> &out) {
  const std::size_t parameters = out.front().size();
  for (const double seen : find_orders(residual)) {
    const bool tried =
        std::any_of(out.begin(), out.end(), [&](const auto &v) { return v[0] == seen; });
    const bool wanted = which == Orders::any || seen == std::round(seen);
    if (tried || !wanted || seen < order.minimum || seen > order.maximum)
      continue;
    out.emplace_back(parameters, 0.0);
    out.back()[0] = seen;
  }
}

} // namespace ada
