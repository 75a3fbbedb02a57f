// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reference's own periodic error of another order than 1: line interpolation, a gear. It reads
// alpha + e sin(n alpha + phase), n not always whole. Nothing is wrong with the sensor.

#include <algorithm>
#include <cmath>
#include <string>

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 3> kParameters{
    ParameterInfo{"order", "per turn", 8.0, 0.01, 65536.0, Role::chosen},
    ParameterInfo{"e_deg", "deg", 0.1, 0.0, 20.0, Role::fitted, 0.01},
    ParameterInfo{"phase_deg", "deg", 0.0, -360.0, 360.0}};

constexpr std::array<Separation, 4> kSeparations{
    {{"field-direction-error", kSteadySpin},
     {"sensor-off-axis", kSteadySpin},
     {"stray-field", kSteadySpin},
     {"harmonic-distortion", "turn the reference on the shaft by a part of its period: what the "
                             "sensor errs keeps its place"}}};

constexpr EffectInfo kInfo{.id = "reference-harmonic",
                           .cause = "The reference itself errs periodically, by its lines, its "
                                    "interpolation or a gear; the sensor is right.",
                           .stage = Stage::record,
                           .parameters = kParameters,
                           .correctable = false,
                           .signature = true,
                           .separations = kSeparations,
                           .yields_to = "field-direction-error",
                           .pattern = Pattern::turn,
                           .prior_rank = 4,
                           .repeats = true};

/// What changes within the record widens the line of order 1, the eccentricity's, and near it
/// nothing is of another order: one whose size comes and goes up to eight times has its sides
/// within as many periods over the record. In few turns no more than this is left out.
constexpr double kPeriodsAside = 8.0, kOfEccentricity = 0.25;

/// From so many turns on orders apart by a sixth are told apart. In fewer a field of the same order
/// looks the same while there are few periods of it.
constexpr double kFewestTurns = 6.0;

class ReferenceHarmonic final : public ReferenceError {
public:
  const EffectInfo &info() const override { return kInfo; }
  std::string invisible(const Residual &r) const override {
    return r.has_reference ? "" : "there is no reference";
  }
  std::string invisible_part(const Residual &r) const override {
    if (r.turns >= kFewestTurns)
      return "";
    return "of orders below " +
           std::to_string(static_cast<int>(
               std::ceil(std::min(kFewestPeriodsOfOrder / std::max(r.arc_turns(), 1e-6), 1e6)))) +
           ": in so few turns a field that errs at the same order looks the same";
  }
  bool shows(Values v, const Residual &r) const override {
    return r.turns >= kFewestTurns || periods_seen(v, r) >= kFewestPeriodsOfOrder;
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    auto out = one_of_each(3, 0, 2, 8); // order 1 is the eccentricity's
    for (const double order : {16.0, 32.0, 64.0})
      out.push_back({order, 0.0, 0.0});
    add_orders_seen(r, kParameters[0], Orders::any, out);
    const double aside = std::min(kOfEccentricity, kPeriodsAside / std::max(1.0, r.turns));
    std::erase_if(out, [&](const auto &v) {
      return std::abs(v[0] - 1.0) <= aside ||
             (v[0] != std::round(v[0]) && periods_seen(v, r) < kFewestPeriodsOfOrder);
    });
    return out;
  }

  // A gear's order is no whole number and is fitted along, once its size says where it lies: over
  // many turns a little of it is much phase. A whole one is what it is.
  std::vector<double> to_coordinates(Values v) const override {
    std::vector<double> x = PolarEffect::to_coordinates(v);
    if (order_is_free(v))
      x.push_back(v[0]);
    return x;
  }
  std::vector<double> from_coordinates(Values v, std::span<const double> x) const override {
    std::vector<double> out = PolarEffect::from_coordinates(v, x.first(2));
    if (x.size() > 2)
      out[0] = x[2];
    return out;
  }
  std::vector<double> steps(Values v) const override {
    std::vector<double> h = PolarEffect::steps(v);
    if (order_is_free(v))
      h.push_back(kOrderStep);
    return h;
  }

protected:
  static double periods_seen(Values v, const Residual &r) {
    return v[0] * (r.turns >= kFewestTurns ? r.turns : r.arc_turns());
  }
  static constexpr double kOrderStep = 1e-6; ///< per turn: a thousandth of a radian in 160 turns
  static bool order_is_free(Values v) { return v[1] != 0.0 && v[0] != std::round(v[0]); }
  double order(Values v) const override { return v[0]; }
  std::size_t amplitude_index() const override { return 1; }
  std::size_t phase_index() const override { return 2; }
};

} // namespace

const Effect &reference_harmonic() {
  static const ReferenceHarmonic effect;
  return effect;
}

} // namespace ada
