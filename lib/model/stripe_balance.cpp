// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/stripe_balance.h"
#include "base/vectors_of_doubles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/stripe_balance.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// 1 - x/d_1 (1 - x/d_2 (1 - ...)), the divisors from the innermost on, as their reciprocals.
template <class D, std::size_t N>
HWY_INLINE hn::Vec<D> alternating(D d, hn::Vec<D> x, const double (&reciprocals)[N]) {
  const auto one = hn::Set(d, 1.0);
  auto sum = one;
  for (double r : reciprocals)
    sum = hn::NegMulAdd(hn::Mul(x, hn::Set(d, r)), sum, one);
  return sum;
}

/// cos 2(phi - theta) of the stripe whose easy axis theta has cos 2(alpha - theta) = c2 and
/// sin 2(alpha - theta) = s2. With d = phi - alpha: -sin d = (h/2) sin(2(alpha - theta) + 2d), by two
/// steps of Newton from the solution for a small d.
template <class D>
HWY_INLINE hn::Vec<D> stripe(D d, hn::Vec<D> h, hn::Vec<D> c2, hn::Vec<D> s2) {
  using V = hn::Vec<D>;
  const V one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
  const V half_h = hn::Mul(h, hn::Set(d, 0.5));
  V x = hn::Neg(hn::Div(hn::Mul(half_h, s2), hn::MulAdd(h, c2, one)));
  for (int step = 0;; ++step) {
    const V xx = hn::Mul(x, x);
    const V s1 = hn::Mul(x, alternating(d, xx, {1.0 / 42.0, 1.0 / 20.0, 1.0 / 6.0}));
    const V c1 = alternating(d, xx, {1.0 / 56.0, 1.0 / 30.0, 1.0 / 12.0, 1.0 / 2.0});
    const V sd = hn::Mul(hn::Mul(two, s1), c1);
    const V cd = hn::NegMulAdd(hn::Mul(two, s1), s1, one);
    const V turned_c = hn::NegMulAdd(s2, sd, hn::Mul(c2, cd));
    if (step == 2)
      return turned_c;
    const V turned_s = hn::MulAdd(s2, cd, hn::Mul(c2, sd));
    x = hn::Sub(x, hn::Div(hn::MulAdd(half_h, turned_s, s1), hn::MulAdd(h, turned_c, c1)));
  }
}

/// Half the difference of the two stripes of a bridge.
template <class D>
HWY_INLINE hn::Vec<D> bridge(D d, hn::Vec<D> h, hn::Vec<D> c2, hn::Vec<D> s2) {
  return hn::Mul(hn::Set(d, 0.5),
                 hn::Sub(stripe(d, h, c2, s2), stripe(d, h, hn::Neg(c2), hn::Neg(s2))));
}

void balance(double h, const double *fx, const double *fy, const double *ex, const double *ey,
             std::size_t n, double *c, double *s) {
  const auto at = [&](auto d, std::size_t i) HWY_ATTR {
    const auto x = hn::LoadU(d, fx + i), y = hn::LoadU(d, fy + i);
    const auto of_field = hn::Div(hn::Set(d, h), hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y))));
    const auto c2 = hn::LoadU(d, ex + i), s2 = hn::LoadU(d, ey + i);
    hn::StoreU(bridge(d, of_field, c2, s2), d, c + i);
    hn::StoreU(bridge(d, of_field, s2, hn::Neg(c2)), d, s + i);
  };
  const hn::ScalableTag<double> d;
  const std::size_t step = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + step <= n; i += step)
    at(d, i);
  for (; i < n; ++i)
    at(hn::CappedTag<double, 1>(), i);
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(balance);

void balance_stripes(double h, const double *fx, const double *fy, const double *ex,
                     const double *ey, std::size_t n, double *c, double *s) {
  HWY_DYNAMIC_DISPATCH(balance)(h, fx, fy, ex, ey, n, c, s);
}

} // namespace ada
#endif
