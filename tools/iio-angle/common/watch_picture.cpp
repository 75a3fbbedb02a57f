// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/watch_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "common/angle_text.h"
#include "common/watch_chart.h"

namespace cli {

namespace {

constexpr int kLeftLabel = 4, kRightLabel = 2;
/// The rest of the columns is the charts'.
constexpr double kDialShare = 0.4;
/// VTEMP over VDD at 0 degrees Celsius and its rise a degree, from a published graph of the part: good
/// for some degrees.
constexpr double kVtempAtZero = 0.233, kVtempPerDegree = 0.00333;

/// A number, or a dash where there is none yet.
std::string number(double value, int decimals, const char *unit) {
  return std::isfinite(value) ? fmt::format("{:.{}f}{}", value, decimals, unit) : "-";
}

class Drawing {
public:
  Drawing(Screen &screen, const WatchHistory &history, const WatchState &state)
      : screen_(screen), history_(history), state_(state) {}

  void draw() {
    title();
    numbers();
    ambiguity();
    const int top = 3, rows = screen_.rows() - 5;
    const int across = static_cast<int>(kDialShare * screen_.columns()) - kLeftLabel - kRightLabel;
    const int columns = dial(top, std::min(rows, 2 + across / 2));
    draw_charts(screen_, history_, state_.zero_deg.value_or(0.0),
                {top, columns + 1, rows, screen_.columns() - columns - 2});
    counters(screen_.rows() - 2);
    keys(screen_.rows() - 1);
  }

private:
  double range() const { return history_.range_deg(); }

  /// From the zero, in [0, range).
  double shown(double angle_deg) const {
    const double angle = angle_deg - state_.zero_deg.value_or(0.0);
    const double wrapped = angle - range() * std::floor(angle / range());
    return wrapped < range() ? wrapped : 0.0;
  }

  void title() {
    const std::string what = state_.away    ? "AWAY: trying again every second"
                             : state_.ended ? "END of the recording"
                             : state_.held  ? "HELD"
                                            : fmt::format("{} samples", history_.samples());
    screen_.put(0, 0, state_.title, Style::strong);
    screen_.put(0, std::max(0, screen_.columns() - static_cast<int>(what.size()) - 1), " " + what,
                state_.away || state_.ended || state_.held ? Style::bad : Style::faint);
  }

  void numbers() {
    const ada4571_angle &last = history_.last();
    const bool none = history_.empty() || !std::isfinite(last.angle_deg);
    const std::string words = history_.empty() ? "nothing yet" : status_words(last.status);
    const std::string angle = none ? "-" : fmt::format("{:8.3f} deg", shown(last.angle_deg));
    screen_.put(1, 0, "angle " + angle, Style::accent);
    screen_.put(1, 20, fmt::format("radius {:<9}", none ? "-" : number(last.radius, 4, "")));
    screen_.put(1, 38, fmt::format("speed {:<16}",
                                   number(history_.speed_deg_per_s() / 6, 2, " rpm")));
    screen_.put(1, 62, words, words == "ok" ? Style::good : Style::bad);
  }

  /// The directions that the sensor cannot tell apart.
  void ambiguity() {
    const ada4571_angle &last = history_.last();
    const int periods = state_.periods_per_turn;
    std::string text = "within a turn: nothing is left open";
    if (periods > 1) {
      text = fmt::format("known within {:g} deg", range());
      if (periods == 2 && !history_.empty() && std::isfinite(last.angle_deg))
        text += fmt::format(": the shaft is at {:.3f} or {:.3f}", shown(last.angle_deg),
                            shown(last.angle_deg) + range());
    }
    if (state_.zero_deg)
      text += fmt::format("; zero at {:.3f} deg", *state_.zero_deg);
    screen_.put(2, 0, text, Style::faint);
  }

  /// The turn with zero at the right, growing counterclockwise. Gives its columns.
  int dial(int top, int rows) {
    const int inside = rows - 2, across = 2 * inside;
    Dots circle(inside, across, screen_.unicode()), hands(inside, across, screen_.unicode());
    const double x = (circle.width() - 1) / 2.0, y = (circle.height() - 1) / 2.0;
    for (int i = 0; i < 16 * inside; ++i) {
      const double a = 2 * std::numbers::pi * i / (16 * inside);
      circle.set(static_cast<int>(std::lround(x + x * std::cos(a))),
                 static_cast<int>(std::lround(y - y * std::sin(a))));
    }
    constexpr int kMostHands = 8; // more fill the dial: then the first period's stands alone
    const int hands_shown = state_.periods_per_turn <= kMostHands ? state_.periods_per_turn : 1;
    if (!history_.empty() && std::isfinite(history_.last().angle_deg))
      for (int i = 0; i < hands_shown; ++i) {
        const double a = (shown(history_.last().angle_deg) + i * range()) * std::numbers::pi / 180;
        hands.line(x, y, x + 0.85 * x * std::cos(a), y - 0.85 * y * std::sin(a));
      }
    for (int row = 0; row < inside; ++row)
      for (int column = 0; column < across; ++column) {
        const std::string hand = hands.at(row, column), ring = circle.at(row, column);
        screen_.put(top + 1 + row, kLeftLabel + column, hand.empty() ? ring : hand,
                    hand.empty() ? Style::faint : Style::accent);
      }
    screen_.put(top, kLeftLabel + inside - 1, "90");
    screen_.put(top + rows - 1, kLeftLabel + inside - 1, "270 deg");
    screen_.put(top + 1 + inside / 2, 0, "180");
    screen_.put(top + 1 + inside / 2, kLeftLabel + across + 1, "0");
    return kLeftLabel + across + kRightLabel;
  }

  std::string temperature() const {
    const ada4571_frame &frame = history_.last_frame();
    if (history_.empty() || !std::isfinite(frame.vtemp_v))
      return "VTEMP not recorded";
    const double supply = std::isfinite(frame.vdd_v) ? frame.vdd_v : state_.supply_v;
    return fmt::format("VTEMP {:.3f} V (~{:.0f} C)", frame.vtemp_v,
                       (frame.vtemp_v / supply - kVtempAtZero) / kVtempPerDegree);
  }

  void counters(int row) {
    const int decimals = history_.rate_hz() < 100 ? 1 : 0;
    const std::string text = fmt::format(
        "lost {}  unsound {}  {}  noise {}  {}", state_.lost, history_.unsound(),
        number(history_.rate_hz(), decimals, " Hz"),
        number(history_.angle_noise_deg(), 4, " deg"), temperature());
    screen_.put(row, 0, text, state_.lost > 0 ? Style::bad : Style::plain);
  }

  void keys(int row) {
    const std::string text = "q quit   space hold   z zero here   a absolute";
    screen_.put(row, 0, text, Style::strong);
    screen_.put(row, static_cast<int>(text.size()) + 3, state_.remark, Style::faint);
  }

  Screen &screen_;
  const WatchHistory &history_;
  const WatchState &state_;
};

} // namespace

void draw_watch(Screen &screen, const WatchHistory &history, const WatchState &state) {
  screen.clear();
  if (screen.rows() < kLeastRows || screen.columns() < kLeastColumns)
    screen.put(0, 0, fmt::format("too small: make it {}x{}, q quits", kLeastColumns, kLeastRows));
  else
    Drawing(screen, history, state).draw();
  screen.show();
}

} // namespace cli
