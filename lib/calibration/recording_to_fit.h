// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a fit looks at first of a recording, which may be long.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "calibration/ellipse_fit.h"
#include "recording/recording.h"

namespace ada {

/// Up to here a recording is fitted as a whole.
inline constexpr std::size_t kFittedWhole = std::size_t{1} << 18;
/// Samples of a longer one that the first fit sees, and how many of them are neighbours.
inline constexpr std::size_t kFirstSample = std::size_t{1} << 15, kFirstStretch = 64;

/// Single pairs from everywhere, one from each of `parts` equal parts of a recording, at a place
/// that looks random; in the order of time (sample_place with stretches of one).
struct Pairs {
  std::vector<double> vsin_v, vcos_v;
  void append(const Pairs &next);
};
/// Those of them that lie in a block.
void pick_pairs(const Block &block, std::size_t samples, std::size_t parts, Pairs &out);

/// A recording and what stands for it where a look at a part is enough.
struct RecordingToFit {
  /// `whole`: to be taken as a whole, however long it is.
  explicit RecordingToFit(const Recording &all, bool whole = false);

  /// Sample of the recording that stands at this place of `sample`.
  std::size_t place(std::size_t of_sample) const;

  /// Of a long one single pairs from everywhere, as many as the sample has: of a magnet that turned
  /// for a short time only they show more of the circle. Made when first asked for.
  const Pairs &scattered() const;

  const Recording &recording;
  bool is_long;
  std::shared_ptr<const Capture> sample;     ///< all of a short one
  mutable std::optional<EllipseFit> ellipse; ///< once it was fitted
  mutable Pairs pairs;                       ///< what scattered() gives
};

/// A fit to the sample, or to the scattered pairs where the sample shows a part of the circle only.
EllipseFit fit_ellipse_to_sample(const RecordingToFit &what, const EllipseFitOptions &options = {});

} // namespace ada
