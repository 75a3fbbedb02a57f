// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Arctangents on vectors, for the instruction set that is being compiled.
//
// float: t = min/max of the magnitudes lies in [0, 1]; atan t as an odd polynomial of degree 15,
// minimax in the absolute error (3.8e-8 rad, found by Remez exchange); then the octants are put
// back. What remains is rounding: half a last place of 2 pi is 2.4e-7, its steps sum up to less
// than ADA4571_ATAN2_F32_MAX_ERROR_RAD.
//
// double: t is folded once more to [-0.21, 0.66] by atan t = pi/4 + atan((t-1)/(t+1)); there the
// rational function of S. Moshier's Cephes library (atan.c) is good to the last place.

#if defined(ADA4571_ATAN2_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ADA4571_ATAN2_INL_H_
#undef ADA4571_ATAN2_INL_H_
#else
#define ADA4571_ATAN2_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Vectors are arguments, results and local variables, never members: those of SVE and RVV have no
// size that the compiler knows, so that no class can hold them. Classes hold the numbers, and the
// compiler broadcasts each of them once, before the loop.

/// atan of t in [0, 1], times `scale`.
template <class D> class AtanF32 {
  using V = hn::Vec<D>;

public:
  HWY_INLINE AtanF32(D d, double scale)
      : d_(d), c0_(static_cast<float>(0.999999335578 * scale)),
        c1_(static_cast<float>(-0.333298607843 * scale)),
        c2_(static_cast<float>(0.199465656513 * scale)),
        c3_(static_cast<float>(-0.139086295502 * scale)),
        c4_(static_cast<float>(0.0964219732856 * scale)),
        c5_(static_cast<float>(-0.0559123267774 * scale)),
        c6_(static_cast<float>(0.0218629578811 * scale)),
        c7_(static_cast<float>(-0.00405456721523 * scale)) {}

  HWY_INLINE V operator()(V t) const {
    const V z = hn::Mul(t, t);
    // Even and odd powers apart: one chain of seven would leave the loop waiting for it.
    const V w = hn::Mul(z, z);
    const V even =
        hn::MulAdd(hn::MulAdd(hn::MulAdd(set(c6_), w, set(c4_)), w, set(c2_)), w, set(c0_));
    const V odd =
        hn::MulAdd(hn::MulAdd(hn::MulAdd(set(c7_), w, set(c5_)), w, set(c3_)), w, set(c1_));
    const V p = hn::MulAdd(odd, z, even);
    return hn::Mul(p, t);
  }

private:
  HWY_INLINE V set(float c) const { return hn::Set(d_, c); }

  D d_;
  float c0_, c1_, c2_, c3_, c4_, c5_, c6_, c7_;
};

#if HWY_HAVE_FLOAT64
template <class D> class AtanF64 {
  using V = hn::Vec<D>;

public:
  HWY_INLINE AtanF64(D d, double scale) : d_(d), scale_(scale) {}

  HWY_INLINE V operator()(V t) const {
    const V one = set(1.0);
    const auto fold = hn::Gt(t, set(0.66));
    const V x = hn::IfThenElse(fold, hn::Div(hn::Sub(t, one), hn::Add(t, one)), t);
    const V z = hn::Mul(x, x);
    V p = set(-8.750608600031904122785e-1);
    p = hn::MulAdd(p, z, set(-1.615753718733365076637e1));
    p = hn::MulAdd(p, z, set(-7.500855792314704667340e1));
    p = hn::MulAdd(p, z, set(-1.228866684490136173410e2));
    p = hn::MulAdd(p, z, set(-6.485021904942025371773e1));
    V q = hn::Add(z, set(2.485846490142306297962e1));
    q = hn::MulAdd(q, z, set(1.650270098316988542046e2));
    q = hn::MulAdd(q, z, set(4.328810604912902668951e2));
    q = hn::MulAdd(q, z, set(4.853903996359136964868e2));
    q = hn::MulAdd(q, z, set(1.945506571482613964425e2));
    const V r = hn::MulAdd(hn::Mul(x, z), hn::Div(p, q), x);
    // pi/4 in two parts: the second one is what the first one rounds away.
    const V folded =
        hn::Add(hn::Add(r, set(3.061616997868383017e-17)), set(0.78539816339744830962));
    return hn::Mul(hn::IfThenElse(fold, folded, r), set(scale_));
  }

private:
  HWY_INLINE V set(double c) const { return hn::Set(d_, c); }

  D d_;
  double scale_;
};

template <class D> HWY_INLINE auto MakeAtan(D d, double, double scale) {
  return AtanF64<D>(d, scale);
}
#endif
template <class D> HWY_INLINE auto MakeAtan(D d, float, double scale) {
  return AtanF32<D>(d, scale);
}

/// `yes` where the sign bit of v is set, minus zero included.
template <class D, class V = hn::Vec<D>> HWY_INLINE V IfSignBit(D d, V v, V yes, V no) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSE4
  (void)d;
  return hn::IfNegativeThenElse(v, yes, no); // one blend
#else
  // Highway 1.0.3: IfNegativeThenElse blends single bits on SSSE3, and compares with zero on the
  // scalar targets. Elsewhere it is no less work than this.
  const hn::RebindToSigned<D> di;
  const auto negative = hn::Lt(hn::BitCast(di, v), hn::Zero(di));
  return hn::IfThenElse(hn::RebindMask(d, negative), yes, no);
#endif
}

/// C's atan2 with all its special values.
template <class D, class Atan, class V = hn::Vec<D>>
HWY_INLINE V Atan2(D d, const Atan &atan, V y, V x) {
  using T = hn::TFromD<D>;
  const V zero = hn::Zero(d), half = hn::Set(d, static_cast<T>(3.14159265358979323846));
  const V quarter = hn::Set(d, static_cast<T>(1.57079632679489661923));
  const V ax = hn::Abs(x), ay = hn::Abs(y);
  const V high = hn::Max(ax, ay), low = hn::Min(ax, ay);
  // Equal magnitudes, infinities among them, make 1; two zeros make 0 like any zero over x.
  V t = hn::IfThenElse(hn::Eq(low, high), hn::Set(d, T{1}), hn::Div(low, high));
  t = hn::IfThenElse(hn::Eq(high, zero), zero, t);
  V r = atan(t);
  r = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(quarter, r), r);
  r = IfSignBit(d, x, hn::Sub(half, r), r);
  r = hn::CopySign(r, y);
  const auto unordered = hn::Or(hn::IsNaN(x), hn::IsNaN(y));
  return hn::IfThenElse(unordered, hn::Add(x, y), r);
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#endif // per-target include guard
