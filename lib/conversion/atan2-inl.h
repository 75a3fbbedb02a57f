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

/// atan of t in [0, 1], times `scale`.
template <class D> struct AtanF32 {
  using V = hn::Vec<D>;
  V c0, c1, c2, c3, c4, c5, c6, c7;

  HWY_INLINE AtanF32(D d, double scale)
      : c0(hn::Set(d, static_cast<float>(0.999999335578 * scale))),
        c1(hn::Set(d, static_cast<float>(-0.333298607843 * scale))),
        c2(hn::Set(d, static_cast<float>(0.199465656513 * scale))),
        c3(hn::Set(d, static_cast<float>(-0.139086295502 * scale))),
        c4(hn::Set(d, static_cast<float>(0.0964219732856 * scale))),
        c5(hn::Set(d, static_cast<float>(-0.0559123267774 * scale))),
        c6(hn::Set(d, static_cast<float>(0.0218629578811 * scale))),
        c7(hn::Set(d, static_cast<float>(-0.00405456721523 * scale))) {}

  HWY_INLINE V operator()(V t) const {
    const V z = hn::Mul(t, t);
    // Even and odd powers apart: one chain of seven would leave the loop waiting for it.
    const V w = hn::Mul(z, z);
    const V even = hn::MulAdd(hn::MulAdd(hn::MulAdd(c6, w, c4), w, c2), w, c0);
    const V odd = hn::MulAdd(hn::MulAdd(hn::MulAdd(c7, w, c5), w, c3), w, c1);
    const V p = hn::MulAdd(odd, z, even);
    return hn::Mul(p, t);
  }
};

template <class D> struct AtanF64 {
  using V = hn::Vec<D>;
  D d;
  V scale, eighth_turn;

  HWY_INLINE AtanF64(D tag, double s)
      : d(tag), scale(hn::Set(d, s)), eighth_turn(hn::Set(d, 0.78539816339744830962)) {}

  HWY_INLINE V operator()(V t) const {
    const V one = hn::Set(d, 1.0);
    const auto fold = hn::Gt(t, hn::Set(d, 0.66));
    const V x = hn::IfThenElse(fold, hn::Div(hn::Sub(t, one), hn::Add(t, one)), t);
    const V z = hn::Mul(x, x);
    V p = hn::Set(d, -8.750608600031904122785e-1);
    p = hn::MulAdd(p, z, hn::Set(d, -1.615753718733365076637e1));
    p = hn::MulAdd(p, z, hn::Set(d, -7.500855792314704667340e1));
    p = hn::MulAdd(p, z, hn::Set(d, -1.228866684490136173410e2));
    p = hn::MulAdd(p, z, hn::Set(d, -6.485021904942025371773e1));
    V q = hn::Add(z, hn::Set(d, 2.485846490142306297962e1));
    q = hn::MulAdd(q, z, hn::Set(d, 1.650270098316988542046e2));
    q = hn::MulAdd(q, z, hn::Set(d, 4.328810604912902668951e2));
    q = hn::MulAdd(q, z, hn::Set(d, 4.853903996359136964868e2));
    q = hn::MulAdd(q, z, hn::Set(d, 1.945506571482613964425e2));
    const V r = hn::MulAdd(hn::Mul(x, z), hn::Div(p, q), x);
    // pi/4 in two parts: the second one is what the first one rounds away.
    const V folded = hn::Add(hn::Add(r, hn::Set(d, 3.061616997868383017e-17)), eighth_turn);
    return hn::Mul(hn::IfThenElse(fold, folded, r), scale);
  }
};

template <class D> HWY_INLINE auto MakeAtan(D d, float, double scale) {
  return AtanF32<D>(d, scale);
}
template <class D> HWY_INLINE auto MakeAtan(D d, double, double scale) {
  return AtanF64<D>(d, scale);
}

/// `yes` where the sign bit of v is set, minus zero included.
template <class D, class V = hn::Vec<D>> HWY_INLINE V IfSignBit(D d, V v, V yes, V no) {
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
  // Highway 1.0.3: IfNegativeThenElse blends single bits on SSSE3, and compares with zero on the
  // scalar targets.
  const hn::RebindToSigned<D> di;
  const V mask = hn::BitCast(d, hn::BroadcastSignBit(hn::BitCast(di, v)));
  return hn::Or(hn::And(mask, yes), hn::AndNot(mask, no));
#else
  (void)d;
  return hn::IfNegativeThenElse(v, yes, no);
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
