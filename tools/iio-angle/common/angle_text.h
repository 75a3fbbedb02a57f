// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angles as text.
#pragma once

#include <span>
#include <string>

#include "ada4571.h"

namespace cli {

enum class AngleFormat { text, csv, json };

/// "time_s,angle_deg,radius,status" and a line end.
extern const char *const kAngleCsvHeader;

/// Writes angles in one of the formats. Text is for a person: a line every tenth of a second of
/// sample time; csv and json have a line a sample.
class AngleText {
public:
  /// range_deg: 360/p. No printed angle reaches it, whatever the rounding.
  AngleText(AngleFormat format, double range_deg) : format_(format), range_deg_(range_deg) {}

  void append(std::string &out, std::span<const ada4571_angle> angles);

private:
  AngleFormat format_;
  double range_deg_;
  double next_s_ = 0;
  bool first_ = true;
};

/// Words for ADA4571_SAMPLE_ bits: "ok", "radius, gap".
std::string status_words(unsigned status);

} // namespace cli
