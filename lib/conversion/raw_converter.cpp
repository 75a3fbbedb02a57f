// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/raw_converter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "base/angle.h"
#include "base/error.h"
#include "conversion/vector_kernels.h"

namespace ada {

namespace {

/// Samples brought into packed form at a time: both channels stay in the first-level cache.
constexpr std::size_t kBlock = 512;

std::size_t size_of(ada4571_sample_type type) {
  switch (type) {
  case ADA4571_S8:
  case ADA4571_U8:
    return 1;
  case ADA4571_S16:
  case ADA4571_U16:
    return 2;
  case ADA4571_S32:
  case ADA4571_U32:
  case ADA4571_F32:
    return 4;
  case ADA4571_F64:
    return 8;
  }
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "layout.type is not an ada4571_sample_type");
}

bool is_float(ada4571_sample_type type) {
  return type == ADA4571_F32 || type == ADA4571_F64;
}

void validate(const ada4571_layout &l) {
  const auto refuse = [](const std::string &why) {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "layout." + why);
  };
  const std::size_t size = size_of(l.type);
  if (l.stride_bytes < size)
    refuse("stride_bytes is less than a sample (" + std::to_string(size) + " bytes)");
  if (!std::isfinite(l.scale_v) || l.scale_v == 0)
    refuse("scale_v must be a number other than 0");
  if (!std::isfinite(l.offset))
    refuse("offset must be a number");
  const unsigned width = static_cast<unsigned>(8 * size);
  if (is_float(l.type) && (l.shift != 0 || l.bits != 0))
    refuse("shift and bits must be 0 for floating-point samples");
  if (l.shift >= width || l.bits > width - l.shift)
    refuse("shift and bits do not fit into " + std::to_string(width) + " bits");
}

template <class Raw> Raw fetch(const std::uint8_t *at) {
  Raw raw;
  std::memcpy(&raw, at, sizeof raw);
  return raw;
}

/// One channel into packed numbers about `centre`.
template <class Raw, class T>
void gather_as(const ada4571_layout &l, const void *base, std::size_t first, std::size_t count,
               double centre, T *out) {
  const std::uint8_t *at = static_cast<const std::uint8_t *>(base) + first * l.stride_bytes;
  if constexpr (std::is_floating_point_v<Raw>) {
    for (std::size_t i = 0; i < count; ++i, at += l.stride_bytes)
      out[i] = static_cast<T>(static_cast<double>(fetch<Raw>(at)) - centre);
  } else {
    // Left to throw away what stands above, right with or without the sign.
    using Wide = std::conditional_t<std::is_signed_v<Raw>, std::int64_t, std::uint64_t>;
    const unsigned width = 8 * sizeof(Raw), bits = l.bits != 0 ? l.bits : width - l.shift;
    const unsigned up = 64 - bits - l.shift, down = 64 - bits;
    for (std::size_t i = 0; i < count; ++i, at += l.stride_bytes) {
      const auto wide = static_cast<std::uint64_t>(static_cast<Wide>(fetch<Raw>(at))) << up;
      out[i] = static_cast<T>(static_cast<double>(static_cast<Wide>(wide) >> down) - centre);
    }
  }
}

template <class T>
void gather(const ada4571_layout &l, const void *base, std::size_t first, std::size_t count,
            double centre, T *out) {
  switch (l.type) {
  case ADA4571_S8:
    return gather_as<std::int8_t>(l, base, first, count, centre, out);
  case ADA4571_U8:
    return gather_as<std::uint8_t>(l, base, first, count, centre, out);
  case ADA4571_S16:
    return gather_as<std::int16_t>(l, base, first, count, centre, out);
  case ADA4571_U16:
    return gather_as<std::uint16_t>(l, base, first, count, centre, out);
  case ADA4571_S32:
    return gather_as<std::int32_t>(l, base, first, count, centre, out);
  case ADA4571_U32:
    return gather_as<std::uint32_t>(l, base, first, count, centre, out);
  case ADA4571_F32:
    return gather_as<float>(l, base, first, count, centre, out);
  case ADA4571_F64:
    return gather_as<double>(l, base, first, count, centre, out);
  }
}

/// Raw numbers of the centre: volts = (raw + offset) scale.
double raw_centre(const ada4571_layout &l, double centre_v) {
  return centre_v / l.scale_v - l.offset;
}

/// Constants for raw numbers about (centre_sin, centre_cos). What these differ from the ellipse's
/// own centre stands in sin_0 and cos_0: whole centres are subtracted exactly, and nothing large
/// is left to cancel in single precision.
template <class T>
PairConstants<T> constants(const EllipseInverse &e, const ada4571_layout &l, double centre_sin,
                           double centre_cos, int periods) {
  const double rs = centre_sin - raw_centre(l, e.centre_sin_v);
  const double rc = centre_cos - raw_centre(l, e.centre_cos_v);
  PairConstants<T> k;
  k.centre_sin = static_cast<T>(centre_sin);
  k.centre_cos = static_cast<T>(centre_cos);
  k.sin_s = static_cast<T>(e.sin_from_sin * l.scale_v);
  k.sin_c = static_cast<T>(e.sin_from_cos * l.scale_v);
  k.sin_0 = static_cast<T>((e.sin_from_sin * rs + e.sin_from_cos * rc) * l.scale_v);
  k.cos_s = static_cast<T>(e.cos_from_sin * l.scale_v);
  k.cos_c = static_cast<T>(e.cos_from_cos * l.scale_v);
  k.cos_0 = static_cast<T>((e.cos_from_sin * rs + e.cos_from_cos * rc) * l.scale_v);
  k.period = static_cast<T>(kTwoPi / periods);
  return k;
}

/// The inverse whose vector stands at psi - angle.
EllipseInverse turned(const EllipseInverse &e, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  EllipseInverse t = e;
  t.sin_from_sin = c * e.sin_from_sin - s * e.cos_from_sin;
  t.sin_from_cos = c * e.sin_from_cos - s * e.cos_from_cos;
  t.cos_from_sin = c * e.cos_from_sin + s * e.sin_from_sin;
  t.cos_from_cos = c * e.cos_from_cos + s * e.sin_from_cos;
  return t;
}

template <class T> PairConstants<T> exchanged(PairConstants<T> k) {
  std::swap(k.centre_sin, k.centre_cos);
  std::swap(k.sin_s, k.sin_c);
  std::swap(k.cos_s, k.cos_c);
  return k;
}

bool whole_16_bits(const ada4571_layout &l) {
  return (l.type == ADA4571_S16 || l.type == ADA4571_U16) && l.shift == 0 &&
         (l.bits == 0 || l.bits == 16);
}

/// Whole centres of a 16-bit converter; beyond this they would not be whole numbers in float.
bool near_zero(double centre_sin, double centre_cos) {
  return std::abs(centre_sin) < (1 << 23) && std::abs(centre_cos) < (1 << 23);
}

/// Interleaved 16-bit pairs in place, whichever channel is first; false: these are none.
template <class T>
bool convert_interleaved(const ada4571_layout &l, const void *sin, const void *cos,
                         std::size_t count, const PairConstants<T> &k, T *angle, T *radius) {
  const auto *s = static_cast<const std::uint8_t *>(sin);
  const auto *c = static_cast<const std::uint8_t *>(cos);
  if (l.stride_bytes != 4 || (c != s + 2 && s != c + 2))
    return false;
  const bool sin_first = c == s + 2;
  const std::uint8_t *pairs = sin_first ? s : c;
  const PairConstants<T> in_order = sin_first ? k : exchanged(k);
  if (l.type == ADA4571_S16)
    convert_pairs_i16(pairs, count, in_order, angle, radius);
  else
    convert_pairs_u16(pairs, count, in_order, angle, radius);
  return true;
}

/// Block by block through packed copies.
template <class T, class Kernel>
void convert_blocks(const ada4571_layout &l, const void *sin, const void *cos, std::size_t count,
                    double centre_sin, double centre_cos, T *angle, T *radius, Kernel kernel) {
  std::array<T, kBlock> s, c;
  for (std::size_t i = 0; i < count; i += kBlock) {
    const std::size_t n = std::min(kBlock, count - i);
    gather(l, sin, i, n, centre_sin, s.data());
    gather(l, cos, i, n, centre_cos, c.data());
    kernel(s.data(), c.data(), n, angle + i, radius != nullptr ? radius + i : nullptr);
  }
}

} // namespace

RawConverter::RawConverter(const Model &model) {
  Model named = model;
  named.remainder.reset();
  const EllipseModel ellipse(named);
  if (ellipse.follows_temperature())
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                "the calibration follows VTEMP, which raw pairs do not carry: convert frames");
  periods_ = ellipse.periods_per_turn();
  inverse_ = turned(ellipse.at(0.0), periods_ * ellipse.zero_rad());
  if (model.remainder)
    table_.emplace(model, inverse_);
}

template <class T>
void RawConverter::convert_by_table(const ada4571_layout &l, const void *sin, const void *cos,
                                    std::size_t count, T *angle, T *radius) const {
  const auto *s = static_cast<const std::uint8_t *>(sin);
  const auto *c = static_cast<const std::uint8_t *>(cos);
  for (std::size_t i = 0; i < count; i += kBlock) {
    const std::size_t n = std::min(kBlock, count - i);
    T *r = radius != nullptr ? radius + i : nullptr;
    by_ellipse(l, s + i * l.stride_bytes, c + i * l.stride_bytes, n, angle + i, r);
    table_->correct(n, angle + i, r);
  }
}

void RawConverter::convert(const ada4571_layout &l, const void *sin, const void *cos,
                           std::size_t count, float *angle, float *radius) const {
  validate(l);
  if (table_)
    convert_by_table(l, sin, cos, count, angle, radius);
  else
    by_ellipse(l, sin, cos, count, angle, radius);
}

void RawConverter::convert(const ada4571_layout &l, const void *sin, const void *cos,
                           std::size_t count, double *angle, double *radius) const {
  validate(l);
  if (table_)
    convert_by_table(l, sin, cos, count, angle, radius);
  else
    by_ellipse(l, sin, cos, count, angle, radius);
}

void RawConverter::by_ellipse(const ada4571_layout &l, const void *sin, const void *cos,
                              std::size_t count, float *angle, float *radius) const {
  const double cs = raw_centre(l, inverse_.centre_sin_v), cc = raw_centre(l, inverse_.centre_cos_v);
  if (whole_16_bits(l) && near_zero(cs, cc)) {
    const auto k = constants<float>(inverse_, l, std::round(cs), std::round(cc), periods_);
    if (l.stride_bytes == 2)
      return (l.type == ADA4571_S16 ? convert_planar_i16 : convert_planar_u16)(sin, cos, count, k,
                                                                               angle, radius);
    if (convert_interleaved(l, sin, cos, count, k, angle, radius))
      return;
  }
  if (l.type == ADA4571_F32 && l.stride_bytes == sizeof(float)) {
    const auto k =
        constants<float>(inverse_, l, static_cast<float>(cs), static_cast<float>(cc), periods_);
    return convert_planar_f32(static_cast<const float *>(sin), static_cast<const float *>(cos),
                              count, k, angle, radius);
  }
  auto centred = constants<float>(inverse_, l, cs, cc, periods_);
  centred.centre_sin = centred.centre_cos = 0;
  convert_blocks(l, sin, cos, count, cs, cc, angle, radius,
                 [&](const float *s, const float *c, std::size_t n, float *a, float *r) {
                   convert_planar_f32(s, c, n, centred, a, r);
                 });
}

void RawConverter::by_ellipse(const ada4571_layout &l, const void *sin, const void *cos,
                              std::size_t count, double *angle, double *radius) const {
  const double cs = raw_centre(l, inverse_.centre_sin_v), cc = raw_centre(l, inverse_.centre_cos_v);
  if (whole_16_bits(l) && near_zero(cs, cc) &&
      convert_interleaved(l, sin, cos, count,
                          constants<double>(inverse_, l, std::round(cs), std::round(cc), periods_),
                          angle, radius))
    return;
  auto k = constants<double>(inverse_, l, cs, cc, periods_);
  if (l.type == ADA4571_F64 && l.stride_bytes == sizeof(double))
    return convert_planar_f64(static_cast<const double *>(sin), static_cast<const double *>(cos),
                              count, k, angle, radius);
  k.centre_sin = k.centre_cos = 0;
  convert_blocks(l, sin, cos, count, cs, cc, angle, radius,
                 [&](const double *s, const double *c, std::size_t n, double *a, double *r) {
                   convert_planar_f64(s, c, n, k, a, r);
                 });
}

} // namespace ada
