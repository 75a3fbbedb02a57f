// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/vector_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "conversion/vector_kernels.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

#include "ada4571.h"
#include "base/vector_targets.h"
#include "conversion/atan2-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

/// No vector is longer.
constexpr std::size_t kMaxBytes = HWY_MAX_BYTES;

// --- where pairs come from: each reader gives raw numbers about their centres. It holds the
// centres by value: the compiler cannot know that writing angles does not change those of the
// caller.

/// Of any alignment: only LoadU reads there.
template <class E> HWY_INLINE const E *elements_at(const std::uint8_t *at) {
  return static_cast<const E *>(static_cast<const void *>(at));
}

/// Neighbouring 16-bit numbers.
template <class D, bool kSigned> class Pairs16 {
  using T = hn::TFromD<D>;
  using DI = hn::Rebind<std::int32_t, D>;
  using V = hn::Vec<D>;
  using VI = hn::Vec<DI>;

public:
  HWY_INLINE Pairs16(D d, const void *pairs, const void *, const PairConstants<T> &k)
      : d_(d), data_(static_cast<const std::uint8_t *>(pairs)),
        centre_sin_(static_cast<std::int32_t>(k.centre_sin)),
        centre_cos_(static_cast<std::int32_t>(k.centre_cos)) {}

  HWY_INLINE void at(std::size_t i, V &s, V &c) const { load(data_ + i * kElement, s, c); }
  HWY_INLINE void last(std::size_t i, std::size_t n, V &s, V &c) const {
    HWY_ALIGN std::uint8_t buffer[kMaxBytes] = {};
    std::memcpy(buffer, data_ + i * kElement, n * kElement);
    load(buffer, s, c);
  }

private:
  static constexpr std::size_t kElement = 4;

  HWY_INLINE void load(const std::uint8_t *at, V &s, V &c) const {
    const VI both = hn::LoadU(di_, elements_at<std::int32_t>(at));
    constexpr bool kSinIsHigh = std::endian::native == std::endian::big;
    s = number(hn::Sub(half<kSinIsHigh>(both), hn::Set(di_, centre_sin_)));
    c = number(hn::Sub(half<!kSinIsHigh>(both), hn::Set(di_, centre_cos_)));
  }
  HWY_INLINE V number(VI whole) const {
    if constexpr (sizeof(T) == sizeof(std::int32_t))
      return hn::ConvertTo(d_, whole);
    else
      return hn::PromoteTo(d_, whole);
  }
  template <bool kHigh> HWY_INLINE VI half(VI both) const {
    const hn::RebindToUnsigned<DI> du;
    if constexpr (kSigned)
      return hn::ShiftRight<16>(kHigh ? both : hn::ShiftLeft<16>(both));
    else if constexpr (kHigh)
      return hn::BitCast(di_, hn::ShiftRight<16>(hn::BitCast(du, both)));
    else
      return hn::And(both, hn::Set(di_, 0xFFFF));
  }

  D d_;
  DI di_;
  const std::uint8_t *data_;
  std::int32_t centre_sin_, centre_cos_;
};

/// Channels of their own: 16-bit numbers E, or the output's type.
template <class D, class E> class Planar {
  using T = hn::TFromD<D>;
  using V = hn::Vec<D>;
  using Wide = std::conditional_t<sizeof(E) == sizeof(T), T, std::int32_t>;
  using DW = hn::Rebind<Wide, D>;

public:
  HWY_INLINE Planar(D d, const void *sin, const void *cos, const PairConstants<T> &k)
      : d_(d), sin_(static_cast<const std::uint8_t *>(sin)),
        cos_(static_cast<const std::uint8_t *>(cos)), centre_sin_(static_cast<Wide>(k.centre_sin)),
        centre_cos_(static_cast<Wide>(k.centre_cos)) {}

  HWY_INLINE void at(std::size_t i, V &s, V &c) const {
    s = load(sin_ + i * sizeof(E), centre_sin_);
    c = load(cos_ + i * sizeof(E), centre_cos_);
  }
  HWY_INLINE void last(std::size_t i, std::size_t n, V &s, V &c) const {
    HWY_ALIGN std::uint8_t buffer[kMaxBytes] = {};
    std::memcpy(buffer, sin_ + i * sizeof(E), n * sizeof(E));
    s = load(buffer, centre_sin_);
    std::memcpy(buffer, cos_ + i * sizeof(E), n * sizeof(E));
    c = load(buffer, centre_cos_);
  }

private:
  HWY_INLINE V load(const std::uint8_t *at, Wide centre_number) const {
    const E *elements = elements_at<E>(at);
    const auto centre = hn::Set(dw_, centre_number);
    if constexpr (sizeof(E) == sizeof(T)) {
      return hn::Sub(hn::LoadU(d_, elements), centre);
    } else {
      const hn::Rebind<E, D> de;
      return hn::ConvertTo(d_, hn::Sub(hn::PromoteTo(dw_, hn::LoadU(de, elements)), centre));
    }
  }

  D d_;
  DW dw_;
  const std::uint8_t *sin_, *cos_;
  Wide centre_sin_, centre_cos_;
};

// --- what is done with them

template <class T, class D> class Correction {
  using V = hn::Vec<D>;
  using Atan = decltype(MakeAtan(D(), T(), 1.0));

public:
  HWY_INLINE Correction(D d, const PairConstants<T> &k)
      : d_(d), k_(k), below_full_(std::nextafter(k.period, T{0})),
        atan_(MakeAtan(d, T(), static_cast<double>(k.period) / 6.283185307179586477)) {}

  HWY_INLINE void vector(V s, V c, V &y, V &x) const {
    y = hn::MulAdd(set(k_.sin_s), s, hn::MulAdd(set(k_.sin_c), c, set(k_.sin_0)));
    x = hn::MulAdd(set(k_.cos_s), s, hn::MulAdd(set(k_.cos_c), c, set(k_.cos_0)));
  }
  HWY_INLINE V angle(V y, V x) const {
    const V ax = hn::Abs(x), ay = hn::Abs(y);
    V r = atan_(tangent(hn::Min(ax, ay), hn::Max(ax, ay)));
    // By sign bits: a subtraction and a blend are cheaper than a comparison and a mask.
    r = IfSignBit(d_, hn::Sub(ax, ay), hn::Sub(set(k_.period / 4), r), r);
    r = IfSignBit(d_, x, hn::Sub(set(k_.period / 2), r), r);
    r = IfSignBit(d_, y, hn::Sub(set(k_.period), r), r);
    // Rounding may reach the period.
    const V below_full = set(below_full_);
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
    return hn::Min(below_full, r); // x86: where one is no number, the second operand
#else
    return hn::IfThenElse(hn::Gt(r, below_full), below_full, r);
#endif
  }
  HWY_INLINE V radius(V y, V x) const {
    return hn::Sqrt(hn::MulAdd(y, y, hn::Mul(x, x)));
  }

private:
  HWY_INLINE V set(T number) const {
    return hn::Set(d_, number);
  }
  /// No number at the very centre, where both are zero.
  HWY_INLINE V tangent(V low, V high) const {
#if HWY_TARGET == HWY_EMU128 // whose Div gives zero for what is divided by zero, from Highway 1.1 on
    return hn::IfThenElse(hn::Eq(high, hn::Zero(d_)), hn::NaN(d_), hn::Div(low, high));
#else
    return hn::Div(low, high);
#endif
  }

  D d_;
  PairConstants<T> k_;
  T below_full_;
  Atan atan_;
};

/// One loop. Only pointers come in: a function with vector arguments leaves the upper halves of the
/// registers in use when it returns, and every SSE instruction of the caller would pay for that.
template <class Reader, bool kRadius, class T>
void run(const void *first_channel, const void *second_channel, std::size_t count,
         const PairConstants<T> &k, T *HWY_RESTRICT angle, T *HWY_RESTRICT radius) {
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  const Reader source(d, first_channel, second_channel, k);
  const Correction<T, decltype(d)> correct(d, k);
  std::size_t i = 0;
  hn::Vec<decltype(d)> s, c, y, x;
  for (; i + lanes <= count; i += lanes) {
    source.at(i, s, c);
    correct.vector(s, c, y, x);
    hn::StoreU(correct.angle(y, x), d, angle + i);
    if constexpr (kRadius)
      hn::StoreU(correct.radius(y, x), d, radius + i);
  }
  if (i == count)
    return;
  HWY_ALIGN T buffer[kMaxBytes / sizeof(T)];
  source.last(i, count - i, s, c);
  correct.vector(s, c, y, x);
  hn::Store(correct.angle(y, x), d, buffer);
  std::memcpy(angle + i, buffer, (count - i) * sizeof(T));
  if constexpr (kRadius) {
    hn::Store(correct.radius(y, x), d, buffer);
    std::memcpy(radius + i, buffer, (count - i) * sizeof(T));
  }
}

template <class Reader, class T>
void convert(const void *a, const void *b, std::size_t count, const PairConstants<T> &k, T *angle,
             T *radius) {
  if (radius != nullptr)
    run<Reader, true>(a, b, count, k, angle, radius);
  else
    run<Reader, false>(a, b, count, k, angle, radius);
}

using F32 = hn::ScalableTag<float>;

#if HWY_HAVE_FLOAT64
using F64 = hn::ScalableTag<double>;

template <class T> void atan2_block(const T *y, const T *x, std::size_t count, T *out) {
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto atan = MakeAtan(d, T(), 1.0);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(Atan2(d, atan, hn::LoadU(d, y + i), hn::LoadU(d, x + i)), d, out + i);
  if (i == count)
    return;
  HWY_ALIGN T a[kMaxBytes / sizeof(T)] = {}, b[kMaxBytes / sizeof(T)] = {};
  std::memcpy(a, y + i, (count - i) * sizeof(T));
  std::memcpy(b, x + i, (count - i) * sizeof(T));
  hn::Store(Atan2(d, atan, hn::Load(d, a), hn::Load(d, b)), d, a);
  std::memcpy(out + i, a, (count - i) * sizeof(T));
}

void planar_f64(const double *s, const double *c, std::size_t n, const PairConstants<double> &k,
                double *angle, double *radius) {
  convert<Planar<F64, double>>(s, c, n, k, angle, radius);
}

template <bool kSigned>
void pairs_f64(const void *pairs, std::size_t n, const PairConstants<double> &k, double *angle,
               double *radius) {
  convert<Pairs16<F64, kSigned>>(pairs, nullptr, n, k, angle, radius);
}

/// Sample after sample for what is left of the vectors.
template <class Reader>
bool finish(const void *first_channel, const void *second_channel, std::size_t count,
            const SampleLimits &limits, double *HWY_RESTRICT angle,
            const double *HWY_RESTRICT radius, std::uint32_t *HWY_RESTRICT status) {
  const F64 d;
  const hn::Rebind<std::int32_t, F64> di;
  using V = hn::Vec<F64>;
  const SampleLimits l = limits; // as above: writing does not change a copy
  const PairConstants<double> as_they_are{};
  const Reader source(d, first_channel, second_channel, as_they_are);
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), rail = hn::Set(d, double{ADA4571_SAMPLE_RAIL}),
          far = hn::Set(d, double{ADA4571_SAMPLE_RADIUS});
  V numbers = zero; // stays 0 while all are
  const auto step = [&](V s, V c, V a, V r, V &degrees, hn::Vec<decltype(di)> &bits) {
    numbers = hn::Add(numbers, hn::Add(hn::Sub(a, a), hn::Sub(r, r)));
    const V full = hn::Set(d, l.largest_deg), deg = hn::Mul(a, hn::Set(d, l.degrees_per_rad));
    degrees = hn::IfThenElse(hn::Gt(deg, full), full, deg);
    const auto within =
        hn::And(hn::Ge(r, hn::Set(d, l.least_radius)), hn::Le(r, hn::Set(d, l.largest_radius)));
    const V offset = hn::Set(d, l.offset), scale = hn::Set(d, l.scale_v);
    s = hn::Mul(hn::Add(s, offset), scale);
    c = hn::Mul(hn::Add(c, offset), scale);
    const auto low = hn::Le(hn::Min(s, c), hn::Set(d, l.low_v));
    const auto high = hn::Ge(hn::Max(s, c), hn::Set(d, l.high_v));
    bits = hn::DemoteTo(di, hn::Add(hn::IfThenElse(within, zero, far),
                                    hn::IfThenElse(hn::Or(low, high), rail, zero)));
  };
  V s, c, degrees;
  hn::Vec<decltype(di)> bits;
  auto *out = reinterpret_cast<std::int32_t *>(status); // the signed fellow of its type
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    source.at(i, s, c);
    step(s, c, hn::LoadU(d, angle + i), hn::LoadU(d, radius + i), degrees, bits);
    hn::StoreU(degrees, d, angle + i);
    hn::StoreU(bits, di, out + i);
  }
  if (i < count) {
    HWY_ALIGN double a[kMaxBytes / sizeof(double)] = {}, r[kMaxBytes / sizeof(double)] = {};
    HWY_ALIGN std::int32_t b[kMaxBytes / sizeof(double)];
    std::memcpy(a, angle + i, (count - i) * sizeof(double));
    std::memcpy(r, radius + i, (count - i) * sizeof(double));
    source.last(i, count - i, s, c);
    step(s, c, hn::Load(d, a), hn::Load(d, r), degrees, bits);
    hn::Store(degrees, d, a);
    hn::Store(bits, di, b);
    std::memcpy(angle + i, a, (count - i) * sizeof(double));
    std::memcpy(status + i, b, (count - i) * sizeof(std::int32_t));
  }
  return hn::AllTrue(d, hn::Eq(numbers, zero));
}

template <bool kSigned>
bool finish_pairs(const void *pairs, std::size_t n, const SampleLimits &limits, double *angle,
                  const double *radius, std::uint32_t *status) {
  return finish<Pairs16<F64, kSigned>>(pairs, nullptr, n, limits, angle, radius, status);
}
bool finish_planar(const double *sin, const double *cos, std::size_t n, const SampleLimits &limits,
                   double *angle, const double *radius, std::uint32_t *status) {
  return finish<Planar<F64, double>>(sin, cos, n, limits, angle, radius, status);
}

std::size_t whole_frames_of_floats(const double *angle, const double *radius,
                                   const std::uint32_t *status, std::size_t count, float turn,
                                   void *frames) {
  auto *out = static_cast<float *>(frames);
  const F64 d;
  const hn::Rebind<float, F64> df;
  const hn::Rebind<std::int32_t, F64> di;
  const std::size_t lanes = hn::Lanes(d);
  const auto *bits = reinterpret_cast<const std::int32_t *>(status);
  const auto whole = hn::Set(df, turn);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto deg = hn::DemoteTo(df, hn::LoadU(d, angle + i));
    hn::StoreInterleaved3(hn::IfThenZeroElse(hn::Ge(deg, whole), deg),
                          hn::DemoteTo(df, hn::LoadU(d, radius + i)),
                          hn::ConvertTo(df, hn::LoadU(di, bits + i)), df, out + 3 * i);
  }
  return i;
}
#else
// NEON of 32 bits has no doubles, takes subnormal floats for zero and divides by an estimate: good
// for a pair, whose length is near 1, but not for all that C says of atan2.
template <class T> void atan2_block(const T *y, const T *x, std::size_t count, T *out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] = std::atan2(y[i], x[i]);
}

void planar_f64(const double *sin, const double *cos, std::size_t n, const PairConstants<double> &k,
                double *angle, double *radius) {
  constexpr double kNoAngle = std::numeric_limits<double>::quiet_NaN();
  const double below_full = std::nextafter(k.period, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double s = sin[i] - k.centre_sin, c = cos[i] - k.centre_cos;
    const double y = k.sin_s * s + k.sin_c * c + k.sin_0, x = k.cos_s * s + k.cos_c * c + k.cos_0;
    const double r = std::atan2(y, x) * (k.period / 6.283185307179586477);
    angle[i] = x == 0.0 && y == 0.0 ? kNoAngle : std::min(r < 0.0 ? r + k.period : r, below_full);
    if (radius != nullptr)
      radius[i] = std::sqrt(y * y + x * x);
  }
}

/// Neighbouring 16-bit numbers one by one.
template <bool kSigned> struct Numbers16 {
  using Number = std::conditional_t<kSigned, std::int16_t, std::uint16_t>;
  const void *pairs;
  void operator()(std::size_t i, double &s, double &c) const {
    Number pair[2];
    std::memcpy(pair, static_cast<const std::uint8_t *>(pairs) + i * sizeof pair, sizeof pair);
    s = pair[0];
    c = pair[1];
  }
};

template <bool kSigned>
void pairs_f64(const void *pairs, std::size_t n, const PairConstants<double> &k, double *angle,
               double *radius) {
  const Numbers16<kSigned> number{pairs};
  for (std::size_t i = 0; i < n; ++i) {
    double s, c;
    number(i, s, c);
    planar_f64(&s, &c, 1, k, angle + i, radius != nullptr ? radius + i : nullptr);
  }
}

template <class Numbers>
bool finish(Numbers number, std::size_t n, const SampleLimits &l, double *angle,
            const double *radius, std::uint32_t *status) {
  bool numbers = true;
  for (std::size_t i = 0; i < n; ++i) {
    double s, c;
    number(i, s, c);
    numbers = numbers && angle[i] - angle[i] == 0 && radius[i] - radius[i] == 0;
    angle[i] = std::min(angle[i] * l.degrees_per_rad, l.largest_deg);
    const bool within = radius[i] >= l.least_radius && radius[i] <= l.largest_radius;
    s = (s + l.offset) * l.scale_v;
    c = (c + l.offset) * l.scale_v;
    const bool rail = std::min(s, c) <= l.low_v || std::max(s, c) >= l.high_v;
    status[i] = (within ? 0u : std::uint32_t{ADA4571_SAMPLE_RADIUS}) |
                (rail ? std::uint32_t{ADA4571_SAMPLE_RAIL} : 0u);
  }
  return numbers;
}
template <bool kSigned>
bool finish_pairs(const void *pairs, std::size_t n, const SampleLimits &limits, double *angle,
                  const double *radius, std::uint32_t *status) {
  return finish(Numbers16<kSigned>{pairs}, n, limits, angle, radius, status);
}
bool finish_planar(const double *sin, const double *cos, std::size_t n, const SampleLimits &limits,
                   double *angle, const double *radius, std::uint32_t *status) {
  const auto number = [&](std::size_t i, double &s, double &c) {
    s = sin[i];
    c = cos[i];
  };
  return finish(number, n, limits, angle, radius, status);
}

std::size_t whole_frames_of_floats(const double *, const double *, const std::uint32_t *,
                                   std::size_t, float, void *) {
  return 0;
}
#endif

} // namespace

void Atan2F32(const float *y, const float *x, std::size_t n, float *out) {
  atan2_block(y, x, n, out);
}
void Atan2F64(const double *y, const double *x, std::size_t n, double *out) {
  atan2_block(y, x, n, out);
}
void PairsI16(const void *pairs, std::size_t n, const PairConstants<float> &k, float *angle,
              float *radius) {
  convert<Pairs16<F32, true>>(pairs, nullptr, n, k, angle, radius);
}
void PairsU16(const void *pairs, std::size_t n, const PairConstants<float> &k, float *angle,
              float *radius) {
  convert<Pairs16<F32, false>>(pairs, nullptr, n, k, angle, radius);
}
void PlanarI16(const void *s, const void *c, std::size_t n, const PairConstants<float> &k,
               float *angle, float *radius) {
  convert<Planar<F32, std::int16_t>>(s, c, n, k, angle, radius);
}
void PlanarU16(const void *s, const void *c, std::size_t n, const PairConstants<float> &k,
               float *angle, float *radius) {
  convert<Planar<F32, std::uint16_t>>(s, c, n, k, angle, radius);
}
void PlanarF32(const float *s, const float *c, std::size_t n, const PairConstants<float> &k,
               float *angle, float *radius) {
  convert<Planar<F32, float>>(s, c, n, k, angle, radius);
}
void PlanarF64(const double *s, const double *c, std::size_t n, const PairConstants<double> &k,
               double *angle, double *radius) {
  planar_f64(s, c, n, k, angle, radius);
}
void PairsI16F64(const void *pairs, std::size_t n, const PairConstants<double> &k, double *angle,
                 double *radius) {
  pairs_f64<true>(pairs, n, k, angle, radius);
}
void PairsU16F64(const void *pairs, std::size_t n, const PairConstants<double> &k, double *angle,
                 double *radius) {
  pairs_f64<false>(pairs, n, k, angle, radius);
}
bool FinishPairsI16(const void *pairs, std::size_t n, const SampleLimits &limits, double *angle,
                    const double *radius, std::uint32_t *status) {
  return finish_pairs<true>(pairs, n, limits, angle, radius, status);
}
bool FinishPairsU16(const void *pairs, std::size_t n, const SampleLimits &limits, double *angle,
                    const double *radius, std::uint32_t *status) {
  return finish_pairs<false>(pairs, n, limits, angle, radius, status);
}
bool FinishPlanarF64(const double *sin, const double *cos, std::size_t n,
                     const SampleLimits &limits, double *angle, const double *radius,
                     std::uint32_t *status) {
  return finish_planar(sin, cos, n, limits, angle, radius, status);
}
void FramesOfFloats(const double *angle, const double *radius, const std::uint32_t *status,
                    std::size_t n, float turn, void *frames) {
  for (std::size_t i = whole_frames_of_floats(angle, radius, status, n, turn, frames); i < n; ++i) {
    const auto deg = static_cast<float>(angle[i]);
    const float values[] = {deg >= turn ? 0.0f : deg, static_cast<float>(radius[i]),
                            static_cast<float>(static_cast<std::int32_t>(status[i]))};
    std::memcpy(static_cast<std::uint8_t *>(frames) + i * sizeof values, values, sizeof values);
  }
}
std::int64_t Target() {
  return HWY_TARGET;
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(Atan2F32);
HWY_EXPORT(Atan2F64);
HWY_EXPORT(PairsI16);
HWY_EXPORT(PairsU16);
HWY_EXPORT(PlanarI16);
HWY_EXPORT(PlanarU16);
HWY_EXPORT(PlanarF32);
HWY_EXPORT(PlanarF64);
HWY_EXPORT(PairsI16F64);
HWY_EXPORT(PairsU16F64);
HWY_EXPORT(FinishPairsI16);
HWY_EXPORT(FinishPairsU16);
HWY_EXPORT(FinishPlanarF64);
HWY_EXPORT(FramesOfFloats);
HWY_EXPORT(Target);

void atan2_f32(const float *y, const float *x, std::size_t count, float *out) {
  HWY_DYNAMIC_DISPATCH(Atan2F32)(y, x, count, out);
}
void atan2_f64(const double *y, const double *x, std::size_t count, double *out) {
  HWY_DYNAMIC_DISPATCH(Atan2F64)(y, x, count, out);
}
void convert_pairs_i16(const void *pairs, std::size_t count, const PairConstants<float> &k,
                       float *angle, float *radius) {
  HWY_DYNAMIC_DISPATCH(PairsI16)(pairs, count, k, angle, radius);
}
void convert_pairs_u16(const void *pairs, std::size_t count, const PairConstants<float> &k,
                       float *angle, float *radius) {
  HWY_DYNAMIC_DISPATCH(PairsU16)(pairs, count, k, angle, radius);
}
void convert_planar_i16(const void *sin, const void *cos, std::size_t count,
                        const PairConstants<float> &k, float *angle, float *radius) {
  HWY_DYNAMIC_DISPATCH(PlanarI16)(sin, cos, count, k, angle, radius);
}
void convert_planar_u16(const void *sin, const void *cos, std::size_t count,
                        const PairConstants<float> &k, float *angle, float *radius) {
  HWY_DYNAMIC_DISPATCH(PlanarU16)(sin, cos, count, k, angle, radius);
}
void convert_planar_f32(const float *sin, const float *cos, std::size_t count,
                        const PairConstants<float> &k, float *angle, float *radius) {
  HWY_DYNAMIC_DISPATCH(PlanarF32)(sin, cos, count, k, angle, radius);
}
void convert_planar_f64(const double *sin, const double *cos, std::size_t count,
                        const PairConstants<double> &k, double *angle, double *radius) {
  HWY_DYNAMIC_DISPATCH(PlanarF64)(sin, cos, count, k, angle, radius);
}
void convert_pairs_i16(const void *pairs, std::size_t count, const PairConstants<double> &k,
                       double *angle, double *radius) {
  HWY_DYNAMIC_DISPATCH(PairsI16F64)(pairs, count, k, angle, radius);
}
void convert_pairs_u16(const void *pairs, std::size_t count, const PairConstants<double> &k,
                       double *angle, double *radius) {
  HWY_DYNAMIC_DISPATCH(PairsU16F64)(pairs, count, k, angle, radius);
}
bool finish_pairs_i16(const void *pairs, std::size_t count, const SampleLimits &limits,
                      double *angle, const double *radius, std::uint32_t *status) {
  return HWY_DYNAMIC_DISPATCH(FinishPairsI16)(pairs, count, limits, angle, radius, status);
}
bool finish_pairs_u16(const void *pairs, std::size_t count, const SampleLimits &limits,
                      double *angle, const double *radius, std::uint32_t *status) {
  return HWY_DYNAMIC_DISPATCH(FinishPairsU16)(pairs, count, limits, angle, radius, status);
}
bool finish_planar_f64(const double *sin, const double *cos, std::size_t count,
                       const SampleLimits &limits, double *angle, const double *radius,
                       std::uint32_t *status) {
  return HWY_DYNAMIC_DISPATCH(FinishPlanarF64)(sin, cos, count, limits, angle, radius, status);
}
void frames_of_floats(const double *angle, const double *radius, const std::uint32_t *status,
                      std::size_t count, float turn, void *frames) {
  HWY_DYNAMIC_DISPATCH(FramesOfFloats)(angle, radius, status, count, turn, frames);
}

const char *vector_target() {
  return hwy::TargetName(HWY_DYNAMIC_DISPATCH(Target)());
}

namespace {
std::int64_t real_targets() {
  static const std::int64_t targets = [] {
    const std::int64_t supported = hwy::SupportedTargets();
    // On Arm the question itself leaves a choice behind, made before the length of the vectors was
    // looked at.
    hwy::GetChosenTarget().Update(supported);
    return supported & HWY_TARGETS;
  }();
  return targets;
}
} // namespace

std::vector<std::string> vector_targets() {
  std::vector<std::string> names;
  for (std::int64_t left = real_targets(); left != 0; left &= left - 1)
    names.emplace_back(hwy::TargetName(left & -left));
  return names;
}

void use_vector_target(const std::string &name) {
  for (std::int64_t left = real_targets(); left != 0; left &= left - 1)
    if (name == hwy::TargetName(left & -left)) {
      hwy::SetSupportedTargetsForTest(left & -left);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      return;
    }
  if (!name.empty())
    throw std::invalid_argument("no vector target '" + name + "'");
  hwy::SetSupportedTargetsForTest(told_targets());
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

} // namespace ada
#endif // HWY_ONCE
