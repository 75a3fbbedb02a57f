// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/products.h"

#include <algorithm>

#include "base/vectors_of_doubles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/products.cpp"
#include <hwy/foreach_target.h> // compiles this file again for every instruction set

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ada {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A matrix by columns, `stride` doubles from one to the next.
struct Columns {
  const double *first;
  std::size_t stride;
};

// Tiles of three vectors of rows of `a` by four rows of `b`: twelve sums, which together with what
// they are made of fit into sixteen registers. Sums are variables, not arrays: a vector of scalable
// length is no member of anything.
template <class D>
HWY_INLINE void tile_3x4(D d, Columns a, Columns b, std::size_t columns, double *sums) {
  const std::size_t lanes = hn::Lanes(d);
  auto s00 = hn::Zero(d), s01 = s00, s02 = s00, s10 = s00, s11 = s00, s12 = s00;
  auto s20 = s00, s21 = s00, s22 = s00, s30 = s00, s31 = s00, s32 = s00;
  for (std::size_t j = 0; j < columns; ++j, a.first += a.stride, b.first += b.stride) {
    const auto a0 = hn::LoadU(d, a.first), a1 = hn::LoadU(d, a.first + lanes),
               a2 = hn::LoadU(d, a.first + 2 * lanes);
    auto by = hn::Set(d, b.first[0]);
    s00 = hn::MulAdd(a0, by, s00);
    s01 = hn::MulAdd(a1, by, s01);
    s02 = hn::MulAdd(a2, by, s02);
    by = hn::Set(d, b.first[1]);
    s10 = hn::MulAdd(a0, by, s10);
    s11 = hn::MulAdd(a1, by, s11);
    s12 = hn::MulAdd(a2, by, s12);
    by = hn::Set(d, b.first[2]);
    s20 = hn::MulAdd(a0, by, s20);
    s21 = hn::MulAdd(a1, by, s21);
    s22 = hn::MulAdd(a2, by, s22);
    by = hn::Set(d, b.first[3]);
    s30 = hn::MulAdd(a0, by, s30);
    s31 = hn::MulAdd(a1, by, s31);
    s32 = hn::MulAdd(a2, by, s32);
  }
  const auto keep = [&](auto v0, auto v1, auto v2) HWY_ATTR {
    hn::StoreU(v0, d, sums);
    hn::StoreU(v1, d, sums + lanes);
    hn::StoreU(v2, d, sums + 2 * lanes);
    sums += 3 * lanes;
  };
  keep(s00, s01, s02);
  keep(s10, s11, s12);
  keep(s20, s21, s22);
  keep(s30, s31, s32);
}

template <class D>
HWY_INLINE void tile_1x4(D d, Columns a, Columns b, std::size_t columns, double *sums) {
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  for (std::size_t j = 0; j < columns; ++j, a.first += a.stride, b.first += b.stride) {
    const auto a0 = hn::LoadU(d, a.first);
    s0 = hn::MulAdd(a0, hn::Set(d, b.first[0]), s0);
    s1 = hn::MulAdd(a0, hn::Set(d, b.first[1]), s1);
    s2 = hn::MulAdd(a0, hn::Set(d, b.first[2]), s2);
    s3 = hn::MulAdd(a0, hn::Set(d, b.first[3]), s3);
  }
  const std::size_t lanes = hn::Lanes(d);
  hn::StoreU(s0, d, sums);
  hn::StoreU(s1, d, sums + lanes);
  hn::StoreU(s2, d, sums + 2 * lanes);
  hn::StoreU(s3, d, sums + 3 * lanes);
}

template <class D>
HWY_INLINE void tile_1x1(D d, Columns a, Columns b, std::size_t columns, double *sums) {
  auto s = hn::Zero(d);
  for (std::size_t j = 0; j < columns; ++j, a.first += a.stride, b.first += b.stride)
    s = hn::MulAdd(hn::LoadU(d, a.first), hn::Set(d, *b.first), s);
  hn::StoreU(s, d, sums);
}

/// Adds the sums of a tile of `height` rows to `out`, from its row `from` on.
HWY_INLINE void add_tile(const double *sums, std::size_t height, std::size_t width,
                         std::size_t from, double *out, std::size_t stride) {
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t i = from; i < height; ++i)
      out[k * stride + i] += sums[k * height + i];
}

/// All rows of `a`, from `row` on, in tiles of one vector of the type D, the last of which overlaps
/// the one before; returns the rows that are done.
template <class D>
std::size_t rows_of(D d, std::size_t row, Columns a, std::size_t rows, Columns b, std::size_t width,
                    std::size_t columns, double *out, std::size_t stride) {
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN double sums[4 * HWY_MAX_BYTES / sizeof(double)];
  while (row < rows && rows >= lanes) {
    const std::size_t at = std::min(row, rows - lanes);
    if (width == 4) {
      tile_1x4(d, {a.first + at, a.stride}, b, columns, sums);
      add_tile(sums, lanes, 4, row - at, out + at, stride);
    } else
      for (std::size_t k = 0; k < width; ++k) {
        tile_1x1(d, {a.first + at, a.stride}, {b.first + k, b.stride}, columns, sums);
        add_tile(sums, lanes, 1, row - at, out + k * stride + at, stride);
      }
    row = at + lanes;
  }
  return row;
}

/// As many columns of `a` at a time as let three vectors of its rows stay in the first cache.
constexpr std::size_t kColumns = 128;

/// out += a b', of the lower triangle only where `triangle`.
void add_products(const double *a, std::size_t rows_a, std::size_t stride_a, const double *b,
                  std::size_t rows_b, std::size_t stride_b, std::size_t columns, double *out,
                  std::size_t stride, bool triangle) {
  const hn::ScalableTag<double> d;
  const std::size_t high = 3 * hn::Lanes(d);
  HWY_ALIGN double sums[12 * HWY_MAX_BYTES / sizeof(double)];
  for (std::size_t first = 0; first < columns; first += kColumns) {
    const std::size_t n = std::min(kColumns, columns - first);
    const double *from_a = a + first * stride_a, *from_b = b + first * stride_b;
    std::size_t row = 0;
    for (; row + high <= rows_a; row += high)
      for (std::size_t k = 0; k + 4 <= rows_b; k += 4) {
        if (triangle && k >= row + high)
          break;
        tile_3x4(d, {from_a + row, stride_a}, {from_b + k, stride_b}, n, sums);
        add_tile(sums, high, 4, 0, out + k * stride + row, stride);
      }
    for (std::size_t k = 0; k < rows_b; k += 4) {
      const std::size_t width = std::min<std::size_t>(4, rows_b - k);
      // What the high tiles have left, or the narrow rest of `b`, of which they have nothing.
      std::size_t at = width == 4 ? row : 0;
      const Columns rows{from_a, stride_a}, by{from_b + k, stride_b};
      at = rows_of(d, at, rows, rows_a, by, width, n, out + k * stride, stride);
      at = rows_of(hn::CappedTag<double, 2>(), at, rows, rows_a, by, width, n, out + k * stride,
                   stride);
      rows_of(hn::CappedTag<double, 1>(), at, rows, rows_a, by, width, n, out + k * stride, stride);
    }
  }
}

/// out += a b for a vector b: column by column, as they lie in memory.
void add_to_vector(const double *a, std::size_t rows, std::size_t stride, const double *b,
                   std::size_t stride_b, std::size_t columns, double *out) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t j = 0;
  for (; j + 4 <= columns; j += 4) {
    const double *a0 = a + j * stride, *a1 = a0 + stride, *a2 = a1 + stride, *a3 = a2 + stride;
    const double *by = b + j * stride_b;
    const double b0 = by[0], b1 = by[stride_b], b2 = by[2 * stride_b], b3 = by[3 * stride_b];
    std::size_t i = 0;
    for (; i + lanes <= rows; i += lanes) {
      auto sum = hn::MulAdd(hn::LoadU(d, a0 + i), hn::Set(d, b0), hn::LoadU(d, out + i));
      sum = hn::MulAdd(hn::LoadU(d, a1 + i), hn::Set(d, b1), sum);
      sum = hn::MulAdd(hn::LoadU(d, a2 + i), hn::Set(d, b2), sum);
      hn::StoreU(hn::MulAdd(hn::LoadU(d, a3 + i), hn::Set(d, b3), sum), d, out + i);
    }
    for (; i < rows; ++i)
      out[i] += a0[i] * b0 + a1[i] * b1 + a2[i] * b2 + a3[i] * b3;
  }
  for (; j < columns; ++j)
    for (std::size_t i = 0; i < rows; ++i)
      out[i] += a[j * stride + i] * b[j * stride_b];
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace ada
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ada {

HWY_EXPORT(add_products);
HWY_EXPORT(add_to_vector);

void add_products(const Eigen::Ref<const Eigen::MatrixXd> &a,
                  const Eigen::Ref<const Eigen::MatrixXd> &b, Eigen::Ref<Eigen::MatrixXd> out) {
  const auto size = [](Eigen::Index n) { return static_cast<std::size_t>(n); };
  if (b.rows() == 1) {
    const auto add = HWY_DYNAMIC_DISPATCH(add_to_vector);
    add(a.data(), size(a.rows()), size(a.outerStride()), b.data(), size(b.outerStride()),
        size(a.cols()), out.data());
    return;
  }
  const auto add = HWY_DYNAMIC_DISPATCH(add_products);
  add(a.data(), size(a.rows()), size(a.outerStride()), b.data(), size(b.rows()),
      size(b.outerStride()), size(a.cols()), out.data(), size(out.outerStride()), false);
}

void add_squares(const Eigen::Ref<const Eigen::MatrixXd> &a, Eigen::Ref<Eigen::MatrixXd> out) {
  const auto rows = static_cast<std::size_t>(a.rows()),
             stride = static_cast<std::size_t>(a.outerStride());
  const auto add = HWY_DYNAMIC_DISPATCH(add_products);
  add(a.data(), rows, stride, a.data(), rows, stride, static_cast<std::size_t>(a.cols()),
      out.data(), static_cast<std::size_t>(out.outerStride()), true);
}

} // namespace ada
#endif
