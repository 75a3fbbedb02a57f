// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/angle_text.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace cli {

namespace {

constexpr double kTextInterval_s = 0.1;

/// Rounded to a number of decimals without reaching the end of the range.
double rounded_into(double angle_deg, double range_deg, int decimals) {
  return angle_deg + 0.5 * std::pow(10.0, -decimals) >= range_deg ? 0.0 : angle_deg;
}

void append_json(std::string &out, const ada4571_angle &a, double angle_deg) {
  const auto number = [](double x) {
    return std::isfinite(x) ? fmt::format("{:.6f}", x) : std::string("null");
  };
  fmt::format_to(std::back_inserter(out),
                 "{{\"time_s\":{:.9f},\"angle_deg\":{},\"radius\":{},\"status\":{}}}\n", a.time_s,
                 number(angle_deg), number(a.radius), a.status);
}

} // namespace

const char *const kAngleCsvHeader = "time_s,angle_deg,radius,status\n";

std::string status_words(unsigned status) {
  constexpr struct {
    unsigned bit;
    const char *word;
  } words[] = {{ADA4571_SAMPLE_RADIUS, "radius out of band"},
               {ADA4571_SAMPLE_RAIL, "at a rail"},
               {ADA4571_SAMPLE_INVALID, "invalid"},
               {ADA4571_SAMPLE_GAP, "samples lost before"}};
  std::string text;
  for (const auto &[bit, word] : words)
    if (status & bit)
      text += (text.empty() ? "" : ", ") + std::string(word);
  return text.empty() ? "ok" : text;
}

void AngleText::append(std::string &out, std::span<const ada4571_angle> angles) {
  if (angles.empty()) // an empty read leaves the header to the first angle
    return;
  if (format_ == AngleFormat::csv && first_)
    out += kAngleCsvHeader;
  for (const ada4571_angle &a : angles) {
    switch (format_) {
    case AngleFormat::csv:
      fmt::format_to(std::back_inserter(out), "{:.9f},{:.6f},{:.6f},{}\n", a.time_s,
                     rounded_into(a.angle_deg, range_deg_, 6), a.radius, a.status);
      break;
    case AngleFormat::json:
      append_json(out, a, rounded_into(a.angle_deg, range_deg_, 6));
      break;
    case AngleFormat::text:
      if (!first_ && a.time_s < next_s_)
        break;
      fmt::format_to(std::back_inserter(out), "{:10.3f} s  {:9.3f} deg  radius {:.3f}  {}\n",
                     a.time_s, rounded_into(a.angle_deg, range_deg_, 3), a.radius,
                     status_words(a.status));
      next_s_ = a.time_s + kTextInterval_s;
      break;
    }
    first_ = false;
  }
}

} // namespace cli
