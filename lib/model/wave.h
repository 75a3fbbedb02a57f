// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the stages of the forward model hand to each other: one block of samples on its way from
// the shaft to the converter, and the conditions under which each sample was taken.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace ada {

/// Conditions of each sample; arrays of one length. Optional ones are nullptr where unknown.
struct Conditions {
  std::size_t n = 0;
  const double *time = nullptr;           ///< s
  const double *alpha = nullptr;          ///< true mechanical angle of the shaft, rad
  const float *omega = nullptr;           ///< d alpha/dt, rad/s
  const float *accel = nullptr;           ///< d omega/dt, rad/s^2, optional
  const signed char *direction = nullptr; ///< -1 or +1, the sense of the last motion
  const float *travel = nullptr;          ///< rad, since it last turned back; nullptr: long ago
  /// What was added to the reading of the reference to make it `alpha`, rad, where several records
  /// have a zero angle each: a reference errs at places of its own reading. nullptr: nothing.
  const float *moved = nullptr;
  const float *temp = nullptr;            ///< VTEMP, V, free of noise; optional
  const float *temp_rate = nullptr;       ///< d VTEMP/dt, V/s; optional
  const float *supply = nullptr;          ///< (VDD/mean - 1) scaled to an rms of 1; optional
  const float *supply_rate = nullptr;     ///< its first derivative, 1/s; optional
  const float *supply_bend = nullptr;     ///< its second derivative, 1/s^2; optional
  const float *vtemp_scan = nullptr; ///< VTEMP as converted before VSIN, V; nullptr: not scanned
  double frame_period_s = 0.0;
  /// `omega` is the mean speed over as much time on either side; 0: the speed there.
  double speed_reach_s = 0.0;
  /// How far the recorded supply, on average, moves mid-supply from where the model has it, V.
  double mid_shift_v = 0.0;

  /// The same conditions from sample `first` on, `count` samples.
  Conditions slice(std::size_t first, std::size_t count) const;
};

inline constexpr std::size_t kWaveBlock = 256;

/// Turns of a vector by functions of the magnet's angle alone, kept for as long as one block lasts:
/// the models of a family have most of them in common.
class TurnsOfBlock {
public:
  struct Turn {
    double cos[kWaveBlock], sin[kWaveBlock];
  };
  /// That of these three numbers and this delay of the angle; make(turn) where it is not known.
  /// `spare` is used where there is no room to keep it.
  template <class Make>
  const Turn &of(const std::array<double, 4> &numbers, Turn &spare, Make make) {
    for (const auto &[key, turn] : kept_)
      if (key == numbers)
        return *turn;
    constexpr std::size_t kMost = 16;
    if (kept_.size() == kMost) {
      make(spare);
      return spare;
    }
    kept_.emplace_back(numbers, std::make_unique_for_overwrite<Turn>());
    make(*kept_.back().second);
    return *kept_.back().second;
  }

private:
  std::vector<std::pair<std::array<double, 4>, std::unique_ptr<Turn>>> kept_;
};

/// One block. Which members are meaningful follows the stages:
/// motion: alpha; field: fx, fy; bridge: ex, ey, c, s (amplitude 1); chain: c, s in volts about
/// mid-supply; sampler and later: c, s in absolute volts.
struct Wave {
  std::size_t n = 0;
  Conditions at;                         ///< the conditions of this block
  double amplitude_v = 1.0;              ///< A of the baseline
  double mid_v = 2.5;                    ///< supply/2
  int periods = 2;                       ///< p
  double apart_rad = 0.0;                ///< by which VSIN leads VCOS beyond a quarter of a period
  double alpha[kWaveBlock];              ///< angle of the magnet, rad
  double fx[kWaveBlock], fy[kWaveBlock]; ///< field at the sensor, magnet alone = 1
  double ex[kWaveBlock], ey[kWaveBlock]; ///< cos psi, sin psi of the field
  double c[kWaveBlock], s[kWaveBlock];   ///< the two signals
  /// What offsets have added to each so far, V: the baseline's and those that drift or step.
  double offset_s[kWaveBlock], offset_c[kWaveBlock];
  void add_offset(std::size_t i, double sin_v, double cos_v) {
    s[i] += sin_v;
    c[i] += cos_v;
    offset_s[i] += sin_v;
    offset_c[i] += cos_v;
  }
  TurnsOfBlock *turns = nullptr; ///< where they are kept, if anywhere
  double delay_s = 0.0;    ///< how much earlier than sampled this copy left the sensor
  double temp[kWaveBlock]; ///< temperature of the bridge in V of VTEMP, minus the reference
};

/// (re + j im) = (x + j y)^power for unit vectors, by squaring; x and y are used up.
void to_power(std::size_t n, unsigned power, double *x, double *y, double *re, double *im);

} // namespace ada
