// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/unseen_supply.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "base/solve.h"
#include "diagnosis/lines/spectrum.h"
#include "diagnosis/search/fit.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

constexpr std::size_t kFewest = 2000;
constexpr double kMostOfAmplitude = 0.2;
constexpr double kAboveNoise = 2.0; ///< the radius must move at least so much
constexpr double kExplained = 0.4;  ///< of its rms that may be left over
constexpr double kBetter = 1.4;     ///< times less left over than any rival leaves

/// Radial part of one volt per volt of a supply, a gain, the offset of VSIN, the offset of VCOS.
using Shape = std::array<std::vector<double>, 4>;

/// Radius of the pair about its middle, freed of what repeats with the electrical angle.
struct Radius {
  std::vector<double> angle; ///< unwrapped, electrical
  std::vector<double> off;   ///< V
  double middle_sin, middle_cos, amplitude;
};

Radius radius_of(const Capture &c) {
  Radius out;
  const auto middle = [](const std::vector<double> &v) {
    return 0.5 * (quantile(v, 0.005) + quantile(v, 0.995));
  };
  out.middle_sin = middle(c.vsin_v);
  out.middle_cos = middle(c.vcos_v);
  std::vector<double> radius;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double s = c.vsin_v[i] - out.middle_sin, k = c.vcos_v[i] - out.middle_cos;
    out.angle.push_back(std::atan2(s, k));
    radius.push_back(std::hypot(s, k));
  }
  out.amplitude = quantile(radius, 0.5);
  constexpr int kOrders = 6, kColumns = 1 + 2 * kOrders;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kColumns, kColumns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kColumns), x(kColumns);
  const auto row = [&](std::size_t i) {
    x[0] = 1.0;
    for (int k = 1; k <= kOrders; ++k) {
      x[2 * k - 1] = std::cos(k * out.angle[i]);
      x[2 * k] = std::sin(k * out.angle[i]);
    }
  };
  const std::size_t stride = std::max<std::size_t>(1, c.size() / 30000);
  for (std::size_t i = 0; i < c.size(); i += stride) {
    row(i);
    normal.selfadjointView<Eigen::Lower>().rankUpdate(x);
    right += radius[i] * x;
  }
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd fitted = solved_lower(normal, right);
  for (std::size_t i = 0; i < c.size(); ++i) {
    row(i);
    out.off.push_back(radius[i] - fitted.dot(x));
  }
  unwrap(out.angle, kTwoPi);
  return out;
}

/// First sample after a quarter of a period from each; travel counts, whatever its sense.
std::vector<std::size_t> quarter_period_ends(const std::vector<double> &angle) {
  std::vector<std::size_t> out(angle.size());
  std::size_t to = 0;
  double travel = 0.0;
  for (std::size_t from = 0; from < angle.size(); ++from) {
    while (to + 1 < angle.size() && (to < from + 4 || travel < 0.25 * kTwoPi)) {
      travel += std::abs(angle[to + 1] - angle[to]);
      ++to;
    }
    out[from] = to;
    if (from < to)
      travel -= std::abs(angle[from + 1] - angle[from]);
  }
  return out;
}

/// What a slow disturbance that acts on the radius as `shape` says must have been, by least squares
/// over half a period about each sample, and the rms that it leaves of the radius.
struct Slow {
  std::vector<double> value;
  double left_v;
};

Slow slow_part(const Radius &r, const std::vector<double> &shape,
               const std::vector<std::size_t> &quarter) {
  const std::size_t n = r.off.size();
  std::vector<double> gg(n + 1, 0.0), gr(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    gg[i + 1] = gg[i] + shape[i] * shape[i];
    gr[i + 1] = gr[i] + shape[i] * r.off[i];
  }
  Slow out{std::vector<double>(n, 0.0), 0.0};
  std::size_t from = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    while (quarter[from] < i)
      ++from;
    const std::size_t to = std::min(n, quarter[i] + 1);
    const double weight = gg[to] - gg[from];
    out.value[i] = weight > 0.0 ? (gr[to] - gr[from]) / weight : 0.0;
    const double left = r.off[i] - shape[i] * out.value[i];
    sum += left * left;
  }
  out.left_v = std::sqrt(sum / static_cast<double>(n));
  return out;
}

double rms(const std::vector<double> &v) {
  double sum = 0.0;
  for (double x : v)
    sum += x * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

using Shapes = std::vector<const std::vector<double> *>;

/// Least squares of the radius on shapes that swing at one frequency.
struct Swing {
  double explained = 0.0; ///< of the sum of squares
  Eigen::VectorXd size;   ///< cosine and sine of each shape
};

Swing swing_at(const Radius &r, const std::vector<double> &time, const Shapes &shapes, double hz) {
  constexpr std::size_t kMostSamples = 30000;
  const auto columns = 2 * static_cast<Eigen::Index>(shapes.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(columns, columns) * 1e-12;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns), row(columns);
  const std::size_t stride = std::max<std::size_t>(1, time.size() / kMostSamples);
  for (std::size_t i = 0; i < time.size(); i += stride) {
    const double c = std::cos(kTwoPi * hz * time[i]), s = std::sin(kTwoPi * hz * time[i]);
    for (Eigen::Index k = 0; k < columns; k += 2) {
      const double shape = (*shapes[static_cast<std::size_t>(k / 2)])[i];
      row[k] = shape * c;
      row[k + 1] = shape * s;
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += r.off[i] * row;
  }
  Swing out;
  out.size = solved_lower(normal, right);
  out.explained = right.dot(out.size) * static_cast<double>(stride);
  return out;
}

/// The frequency at which a supply that swings would explain most of the radius, Hz; 0: none.
double frequency_of(const Capture &c, const Radius &r, const std::vector<double> &supply) {
  constexpr std::size_t kSlow = 20; ///< lines that are no swing but what is slow
  PowerOverTime spectrum;
  add_power_over_time(
      c.time_s, median_step(c.time_s), [&](std::size_t i) { return r.off[i] * supply[i]; },
      spectrum);
  std::size_t peak = 0;
  for (std::size_t k = kSlow; k < spectrum.power.size(); ++k)
    if (peak == 0 || spectrum.power[k] > spectrum.power[peak])
      peak = k;
  double best = static_cast<double>(peak) * spectrum.bin_hz, most = 0.0;
  for (double reach = spectrum.bin_hz; peak > 0 && reach > 1e-3 * spectrum.bin_hz; reach *= 0.25) {
    const double middle = best;
    for (int k = -4; k <= 4; ++k) {
      const double hz = middle + 0.25 * k * reach;
      const double explained = swing_at(r, c.time_s, {&supply}, hz).explained;
      if (explained > most) {
        most = explained;
        best = hz;
      }
    }
  }
  return best;
}

/// A supply that is slow against the rotation accounts for most of what the radius does, and far
/// better than a gain or an offset that wander. What it does per sample, of itself; empty when it
/// does not.
std::vector<double> wandering_supply(const Radius &r, const Shape &shape) {
  const double whole = rms(r.off);
  if (whole < kAboveNoise * noise_between(r.off))
    return {};
  const std::vector<std::size_t> quarter = quarter_period_ends(r.angle);
  Slow supply = slow_part(r, shape[0], quarter);
  if (supply.left_v > kExplained * whole)
    return {};
  for (std::size_t k = 1; k < shape.size(); ++k)
    if (slow_part(r, shape[k], quarter).left_v < kBetter * supply.left_v)
      return {};
  return std::move(supply.value);
}

/// A supply that swings at one frequency moves the radius by what no tone on the channels, with
/// twice as many numbers to choose, and no swing of the gain or of an offset does. The swing per
/// sample, of itself; empty when there is none.
std::vector<double> swinging_supply(const Capture &c, const Radius &r, const Shape &shape) {
  constexpr double kStandsOut = 100.0; ///< nats, of the radius as it is
  constexpr double kMore = 1.2;        ///< times as much explained as by any rival
  constexpr double kSlower = 0.25;     ///< than the electrical angle: that would be a wander
  const double hz = frequency_of(c, r, shape[0]);
  double travel = 0.0;
  for (std::size_t i = 1; i < r.angle.size(); ++i)
    travel += std::abs(r.angle[i] - r.angle[i - 1]) / kTwoPi;
  if (hz <= kSlower * travel / (c.time_s.back() - c.time_s.front()))
    return {};
  const Swing supply = swing_at(r, c.time_s, {&shape[0]}, hz);
  const double whole = rms(r.off);
  const bool clear = supply.explained > 2.0 * kStandsOut * whole * whole;
  for (const Shapes &rival : {Shapes{&shape[2], &shape[3]}, Shapes{&shape[1]}})
    if (!clear || supply.explained < kMore * swing_at(r, c.time_s, rival, hz).explained)
      return {};
  std::vector<double> out;
  for (double t : c.time_s)
    out.push_back(supply.size[0] * std::cos(kTwoPi * hz * t) +
                  supply.size[1] * std::sin(kTwoPi * hz * t));
  return out;
}

/// How much a column moves within a hundredth of the record.
double unrest(const std::vector<double> &v) {
  const std::size_t lag = v.size() / 100;
  double sum = 0.0;
  for (std::size_t i = lag; i < v.size(); ++i)
    sum += (v[i] - v[i - lag]) * (v[i] - v[i - lag]);
  return sum;
}

/// `part`: what the supply moves by at each sample, of itself.
Capture with_vdd(Capture capture, const std::vector<double> &part) {
  for (double u : part)
    capture.vdd_v.push_back(capture.meta.supply_v * (1.0 + u));
  return capture;
}

} // namespace

std::optional<Capture> with_unseen_supply(const Capture &capture) {
  if (capture.has_vdd() || capture.size() < kFewest ||
      (capture.has_reference() && !capture.has_vtemp()))
    return std::nullopt;
  const Radius radius = radius_of(capture);
  if (rms(radius.off) > kMostOfAmplitude * radius.amplitude)
    return std::nullopt;
  Shape shape;
  for (double a : radius.angle) {
    const double s = std::sin(a), c = std::cos(a);
    shape[0].push_back(radius.middle_sin * s + radius.middle_cos * c + radius.amplitude);
    shape[1].push_back(1.0);
    shape[2].push_back(s);
    shape[3].push_back(c);
  }
  std::vector<double> supply = wandering_supply(radius, shape);
  if (!capture.has_reference()) {
    if (supply.empty())
      supply = swinging_supply(capture, radius, shape);
    return supply.empty() ? std::nullopt : std::optional(with_vdd(capture, supply));
  }
  if (supply.empty())
    return std::nullopt;
  Capture out = capture;
  for (std::size_t i = 0; i < out.size(); ++i)
    out.vtemp_v[i] /= 1.0 + supply[i];
  return unrest(out.vtemp_v) < unrest(capture.vtemp_v) ? std::optional(out) : std::nullopt;
}

std::optional<Capture> with_free_vtemp(const Capture &capture, const Scene &scene,
                                       const Model &model) {
  if (!capture.has_vtemp() || scene.all.size() < kFewest)
    return std::nullopt;
  const ResidualColumns r = residual_columns(scene.all, model);
  Capture out = capture;
  std::size_t k = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    while (k + 1 < scene.index.size() && scene.index[k] < i)
      ++k;
    const double s = r.model_sin[k], c = r.model_cos[k];
    out.vtemp_v[i] /= 1.0 + (r.sin[k] * s + r.cos[k] * c) / (s * s + c * c);
  }
  return unrest(out.vtemp_v) < unrest(capture.vtemp_v) ? std::optional(out) : std::nullopt;
}

bool accounts_for_radius(const Observations &data, const Model &model, double rms_fraction,
                         double noise_v) {
  constexpr double kMore = 1.5;
  const ResidualColumns r = residual_columns(data, model);
  double radial2 = 0.0, reach2 = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double s = r.model_sin[i] - data.centre_sin_v, c = r.model_cos[i] - data.centre_cos_v;
    const double square = std::max(s * s + c * c, 1e-12);
    const double radial = r.sin[i] * s + r.cos[i] * c;
    const double reach = data.vsin[i] * s + data.vcos[i] * c;
    radial2 += radial * radial / square;
    reach2 += reach * reach / square;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, data.size()));
  return radial2 / n < kMore * (noise_v * noise_v + rms_fraction * rms_fraction * reach2 / n);
}

} // namespace ada
