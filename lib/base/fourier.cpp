// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/fourier.h"

#include <algorithm>

#include "base/sincos.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/fourier.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Samples first, orders inside: the power and both sums stay in registers.
template <class D>
HWY_INLINE void add_series(D d, const double *sine, const double *cosine,
                           std::span<const FourierPair> orders, double *first, double *second) {
  using V = hn::Vec<D>;
  const V s1 = hn::LoadU(d, sine), c1 = hn::LoadU(d, cosine);
  V s = s1, c = c1;
  V one = hn::LoadU(d, first), two = hn::LoadU(d, second);
  for (const FourierPair &k : orders) {
    one = hn::MulAdd(hn::Set(d, k.cos_first), c, one);
    two = hn::MulAdd(hn::Set(d, k.cos_second), c, two);
    one = hn::MulAdd(hn::Set(d, k.sin_first), s, one);
    two = hn::MulAdd(hn::Set(d, k.sin_second), s, two);
    const V next = hn::NegMulAdd(s, s1, hn::Mul(c, c1));
    s = hn::MulAdd(s, c1, hn::Mul(c, s1));
    c = next;
  }
  hn::StoreU(one, d, first);
  hn::StoreU(two, d, second);
}

void fourier_block(const double *sine, const double *cosine, std::size_t n,
                   std::span<const FourierPair> orders, double *first, double *second) {
  const hn::ScalableTag<double> d;
  const std::size_t step = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + step <= n; i += step)
    add_series(d, sine + i, cosine + i, orders, first + i, second + i);
  const hn::CappedTag<double, 1> single;
  for (; i < n; ++i)
    add_series(single, sine + i, cosine + i, orders, first + i, second + i);
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
