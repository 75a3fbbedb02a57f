// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/ellipse_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/circle_start.h"

namespace ada {

namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kBins = 72; ///< of psi, for the structure of the residual
constexpr std::size_t kCoverageBins = 360;
constexpr double kSigmaPerMad = 1.482602218505602; ///< of a Gaussian

/// One sample against the curve.
struct FootPoint {
  double distance; ///< outward, volts
  Vector5 normal;  ///< n . df/dtheta
  double sin_psi, cos_psi;
};

/// The curve at one set of parameters, compiled for many samples.
class Curve {
public:
  explicit Curve(const EllipseParameters &e)
      : e_(e), inverse_(invert(e)), cos_h_(std::cos(e.delta_rad / 2)),
        sin_h_(std::sin(e.delta_rad / 2)) {}

  FootPoint foot(double vsin, double vcos) const {
    const double y = inverse_.sine(vsin, vcos), x = inverse_.cosine(vsin, vcos);
    const double r = std::sqrt(x * x + y * y);
    FootPoint p;
    p.sin_psi = r > 0 ? y / r : 0.0;
    p.cos_psi = r > 0 ? x / r : 1.0;
    const double s = p.sin_psi * cos_h_ + p.cos_psi * sin_h_; // sin(psi + h)
    const double c = p.cos_psi * cos_h_ + p.sin_psi * sin_h_; // cos(psi - h)
    const double ds = p.cos_psi * cos_h_ - p.sin_psi * sin_h_;
    const double dc = -p.sin_psi * cos_h_ + p.cos_psi * sin_h_;
    const double a = e_.amplitude_v, gs = 1 + e_.k / 2, gc = 1 - e_.k / 2;
    const double ts = gs * ds, tc = gc * dc, length = std::hypot(ts, tc);
    const double ns = -tc / length, nc = ts / length;
    p.distance =
        ns * (vsin - e_.centre_sin_v - a * gs * s) + nc * (vcos - e_.centre_cos_v - a * gc * c);
    p.normal[kAmplitude] = ns * gs * s + nc * gc * c;
    p.normal[kMismatch] = 0.5 * a * (ns * s - nc * c);
    p.normal[kDelta] = 0.5 * a * (ns * gs * ds - nc * gc * dc);
    p.normal[kCentreSin] = ns;
    p.normal[kCentreCos] = nc;
    return p;
  }

private:
  EllipseParameters e_;
  EllipseInverse inverse_;
  double cos_h_, sin_h_;
};

std::size_t bin_of(const FootPoint &p, std::size_t bins) {
  const double turn = wrap(std::atan2(p.sin_psi, p.cos_psi) / kTwoPi, 1.0);
  return std::min(static_cast<std::size_t>(turn * static_cast<double>(bins)), bins - 1);
}

/// Bin means of the residual along psi.
struct Structure {
  std::array<double, kBins> count{}, sum{};
  double variance = 0;       ///< of the bin means, beyond what noise explains
  double noise_variance = 0; ///< within bins
};

class Fitter {
public:
  Fitter(std::span<const double> vsin, std::span<const double> vcos,
         const EllipseFitOptions &options)
      : vsin_(vsin), vcos_(vcos), options_(options), use_(vsin.size(), 1), bin_weight_{} {
    bin_weight_.fill(1.0);
  }

  EllipseFit run();

private:
  struct Normal {
    Matrix5 information = Matrix5::Zero();
    Vector5 gradient = Vector5::Zero();
    double cost = 0;
  };

  std::size_t free_parameters() const { return options_.circle ? 3 : 5; }
  void start();
  Normal accumulate(const EllipseParameters &e) const;
  double cost(const EllipseParameters &e) const;
  Vector5 solve(const Normal &normal, double damping) const;
  static EllipseParameters moved(const EllipseParameters &e, const Vector5 &step);
  bool descend();
  double scale(const std::vector<double> &distance, const std::vector<std::size_t> &bin) const;
  bool reject();
  Structure structure() const;
  void weigh_angles(EllipseFit &fit);
  void report(EllipseFit &fit) const;
  void describe_coverage(EllipseFit &fit) const;
  std::size_t used() const {
    return static_cast<std::size_t>(std::count(use_.begin(), use_.end(), 1));
  }

  std::span<const double> vsin_, vcos_;
  EllipseFitOptions options_;
  std::vector<unsigned char> use_;
  std::array<double, kBins> bin_weight_;
  bool weighted_ = false;
  EllipseParameters value_;
};

[[noreturn]] void no_ellipse(const std::string &why) {
  throw Error(ADA4571_ERROR_UNUSABLE_DATA, "no ellipse can be fitted: " + why);
}

void Fitter::start() {
  const Reach sin_fence = fence(vsin_), cos_fence = fence(vcos_);
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    use_[i] = sin_fence.holds(vsin_[i]) && cos_fence.holds(vcos_[i]);
  if (used() < 3 * free_parameters())
    no_ellipse("the capture holds " + std::to_string(used()) + " usable samples");
  value_ = circle_start(vsin_, vcos_, use_);
  if (!(value_.amplitude_v > 0))
    no_ellipse("VSIN and VCOS stand still or move along one line");
}

Fitter::Normal Fitter::accumulate(const EllipseParameters &e) const {
  const Curve curve(e);
  Normal normal;
  for (std::size_t i = 0; i < vsin_.size(); ++i) {
    if (!use_[i])
      continue;
    const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
    const double w = weighted_ ? bin_weight_[bin_of(p, kBins)] : 1.0;
    normal.information.selfadjointView<Eigen::Lower>().rankUpdate(p.normal, w);
    normal.gradient += w * p.distance * p.normal;
    normal.cost += w * p.distance * p.distance;
  }
  normal.information.triangularView<Eigen::StrictlyUpper>() = normal.information.transpose();
  return normal;
}

double Fitter::cost(const EllipseParameters &e) const {
  const Curve curve(e);
  double sum = 0;
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i]) {
      const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
      sum += (weighted_ ? bin_weight_[bin_of(p, kBins)] : 1.0) * p.distance * p.distance;
    }
  return sum;
}

Vector5 Fitter::solve(const Normal &normal, double damping) const {
  Matrix5 m = normal.information;
  m.diagonal() *= 1 + damping;
  Vector5 g = normal.gradient;
  if (options_.circle)
    for (const auto held : {kMismatch, kDelta}) {
      m.row(held).setZero();
      m.col(held).setZero();
      m(held, held) = 1;
      g[held] = 0;
    }
  // Scaled to a unit diagonal: volts and pure numbers then weigh alike in the factorisation.
  const Vector5 scale = m.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Vector5 x =
      (scale.asDiagonal() * m * scale.asDiagonal()).ldlt().solve(scale.cwiseProduct(g));
  return scale.cwiseProduct(x);
}

EllipseParameters Fitter::moved(const EllipseParameters &e, const Vector5 &step) {
  EllipseParameters m = e;
  m.amplitude_v += step[kAmplitude];
  m.k += step[kMismatch];
  m.delta_rad += step[kDelta];
  m.centre_sin_v += step[kCentreSin];
  m.centre_cos_v += step[kCentreCos];
  return m;
}

bool valid(const EllipseParameters &e) {
  return std::isfinite(e.amplitude_v + e.k + e.delta_rad + e.centre_sin_v + e.centre_cos_v) &&
         e.amplitude_v > 0 && std::abs(e.k) < 1.9 && std::abs(e.delta_rad) < 1.4;
}

/// Levenberg-Marquardt to the minimum for the samples in use; whether it converged.
bool Fitter::descend() {
  double damping = 0;
  Normal normal = accumulate(value_);
  for (std::size_t i = 0; i < options_.iterations; ++i) {
    const Vector5 step = solve(normal, damping);
    const double a = value_.amplitude_v;
    Vector5 relative = step;
    for (const auto volts : {kAmplitude, kCentreSin, kCentreCos})
      relative[volts] /= a;
    if (!relative.allFinite())
      return false;
    if (relative.cwiseAbs().maxCoeff() < 1e-10)
      return true;
    const EllipseParameters next = moved(value_, step);
    if (valid(next) && cost(next) <= normal.cost * (1 + 1e-12)) {
      value_ = next;
      damping *= 0.1;
      if (damping < 1e-8)
        damping = 0;
      normal = accumulate(value_);
    } else if (relative.cwiseAbs().maxCoeff() < 1e-7) {
      return true; // rounding: no step of this size can be judged
    } else {
      damping = damping == 0 ? 1e-4 : damping * 10;
      if (damping > 1e12)
        return false;
    }
  }
  return false;
}

/// Robust scale of the distances: their median, every angle counting alike however long the magnet
/// stayed there. Bins with next to no samples count less: they may hold nothing but spikes.
double Fitter::scale(const std::vector<double> &distance,
                     const std::vector<std::size_t> &bin) const {
  std::array<double, kBins> count{};
  for (std::size_t i = 0; i < bin.size(); ++i)
    if (std::isfinite(distance[i]))
      count[bin[i]] += 1;
  const double total = std::accumulate(count.begin(), count.end(), 0.0);
  const double least = total / (8 * kBins);
  std::vector<std::pair<double, double>> weighed;
  weighed.reserve(bin.size());
  double sum = 0;
  for (std::size_t i = 0; i < bin.size(); ++i)
    if (std::isfinite(distance[i])) {
      weighed.emplace_back(distance[i], 1 / std::max(count[bin[i]], least));
      sum += weighed.back().second;
    }
  std::sort(weighed.begin(), weighed.end());
  double below = 0;
  for (const auto &[d, weight] : weighed)
    if ((below += weight) >= 0.5 * sum)
      return std::max(kSigmaPerMad * d, 1e-6 * value_.amplitude_v);
  return 1e-6 * value_.amplitude_v;
}

/// Takes out what lies too far off the curve; whether the choice changed.
bool Fitter::reject() {
  const Curve curve(value_);
  std::vector<double> distance(vsin_.size());
  std::vector<std::size_t> bin(vsin_.size());
  for (std::size_t i = 0; i < vsin_.size(); ++i) {
    const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
    distance[i] = std::abs(p.distance);
    bin[i] = std::isfinite(p.distance) ? bin_of(p, kBins) : 0;
  }
  const double limit = kOutlierSigmas * scale(distance, bin);
  bool changed = false;
  for (std::size_t i = 0; i < vsin_.size(); ++i) {
    const unsigned char use = distance[i] <= limit; // false for no number
    changed = changed || use != use_[i];
    use_[i] = use;
  }
  return changed;
}

Structure Fitter::structure() const {
  const Curve curve(value_);
  Structure s;
  double square = 0, n = 0;
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i]) {
      const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
      const std::size_t b = bin_of(p, kBins);
      s.count[b] += 1;
      s.sum[b] += p.distance;
      square += p.distance * p.distance;
      n += 1;
    }
  double occupied = 0, between = 0, count_square = 0;
  for (std::size_t b = 0; b < kBins; ++b)
    if (s.count[b] > 0) {
      occupied += 1;
      between += s.sum[b] * s.sum[b] / s.count[b];
      count_square += s.count[b] * s.count[b];
    }
  const double freedom = occupied - static_cast<double>(free_parameters());
  if (freedom < 4 || n <= occupied + 4)
    return s;
  s.noise_variance = std::max(square - between, 0.0) / (n - occupied);
  // Under noise alone `between` is noise_variance times a chi-square of `freedom`: believe in
  // structure only five standard deviations above that, so that white data keep equal weights.
  const double excess = between - freedom * s.noise_variance;
  if (excess > 5 * std::sqrt(2 * freedom) * s.noise_variance)
    s.variance = excess / (n - count_square / n);
  return s;
}

/// Random effect of variance `structure` in each bin: a bin of n samples carries the information
/// 1/(structure + noise/n) rather than n/noise.
void Fitter::weigh_angles(EllipseFit &fit) {
  for (int round = 0; round < 3; ++round) {
    const Structure s = structure();
    if (s.variance == 0)
      return;
    fit.structure_rms_v = std::sqrt(s.variance);
    for (std::size_t b = 0; b < kBins; ++b)
      bin_weight_[b] = s.noise_variance > 0 ? 1 / (1 + s.count[b] * s.variance / s.noise_variance)
                                            : 1 / std::max(s.count[b], 1.0);
    weighted_ = true;
    if (!descend())
      return;
  }
}

/// What of the circle holds samples: all but the longest stretch without, and how many angles
/// kDirectionDeg apart can be picked from it, going round from the end of that stretch.
void Fitter::describe_coverage(EllipseFit &fit) const {
  const Curve curve(value_);
  std::array<bool, kCoverageBins> seen{};
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i])
      seen[bin_of(curve.foot(vsin_[i], vcos_[i]), kCoverageBins)] = true;
  std::size_t longest = 0, run = 0, begin = 0;
  for (std::size_t i = 0; i < 2 * kCoverageBins; ++i) {
    run = seen[i % kCoverageBins] ? 0 : run + 1;
    if (run > longest) {
      longest = run;
      begin = i + 1;
    }
  }
  longest = std::min(longest, kCoverageBins);
  constexpr double bin_deg = 360.0 / kCoverageBins;
  fit.coverage_deg = 360.0 - bin_deg * static_cast<double>(longest);
  constexpr auto apart = static_cast<std::size_t>(kDirectionDeg / bin_deg);
  for (std::size_t i = 0; i + apart <= kCoverageBins;)
    if (seen[(begin + i) % kCoverageBins]) {
      ++fit.directions;
      i += apart;
    } else {
      ++i;
    }
}

void Fitter::report(EllipseFit &fit) const {
  const Curve curve(value_);
  double square = 0;
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i])
      square += std::pow(curve.foot(vsin_[i], vcos_[i]).distance, 2);
  fit.used = used();
  fit.rejected = vsin_.size() - fit.used;
  const double freedom = static_cast<double>(fit.used) - static_cast<double>(free_parameters());
  const double variance = square / std::max(freedom, 1.0);
  fit.residual_rms_v = std::sqrt(variance);
  const Structure s = structure();
  const double noise = fit.structure_rms_v > 0 ? s.noise_variance : variance;
  fit.value = value_;
  fit.value.amplitude_v -= 0.5 * noise / value_.amplitude_v; // curvature, see ellipse_fit.h
  Matrix5 information = accumulate(value_).information;
  const Vector5 scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::Map<Eigen::Matrix<double, 5, 5, Eigen::RowMajor>> out(fit.covariance.data());
  if (options_.circle)
    for (const auto held : {kMismatch, kDelta}) {
      information.row(held).setZero();
      information.col(held).setZero();
      information(held, held) = 1;
    }
  const Matrix5 scaled = scale.asDiagonal() * information * scale.asDiagonal();
  // With bins of unequal weight the weights already are noise/(variance of the bin mean) / n.
  out = scale.asDiagonal() * scaled.ldlt().solve(Matrix5::Identity()) * scale.asDiagonal();
  out *= std::max(noise, 1e-300);
  if (options_.circle)
    for (const auto held : {kMismatch, kDelta}) {
      out.row(held).setZero();
      out.col(held).setZero();
    }
  fit.free_parameters = free_parameters();
  describe_coverage(fit);
}

EllipseFit Fitter::run() {
  start();
  bool converged = false;
  for (int round = 0; round < 20; ++round) {
    converged = descend();
    if (!reject())
      break;
    if (used() < 3 * free_parameters())
      no_ellipse("the samples do not lie on one curve");
  }
  if (!converged)
    no_ellipse("the samples cover too little of the circle, or do not lie on one curve");
  EllipseFit fit;
  weigh_angles(fit);
  report(fit);
  fit.accepted = std::move(use_);
  return fit;
}

} // namespace

double EllipseFit::std_error(EllipseIndex i) const {
  return std::sqrt(std::max(covariance[i * kEllipseSize + i], 0.0));
}

double EllipseFit::predicted_error_rad() const {
  const Eigen::Map<const Eigen::Matrix<double, 5, 5, Eigen::RowMajor>> cov(covariance.data());
  const double h = value.delta_rad / 2, a = value.amplitude_v;
  const double gs = 1 + value.k / 2, gc = 1 - value.k / 2;
  constexpr int kSteps = 72;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double psi = kTwoPi * i / kSteps;
    const double s = std::sin(psi + h), c = std::cos(psi - h);
    const double ds = std::cos(psi + h), dc = -std::sin(psi - h);
    const double ts = a * gs * ds, tc = a * gc * dc;
    Vector5 g;
    g << ts * gs * s + tc * gc * c, 0.5 * a * (ts * s - tc * c),
        0.5 * a * (ts * gs * ds - tc * gc * dc), ts, tc;
    g /= ts * ts + tc * tc;
    sum += g.dot(cov * g);
  }
  return std::sqrt(std::max(sum, 0.0) / kSteps);
}

EllipseFit fit_ellipse(std::span<const double> vsin, std::span<const double> vcos,
                       const EllipseFitOptions &options) {
  return Fitter(vsin, vcos, options).run();
}

} // namespace ada
