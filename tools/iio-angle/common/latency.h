// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From the timestamp of a sample to its angle in this program, for buffers of several lengths.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/angle_text.h"
#include "common/live.h"

namespace cli {

/// Times on a logarithmic scale, eight steps an octave from 1 us on: quantiles to within 9 %, the
/// worst exactly, in memory that does not grow.
class LatencyHistogram {
public:
  void add(double seconds);

  std::uint64_t count() const { return count_; }
  double worst_s() const { return worst_s_; }
  /// Upper edge of the step that holds the quantile, at most the worst.
  double quantile_s(double share) const;
  /// Share of the times in each octave: below 2 us, 2 to 4 us, ...
  std::vector<double> octaves() const;
  /// Lower edge of an octave, seconds.
  static double octave_s(std::size_t octave);

private:
  static constexpr std::size_t kSteps = 8, kOctaves = 27; ///< to 134 s
  std::array<std::uint64_t, kSteps * kOctaves> counts_{};
  std::uint64_t count_ = 0;
  double worst_s_ = 0;
};

/// Reads with buffers of each length in turn and prints what came of it; `lengths` empty: from one
/// frame to the length in use, in steps of eight. `samples` 0: two seconds or fifty buffers of
/// each, whichever is longer.
void measure_latency(const Source &source, LiveAngles &angles, std::vector<std::size_t> lengths,
                     std::uint64_t samples, AngleFormat format);

} // namespace cli
