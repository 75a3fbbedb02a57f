// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/alternation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "base/solve.h"
#include "calibration/ellipse_fit.h"
#include "conversion/ellipse.h"
#include "diagnosis/conditions/no_circle.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// By how much each row lies off the mean of its neighbours, with the sign of the row: an
/// alternation is a constant there, a smooth course and noise alternate. V.
std::vector<double> against_neighbours(const std::vector<double> &v) {
  std::vector<double> out(v.size());
  for (std::size_t i = 1; i + 1 < v.size(); ++i)
    out[i] = (i % 2 == 0 ? 0.25 : -0.25) * (2.0 * v[i] - v[i - 1] - v[i + 1]);
  if (v.size() > 2) {
    out.front() = out[1];
    out.back() = out[v.size() - 2];
  }
  return out;
}

double rms_of(const std::vector<double> &v) {
  double sum = 0.0;
  for (double x : v)
    sum += x * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

/// The parabola through the rows within kAlternationReach of each.
std::vector<double> slow_course(const std::vector<double> &v) {
  const auto reach = static_cast<std::ptrdiff_t>(criteria::kAlternationReach);
  const auto n = static_cast<std::ptrdiff_t>(v.size());
  std::vector<double> out(v.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t from = std::clamp(i - reach, std::ptrdiff_t{0}, n - 1),
                         to = std::clamp(i + reach, std::ptrdiff_t{0}, n - 1);
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::ptrdiff_t k = from; k <= to; ++k) {
      const double x = static_cast<double>(k - i) / static_cast<double>(reach);
      const Eigen::Vector3d row(1.0, x, x * x);
      products += row * row.transpose();
      right += v[static_cast<std::size_t>(k)] * row;
    }
    out[static_cast<std::size_t>(i)] = solved(products, right)(0, 0);
  }
  return out;
}

struct Channel {
  std::vector<double> alternation, without;
  double rms_v = 0.0, scatter_v = 0.0; ///< of the alternation; of what of it is not slow
};

/// `off`: against_neighbours of `v`.
Channel channel_of(const std::vector<double> &v, const std::vector<double> &off) {
  Channel out;
  out.alternation = slow_course(off);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double a = out.alternation[i];
    out.without.push_back(v[i] + (i % 2 == 0 ? -a : a));
    out.scatter_v += (off[i] - a) * (off[i] - a);
  }
  out.rms_v = rms_of(out.alternation);
  out.scatter_v = std::sqrt(out.scatter_v / static_cast<double>(v.size()));
  return out;
}

/// Electrical angle, rad, by which half of the rows lie further from the row before than the
/// others.
double usual_step(const Channel &sin, const Channel &cos, const Range &of_sin,
                  const Range &of_cos) {
  std::vector<double> steps;
  double before = 0.0;
  for (std::size_t i = 0; i < sin.without.size(); ++i) {
    const double angle = std::atan2((sin.without[i] - of_sin.middle) / of_sin.half,
                                    (cos.without[i] - of_cos.middle) / of_cos.half);
    if (i > 0)
      steps.push_back(std::abs(wrap_centred(angle - before, kTwoPi)));
    before = angle;
  }
  return quantile(std::move(steps), 0.5);
}

/// Rms distance of the readings from the best ellipse, all of them, of its radius; infinite
/// where there is none.
double off_ellipse(const std::vector<double> &vsin, const std::vector<double> &vcos) {
  try {
    const EllipseFit fit = fit_ellipse(vsin, vcos);
    const EllipseInverse circle = invert(fit.value);
    double sum = 0.0;
    for (std::size_t i = 0; i < vsin.size(); ++i)
      sum += std::pow(
          std::hypot(circle.sine(vsin[i], vcos[i]), circle.cosine(vsin[i], vcos[i])) - 1.0, 2);
    return std::sqrt(sum / static_cast<double>(vsin.size()));
  } catch (const Error &error) {
    if (error.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
    return std::numeric_limits<double>::infinity();
  }
}

} // namespace

std::optional<Alternation> large_alternation(const Capture &capture) {
  const std::size_t n = capture.size();
  if (capture.has_reference() || n < criteria::kFewestAlternating || !capture.gaps.empty() ||
      !capture.starts.empty() || !(median_step(capture.time_s) > 0.0))
    return std::nullopt;
  const std::vector<char> all(n, 1);
  const std::vector<double> off_sin = against_neighbours(capture.vsin_v),
                            off_cos = against_neighbours(capture.vcos_v);
  // No alternation is larger than that: most captures are told at once, and what holds no numbers.
  if (!(std::hypot(rms_of(off_sin), rms_of(off_cos)) >
        0.5 * criteria::kLargeAlternation *
            std::hypot(range_of(capture.vsin_v, all).half, range_of(capture.vcos_v, all).half)))
    return std::nullopt;
  const Channel sin = channel_of(capture.vsin_v, off_sin),
                cos = channel_of(capture.vcos_v, off_cos);
  const Range of_sin = range_of(sin.without, all), of_cos = range_of(cos.without, all);
  const double rms = std::hypot(sin.rms_v, cos.rms_v);
  const double noise = std::hypot(sin.scatter_v, cos.scatter_v);
  if (!(of_sin.half > 0.0 && of_cos.half > 0.0) ||
      rms < criteria::kLargeAlternation * std::hypot(of_sin.half, of_cos.half) ||
      rms < criteria::kSteadyAlternation * noise ||
      usual_step(sin, cos, of_sin, of_cos) > criteria::kSlowBesideAlternation ||
      !draws_circle(sin.without, cos.without) ||
      2.0 * off_ellipse(sin.without, cos.without) > off_ellipse(capture.vsin_v, capture.vcos_v))
    return std::nullopt;
  double product = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    product += sin.alternation[i] * cos.alternation[i];
  product /= static_cast<double>(n);
  // A tone lies on one line; what goes round with the pair is two gains, or two sensors.
  if (std::abs(product) < criteria::kOnOneLine * sin.rms_v * cos.rms_v &&
      std::min(sin.rms_v, cos.rms_v) > criteria::kOfOneChannel * rms)
    return std::nullopt;
  Alternation out;
  out.without = capture;
  out.without.vsin_v = sin.without;
  out.without.vcos_v = cos.without;
  // Beside half the rate by as many half periods as the alternation changes its sense, along the
  // line on which it lies.
  out.opposed = product < 0.0;
  const double sense = out.opposed ? -1.0 : 1.0;
  std::size_t changes = 0;
  double last = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double along = sin.rms_v * sin.alternation[i] + sense * cos.rms_v * cos.alternation[i];
    if (std::abs(along) < noise * rms)
      continue;
    changes += along * last < 0.0;
    last = along;
  }
  // One that comes and goes faster than the windows follow is a line like another.
  if (changes * criteria::kRowsOfAlternation > n)
    return std::nullopt;
  const double span = std::max(capture.time_s.back() - capture.time_s.front(), 1e-12);
  out.frequency_hz = 0.5 / median_step(capture.time_s) - 0.5 * static_cast<double>(changes) / span;
  out.frequency_error_hz = 0.5 / span;
  // Of a tone that comes and goes against the rows the amplitude shows; of one that does not, what
  // the rows see of it.
  const double amplitude = changes >= criteria::kComesAndGoes ? std::sqrt(2.0) : 1.0;
  out.sin_v = amplitude * sin.rms_v;
  out.cos_v = amplitude * cos.rms_v;
  const double windows = static_cast<double>(n) / static_cast<double>(criteria::kAlternationReach);
  out.sin_error_v = amplitude * sin.scatter_v / std::sqrt(windows);
  out.cos_error_v = amplitude * cos.scatter_v / std::sqrt(windows);
  return out;
}

} // namespace ada
