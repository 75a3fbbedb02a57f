// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A stretch of a recording, as what works block by block gets it.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace ada {

/// Which columns are wanted: bits in the order of kColumns (columns.h).
using ColumnMask = unsigned;
inline constexpr ColumnMask kTimeColumn = 1, kPairColumns = 2 | 4, kVtempColumn = 8,
                            kVddColumn = 16, kReferenceColumn = 32, kAllColumns = 63;
inline constexpr std::size_t kColumnCount = 6;

/// One column a channel, empty where there is none or it was not asked for.
struct Block {
  std::size_t first = 0, count = 0; ///< samples [first, first + count) of the recording
  std::span<const double> time_s, vsin_v, vcos_v, vtemp_v, vdd_v, reference_deg;
  /// What the columns point into, unless the recording has them in memory; used again by the next
  /// read.
  std::array<std::vector<double>, kColumnCount> store;
};

} // namespace ada
