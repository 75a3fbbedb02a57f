// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "sleef_loops.h"

#ifdef ADA4571_BENCH_X86
#include <immintrin.h>

// Declared here: sleef.h shows the wide functions only to a compiler that is told to use them for
// the whole file.
extern "C" {
__attribute__((target("avx2"))) __m256 Sleef_atan2f8_u35avx2(__m256, __m256);
__attribute__((target("avx512f"))) __m512 Sleef_atan2f16_u35avx512f(__m512, __m512);
}

namespace ada::bench {

bool have_avx2() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
bool have_avx512() {
  return __builtin_cpu_supports("avx512f");
}

__attribute__((target("avx2,fma"))) void sleef_avx2(const std::int16_t *pairs, std::size_t count,
                                                    float *out) {
  const __m256i centre = _mm256_set1_epi32(7);
  for (std::size_t i = 0; i + 8 <= count; i += 8) {
    const __m256i both = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(pairs + 2 * i));
    const __m256i s = _mm256_srai_epi32(_mm256_slli_epi32(both, 16), 16);
    const __m256i c = _mm256_srai_epi32(both, 16);
    const __m256 y = _mm256_cvtepi32_ps(_mm256_sub_epi32(s, centre));
    const __m256 x = _mm256_cvtepi32_ps(_mm256_sub_epi32(c, centre));
    _mm256_storeu_ps(out + i, Sleef_atan2f8_u35avx2(y, x));
  }
}

__attribute__((target("avx512f"))) void sleef_avx512(const std::int16_t *pairs, std::size_t count,
                                                     float *out) {
  const __m512i centre = _mm512_set1_epi32(7);
  for (std::size_t i = 0; i + 16 <= count; i += 16) {
    const __m512i both = _mm512_loadu_si512(pairs + 2 * i);
    const __m512i s = _mm512_srai_epi32(_mm512_slli_epi32(both, 16), 16);
    const __m512i c = _mm512_srai_epi32(both, 16);
    const __m512 y = _mm512_cvtepi32_ps(_mm512_sub_epi32(s, centre));
    const __m512 x = _mm512_cvtepi32_ps(_mm512_sub_epi32(c, centre));
    _mm512_storeu_ps(out + i, Sleef_atan2f16_u35avx512f(y, x));
  }
}

} // namespace ada::bench

#else

namespace ada::bench {
bool have_avx2() {
  return false;
}
bool have_avx512() {
  return false;
}
void sleef_avx2(const std::int16_t *, std::size_t, float *) {}
void sleef_avx512(const std::int16_t *, std::size_t, float *) {}
} // namespace ada::bench

#endif
