// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is done to every number of a recording whatever it is read for, by the best vector unit of
// the machine. To the last bit what the same formulas give one number at a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace ada {

/// Where a number stands in a word of 16 bits of the machine's byte order: what is left when the
/// word was shifted by `left` bits, out at its upper end, and then back by `right`.
struct Word16 {
  bool is_signed;
  unsigned left, right; ///< below 16
};

/// out[i] = (number i + offset) scale, of words that are 4 or 8 bytes apart. Nothing is read beyond
/// the last word.
void scaled_words16(const void *first, std::size_t stride, std::size_t count, Word16 word,
                    double offset, double scale, double *out);
/// Where that may be asked for.
inline bool has_vectors_for(std::size_t stride) {
  return std::endian::native == std::endian::little && (stride == 4 || stride == 8);
}

/// out[i] = origin + (first + i) / rate, as regular_time (recording/sigmf_frame.h) has it; first +
/// count must be below 2^52.
void regular_times(double origin, std::uint64_t first, double rate, std::size_t count, double *out);

/// out[i] = to_steps(in[i], scale) (recording/fixed_point.h), of what is no finite number the least
/// number there is.
void decimal_steps(const double *in, double scale, std::size_t count, std::int64_t *out);

} // namespace ada
