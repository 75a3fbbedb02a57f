// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/recording_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "calibration/ellipse_curve.h"
#include "conversion/vector_kernels.h"

namespace ada {

namespace {

using namespace ellipse;

/// Bins a structure bin, so narrow that the derivatives within them are straight lines: they differ
/// from that at their middle by 0.0013 of their size (rms). For the noise this is too little to
/// count, yet not for a million samples at rest, whose few codes all err to one side: the place
/// within the bin counts as well.
constexpr std::size_t kFine = 20;
constexpr std::size_t kFineBins = kBins * kFine;
static_assert(kFineBins % kCoverageBins == 0);

constexpr std::size_t kCells = kDistanceCells; ///< of each structure bin

constexpr std::size_t kBlocksARun = 8; ///< blocks that are summed up at once
constexpr int kMostPasses = 10;
constexpr double kSmallStep = 0.003;  ///< standard errors
constexpr double kSmallChange = 1e-3; ///< of the limit, relative
constexpr double kNear = 0.05;        ///< the same, where no sample lies so near to the limit

struct Bin {
  double count = 0, sum = 0, square = 0;
  double placed = 0; ///< sum of distance x place, which is -0.5 to 0.5 within the bin
};

void add_bins(const std::vector<Bin> &from, std::vector<Bin> &to) {
  for (std::size_t b = 0; b < kFineBins; ++b) {
    to[b].count += from[b].count;
    to[b].sum += from[b].sum;
    to[b].square += from[b].square;
    to[b].placed += from[b].placed;
  }
}

/// What one pass over the samples adds up.
struct BlockSums {
  /// Of each part of the recording.
  std::array<std::vector<Bin>, kParts> bins{
      std::vector<Bin>(kFineBins), std::vector<Bin>(kFineBins), std::vector<Bin>(kFineBins)};
  std::vector<std::uint32_t> cells = std::vector<std::uint32_t>(kBins * kCells);
  std::size_t used = 0, rejected = 0, near_limit = 0;

  void clear() {
    for (std::vector<Bin> &part : bins)
      std::fill(part.begin(), part.end(), Bin());
    std::fill(cells.begin(), cells.end(), 0u);
    used = rejected = near_limit = 0;
  }
  void add(const BlockSums &other) {
    for (std::size_t part = 0; part < kParts; ++part)
      add_bins(other.bins[part], bins[part]);
    for (std::size_t c = 0; c < cells.size(); ++c)
      cells[c] += other.cells[c];
    used += other.used;
    rejected += other.rejected;
    near_limit += other.near_limit;
  }
};

/// The sums of a run of blocks, and room to make them.
struct Run {
  BlockSums sums;
  Block block;
  std::vector<double> psi, radius;
};

PairConstants<double> about_ellipse(const EllipseInverse &e) {
  return {e.centre_sin_v,
          e.centre_cos_v,
          e.sin_from_sin,
          e.sin_from_cos,
          0,
          e.cos_from_sin,
          e.cos_from_cos,
          0,
          kTwoPi};
}

class RecordingFitter {
public:
  RecordingFitter(const Recording &recording, const EllipseFitOptions &options,
                  const EllipseFit &first)
      : recording_(recording), circle_(options.circle), value_(first.value),
        limit_v_(first.limit_v),
        cell_v_(kDistanceSigmas * first.limit_v / kOutlierSigmas / kCells) {}

  void run(EllipseFit &fit);

private:
  void pass();
  void add(Run &run) const;
  void linearise();
  Structure structure(const Vector5 &step) const;
  Share share_of(const std::vector<Bin> &bins) const;
  double scale() const;
  double greatest_move_v(const Vector5 &step) const;
  bool is_small(const Vector5 &step, const EllipseFit &fit) const;
  bool refine(EllipseFit &fit);

  const Recording &recording_;
  bool circle_;
  EllipseParameters value_; ///< the curve of the pass
  double limit_v_, cell_v_; ///< greatest distance, and that of a cell
  BlockSums sums_;
  std::vector<Bin> bins_;       ///< of the whole recording
  std::vector<Vector5> normal_; ///< of the fine bins
  std::vector<double> weight_ = std::vector<double>(kBins, 1.0);
};

/// One pass over the samples about value_.
void RecordingFitter::pass() {
  linearise();
  sums_.clear();
  const std::size_t blocks = recording_.blocks();
  in_order<Run>((blocks + kBlocksARun - 1) / kBlocksARun,
                [&](std::size_t r, Run &run) {
                  run.sums.clear();
                  for (std::size_t k = r * kBlocksARun; k < std::min(blocks, (r + 1) * kBlocksARun);
                       ++k) {
                    recording_.read(k, kPairColumns, run.block);
                    add(run);
                  }
                },
                [&](std::size_t, const Run &run) { sums_.add(run.sums); });
  bins_.assign(kFineBins, Bin());
  for (const std::vector<Bin> &part : sums_.bins)
    add_bins(part, bins_);
}

void RecordingFitter::linearise() {
  const Curve curve(value_);
  normal_.resize(kFineBins);
  for (std::size_t b = 0; b < kFineBins; ++b) {
    const double psi = kTwoPi * (static_cast<double>(b) + 0.5) / kFineBins;
    normal_[b] = curve.at(std::sin(psi), std::cos(psi), 1.0).normal;
  }
}

void RecordingFitter::add(Run &run) const {
  const Block &in = run.block;
  run.psi.resize(in.count);
  run.radius.resize(in.count);
  convert_planar_f64(in.vsin_v.data(), in.vcos_v.data(), in.count, about_ellipse(invert(value_)),
                     run.psi.data(), run.radius.data());
  std::uint32_t *const cells = run.sums.cells.data();
  constexpr double per_radian = kFineBins / kTwoPi;
  const double near_v = kNear * limit_v_;
  std::size_t used = 0, near_limit = 0;
  Bin *bins = nullptr;
  std::size_t end = 0; // of the stretch that is one part
  for (std::size_t i = 0; i < in.count; ++i) {
    if (i == end) {
      const std::size_t stretch = stretch_of(in.first + i, recording_.size());
      bins = run.sums.bins[stretch % kParts].data();
      end = stretch_begin(stretch + 1, recording_.size()) - in.first;
    }
    // A sample at the centre has no angle; it is far off whatever that is.
    const double psi = run.psi[i] >= 0 ? run.psi[i] : 0.0;
    const std::size_t b = std::min(static_cast<std::size_t>(psi * per_radian), kFineBins - 1);
    const double e = value_.amplitude_v * normal_[b][kAmplitude] * (run.radius[i] - 1);
    const double off = std::abs(e);
    if (off < cell_v_ * kCells)
      ++cells[b / kFine * kCells + static_cast<std::size_t>(off / cell_v_)];
    else if (off - off == 0)
      ++cells[b / kFine * kCells + kCells - 1];
    near_limit += std::abs(off - limit_v_) <= near_v;
    if (off <= limit_v_) { // false for no number
      bins[b].count += 1;
      bins[b].sum += e;
      bins[b].square += e * e;
      bins[b].placed += e * (psi * per_radian - static_cast<double>(b) - 0.5);
      ++used;
    }
  }
  run.sums.used += used;
  run.sums.rejected += in.count - used;
  run.sums.near_limit += near_limit;
}

/// Normal equations about value_ from the sums of some samples, under weight_.
Share RecordingFitter::share_of(const std::vector<Bin> &bins) const {
  Share s;
  for (std::size_t b = 0; b < kFineBins; ++b) {
    const Bin &bin = bins[b];
    const double w = weight_[b / kFine];
    const Vector5 &after = normal_[(b + 1) % kFineBins];
    const Vector5 &before = normal_[(b + kFineBins - 1) % kFineBins];
    const Matrix5 product = bin.count * normal_[b] * normal_[b].transpose();
    const Vector5 onto = bin.sum * normal_[b] + 0.5 * bin.placed * (after - before);
    s.information += product;
    s.weighed_information += w * product;
    s.gradient += onto;
    s.weighed_gradient += w * onto;
    s.square += bin.square;
    s.count += bin.count;
  }
  return s;
}

/// The structure of the residual after a step from value_, to first order.
Structure RecordingFitter::structure(const Vector5 &step) const {
  Structure s;
  for (std::size_t b = 0; b < kFineBins; ++b) {
    const Bin &bin = bins_[b];
    const double moved = normal_[b].dot(step);
    s.count[b / kFine] += bin.count;
    s.sum[b / kFine] += bin.sum - bin.count * moved;
    s.square += bin.square - 2 * moved * bin.sum + bin.count * moved * moved;
  }
  s.judge(circle_ ? 3 : 5);
  return s;
}

/// Robust scale of the distances, as the fit of samples takes it: their median, every angle
/// counting alike.
double RecordingFitter::scale() const {
  std::vector<double> count(kBins), weighed(kCells);
  double total = 0;
  for (std::size_t c = 0; c < sums_.cells.size(); ++c)
    count[c / kCells] += sums_.cells[c];
  for (const double n : count)
    total += n;
  double sum = 0;
  for (std::size_t c = 0; c < sums_.cells.size(); ++c) {
    const double w = sums_.cells[c] / std::max(count[c / kCells], total / (8 * kBins));
    weighed[c % kCells] += w;
    sum += w;
  }
  double below = 0;
  for (std::size_t c = 0; c < kCells; ++c) {
    if (below + weighed[c] >= 0.5 * sum && weighed[c] > 0)
      return std::max(kSigmaPerMad * cell_v_ *
                          (static_cast<double>(c) + (0.5 * sum - below) / weighed[c]),
                      1e-6 * value_.amplitude_v);
    below += weighed[c];
  }
  return 1e-6 * value_.amplitude_v;
}

/// Farther than any sample moves by a step, for the distance changes by at most this: a change of
/// amplitude and of centre in full, of mismatch and quadrature by half of the amplitude.
double RecordingFitter::greatest_move_v(const Vector5 &step) const {
  return std::abs(step[kAmplitude]) + std::abs(step[kCentreSin]) + std::abs(step[kCentreCos]) +
         value_.amplitude_v * (std::abs(step[kMismatch]) + std::abs(step[kDelta]));
}

/// Beside the standard errors: the step itself, or what a step leaves out, which is of second order
/// in it. A distance that is wrong by b everywhere moves no parameter by more than 2b.
bool RecordingFitter::is_small(const Vector5 &step, const EllipseFit &fit) const {
  const double move_v = greatest_move_v(step);
  const double left_out_v = 2 * move_v * move_v / value_.amplitude_v;
  for (std::size_t i = 0; i < kEllipseSize; ++i) {
    const double error = fit.std_error(static_cast<EllipseIndex>(i));
    const bool volts = i != kMismatch && i != kDelta;
    const double error_v = volts ? error : 0.5 * value_.amplitude_v * error;
    if (std::abs(step[static_cast<Eigen::Index>(i)]) > kSmallStep * error &&
        left_out_v > kSmallStep * error_v)
      return false;
  }
  return true;
}

/// The minimum from the sums of a pass; whether another pass about it is needed.
bool RecordingFitter::refine(EllipseFit &fit) {
  Matrix5 information;
  const auto step_by_weights = [&] {
    const Share all = share_of(bins_);
    information = all.weighed_information;
    return solve(information, all.weighed_gradient, 0, circle_);
  };
  weight_.assign(kBins, 1.0);
  fit.structure_rms_v = 0;
  Vector5 step = step_by_weights();
  Structure found = structure(step);
  for (int round = 0; round < 3 && found.variance > 0; ++round) {
    fit.structure_rms_v = std::sqrt(found.variance);
    for (std::size_t b = 0; b < kBins; ++b)
      weight_[b] = found.weight(b);
    step = step_by_weights();
    found = structure(step);
  }
  const EllipseParameters next = moved(value_, step);
  if (!step.allFinite() || !valid(next) || sums_.used < 3 * (circle_ ? 3 : 5))
    no_ellipse("the samples cover too little of the circle, or do not lie on one curve");
  fit.used = sums_.used;
  fit.rejected = sums_.rejected;
  describe(fit, next, information, found, circle_);
  Shares shares;
  for (std::size_t k = 0; k < kParts; ++k)
    shares[k] = share_of(sums_.bins[k]);
  fit.heldout_rms_v = heldout_rms(shares, next.amplitude_v, circle_);
  const double limit_v = kOutlierSigmas * scale();
  const double change_v = std::abs(limit_v - limit_v_), move_v = greatest_move_v(step);
  const bool same_samples = change_v < kSmallChange * limit_v_ ||
                            (sums_.near_limit == 0 && change_v + move_v < kNear * limit_v_);
  const bool settled = same_samples && is_small(step, fit);
  fit.limit_v = limit_v;
  value_ = next;
  limit_v_ = limit_v;
  return !settled;
}

void RecordingFitter::run(EllipseFit &fit) {
  int passes = 0;
  do
    pass();
  while (refine(fit) && ++passes < kMostPasses);
  std::array<bool, kCoverageBins> seen{};
  for (std::size_t b = 0; b < kFineBins; ++b)
    if (bins_[b].count > 0)
      seen[b / (kFineBins / kCoverageBins)] = true;
  describe_coverage(fit, seen);
}

/// Which samples lie on the curve that was found.
std::vector<unsigned char> accepted_of(const Capture &sample, const EllipseFit &fit) {
  const Curve curve(fit.value);
  std::vector<unsigned char> accepted(sample.size());
  for (std::size_t i = 0; i < sample.size(); ++i)
    accepted[i] = std::abs(curve.foot(sample.vsin_v[i], sample.vcos_v[i]).distance) <= fit.limit_v;
  return accepted;
}

} // namespace

EllipseFit fit_ellipse(const RecordingToFit &what, const EllipseFitOptions &options) {
  if (!options.circle && what.ellipse)
    return *what.ellipse;
  EllipseFit fit = fit_ellipse_to_sample(what, options);
  if (what.is_long) {
    RecordingFitter(what.recording, options, fit).run(fit);
    fit.accepted = accepted_of(*what.sample, fit);
  }
  if (!options.circle)
    what.ellipse = fit;
  return fit;
}

} // namespace ada
