// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Lines of a residual over time: what either channel has at one frequency.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "base/sincos.h"
#include "model/residual.h"

namespace ada {

/// Power and quadrature sums of both channels at one frequency.
struct Line {
  double power;
  std::array<double, 4> amplitudes; ///< sine, cosine of VSIN; sine, cosine of VCOS
};

/// `phase` gives rad for sample i.
template <class Phase> Line line_along(const Residual &r, Phase phase) {
  std::array<double, 4> sum{};
  for_each_sincos(r.time.size(), phase, [&](std::size_t i, double s, double c) {
    sum[0] += r.sin_v[i] * s;
    sum[1] += r.sin_v[i] * c;
    sum[2] += r.cos_v[i] * s;
    sum[3] += r.cos_v[i] * c;
  });
  Line line{0.0, sum};
  for (double &a : line.amplitudes) {
    a *= 2.0 / static_cast<double>(r.time.size());
    line.power += a * a;
  }
  return line;
}

/// The line at a frequency in Hz.
Line line_at(const Residual &r, double frequency);

/// Two channels a quarter of a period apart and of one size: something that turns, such as a gain
/// that wanders, or a pickup that happens to reach the wires so.
bool rotates(const Line &tone);

constexpr std::size_t kFewestForTones = 256; // samples, of a spectrum that shows a line

/// The two strongest lines of the spectrum above a frequency in Hz that `skip` lets pass, with
/// their frequencies.
std::vector<std::pair<double, Line>>
strongest_lines(const Residual &r, double above_hz,
                const std::function<bool(double frequency, const Line &)> &skip);

/// Of some lines, the strongest first, those that stand still and stand out of all that is left
/// beside them once they are taken out, as a tone does and none of the many lines of a function of
/// the angle.
void keep_single_lines(Residual r, std::vector<std::pair<double, Line>> &lines);

} // namespace ada
