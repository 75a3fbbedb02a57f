// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The forward model: the pair of voltages that a sensor with the given effects gives under the
// given conditions. Physical order: motion, field, bridge, chain (with its dynamics), sampler,
// converter, record. Noise is not part of it.
#pragma once

#include <vector>

#include "model/effect.h"
#include "model/model.h"
#include "model/wave.h"

namespace ada {

enum class AlphaIs {
  shaft,     ///< Conditions::alpha is the true angle of the shaft
  reference, ///< it is what the reference reads; effects of the reference are taken out first
};

/// Immutable once made, so it may be used by several threads. Holds copies of what it needs.
class ForwardModel {
public:
  explicit ForwardModel(const Model &model, AlphaIs alpha = AlphaIs::shaft);

  /// Absolute volts of both channels for every sample of `at`; both arrays hold at.n.
  void evaluate(const Conditions &at, double *vsin_v, double *vcos_v) const;

  /// The angle of the magnet (rad, without the zero angle) behind Conditions::alpha: errors of the
  /// reference taken out, ripple and slip of the shaft put in.
  void magnet_angle(const Conditions &at, double *alpha) const;

private:
  struct Step {
    const Effect *effect;
    std::vector<double> values;
  };

  void motion(Wave &w, double *shaft, double *speed) const;
  void block(const Conditions &at, double *vsin_v, double *vcos_v, Wave &w) const;
  void until_sampler(Wave &w, double delay_s, const double *shaft) const;
  void add_remainder(Wave &w) const;

  Baseline baseline_;
  double mid_v_, temp_reference_v_;
  int periods_;
  double apart_rad_ = 0.0; ///< of the channels, beyond a quarter of a period
  std::vector<Step> reference_, motion_, field_, bridge_, chain_, later_;
  std::vector<FourierPair> remainder_; ///< in volts; empty: none
  double remainder_periods_ = 1.0;     ///< its periods a turn of the magnet
  Taps taps_;
};

} // namespace ada
