// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/watch_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>

namespace cli {

namespace {

constexpr int kLabel = 9; ///< columns of the numbers at an axis
constexpr double kLeastAngle_deg = 0.02, kLeastRadius = 0.002;

using BandOf = std::function<Band(std::size_t)>;

/// What an axis covers, a little more than the values.
Band covering(const BandOf &values, double least) {
  Band all;
  for (std::size_t i = 0; i < WatchHistory::kBins; ++i)
    all.add(values(i));
  if (all.empty())
    return {0.0, 1.0};
  const double middle = (all.low + all.high) / 2;
  const double half = std::max(0.55 * (all.high - all.low), least / 2);
  return {middle - half, middle + half};
}

class Chart {
public:
  Chart(Screen &screen, const Place &place, Band axis)
      : screen_(screen), place_(place), axis_(axis),
        dots_(place.rows - 1, place.columns - kLabel, screen.unicode()) {}

  void name(const std::string &text) {
    screen_.put(place_.row, place_.column + kLabel, text, Style::strong);
  }

  /// From `low` to `high` in the column of a bin.
  void bar(std::size_t bin, double low, double high) {
    const int x = static_cast<int>(bin * static_cast<std::size_t>(dots_.width()) /
                                   WatchHistory::kBins);
    for (int y = height_of(high); y <= height_of(low); ++y)
      dots_.set(x, y);
  }

  void values(const BandOf &of) {
    for (std::size_t i = 0; i < WatchHistory::kBins; ++i)
      if (const Band band = of(i); !band.empty())
        bar(i, band.low, band.high);
  }

  /// `number` turns an end of the axis into its label.
  void finish(const std::function<std::string(double)> &number) {
    const int rows = place_.rows - 1;
    for (int row = 0; row < rows; ++row) {
      screen_.put(place_.row + 1 + row, place_.column + kLabel - 1, "|", Style::faint);
      for (int column = 0; column < place_.columns - kLabel; ++column)
        screen_.put(place_.row + 1 + row, place_.column + kLabel + column, dots_.at(row, column),
                    Style::good);
    }
    label(1, number(axis_.high));
    if (rows > 4)
      label(1 + rows / 2, number((axis_.low + axis_.high) / 2));
    label(rows, number(axis_.low));
  }

private:
  int height_of(double value) const {
    const double share = (axis_.high - value) / (axis_.high - axis_.low);
    const double y = std::floor(share * dots_.height());
    return static_cast<int>(std::clamp(y, 0.0, dots_.height() - 1.0));
  }

  void label(int row, const std::string &text) {
    screen_.put(place_.row + row, place_.column, fmt::format("{:>{}}", text, kLabel - 1));
  }

  Screen &screen_;
  Place place_;
  Band axis_;
  Dots dots_;
};

double wrapped(double angle, double range) {
  const double w = angle - range * std::floor(angle / range);
  return w < range ? w : 0.0;
}

/// The whole range, each bar broken where the angle leaps from its end to its beginning.
void draw_turning(Chart &chart, const BandOf &angle, double range) {
  for (std::size_t i = 0; i < WatchHistory::kBins; ++i) {
    const Band band = angle(i);
    if (band.empty())
      continue;
    const double low = wrapped(band.low, range), high = wrapped(band.high, range);
    if (band.high - band.low >= range) {
      chart.bar(i, 0.0, range);
    } else if (low <= high) {
      chart.bar(i, low, high);
    } else {
      chart.bar(i, low, range);
      chart.bar(i, 0.0, high);
    }
  }
}

void draw_angle(Screen &screen, const WatchHistory &history, double zero_deg, const Place &place) {
  const BandOf angle = [&](std::size_t i) {
    const Band band = history.angle(i);
    return Band{band.low - zero_deg, band.high - zero_deg};
  };
  const double range = history.range_deg();
  const Band seen = covering(angle, kLeastAngle_deg);
  const bool turning = seen.high - seen.low > range / 2;
  Chart chart(screen, place, turning ? Band{0.0, range} : seen);
  chart.name("angle, deg");
  if (turning)
    draw_turning(chart, angle, range);
  else
    chart.values(angle);
  chart.finish([&](double value) {
    return fmt::format("{:.{}f}", turning ? value : wrapped(value, range), turning ? 0 : 3);
  });
}

void draw_radius(Screen &screen, const WatchHistory &history, const Place &place) {
  const BandOf radius = [&](std::size_t i) { return history.radius(i); };
  Chart chart(screen, place, covering(radius, kLeastRadius));
  chart.name("radius (1: as calibrated)");
  chart.values(radius);
  chart.finish([](double value) { return fmt::format("{:.4f}", value); });
}

void draw_time_axis(Screen &screen, const Place &place) {
  const int columns = place.columns - kLabel;
  const int at = place.column + kLabel;
  screen.put(place.row, at, fmt::format("-{:g} s", WatchHistory::kSeconds));
  screen.put(place.row, at + columns / 2 - 2, fmt::format("-{:g} s", WatchHistory::kSeconds / 2));
  screen.put(place.row, at + columns - 3, "now");
}

} // namespace

void draw_charts(Screen &screen, const WatchHistory &history, double zero_deg, const Place &place) {
  const int charts = place.rows - 1, upper = (charts + 1) / 2;
  draw_angle(screen, history, zero_deg, {place.row, place.column, upper, place.columns});
  draw_radius(screen, history,
              {place.row + upper, place.column, charts - upper, place.columns});
  draw_time_axis(screen, {place.row + charts, place.column, 1, place.columns});
}

} // namespace cli
