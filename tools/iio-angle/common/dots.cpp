// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/dots.h"

#include <algorithm>
#include <cmath>

namespace cli {

namespace {

/// Bits of U+2800 and following, by row and column of the dot.
constexpr unsigned char kBits[Dots::kDown][Dots::kAcross] = {
    {0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
constexpr unsigned char kUpperHalf = 0x01 | 0x08 | 0x02 | 0x10;

} // namespace

void Dots::set(int x, int y) {
  if (x < 0 || y < 0 || x >= width() || y >= height())
    return;
  cells_[static_cast<std::size_t>((y / kDown) * columns_ + x / kAcross)] |=
      kBits[y % kDown][x % kAcross];
}

void Dots::line(double x0, double y0, double x1, double y1) {
  const double steps = std::max({std::fabs(x1 - x0), std::fabs(y1 - y0), 1.0});
  for (double i = 0; i <= steps; ++i)
    set(static_cast<int>(std::lround(x0 + (x1 - x0) * i / steps)),
        static_cast<int>(std::lround(y0 + (y1 - y0) * i / steps)));
}

std::string Dots::at(int row, int column) const {
  const unsigned char bits = cells_[static_cast<std::size_t>(row * columns_ + column)];
  if (bits == 0)
    return {};
  if (!unicode_)
    return (bits & kUpperHalf) == 0 ? "." : (bits & ~kUpperHalf) == 0 ? "'" : ":";
  return {static_cast<char>(0xe2), static_cast<char>(0xa0 | bits >> 6),
          static_cast<char>(0x80 | (bits & 0x3f))};
}

} // namespace cli
