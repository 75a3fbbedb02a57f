// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/signature.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Dense>

#include "base/angle.h"

namespace ada::study {

namespace {

using Complex = std::complex<double>;

constexpr std::size_t kMostSamples = 40000; ///< of a half: the rest would only average noise

/// Whether the angles reach every part of the turn that the highest order needs.
bool covers(const std::vector<double> &alpha, int orders) {
  std::vector<char> hit(static_cast<std::size_t>(3 * orders), 0);
  for (double a : alpha)
    hit[std::min(hit.size() - 1, static_cast<std::size_t>(wrap(a, kTwoPi) / kTwoPi *
                                                          static_cast<double>(hit.size())))] = 1;
  return std::all_of(hit.begin(), hit.end(), [](char h) { return h != 0; });
}

/// Least squares of both channels on the orders of the turn; false where the half cannot carry it.
bool fit_half(const Capture &c, std::size_t first, std::size_t last, int orders,
              std::vector<double> &out) {
  const std::size_t stride = (last - first) / kMostSamples + 1;
  const int size = 2 * orders + 1;
  std::vector<double> alpha;
  for (std::size_t i = first; i < last; i += stride)
    alpha.push_back(c.reference_deg[i] / kDegPerRad);
  if (alpha.size() < static_cast<std::size_t>(4 * size) || !covers(alpha, orders))
    return false;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, 2);
  Eigen::VectorXd row(size);
  row[0] = 1.0;
  for (std::size_t k = 0; k < alpha.size(); ++k) {
    const Complex turn = std::polar(1.0, alpha[k]);
    Complex power = 1.0;
    for (int n = 1; n <= orders; ++n) {
      power *= turn;
      row[2 * n - 1] = power.real();
      row[2 * n] = power.imag();
    }
    const std::size_t i = first + k * stride;
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right.col(0) += row * (c.vsin_v[i] - 0.5 * c.meta.supply_v);
    right.col(1) += row * (c.vcos_v[i] - 0.5 * c.meta.supply_v);
  }
  const Eigen::MatrixXd solved = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  if (!solved.allFinite())
    return false;
  for (int channel = 0; channel < 2; ++channel)
    out.insert(out.end(), solved.col(channel).begin(), solved.col(channel).end());
  return true;
}

/// Series of a channel; half 2 is the mean of both.
std::vector<double> series_of(const Signature &s, int half, int channel) {
  const auto a = s.series(half == 2 ? 0 : half, channel);
  std::vector<double> out(a.begin(), a.end());
  if (half == 2) {
    const auto b = s.series(1, channel);
    for (std::size_t k = 0; k < out.size(); ++k)
      out[k] = 0.5 * (out[k] + b[k]);
  }
  return out;
}

double value_at(const std::vector<double> &series, double alpha) {
  const Complex turn = std::polar(1.0, alpha);
  Complex power = 1.0;
  double sum = series[0];
  for (std::size_t n = 1; 2 * n < series.size(); ++n) {
    power *= turn;
    sum += series[2 * n - 1] * power.real() + series[2 * n] * power.imag();
  }
  return sum;
}

/// The orders of the turn that no part of it tells apart from the others.
void keep_electrical(std::vector<double> &series, int periods) {
  for (std::size_t n = 1; 2 * n < series.size(); ++n)
    if (n % static_cast<std::size_t>(periods) != 0)
      series[2 * n - 1] = series[2 * n] = 0.0;
}

/// Points of a curve that takes part, several a period of the highest order.
int points(const Signature &s) {
  return 6 * s.orders();
}

/// Electrical angle of the pair by a calibration, rad.
double converted(double sin_v, double cos_v, double amplitude, const Learned &l, Calibration use) {
  const bool offsets = use >= Calibration::offsets, ellipse = use >= Calibration::ellipse;
  const double k = ellipse ? l[2] : 0.0, h = ellipse ? 0.5 * l[3] : 0.0;
  const double S = (sin_v / amplitude - (offsets ? l[0] : 0.0)) / (1.0 + 0.5 * k);
  const double C = (cos_v / amplitude - (offsets ? l[1] : 0.0)) / (1.0 - 0.5 * k);
  double psi = std::atan2(std::cos(h) * S - std::sin(h) * C, std::cos(h) * C - std::sin(h) * S);
  const int orders = use == Calibration::table8 ? 8 : use == Calibration::table4 ? 4 : 0;
  const double measured = psi;
  for (int n = 1; n <= orders; ++n)
    psi -= l[2 + 2 * static_cast<std::size_t>(n)] * std::cos(n * measured) +
           l[3 + 2 * static_cast<std::size_t>(n)] * std::sin(n * measured);
  return psi;
}

/// Amplitude, direction and lag of the electrical fundamental of the pair.
struct Fundamental {
  double sin_amplitude, cos_amplitude, sin_phase, cos_phase;
  double amplitude() const { return 0.5 * (sin_amplitude + cos_amplitude); }
  /// 1 where VSIN = sin, VCOS = cos of an angle that grows with the reference, -1 else.
  double sense() const { return std::cos(sin_phase - cos_phase) >= 0.0 ? 1.0 : -1.0; }
};

Fundamental fundamental(const std::vector<double> &sin, const std::vector<double> &cos, int p) {
  const auto n = static_cast<std::size_t>(p);
  // a cos x + b sin x = r sin(x + atan2(a, b)) = r cos(x - atan2(b, a))
  return {std::hypot(sin[2 * n - 1], sin[2 * n]), std::hypot(cos[2 * n - 1], cos[2 * n]),
          std::atan2(sin[2 * n - 1], sin[2 * n]), std::atan2(-cos[2 * n], cos[2 * n - 1])};
}

/// Error of the angle over the turn, electrical rad, without its mean.
std::vector<double> errors(const std::vector<double> &sin, const std::vector<double> &cos,
                           const Signature &s, const Learned &l, Calibration use,
                           std::vector<double> *measured = nullptr) {
  const Fundamental f = fundamental(sin, cos, s.periods);
  const double sense = f.sense();
  std::vector<double> out;
  Complex sum = 0.0;
  for (int i = 0; i < points(s); ++i) {
    const double alpha = kTwoPi * i / points(s);
    const double psi = converted(value_at(sin, alpha), value_at(cos, alpha), f.amplitude(), l, use);
    if (measured != nullptr)
      measured->push_back(psi);
    out.push_back(psi - sense * s.periods * alpha);
    sum += std::polar(1.0, out.back());
  }
  const double zero = std::arg(sum);
  for (double &e : out)
    e = wrap_centred(e - zero, kTwoPi);
  double mean = 0.0;
  for (double e : out)
    mean += e / static_cast<double>(out.size());
  for (double &e : out)
    e -= mean;
  return out;
}

} // namespace

Signature signature_of(const Capture &c) {
  Signature out;
  const int p = c.meta.periods_per_turn;
  if (!c.has_reference() || p < 1 || p > 4)
    return out;
  const std::size_t middle = c.size() / 2;
  std::vector<double> values;
  const int orders = kSignatureOrders * p;
  if (!fit_half(c, 0, middle, orders, values) || !fit_half(c, middle, c.size(), orders, values))
    return out;
  out.periods = p;
  out.values = std::move(values);
  return out;
}

Learned learn(const Signature &s, int half) {
  std::vector<double> sin = series_of(s, half, 0), cos = series_of(s, half, 1);
  keep_electrical(sin, s.periods);
  keep_electrical(cos, s.periods);
  const Fundamental f = fundamental(sin, cos, s.periods);
  Learned l{};
  l[0] = sin[0] / f.amplitude();
  l[1] = cos[0] / f.amplitude();
  l[2] = (f.sin_amplitude - f.cos_amplitude) / f.amplitude();
  // Against the sense of rotation, sin(-x + d/2) is a fundamental that leads by pi - d/2.
  const double lead = f.sin_phase - f.cos_phase;
  l[3] = f.sense() > 0.0 ? wrap_centred(lead, kTwoPi) : wrap_centred(kPi - lead, kTwoPi);
  std::vector<double> measured;
  const std::vector<double> left = errors(sin, cos, s, l, Calibration::ellipse, &measured);
  // Evenly over the measured angle, which is what the table is read by.
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double next = measured[(i + 1) % left.size()];
    const double last = measured[(i + left.size() - 1) % left.size()];
    const double weight = std::abs(wrap_centred(next - last, kTwoPi)) / (kTwoPi * s.periods);
    for (std::size_t n = 1; n <= kSignatureOrders; ++n) {
      const double x = static_cast<double>(n) * measured[i];
      l[2 + 2 * n] += weight * left[i] * std::cos(x);
      l[3 + 2 * n] += weight * left[i] * std::sin(x);
    }
  }
  return l;
}

double angle_rms_deg(const Signature &judge, int half, const Learned &learned, Calibration use) {
  const std::vector<double> e =
      errors(series_of(judge, half, 0), series_of(judge, half, 1), judge, learned, use);
  double sum = 0.0;
  for (double x : e)
    sum += x * x;
  return std::sqrt(sum / static_cast<double>(e.size())) / judge.periods * kDegPerRad;
}

} // namespace ada::study
