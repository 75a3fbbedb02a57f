// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Loops over all samples by several threads (base/parallel). The parts are fixed by the number of
// samples, and their sums are added in their order: a result is the same to the bit for any number
// of threads.
#pragma once

#include <algorithm>

#include "base/parallel.h"
#include "model/wave.h"

namespace ada {

/// Samples of one part: the few thousand samples that most fits use make four, so that several
/// threads have a share, and the models of all parameters over one part take far longer than handing
/// it over.
inline constexpr std::size_t kSamplesOfPart = 4 * kWaveBlock;

namespace detail {

inline std::size_t parts_of(std::size_t samples) {
  return (samples + kSamplesOfPart - 1) / kSamplesOfPart;
}

template <class Work> void blocks_of_part(std::size_t part, std::size_t samples, Work work) {
  const std::size_t end = std::min(samples, (part + 1) * kSamplesOfPart);
  for (std::size_t first = part * kSamplesOfPart; first < end; first += kWaveBlock)
    work(first, std::min(kWaveBlock, end - first));
}

} // namespace detail

/// add(sum, first, n) for each block of at most kWaveBlock samples, from several threads on sums of
/// their own, which begin as `zero`. Needs Sum += Sum.
template <class Sum, class Add> Sum sum_over(std::size_t samples, const Sum &zero, Add add) {
  Sum out = zero;
  in_order<Sum>(
      detail::parts_of(samples),
      [&](std::size_t part, Sum &sum) {
        sum = zero;
        detail::blocks_of_part(part, samples,
                               [&](std::size_t first, std::size_t n) { add(sum, first, n); });
      },
      [&](std::size_t, Sum &sum) { out += sum; });
  return out;
}

/// work(first, n) for each block of at most kWaveBlock samples, from several threads: it writes
/// only what belongs to those samples.
template <class Work> void for_all_samples(std::size_t samples, Work work) {
  struct Nothing {};
  for_each_block<Nothing>(detail::parts_of(samples), [&](std::size_t part, Nothing &) {
    detail::blocks_of_part(part, samples, work);
  });
}

} // namespace ada
