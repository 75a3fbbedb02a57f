// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/jump_gap.h"

#include <Eigen/Dense>
#include <cmath>

namespace ada {

namespace {

struct GapFit {
  Gap gap;
  double rms = 0.0;
  bool enough = false;
};

/// Angle, speed and acceleration in common, and the gap, over `side` samples on either side.
GapFit fit_gap(std::span<const double> time, std::span<const double> angle,
               std::span<const char> usable, std::size_t at, std::size_t side) {
  constexpr double kEnough = 0.75; // of the samples of a side
  const double middle = 0.5 * (time[at] + time[at - 1]);
  const double unit = time[at + side - 1] - middle;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double squares = 0.0, count[2] = {0.0, 0.0};
  for (std::size_t i = at - side; i < at + side; ++i) {
    if (!usable[i])
      continue;
    const double u = (time[i] - middle) / unit, v = angle[i] - angle[at];
    const Eigen::Vector4d row(1.0, u, u * u, i >= at ? 1.0 : 0.0);
    normal += row * row.transpose();
    right += v * row;
    squares += v * v;
    count[i >= at] += 1.0;
  }
  GapFit out;
  const double fewest = kEnough * static_cast<double>(side);
  if (count[0] < fewest || count[1] < fewest)
    return out;
  const auto solver = normal.ldlt();
  const Eigen::Vector4d x = solver.solve(right);
  const double left = std::max(0.0, squares - right.dot(x));
  out.rms = std::sqrt(left / (count[0] + count[1] - 4.0));
  out.gap.size = x[3];
  out.gap.speed = x[1] / unit;
  out.gap.error = out.rms * std::sqrt(solver.solve(Eigen::Vector4d::Unit(3))[3]);
  out.enough = true;
  return out;
}

} // namespace

Gap gap_at(std::span<const double> time, std::span<const double> angle,
           std::span<const char> usable, std::size_t at) {
  constexpr std::size_t kFirst = 16, kMost = 512;
  constexpr double kByChance = 3.0; // standard deviations of the rms
  Gap best;
  double least = 0.0;
  for (std::size_t side = kFirst; side <= kMost && at >= side && at + side <= angle.size();
       side *= 2) {
    const GapFit now = fit_gap(time, angle, usable, at, side);
    // Where the rms rises by more than chance the motion is no longer so simple.
    const double spread = 1.0 / std::sqrt(static_cast<double>(4 * side));
    if (!now.enough || (best.error > 0.0 && now.rms > (1.0 + kByChance * spread) * least))
      break;
    best = now.gap;
    least = now.rms;
  }
  return best;
}

} // namespace ada
