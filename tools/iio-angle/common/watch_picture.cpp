// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/watch_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "common/angle_text.h"

namespace cli {

namespace {

constexpr int kDialRows = 11, kDialColumns = 23; ///< a character is about twice as high as wide
constexpr int kLines = kDialRows + 6;

/// The shortest way from a to b, in (-range/2, range/2].
double difference(double b, double a, double range) {
  return std::remainder(b - a, range);
}

/// A dial of the whole range, zero at the right, growing counterclockwise.
std::vector<std::string> dial(double fraction) {
  std::vector<std::string> rows(kDialRows, std::string(kDialColumns, ' '));
  const auto put = [&rows](double turn, double radius, char c) {
    const double a = 2 * std::numbers::pi * turn;
    const auto row = std::lround((kDialRows - 1) / 2.0 * (1 - radius * std::sin(a)));
    const auto column = std::lround((kDialColumns - 1) / 2.0 * (1 + radius * std::cos(a)));
    rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = c;
  };
  for (int i = 0; i < 72; ++i)
    put(i / 72.0, 1, '.');
  for (int i = 0; i < 4; ++i)
    put(i / 4.0, 1, '+');
  if (std::isfinite(fraction)) {
    for (double r = 0; r < 0.9; r += 0.09)
      put(fraction, r, '*');
    put(fraction, 0.93, '@');
  }
  put(0, 0, 'o');
  return rows;
}

/// A bar of `width` characters for a value in [0, 1].
std::string bar(double value, int width) {
  const double clamped = std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 0.0;
  const auto full = static_cast<std::size_t>(std::lround(clamped * width));
  return std::string(full, '#') + std::string(static_cast<std::size_t>(width) - full, '-');
}

} // namespace

Picture::Picture(std::string title, double range_deg)
    : title_(std::move(title)), range_deg_(range_deg) {}

void Picture::add(std::span<const ada4571_angle> angles) {
  for (const ada4571_angle &a : angles) {
    if (seen_ > 0 && std::isfinite(a.angle_deg) && std::isfinite(last_.angle_deg))
      travel_deg_ += difference(a.angle_deg, last_.angle_deg, range_deg_);
    if (seen_ > 0)
      travel_s_ += a.time_s - last_.time_s;
    unsound_ += a.status != 0;
    ++interval_samples_;
    ++seen_;
    last_ = a;
  }
}

std::string Picture::draw(int columns) {
  if (travel_s_ > 0) {
    speed_deg_per_s_ = travel_deg_ / travel_s_;
    rate_hz_ = static_cast<double>(interval_samples_) / travel_s_;
  }
  drawn_s_ = last_.time_s;
  travel_deg_ = travel_s_ = 0;
  interval_samples_ = 0;

  const int width = std::clamp(columns - 32, 10, 60);
  std::vector<std::string> lines{title_};
  for (std::string &row : dial(last_.angle_deg / range_deg_))
    lines.push_back("  " + row);
  lines.push_back(fmt::format("angle  {:9.3f} deg  |{}| {:g}", last_.angle_deg,
                              bar(last_.angle_deg / range_deg_, width), range_deg_));
  lines.push_back(
      fmt::format("radius {:9.3f}      |{}| 1.25", last_.radius, bar(last_.radius / 1.25, width)));
  lines.push_back(
      fmt::format("speed  {:9.1f} rpm  ({:.1f} deg/s)", speed_deg_per_s_ / 6, speed_deg_per_s_));
  lines.push_back(fmt::format("rate   {:9.0f} Hz   {} samples, {} lost, {} not sound", rate_hz_,
                              seen_, lost_, unsound_));
  lines.push_back("state  " + status_words(last_.status));
  std::string text;
  for (const std::string &line : lines)
    text += line.substr(0, static_cast<std::size_t>(std::max(columns, 1))) + "\033[K\n";
  return text;
}

std::string Picture::back_to_top() const {
  return fmt::format("\033[{}A", kLines);
}

} // namespace cli
