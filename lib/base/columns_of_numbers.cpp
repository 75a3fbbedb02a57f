// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/columns_of_numbers.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/vectors_of_doubles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/columns_of_numbers.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F64 = hn::ScalableTag<double>;
/// At least 2, which is what the compiler takes for possible.
constexpr std::size_t kMostLanes = std::max<std::size_t>(HWY_MAX_BYTES / sizeof(double), 2);

/// Calls step(i, n) for the places of whole vectors, and once with n < lanes for what is left.
template <class Step> HWY_INLINE void by_vectors(std::size_t count, Step step) {
  const std::size_t lanes = hn::Lanes(F64());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    step(i, lanes);
  if (i < count)
    step(i, count - i);
}

/// A vector, or the first n of it.
HWY_INLINE void store(hn::Vec<F64> v, std::size_t n, double *out) {
  const F64 d;
  if (n == hn::Lanes(d)) {
    hn::StoreU(v, d, out);
    return;
  }
  HWY_ALIGN double buffer[kMostLanes];
  hn::Store(v, d, buffer);
  std::memcpy(out, buffer, n * sizeof(double));
}

/// Numbers of 32 bits whose low half is a word.
template <bool kSigned>
HWY_INLINE hn::Vec<F64> numbers(hn::Vec<hn::Rebind<std::uint32_t, F64>> low_halves, int left,
                                int right) {
  const F64 d;
  const hn::Rebind<std::int32_t, F64> di;
  const auto high = hn::ShiftLeftSame(low_halves, 16 + left);
  if constexpr (kSigned)
    return hn::PromoteTo(d, hn::ShiftRightSame(hn::BitCast(di, high), 16 + right));
  else // at most 65535
    return hn::PromoteTo(d, hn::BitCast(di, hn::ShiftRightSame(high, 16 + right)));
}

/// Frame by frame a lane is read: each but the last word has two or six bytes of its own behind it.
template <class Frame, bool kSigned>
void scaled_words(const std::uint8_t *from, std::size_t count, Word16 word, double offset,
                  double scale, double *out) {
  const F64 d;
  const hn::Rebind<std::uint32_t, F64> du;
  const hn::Rebind<Frame, F64> df;
  const int left = static_cast<int>(word.left), right = static_cast<int>(word.right);
  by_vectors(count, [&](std::size_t i, std::size_t n) HWY_ATTR {
    const std::uint8_t *at = from + i * sizeof(Frame);
    HWY_ALIGN Frame buffer[kMostLanes] = {};
    if (i + n == count) {
      std::memcpy(buffer, at, (n - 1) * sizeof(Frame) + sizeof(std::uint16_t));
      at = reinterpret_cast<const std::uint8_t *>(buffer);
    }
    const auto frames = hn::LoadU(df, static_cast<const Frame *>(static_cast<const void *>(at)));
    hn::Vec<decltype(du)> halves;
    if constexpr (sizeof(Frame) == sizeof(std::uint32_t))
      halves = frames;
    else
      halves = hn::TruncateTo(du, frames);
    store(hn::Mul(hn::Add(numbers<kSigned>(halves, left, right), hn::Set(d, offset)),
                  hn::Set(d, scale)),
          n, out + i);
  });
}

void scaled(const void *first, std::size_t stride, std::size_t count, Word16 word, double offset,
            double scale, double *out) {
  const auto *from = static_cast<const std::uint8_t *>(first);
  const auto run = stride == 4 ? (word.is_signed ? scaled_words<std::uint32_t, true>
                                                 : scaled_words<std::uint32_t, false>)
                               : (word.is_signed ? scaled_words<std::uint64_t, true>
                                                 : scaled_words<std::uint64_t, false>);
  run(from, count, word, offset, scale, out);
}

void times(double origin, double first, double rate, std::size_t count, double *out) {
  const F64 d;
  by_vectors(count, [&](std::size_t i, std::size_t n) HWY_ATTR {
    const auto at = hn::Iota(d, 0.0);
    const auto place = hn::Add(hn::Set(d, first + static_cast<double>(i)), at);
    store(hn::Add(hn::Set(d, origin), hn::Div(place, hn::Set(d, rate))), n, out + i);
  });
}

/// Halves away from zero; all sums of the whole part are exact.
void steps(const double *in, double scale, std::size_t count, std::int64_t *out) {
  const F64 d;
  const hn::RebindToSigned<F64> di;
  const auto half = hn::Set(d, 0.5), one = hn::Set(d, 1.0);
  by_vectors(count, [&](std::size_t i, std::size_t n) HWY_ATTR {
    HWY_ALIGN double buffer[kMostLanes] = {};
    HWY_ALIGN std::int64_t whole[kMostLanes];
    const bool all = n == hn::Lanes(d);
    if (!all)
      std::memcpy(buffer, in + i, n * sizeof(double));
    const auto value = all ? hn::LoadU(d, in + i) : hn::Load(d, buffer);
    const auto exact = hn::Mul(value, hn::Set(d, scale));
    auto nearest = hn::Trunc(exact);
    const auto rest = hn::Sub(exact, nearest);
    nearest = hn::Add(nearest, hn::IfThenElseZero(hn::Ge(rest, half), one));
    nearest = hn::Sub(nearest, hn::IfThenElseZero(hn::Le(rest, hn::Neg(half)), one));
    const auto counted = hn::IfThenElse(
        hn::RebindMask(di, hn::Eq(hn::Sub(value, value), hn::Zero(d))), hn::ConvertTo(di, nearest),
        hn::Set(di, std::numeric_limits<std::int64_t>::min()));
    if (all) {
      hn::StoreU(counted, di, out + i);
      return;
    }
    hn::Store(counted, di, whole);
    std::memcpy(out + i, whole, n * sizeof(std::int64_t));
  });
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(scaled);
HWY_EXPORT(times);
HWY_EXPORT(steps);

void scaled_words16(const void *first, std::size_t stride, std::size_t count, Word16 word,
                    double offset, double scale, double *out) {
  HWY_DYNAMIC_DISPATCH(scaled)(first, stride, count, word, offset, scale, out);
}

void regular_times(double origin, std::uint64_t first, double rate, std::size_t count,
                   double *out) {
  HWY_DYNAMIC_DISPATCH(times)(origin, static_cast<double>(first), rate, count, out);
}

void decimal_steps(const double *in, double scale, std::size_t count, std::int64_t *out) {
  HWY_DYNAMIC_DISPATCH(steps)(in, scale, count, out);
}

} // namespace ada
#endif
