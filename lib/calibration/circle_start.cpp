// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/circle_start.h"

#include <cmath>

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

} // namespace

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
