// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The forward model: the pair of voltages that a sensor with the given effects gives under the
// given conditions. Physical order: motion, field, bridge, chain (with its dynamics), sampler,
// converter, record. Noise is not part of it.
#pragma once

#include <functional>
#include <vector>

#include "model/effect.h"
#include "model/model.h"
#include "model/taps.h"
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
  friend class ForwardFamily;

  /// One thing that happens to a signal on its way from the magnet to the sampler, or after it.
  struct Step {
    enum Kind { effect_acts, field_to_vector, vector_to_volts, remainder } kind;
    const Effect *effect = nullptr;
    std::vector<double> values;
    bool operator==(const Step &) const = default;
  };

  /// The motion of one block, in arrays that have to live as long as the wave.
  struct Motion {
    double shaft[kWaveBlock];
    float speed[kWaveBlock];
  };

  /// A sum of delayed copies of the signals.
  struct Copies {
    double s[kWaveBlock] = {}, c[kWaveBlock] = {};
    void add(const Taps &taps, double delay_s, const Wave &w);
  };

  Wave wave() const;
  void motion(Wave &w, double *shaft, float *speed) const;
  void begin(const Conditions &at, Wave &w, Motion &m) const;
  void leave_magnet(Wave &w, double delay_s, const double *shaft) const;
  void act(const Step &step, Wave &w) const;
  void finish(Wave &w, double *vsin_v, double *vcos_v) const;
  void block(const Conditions &at, double *vsin_v, double *vcos_v, Wave &w) const;
  void add_remainder(Wave &w) const;
  double highest_harmonic() const;
  Taps copies(const Wave &w) const;

  Baseline baseline_;
  double mid_v_, temp_reference_v_;
  int periods_;
  double apart_rad_ = 0.0; ///< of the channels, beyond a quarter of a period
  std::vector<Step> reference_, motion_;
  bool field_is_magnet_ = true;        ///< nothing acts on the field
  std::vector<Step> way_;              ///< field, bridge and chain, from the magnet to the sampler
  std::vector<Step> later_;            ///< than the sampler
  std::vector<FourierPair> remainder_; ///< in volts; empty: none
  double remainder_periods_ = 1.0;     ///< its periods a turn of the magnet
  Taps taps_;
  /// Highest frequency that the signals hold before them, in that of their fundamental; infinite
  /// where they have edges.
  double highest_ = 0.0;
};

/// Models that have most of their way in common with a first one, each with one number or one
/// effect more, say. Up to where each differs the signals are computed once. Immutable while it is
/// used, by several threads if need be.
class ForwardFamily {
public:
  ForwardFamily(const Model &first, AlphaIs alpha);
  void add(const Model &other);

  /// take(k, vsin_v, vcos_v) for the first model, k = 0, and for the others in their order, of one
  /// block: `at.n` is at most kWaveBlock. The volts are those of each model by itself, to the bit.
  using Take = std::function<void(std::size_t, const double *, const double *)>;
  void evaluate(const Conditions &at, const Take &take) const;

private:
  struct Other {
    ForwardModel model;
    std::size_t same; ///< steps of the way that it has in common; kNone: not even the motion
    std::size_t kept; ///< place of the state after those among what is kept
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t in_common(const ForwardModel &other) const;

  AlphaIs alpha_;
  ForwardModel first_;
  std::vector<Other> others_;
  std::vector<std::size_t> places_; ///< numbers of steps after which the state is kept
};

} // namespace ada
