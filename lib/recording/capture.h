// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A capture in memory: one column a channel, volts, seconds and mechanical degrees.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/frame.h"

namespace ada {

struct CaptureMetadata {
  double supply_v = 5.0;
  int periods_per_turn = 2;
  std::optional<bool> gain_control;
  std::optional<double> noise_rms_v;
  std::optional<double> sample_rate_hz;
  std::optional<double> adc_bits;
  std::optional<double> adc_reference_v;
  std::string serial;
  std::string origin;
  std::vector<std::pair<std::string, std::string>> other; ///< unknown keys, kept in order
  bool at_rest = false; ///< each row is the mean of what was read where the shaft stood
};

struct Capture {
  CaptureMetadata meta;
  std::vector<double> time_s, vsin_v, vcos_v;        ///< always of one length
  std::vector<double> vtemp_v, vdd_v, reference_deg; ///< that length, or empty when absent
  std::vector<std::size_t> starts; ///< first sample of each record, where several were joined
  std::vector<std::size_t> gaps; ///< first sample after each gap that the source reported
  /// Electrical angle, rad, by which the pair turned in each of the gaps; empty, or not a number,
  /// where nobody followed it.
  std::vector<double> turned_rad;
  std::string identity;          ///< checksum of the content, names the capture in provenance
  std::string data_file;         ///< of a SigMF recording: where its samples were read
  std::vector<std::string>
      ignored_columns; ///< names of columns in the file that have no meaning here

  std::size_t size() const { return time_s.size(); }
  bool has_vtemp() const { return !vtemp_v.empty(); }
  bool has_vdd() const { return !vdd_v.empty(); }
  bool has_reference() const { return !reference_deg.empty(); }

  Frame frame(std::size_t i) const {
    return {time_s[i],
            vsin_v[i],
            vcos_v[i],
            has_vtemp() ? vtemp_v[i] : kAbsent,
            has_vdd() ? vdd_v[i] : kAbsent,
            has_reference() ? reference_deg[i] : kAbsent};
  }
};

} // namespace ada
