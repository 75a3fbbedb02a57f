// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/angle_path.h"

#include <cmath>

#include "base/angle.h"
#include "base/error.h"

namespace ada {

namespace {

/// A step longer than this may as well have gone the other way round.
constexpr double kMaxStep = 0.8 * kPi;
/// Steps across a gap are allowed to be long; more of them than this means too high a speed.
constexpr double kMaxAmbiguous = 0.01;

} // namespace

AnglePath unwrap(const Capture &capture, const EllipseFit &fit) {
  const EllipseInverse inverse = invert(fit.value);
  AnglePath path;
  path.sample.reserve(fit.used);
  path.psi.reserve(fit.used);
  std::size_t ambiguous = 0;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    if (!fit.accepted[i])
      continue;
    const double psi = std::atan2(inverse.sine(capture.vsin_v[i], capture.vcos_v[i]),
                                  inverse.cosine(capture.vsin_v[i], capture.vcos_v[i]));
    double next = psi;
    if (!path.psi.empty()) {
      const double step = wrap_centred(psi - path.psi.back(), kTwoPi);
      next = path.psi.back() + step;
      ambiguous += std::abs(step) > kMaxStep;
    }
    path.sample.push_back(i);
    path.psi.push_back(next);
  }
  if (static_cast<double>(ambiguous) > kMaxAmbiguous * static_cast<double>(path.psi.size()))
    throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                "fewer than about three samples an electrical period: turns cannot be counted; "
                "turn more slowly, or use the method fit");
  return path;
}

} // namespace ada
