// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Lines of a residual over time: what either channel has at one frequency.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/angle.h"
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

/// use(k, sine, cosine), of each time's phase, for the frequencies first_hz + k step_hz, k from 0
/// to count - 1: the phases are turned on from one to the next.
template <class Use>
void for_each_frequency(std::span<const double> time, double first_hz, double step_hz, int count,
                        Use use) {
  const std::size_t n = time.size();
  std::vector<double> s(n), c(n), turn_s(n), turn_c(n);
  const auto fill = [&](double hz, std::vector<double> &sine, std::vector<double> &cosine) {
    for_each_sincos(
        n, [&](std::size_t i) { return kTwoPi * hz * time[i]; },
        [&](std::size_t i, double x, double y) {
          sine[i] = x;
          cosine[i] = y;
        });
  };
  fill(first_hz, s, c);
  fill(step_hz, turn_s, turn_c);
  for (int k = 0; k < count; ++k) {
    use(k, s, c);
    for (std::size_t i = 0; i < n; ++i) {
      const double next = s[i] * turn_c[i] + c[i] * turn_s[i];
      c[i] = c[i] * turn_c[i] - s[i] * turn_s[i];
      s[i] = next;
    }
  }
}

/// The line whose phase has this sine and cosine.
Line line_of(const Residual &r, std::span<const double> sine, std::span<const double> cosine);

/// How long a line must swing to be told from another, s: in one stretch, for nobody saw it swing
/// in a pause of the record, however long that makes the whole.
double tells_apart_s(const Residual &r);

/// The line at a frequency in Hz.
Line line_at(const Residual &r, double frequency);

/// Takes the line at a frequency in Hz out of two channels by least squares.
void take_out_line(std::span<const double> time, double frequency, std::span<double> sin_v,
                   std::span<double> cos_v);

/// The same of a residual along the radius, where a line that stands shows as far as the pair
/// points its way: over a few rounds of the shaft much beside its frequency is its own.
void take_out_line_of_radius(const Residual &r, double frequency, std::span<double> sin_v,
                             std::span<double> cos_v);

/// Two channels a quarter of a period apart and of one size: something that turns, such as a gain
/// that wanders, or a pickup that happens to reach the wires so.
bool rotates(const Line &tone);

constexpr std::size_t kFewestForTones = 64; // samples, of a spectrum that shows a line

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
