// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a user would write with SLEEF: interleaved 16-bit pairs, one centre and one gain a channel,
// Sleef_atan2f of 3.5 ULP. Only intrinsics around it, so that SLEEF is what is timed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ada::bench {

bool have_avx2();
bool have_avx512();
void sleef_avx2(const std::int16_t *pairs, std::size_t count, float *out);
void sleef_avx512(const std::int16_t *pairs, std::size_t count, float *out);

} // namespace ada::bench
