// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Many samples as a few: means with their spread over bins of equal width.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ada {

/// One entry a bin that holds enough samples; `gap_before` where bins before it do not.
struct Bin {
  double x; ///< mean of the key
  double mean;
  double spread; ///< standard deviation of the values in the bin
  double error;  ///< standard error of the mean, taken as if the values were independent
  bool gap_before;
};

std::vector<Bin> bin_means(std::span<const double> key, std::span<const double> value, double from,
                           double to, std::size_t bins, std::size_t fewest);

} // namespace ada
