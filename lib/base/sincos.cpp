// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/sincos.h"
#include "base/vectors_of_doubles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/sincos.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Cody-Waite: x minus the nearest multiple of pi/2, in three parts of pi/2 with trailing zeros;
/// then the kernels of fdlibm (k_sin.c, k_cos.c) on [-pi/4, pi/4].
template <class D> HWY_INLINE void sincos(D d, const double *x, double *sine, double *cosine) {
  using V = hn::Vec<D>;
  const hn::RebindToSigned<D> di;
  const V v = hn::LoadU(d, x);
  const V quarters = hn::Round(hn::Mul(v, hn::Set(d, 0.63661977236758134308)));
  V r = hn::NegMulAdd(quarters, hn::Set(d, 1.57079632673412561417e+00), v);
  r = hn::NegMulAdd(quarters, hn::Set(d, 6.07710050630396597660e-11), r);
  r = hn::NegMulAdd(quarters, hn::Set(d, 2.02226624879595063154e-21), r);
  const V r2 = hn::Mul(r, r);

  V s = hn::Set(d, 1.58969099521155010221e-10);
  for (double c :
       {-2.50507602534068634195e-08, 2.75573137070700676789e-06, -1.98412698298579493134e-04,
        8.33333333332248946124e-03, -1.66666666666666324348e-01})
    s = hn::MulAdd(s, r2, hn::Set(d, c));
  s = hn::MulAdd(hn::Mul(s, r2), r, r);
  V c = hn::Set(d, -1.13596475577881948265e-11);
  for (double k :
       {2.08757232129817482790e-09, -2.75573143513906633035e-07, 2.48015872894767294178e-05,
        -1.38888888888741095749e-03, 4.16666666666666019037e-02, -0.5, 1.0})
    c = hn::MulAdd(c, r2, hn::Set(d, k));

  // Quadrant: odd ones exchange the two; 2 and 3 turn the sine, 1 and 2 the cosine.
  const V remainder =
      hn::NegMulAdd(hn::Floor(hn::Mul(quarters, hn::Set(d, 0.25))), hn::Set(d, 4.0), quarters);
  const auto q = hn::ConvertTo(di, remainder);
  const auto one = hn::Set(di, 1), two = hn::Set(di, 2);
  const auto odd = hn::MaskFromVec(hn::BitCast(d, hn::Neg(hn::And(q, one))));
  const V sine_sign = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(q, two)));
  const V cosine_sign = hn::BitCast(d, hn::ShiftLeft<62>(hn::And(hn::Add(q, one), two)));
  hn::StoreU(hn::Xor(hn::IfThenElse(odd, c, s), sine_sign), d, sine);
  hn::StoreU(hn::Xor(hn::IfThenElse(odd, s, c), cosine_sign), d, cosine);
}

void sincos_block(const double *x, std::size_t n, double *sine, double *cosine) {
  const hn::ScalableTag<double> d;
  const std::size_t step = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + step <= n; i += step)
    sincos(d, x + i, sine + i, cosine + i);
  if (i == n)
    return;
  HWY_ALIGN double in[HWY_MAX_BYTES / sizeof(double)] = {}, s[HWY_MAX_BYTES / sizeof(double)],
                                      c[HWY_MAX_BYTES / sizeof(double)];
  for (std::size_t k = i; k < n; ++k)
    in[k - i] = x[k];
  sincos(d, in, s, c);
  for (std::size_t k = i; k < n; ++k) {
    sine[k] = s[k - i];
    cosine[k] = c[k - i];
  }
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(sincos_block);

void sincos_of(const double *x, std::size_t n, double *sine, double *cosine) {
  HWY_DYNAMIC_DISPATCH(sincos_block)(x, n, sine, cosine);
}

} // namespace ada
#endif
