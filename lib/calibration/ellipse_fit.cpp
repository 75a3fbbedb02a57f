// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/ellipse_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/circle_start.h"
#include "calibration/ellipse_curve.h"

namespace ada {

namespace {

using namespace ellipse;

std::size_t bin_of(const FootPoint &p, std::size_t bins) {
  const double turn = wrap(std::atan2(p.sin_psi, p.cos_psi) / kTwoPi, 1.0);
  return std::min(static_cast<std::size_t>(turn * static_cast<double>(bins)), bins - 1);
}

class Fitter {
public:
  Fitter(std::span<const double> vsin, std::span<const double> vcos,
         const EllipseFitOptions &options)
      : vsin_(vsin), vcos_(vcos), options_(options), use_(vsin.size(), 1), bin_weight_{} {
    bin_weight_.fill(1.0);
  }

  /// From Taubin's circle through what the fences hold, from the circle of most places, or from
  /// Taubin's circle through what the fences hold with its principal axes stretched to one range.
  enum class Start { fences, places, axes };
  EllipseFit run(Start from);

private:
  struct Normal {
    Matrix5 information = Matrix5::Zero();
    Vector5 gradient = Vector5::Zero();
    double cost = 0;
  };

  std::size_t free_parameters() const { return options_.circle ? 3 : 5; }
  void start_within_fences();
  void start_at_places();
  void start_by_axes();
  Normal accumulate(const EllipseParameters &e) const;
  double cost(const EllipseParameters &e) const;
  bool descend();
  double scale(const std::vector<double> &distance, const std::vector<std::size_t> &bin) const;
  bool reject();
  Structure structure() const;
  Shares shares() const;
  void weigh_angles(EllipseFit &fit);
  void report(EllipseFit &fit) const;
  std::array<bool, kCoverageBins> seen() const;
  std::size_t used() const {
    return static_cast<std::size_t>(std::count(use_.begin(), use_.end(), 1));
  }

  std::span<const double> vsin_, vcos_;
  EllipseFitOptions options_;
  std::vector<unsigned char> use_;
  std::array<double, kBins> bin_weight_;
  bool weighted_ = false;
  double limit_v_ = 0; ///< of the distance of samples in use
  EllipseParameters value_;
};

void Fitter::start_within_fences() {
  const Reach sin_fence = fence(vsin_), cos_fence = fence(vcos_);
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    use_[i] = sin_fence.holds(vsin_[i]) && cos_fence.holds(vcos_[i]);
  if (used() < 3 * free_parameters())
    no_ellipse("the capture holds " + std::to_string(used()) + " usable samples");
  value_ = circle_start(vsin_, vcos_, use_);
  if (!(value_.amplitude_v > 0))
    no_ellipse("VSIN and VCOS stand still or move along one line");
}

void Fitter::start_at_places() {
  value_ = circle_of_most_places(vsin_, vcos_);
  if (!(value_.amplitude_v > 0))
    no_ellipse("VSIN and VCOS stand still or move along one line");
  reject();
  if (used() < 3 * free_parameters())
    no_ellipse("the samples do not lie on one curve");
}

void Fitter::start_by_axes() {
  start_within_fences();
  const auto count = static_cast<double>(used());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const bool second : {false, true})
    for (std::size_t i = 0; i < vsin_.size(); ++i)
      if (use_[i]) {
        const Eigen::Vector2d at(vsin_[i], vcos_[i]);
        if (!second)
          mean += at / count;
        else
          spread += (at - mean) * (at - mean).transpose();
      }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread);
  const Eigen::Matrix2d axes = eigen.eigenvectors(); // the short one first
  std::array<std::vector<double>, 2> along;
  Eigen::Vector2d range;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> &v = along[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < vsin_.size(); ++i)
      v.push_back(axes.col(axis).dot(Eigen::Vector2d(vsin_[i], vcos_[i])));
    constexpr double kEnd = 0.05;
    range[axis] = quantile(v, 1 - kEnd) - quantile(v, kEnd);
  }
  if (!(range[0] > 0 && range[1] > 0))
    no_ellipse("VSIN and VCOS stand still or move along one line");
  const double stretch = range[1] / range[0];
  for (double &v : along[0])
    v *= stretch;
  const EllipseParameters circle = circle_start(along[0], along[1], use_);
  if (!(circle.amplitude_v > 0))
    no_ellipse("VSIN and VCOS stand still or move along one line");
  const Eigen::Vector2d centre =
      axes * Eigen::Vector2d(circle.centre_sin_v / stretch, circle.centre_cos_v);
  // The circle seen in the channels: of A (1 +- k/2) and d its second moments know all.
  const Eigen::Vector2d half(circle.amplitude_v / stretch, circle.amplitude_v);
  const Eigen::Matrix2d moments = axes * half.cwiseAbs2().asDiagonal() * axes.transpose();
  const double sin = std::sqrt(moments(0, 0)), cos = std::sqrt(moments(1, 1));
  value_ = {};
  value_.centre_sin_v = centre[0];
  value_.centre_cos_v = centre[1];
  value_.amplitude_v = 0.5 * (sin + cos);
  value_.k = 2 * (sin - cos) / (sin + cos);
  value_.delta_rad = std::asin(std::clamp(moments(0, 1) / (sin * cos), -1.0, 1.0));
  if (!valid(value_))
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

/// Levenberg-Marquardt to the minimum for the samples in use; whether it converged.
bool Fitter::descend() {
  double damping = 0;
  Normal normal = accumulate(value_);
  for (std::size_t i = 0; i < options_.iterations; ++i) {
    const Vector5 step = solve(normal.information, normal.gradient, damping, options_.circle);
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
  const double limit = limit_v_ = kOutlierSigmas * scale(distance, bin);
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
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i]) {
      const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
      const std::size_t b = bin_of(p, kBins);
      s.count[b] += 1;
      s.sum[b] += p.distance;
      s.square += p.distance * p.distance;
    }
  s.judge(free_parameters());
  return s;
}

void Fitter::weigh_angles(EllipseFit &fit) {
  for (int round = 0; round < 3; ++round) {
    const Structure s = structure();
    if (s.variance == 0)
      return;
    fit.structure_rms_v = std::sqrt(s.variance);
    for (std::size_t b = 0; b < kBins; ++b)
      bin_weight_[b] = s.weight(b);
    weighted_ = true;
    if (!descend())
      return;
  }
}

Shares Fitter::shares() const {
  const Curve curve(value_);
  Shares out;
  for (std::size_t i = 0; i < vsin_.size(); ++i) {
    if (!use_[i])
      continue;
    const FootPoint p = curve.foot(vsin_[i], vcos_[i]);
    const double w = weighted_ ? bin_weight_[bin_of(p, kBins)] : 1.0;
    Share &s = out[stretch_of(i, vsin_.size()) % kParts];
    const Matrix5 product = p.normal * p.normal.transpose();
    s.information += product;
    s.weighed_information += w * product;
    s.gradient += p.distance * p.normal;
    s.weighed_gradient += w * p.distance * p.normal;
    s.square += p.distance * p.distance;
    s.count += 1;
  }
  return out;
}

std::array<bool, kCoverageBins> Fitter::seen() const {
  const Curve curve(value_);
  std::array<bool, kCoverageBins> seen{};
  for (std::size_t i = 0; i < vsin_.size(); ++i)
    if (use_[i])
      seen[bin_of(curve.foot(vsin_[i], vcos_[i]), kCoverageBins)] = true;
  return seen;
}

void Fitter::report(EllipseFit &fit) const {
  fit.used = used();
  fit.rejected = vsin_.size() - fit.used;
  fit.limit_v = limit_v_;
  describe(fit, value_, accumulate(value_).information, structure(), options_.circle);
  fit.heldout_rms_v = heldout_rms(shares(), value_.amplitude_v, options_.circle);
  describe_coverage(fit, seen());
}

EllipseFit Fitter::run(Start from) {
  switch (from) {
  case Start::fences:
    start_within_fences();
    break;
  case Start::places:
    start_at_places();
    break;
  case Start::axes:
    start_by_axes();
    break;
  }
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

/// Whether the start may have been none. More than one in a hundred wild values at one end lie
/// within the fences, which then hold nothing back: many are off the curve in the end, or far off
/// it, or at some angles all are. So it may have been where the samples stand at too few angles of
/// the curve to prove it: a flat ellipse lies on a part of any large circle.
bool is_doubtful(const EllipseFit &fit, std::size_t samples) {
  constexpr double kFew = 0.01;       // of the samples
  constexpr double kFar = 0.05;       // of the amplitude
  constexpr double kOfResidual = 0.5; // of its variance
  const double structure = fit.structure_rms_v / fit.residual_rms_v;
  return fit.directions <= fit.free_parameters ||
         static_cast<double>(fit.rejected) > kFew * static_cast<double>(samples) ||
         fit.residual_rms_v > kFar * fit.value.amplitude_v || structure * structure > kOfResidual;
}

/// Whether most samples lie on a curve that is much finer. A magnet that rests lies on any curve
/// through its place: what a fit sees of the circle may not become less.
bool is_far_better(const EllipseFit &a, const EllipseFit &b) {
  constexpr double kFiner = 0.5;
  return a.limit_v < kFiner * b.limit_v && 2 * a.used > a.used + a.rejected &&
         a.coverage_deg >= b.coverage_deg;
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
  const auto from = [&](Fitter::Start start) { return Fitter(vsin, vcos, options).run(start); };
  std::optional<EllipseFit> plain;
  std::string why;
  try {
    plain = from(Fitter::Start::fences);
  } catch (const Error &e) {
    why = e.what();
  }
  if (plain && !is_doubtful(*plain, vsin.size()))
    return *std::move(plain);
  // Wild samples, or a figure that is far from a circle.
  for (const auto start : {Fitter::Start::places, Fitter::Start::axes}) {
    if (options.circle && start == Fitter::Start::axes) // which would stay as they are
      continue;
    try {
      EllipseFit other = from(start);
      if (!plain || is_far_better(other, *plain))
        plain = std::move(other);
    } catch (const Error &) {
      // Then the samples lie on no curve, and the first fit says so best.
    }
  }
  if (plain)
    return *std::move(plain);
  throw Error(ADA4571_ERROR_UNUSABLE_DATA, why);
}

} // namespace ada
