// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Rows of a fleet, drawn: what a bench with such sensors would leave in a study. The truth is no
// model of the statistics that are tested: sizes are skewed where real ones are, noise has heavier
// tails than a normal distribution, keys are as uneven as those of real headers.
#pragma once

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "study/row.h"

namespace ada::test {

/// Laws that may be hidden in a fleet; zero means that there is none.
struct Laws {
  int sensors = 120;
  int repeats = 1;
  double off_axis_per_um = 0.0;       ///< a_deg per um of position
  double quadrature_of_batch_b = 0.0; ///< degrees added in batch B
  double second_mismatch = 0.0;       ///< k added to part of the sensors, which no key names
  double drift_v_per_h = 0.0;         ///< of the sine's offset, over the day
  int slipping = -1;                  ///< the sensor whose magnet slips
  int unnamed = -1;                   ///< the sensor with something that has no name
  double unnamed_v = 0.0;             ///< and how much of it is left
  double within_mismatch = 0.0003;    ///< spread of k from capture to capture of a sensor
};

class FleetGenerator {
public:
  explicit FleetGenerator(std::uint64_t seed) : rng_(seed) {}

  std::vector<study::Row> draw(const Laws &laws) {
    std::vector<study::Row> rows;
    const double k_mean = normal(0.01, 0.005), delta_mean = normal(0.5, 0.3);
    int number = 0;
    for (int s = 0; s < laws.sensors; ++s) {
      const Sensor sensor = draw_sensor(laws, k_mean, delta_mean);
      for (int r = 0; r < laws.repeats; ++r)
        rows.push_back(draw_capture(laws, sensor, s, number++));
    }
    return rows;
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  double normal(double mean, double spread) {
    return std::normal_distribution<double>(mean, spread)(rng_);
  }
  std::size_t second_population = 0; ///< sensors in it, of the last draw

private:
  struct Sensor {
    double amplitude, offset_sin, offset_cos, k, delta, off_axis, position, noise;
    std::string batch, station;
  };

  /// Noise as measured numbers have it: Student's t with five degrees of freedom.
  double heavy(double spread) { return spread * std::student_t_distribution<double>(5.0)(rng_); }

  Sensor draw_sensor(const Laws &laws, double k_mean, double delta_mean) {
    Sensor s{};
    s.amplitude = normal(1.45, 0.02);
    s.offset_sin = normal(0.0, 0.004);
    s.offset_cos = normal(0.001, 0.004);
    s.k = normal(k_mean, 0.003);
    s.delta = normal(delta_mean, 0.1);
    s.position = std::round(uniform(20.0, 300.0));
    s.noise = 0.0005 * std::exp(normal(0.0, 0.15));
    s.batch = std::string(1, "AABBCD"[static_cast<std::size_t>(uniform(0.0, 5.999))]);
    s.station = uniform(0.0, 1.0) < 0.3 ? "left" : "right";
    s.off_axis = laws.off_axis_per_um > 0.0 ? laws.off_axis_per_um * s.position
                                            : 0.1 * std::exp(normal(0.0, 0.3));
    s.delta += s.batch == "B" ? laws.quadrature_of_batch_b : 0.0;
    if (laws.second_mismatch != 0.0 && uniform(0.0, 1.0) < 0.4) {
      s.k += laws.second_mismatch;
      ++second_population;
    }
    return s;
  }

  study::Row draw_capture(const Laws &laws, const Sensor &s, int sensor, int number) {
    study::Row row;
    row.capture = "day/ring-" + std::to_string(number) + ".csv";
    row.state = study::RowState::done;
    row.serial = "S" + std::to_string(1000 + sensor);
    row.program = "1.0.0";
    row.verdict = "explained";
    row.sound = true;
    row.has_reference = true;
    row.samples = 5000;
    row.duration_s = 5.0;
    row.extended_angle_rms_deg = 0.012 * std::exp(normal(0.0, 0.1));
    const double hour = number * 8.0 / (laws.sensors * laws.repeats);
    const int minute = static_cast<int>(hour * 60.0);
    char date[40];
    std::snprintf(date, sizeof date, "2026-03-05T%02d:%02d:%02dZ", 8 + minute / 60, minute % 60,
                  static_cast<int>(hour * 3600.0) % 60);
    row.factors = {{"batch", s.batch},
                   {"date", date},
                   {"position_um", std::to_string(s.position)},
                   {"station", s.station},
                   {"temperature_deg_c", std::to_string(normal(24.0, 1.5))}};
    add(row, 0, "baseline", "amplitude_v", "V", s.amplitude + heavy(0.0002));
    add(row, 0, "baseline", "offset_sin_v", "V",
        s.offset_sin + laws.drift_v_per_h * hour + heavy(0.0002));
    add(row, 0, "baseline", "offset_cos_v", "V", s.offset_cos + heavy(0.0002));
    add(row, 0, "baseline", "noise_rms_v", "V", s.noise * std::exp(normal(0.0, 0.01)));
    add(row, 0, "extended-model", "residual_rms_v", "V",
        laws.unnamed == sensor ? laws.unnamed_v
                               : s.noise * std::exp(0.1 * std::abs(normal(0.0, 1.0))));
    const double k = s.k + heavy(laws.within_mismatch / std::sqrt(5.0 / 3.0)),
                 delta = s.delta + heavy(0.01);
    add(row, 0, "amplitude-mismatch", "k", "1", k);
    add(row, 0, "quadrature-error", "delta_deg", "deg", delta);
    found(row, "amplitude-mismatch", 20.0 * std::abs(k) / 2.83);
    found(row, "quadrature-error", std::abs(delta) / 5.66);
    const double a = s.off_axis + heavy(0.002);
    if (a > 0.005) {
      found(row, "sensor-off-axis", a / 1.414);
      add(row, 3, "sensor-off-axis", "a_deg", "deg", a);
      add(row, 3, "sensor-off-axis", "direction_deg", "deg", uniform(0.0, 180.0));
    }
    if (sensor == laws.slipping) {
      found(row, "angle-slip", 0.8);
      const int place = static_cast<int>(row.findings.size());
      add(row, place, "angle-slip", "time_s", "s", uniform(0.5, 4.5));
      add(row, place, "angle-slip", "step_deg", "deg", 1.7);
    }
    return row;
  }

  static void found(study::Row &row, const char *cause, double cost) {
    row.findings.push_back({cause, {}, cost, true});
  }
  static void add(study::Row &row, int place, const char *cause, const char *parameter,
                  const char *unit, double value) {
    row.quantities.push_back({place, cause, parameter, unit, value, 0.001});
  }

  std::mt19937_64 rng_;
};

} // namespace ada::test
