// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/dual.h"
#include "calibration/single.h"
#include "conversion/ellipse.h"
#include "conversion/frame_converter.h"
#include "model/effect.h"
#include "simulation/simulation.h"

namespace ada {

namespace {

constexpr std::array<std::string_view, 7> kNames = {"mismatch",     "offset-25",    "offset-0-110",
                                                    "offset-20-80", "offset-20-50", "error-gc-on",
                                                    "error-gc-off"};

constexpr int kSensors = 8;
constexpr double kColdest = -40.0, kHottest = 150.0, kStep = 10.0; ///< range of the part, deg C
constexpr double kSupply = 5.0;
/// Standard deviation of the drawn curvature of either offset, V per V^2 of VTEMP.
constexpr double kCurvature = 0.004;

/// A drawn sensor with O(T) = O0 + a T + b T^2 for both offsets.
Model drawn_sensor(std::uint64_t seed, int index, bool gain_control) {
  const std::uint64_t own = seed * 1000003u + static_cast<std::uint64_t>(index);
  Model model = sound_sensor(own, kSupply, gain_control);
  Rng rng(own ^ 0x9e3779b97f4a7c15u);
  std::normal_distribution<double> normal(0.0, kCurvature);
  const double b_sin = normal(rng), b_cos = normal(rng);
  model.effects.push_back({find_effect("offset-temperature-curvature"), {b_sin, b_cos}, {}});
  return model;
}

/// Ten turns at one temperature.
Capture at_temperature(const Model &model, double deg_c, bool gain_control, std::uint64_t seed) {
  SimulationOptions o;
  o.sample_rate_hz = 5000.0;
  o.duration_s = 1.0;
  o.motion = "constant:rpm=600";
  o.temperature = fmt::format("constant:deg_c={}", deg_c);
  o.gain_control = gain_control;
  o.has_vdd = false;
  Capture capture = Simulation(model, o, seed).run();
  capture.meta.serial = "drawn"; // other noise does not make it another sensor
  return capture;
}

double mean_vtemp(const Capture &capture) {
  double sum = 0.0;
  for (double v : capture.vtemp_v)
    sum += v;
  return sum / static_cast<double>(capture.size());
}

/// Calibrates at one temperature, or at two.
Model calibrated(const Model &sensor, double t1, std::optional<double> t2, bool gain_control,
                 std::uint64_t seed) {
  const Capture first = at_temperature(sensor, t1, gain_control, seed);
  if (!t2)
    return calibrate_single(first, CalibrationMethod::fit);
  return calibrate_dual(first, at_temperature(sensor, *t2, gain_control, seed + 1),
                        CalibrationMethod::fit);
}

std::vector<double> temperatures() {
  std::vector<double> out;
  for (double t = kColdest; t <= kHottest + 0.5 * kStep; t += kStep)
    out.push_back(t);
  return out;
}

std::vector<std::string> drift_assumptions() {
  return {
      fmt::format("assumed: supply {:g} V, amplitude 0.29 VDD, noise 0.5 mV rms, 16 bits", kSupply),
      "assumed: offsets at 25 deg C drawn with a standard deviation of 0.4 % of VDD",
      "assumed: drift O(T) = O0 + a T + b T^2, a drawn as 0.1 % of the offset a degree plus 5 ppm "
      "of "
      "VDD a degree",
      fmt::format("assumed: b drawn with a standard deviation of {:g} V per V^2 of VTEMP",
                  kCurvature),
      "assumed: VTEMP = VDD (0.233 + 0.00333 T)"};
}

/// Offset of the sensor minus what the calibration takes for it, over temperature; % of VDD.
FigureData residual_offset(std::string name, double t1, std::optional<double> t2,
                           std::uint64_t seed) {
  FigureData out{
      std::move(name),
      t2 ? fmt::format("Residual offset after calibration at {:g} and {:g} \u00b0C", t1, *t2)
         : fmt::format("Residual offset after calibration at {:g} \u00b0C", t1),
      "temperature, \u00b0C",
      "residual offset, % of VDD",
      drift_assumptions(),
      {"temperature_deg_c"},
      {}};
  for (double t : temperatures())
    out.rows.push_back({t});
  for (int k = 0; k < kSensors; ++k) {
    const Model sensor = drawn_sensor(seed, k, true);
    const std::uint64_t noise = seed + 100u * static_cast<std::uint64_t>(k);
    const EllipseModel assumed(calibrated(sensor, t1, t2, true, noise));
    for (std::vector<double> &row : out.rows) {
      const Capture now = at_temperature(sensor, row[0], true, noise + 2);
      const PairEstimate truth = estimate_pair(now, CalibrationMethod::fit);
      const EllipseParameters believed = assumed.parameters_at(mean_vtemp(now));
      row.push_back(100.0 / kSupply * (truth.value.centre_sin_v - believed.centre_sin_v));
      row.push_back(100.0 / kSupply * (truth.value.centre_cos_v - believed.centre_cos_v));
    }
    out.columns.push_back(fmt::format("sensor{}_sin_percent", k + 1));
    out.columns.push_back(fmt::format("sensor{}_cos_percent", k + 1));
  }
  return out;
}

/// Greatest mean error over 5 degrees of angle: the systematic error, without the noise.
double peak_error_deg(const Capture &capture, const Model &model) {
  std::vector<ada4571_angle> angles(capture.size());
  FrameConverter(model).capture(capture, angles);
  std::array<double, 72> sum{}, count{};
  const double period = 360.0 / model.periods_per_turn;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double at = wrap(capture.reference_deg[i], 360.0);
    const auto bin = std::min<std::size_t>(71, static_cast<std::size_t>(at / 5.0));
    sum[bin] += wrap_centred(angles[i].angle_deg - capture.reference_deg[i], period);
    count[bin] += 1.0;
  }
  double peak = 0.0;
  for (std::size_t b = 0; b < sum.size(); ++b)
    if (count[b] > 0.0)
      peak = std::max(peak, std::abs(sum[b] / count[b]));
  return peak;
}

FigureData angle_error(std::string name, bool gain_control, std::uint64_t seed) {
  FigureData out{std::move(name),
                 fmt::format("Angle error after calibration at 25 \u00b0C, gain control {}",
                             gain_control ? "on" : "off"),
                 "temperature, \u00b0C",
                 "peak angle error, deg",
                 drift_assumptions(),
                 {"temperature_deg_c"},
                 {}};
  out.assumptions.push_back(gain_control
                                ? "assumed: with gain control the amplitude does not change"
                                : "assumed: without gain control the amplitude falls by 0.3 % of "
                                  "its value at 25 deg C a degree");
  for (double t : temperatures())
    out.rows.push_back({t});
  for (int k = 0; k < kSensors; ++k) {
    const Model sensor = drawn_sensor(seed, k, gain_control);
    const std::uint64_t noise = seed + 100u * static_cast<std::uint64_t>(k);
    const Model model = calibrated(sensor, 25.0, std::nullopt, gain_control, noise);
    for (std::vector<double> &row : out.rows)
      row.push_back(peak_error_deg(at_temperature(sensor, row[0], gain_control, noise + 2), model));
    out.columns.push_back(fmt::format("sensor{}_deg", k + 1));
  }
  return out;
}

/// The note's correction takes both amplitudes as one: what a mismatch then costs.
FigureData mismatch(std::uint64_t seed) {
  FigureData out{"mismatch",
                 "Angle error by amplitude mismatch",
                 "amplitude mismatch k, %",
                 "peak angle error, deg",
                 {"closed form: k/4 rad peak, mechanical, for p = 2",
                  "assumed: no noise, no offset, no quantisation, amplitude 0.29 VDD"},
                 {"k_percent", "simulated_deg", "closed_form_deg"},
                 {}};
  Model ideal;
  ideal.supply_v = kSupply;
  for (int step = 0; step <= 20; ++step) {
    const double k = 0.001 * step;
    Model sensor = ideal;
    if (step > 0)
      sensor.effects.push_back({find_effect("amplitude-mismatch"), {k}, {}});
    SimulationOptions o;
    o.duration_s = 1.0;
    o.noise_rms_v = 0.0;
    o.adc_bits = 0;
    o.motion = "constant:rpm=67"; // many different angles
    const Capture capture = Simulation(sensor, o, seed).run();
    std::vector<ada4571_angle> angles(capture.size());
    FrameConverter(ideal).capture(capture, angles);
    double peak = 0.0;
    for (std::size_t i = 0; i < angles.size(); ++i)
      peak = std::max(
          peak, std::abs(wrap_centred(angles[i].angle_deg - capture.reference_deg[i], 180.0)));
    out.rows.push_back({100.0 * k, peak, 0.25 * k * kDegPerRad});
  }
  return out;
}

} // namespace

std::span<const std::string_view> figure_names() {
  return kNames;
}

FigureData make_figure(std::string_view name, std::uint64_t seed) {
  if (name == "mismatch")
    return mismatch(seed);
  if (name == "offset-25")
    return residual_offset(std::string(name), 25.0, std::nullopt, seed);
  if (name == "offset-0-110")
    return residual_offset(std::string(name), 0.0, 110.0, seed);
  if (name == "offset-20-80")
    return residual_offset(std::string(name), 20.0, 80.0, seed);
  if (name == "offset-20-50")
    return residual_offset(std::string(name), 20.0, 50.0, seed);
  if (name == "error-gc-on" || name == "error-gc-off")
    return angle_error(std::string(name), name == "error-gc-on", seed);
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
              fmt::format("there is no such figure; the names are {}", fmt::join(kNames, ", ")));
}

} // namespace ada
