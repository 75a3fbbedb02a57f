// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/residual/components.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

Components components(const Scene &scene, const ResidualColumns &r) {
  Components out;
  out.judged = scene.has_reference ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{2};
  for (auto &v : out.of)
    v.resize(r.sin.size());
  out.cos2.resize(r.sin.size());
  out.sin2.resize(r.sin.size());
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double c = r.model_cos[i] - scene.all.centre_cos_v,
                 s = r.model_sin[i] - scene.all.centre_sin_v;
    const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
    out.cos2[i] = (c * c - s * s) * inverse * inverse;
    out.sin2[i] = 2.0 * s * c * inverse * inverse;
    out.of[0][i] = r.sin[i];
    out.of[1][i] = r.cos[i];
    out.of[2][i] = (r.cos[i] * c + r.sin[i] * s) * inverse;
    out.of[3][i] = (r.sin[i] * c - r.cos[i] * s) * inverse;
  }
  double own[4];
  for (int k = 0; k < 4; ++k)
    own[k] = noise_between(out.of[k]);
  const double mean = std::hypot(own[0], own[1]) / std::numbers::sqrt2;
  // Where the angle is the pair's own, the noise that is known is that of the radius.
  const bool radius = out.judged.size() == 1 && !scene.radius_only;
  for (int k : out.judged)
    if ((k < 2 || radius) && mean > 0.0 && own[k] > 0.0)
      out.noise[k] = own[k] / mean;
  return out;
}

Memory::Memory(const Scene &scene, const Observations &data, const Components &split) {
  const double turn = scene.fastest_omega * scene.periods * data.frame_period_s;
  const double least = static_cast<double>(criteria::kMemory * criteria::kMemory);
  if (turn > kTwoPi / least) // structure is not the same then
    return;
  // What averages or filters does so to both channels: along the vector the noise remembers
  // itself for as long as across it. What does so in one of the two only is a motion, or a gain.
  constexpr std::size_t kAlong = 2, kAcross = 3;
  *this = Memory(data, split.of[kAlong]);
  if (split.judged.size() > 1)
    if (Memory across(data, split.of[kAcross]);
        across.rms_v() * across.of_means() < rms_v() * of_means())
      *this = std::move(across);
}

Memory::Memory(const Observations &data, const std::vector<double> &noise) {
  std::vector<double> sum(2 * criteria::kMemory + 1, 0.0), count = sum;
  for (std::size_t lag = 0; lag < sum.size(); ++lag)
    for (std::size_t i = 0; i + lag < data.size(); ++i) {
      if (data.time[i + lag] - data.time[i] >
          (static_cast<double>(lag) + 0.5) * data.frame_period_s)
        continue;
      sum[lag] += noise[i] * noise[i + lag];
      count[lag] += 1.0;
    }
  for (std::size_t lag = 0; lag < sum.size(); ++lag)
    sum[lag] /= std::max(1.0, count[lag]);
  double plateau = 0.0;
  for (std::size_t lag = criteria::kMemory + 1; lag < sum.size(); ++lag)
    plateau += sum[lag] / static_cast<double>(criteria::kMemory);
  const double own = sum[0] - std::max(0.0, plateau);
  if (!(own > 0.0))
    return;
  std::vector<double> of(criteria::kMemory);
  double all = 1.0;
  for (std::size_t lag = 1; lag <= criteria::kMemory; ++lag)
    all += 2.0 * (of[lag - 1] = (sum[lag] - std::max(0.0, plateau)) / own);
  // Each correlation of n samples of white noise has an error of the root of 1/n.
  const double error = 2.0 * std::sqrt(static_cast<double>(criteria::kMemory) / count[0]);
  if (all < 1.0 + criteria::kClearErrors * error)
    return;
  correlation_ = std::move(of);
  rms_v_ = std::sqrt(own);
}

} // namespace ada
