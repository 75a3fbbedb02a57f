// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/fourier.h"

#include <algorithm>

#include "base/sincos.h"
#include "base/vectors_of_doubles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/fourier.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Adds one order and turns s, c on to the next.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void add_order(D d, const FourierPair &k, V s1, V c1, V &s, V &c, V &one, V &two) {
  one = hn::MulAdd(hn::Set(d, k.cos_first), c, one);
  two = hn::MulAdd(hn::Set(d, k.cos_second), c, two);
  one = hn::MulAdd(hn::Set(d, k.sin_first), s, one);
  two = hn::MulAdd(hn::Set(d, k.sin_second), s, two);
  const V next = hn::NegMulAdd(s, s1, hn::Mul(c, c1));
  s = hn::MulAdd(s, c1, hn::Mul(c, s1));
  c = next;
}

/// Two vectors of samples, orders inside: powers and sums stay in registers, and neither waits for
/// the other's products.
template <class D>
HWY_INLINE void add_series(D d, const double *sine, const double *cosine,
                           std::span<const FourierPair> orders, double *first, double *second) {
  using V = hn::Vec<D>;
  const std::size_t b = hn::Lanes(d);
  const V s1a = hn::LoadU(d, sine), s1b = hn::LoadU(d, sine + b);
  const V c1a = hn::LoadU(d, cosine), c1b = hn::LoadU(d, cosine + b);
  V sa = s1a, sb = s1b, ca = c1a, cb = c1b;
  V one_a = hn::LoadU(d, first), one_b = hn::LoadU(d, first + b);
  V two_a = hn::LoadU(d, second), two_b = hn::LoadU(d, second + b);
  for (const FourierPair &k : orders) {
    add_order(d, k, s1a, c1a, sa, ca, one_a, two_a);
    add_order(d, k, s1b, c1b, sb, cb, one_b, two_b);
  }
  hn::StoreU(one_a, d, first);
  hn::StoreU(one_b, d, first + b);
  hn::StoreU(two_a, d, second);
  hn::StoreU(two_b, d, second + b);
}

void fourier_block(const double *sine, const double *cosine, std::size_t n,
                   std::span<const FourierPair> orders, double *first, double *second) {
  const hn::ScalableTag<double> d;
  const std::size_t step = 2 * hn::Lanes(d);
  std::size_t i = 0;
  for (; i + step <= n; i += step)
    add_series(d, sine + i, cosine + i, orders, first + i, second + i);
  if (i == n)
    return;
  constexpr std::size_t kMost = 2 * HWY_MAX_BYTES / sizeof(double);
  double s[kMost] = {}, c[kMost] = {}, one[kMost] = {}, two[kMost] = {};
  std::copy(sine + i, sine + n, s);
  std::copy(cosine + i, cosine + n, c);
  add_series(d, s, c, orders, one, two);
  for (std::size_t k = i; k < n; ++k) {
    first[k] += one[k - i];
    second[k] += two[k - i];
  }
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(fourier_block);

void add_fourier_pair(const double *x, std::size_t n, std::span<const FourierPair> orders,
                      double *first, double *second) {
  constexpr std::size_t kBlock = 256; // stays in the first-level cache
  double sine[kBlock], cosine[kBlock];
  for (std::size_t i = 0; i < n; i += kBlock) {
    const std::size_t count = std::min(kBlock, n - i);
    sincos_of(x + i, count, sine, cosine);
    HWY_DYNAMIC_DISPATCH(fourier_block)(sine, cosine, count, orders, first + i, second + i);
  }
}

} // namespace ada
#endif
