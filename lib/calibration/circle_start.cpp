// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/circle_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <vector>

#include "base/robust.h"

namespace ada {

namespace {

struct Moments {
  double n = 0, mean_x = 0, mean_y = 0;
  double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0, zz = 0; ///< centred, z = x^2 + y^2
};

Moments moments(std::span<const double> x, std::span<const double> y,
                std::span<const unsigned char> use) {
  Moments m;
  const auto used = [&](std::size_t i) { return use.empty() || use[i] != 0; };
  for (std::size_t i = 0; i < x.size(); ++i)
    if (used(i)) {
      m.n += 1;
      m.mean_x += x[i];
      m.mean_y += y[i];
    }
  if (m.n < 3)
    return m;
  m.mean_x /= m.n;
  m.mean_y /= m.n;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (used(i)) {
      const double u = x[i] - m.mean_x, v = y[i] - m.mean_y, z = u * u + v * v;
      m.xx += u * u;
      m.yy += v * v;
      m.xy += u * v;
      m.xz += u * z;
      m.yz += v * z;
      m.zz += z * z;
    }
  for (double *s : {&m.xx, &m.yy, &m.xy, &m.xz, &m.yz, &m.zz})
    *s /= m.n;
  return m;
}

struct Place {
  double vsin, vcos;
};

/// One sample of each cell that holds any.
std::vector<Place> places_of(std::span<const double> vsin, std::span<const double> vcos) {
  constexpr std::size_t kCells = 64;
  constexpr double kTail = 0.1;
  const auto reach = [](std::span<const double> x) {
    std::vector<double> finite;
    std::copy_if(x.begin(), x.end(), std::back_inserter(finite),
                 [](double e) { return std::isfinite(e); });
    const Reach middle{quantile(finite, kTail), quantile(finite, 1.0 - kTail)};
    return Reach{middle.low - middle.width(), middle.high + middle.width()};
  };
  const Reach sin = reach(vsin), cos = reach(vcos);
  std::vector<Place> out;
  if (!(sin.width() > 0.0) || !(cos.width() > 0.0))
    return out;
  const auto cell = [](const Reach &r, double v) {
    return std::min(kCells - 1, static_cast<std::size_t>((v - r.low) / r.width() * kCells));
  };
  std::vector<char> taken(kCells * kCells);
  for (std::size_t i = 0; i < vsin.size(); ++i)
    if (sin.holds(vsin[i]) && cos.holds(vcos[i])) {
      char &here = taken[cell(sin, vsin[i]) * kCells + cell(cos, vcos[i])];
      if (!here)
        out.push_back({vsin[i], vcos[i]});
      here = 1;
    }
  return out;
}

std::optional<EllipseParameters> circle_through(const Place &a, const Place &b, const Place &c) {
  const double bx = b.vsin - a.vsin, by = b.vcos - a.vcos;
  const double cx = c.vsin - a.vsin, cy = c.vcos - a.vcos;
  const double area = 2.0 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  if (!(std::abs(area) > 1e-6 * (bb + cc)))
    return std::nullopt;
  const double x = (cy * bb - by * cc) / area, y = (bx * cc - cx * bb) / area;
  EllipseParameters out;
  out.amplitude_v = std::hypot(x, y);
  out.centre_sin_v = a.vsin + x;
  out.centre_cos_v = a.vcos + y;
  return out;
}

} // namespace

EllipseParameters circle_of_most_places(std::span<const double> vsin,
                                        std::span<const double> vcos) {
  constexpr std::size_t kFewest = 12;
  // Of three places all are right in an eighth of the draws where half of them are wrong: the
  // chance that none of so many draws is right then is 1e-12.
  constexpr std::size_t kDraws = 200;
  EllipseParameters best;
  best.amplitude_v = 0.0;
  const std::vector<Place> places = places_of(vsin, vcos);
  const std::size_t n = places.size();
  if (n < kFewest)
    return best;
  double least = INFINITY;
  // Weyl's sequences: the same draws for the same samples, and no two places alike.
  const auto drawn = [n](std::size_t draw, double step) {
    const double u = static_cast<double>(draw + 1) * step;
    return static_cast<std::size_t>((u - std::floor(u)) * static_cast<double>(n));
  };
  std::vector<double> off(n);
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    const std::optional<EllipseParameters> circle =
        circle_through(places[drawn(draw, std::sqrt(2.0))], places[drawn(draw, std::sqrt(3.0))],
                       places[drawn(draw, std::sqrt(5.0))]);
    if (!circle)
      continue;
    for (std::size_t i = 0; i < n; ++i)
      off[i] = std::abs(
          std::hypot(places[i].vsin - circle->centre_sin_v, places[i].vcos - circle->centre_cos_v) -
          circle->amplitude_v);
    if (const double median = quantile(off, 0.5); median < least) {
      least = median;
      best = *circle;
    }
  }
  return best;
}

EllipseParameters circle_start(std::span<const double> vsin, std::span<const double> vcos,
                               std::span<const unsigned char> use) {
  const Moments m = moments(vsin, vcos, use);
  EllipseParameters circle;
  circle.amplitude_v = 0;
  const double mz = m.xx + m.yy, det = m.xx * m.yy - m.xy * m.xy;
  if (m.n < 3 || !(mz > 0) || !(det > 1e-12 * mz * mz))
    return circle;
  // Characteristic polynomial of the generalised eigenproblem; its smallest root by Newton from 0.
  const double var_z = m.zz - mz * mz;
  const double a3 = 4 * mz, a2 = -3 * mz * mz - m.zz;
  const double a1 = var_z * mz + 4 * det * mz - m.xz * m.xz - m.yz * m.yz;
  const double a0 =
      m.xz * (m.xz * m.yy - m.yz * m.xy) + m.yz * (m.yz * m.xx - m.xz * m.xy) - var_z * det;
  double root = 0, value = a0;
  for (int i = 0; i < 50; ++i) {
    const double slope = a1 + root * (2 * a2 + 3 * a3 * root);
    const double next = root - value / slope;
    if (!std::isfinite(next) || next == root)
      break;
    const double next_value = a0 + next * (a1 + next * (a2 + next * a3));
    if (std::abs(next_value) >= std::abs(value))
      break;
    root = next;
    value = next_value;
  }
  const double d = root * root - root * mz + det;
  if (d == 0 || !std::isfinite(d))
    return circle;
  const double cx = (m.xz * (m.yy - root) - m.yz * m.xy) / d / 2;
  const double cy = (m.yz * (m.xx - root) - m.xz * m.xy) / d / 2;
  circle.centre_sin_v = m.mean_x + cx;
  circle.centre_cos_v = m.mean_y + cy;
  circle.amplitude_v = std::sqrt(cx * cx + cy * cy + mz);
  return circle;
}

} // namespace ada
