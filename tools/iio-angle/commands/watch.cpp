// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>

#include <sys/ioctl.h>
#include <unistd.h>

#include "common/angle_text.h"
#include "common/live.h"
#include "common/print.h"
#include "common/screen.h"
#include "common/source_options.h"
#include "common/verb.h"
#include "common/watch_picture.h"

namespace cli {

namespace {

struct WatchOptions {
  SourceOptions source;
  std::string calibration;
  bool dynamic = false, reconnect = true;
};

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPicture{50}, kEndPoll{50};

/// A picture that is too small to be read is none; a terminal that does not know its size is as usual.
void require_room() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0)
    return;
  if (size.ws_col < kLeastColumns || size.ws_row < kLeastRows)
    throw Failure(kUnusable, fmt::format("the terminal has {}x{} characters, watch needs {}x{}; "
                                         "`iio-angle read` needs no room",
                                         size.ws_col, size.ws_row, kLeastColumns, kLeastRows));
}

/// The picture and its keys, from sample to sample.
class Watcher {
public:
  Watcher(Screen &screen, LiveReader &reader, LiveAngles &angles, WatchState state)
      : screen_(screen), reader_(reader), angles_(angles), state_(std::move(state)),
        history_(angles.range_deg()) {}

  /// False when the user has enough.
  bool take(std::span<const ada4571_frame> frames) {
    history_.add(frames, angles_.convert(frames));
    return step();
  }

  /// A recording that has ended stays to be looked at.
  void stay() {
    state_.ended = true;
    while (!left_ && !StopSignal::requested() && step())
      std::this_thread::sleep_for(kEndPoll);
  }

private:
  bool step() {
    bool pressed = false;
    for (int key = screen_.key(); key != Screen::kNoKey; key = screen_.key()) {
      press(key);
      pressed = true;
    }
    if (pressed || Clock::now() - drawn_ >= kPicture)
      draw();
    return !left_;
  }

  void press(int key) {
    const WatchHistory &seen = held_ ? *held_ : history_;
    if (key == 'q' || key == 'Q')
      left_ = true;
    else if (key == ' ')
      held_ = held_ ? std::nullopt : std::optional(history_);
    else if (key == 'z' && std::isfinite(seen.last().angle_deg) && !seen.empty())
      state_.zero_deg = seen.last().angle_deg;
    else if (key == 'a')
      state_.zero_deg.reset();
  }

  void draw() {
    const Losses losses = reader_.losses();
    state_.lost = losses.samples + losses.missed;
    state_.away = reader_.away();
    state_.held = held_.has_value();
    state_.remark = screen_.last_remark();
    draw_watch(screen_, held_ ? *held_ : history_, state_);
    drawn_ = Clock::now();
  }

  Screen &screen_;
  LiveReader &reader_;
  LiveAngles &angles_;
  WatchState state_;
  WatchHistory history_;
  std::optional<WatchHistory> held_; ///< as it was when it was held
  Clock::time_point drawn_{};
  bool left_ = false;
};

void draw_live(Screen &screen, const Source &source, LiveReader &reader, LiveAngles &angles) {
  const auto info = source_info(source);
  WatchState state;
  state.title = info.description;
  state.periods_per_turn = static_cast<int>(std::lround(360 / angles.range_deg()));
  state.supply_v = info.supply_v;
  Watcher watcher(screen, reader, angles, std::move(state));
  reader.run([&](std::span<const ada4571_frame> frames) { return watcher.take(frames); });
  watcher.stay();
}

/// Lines instead of the picture, for a terminal that has a reason.
void mention_no_picture() {
  if (isatty(STDOUT_FILENO) == 0)
    return;
  const char *type = std::getenv("TERM");
  if (type == nullptr || *type == '\0')
    note("TERM is not set: printing lines instead of the picture\n");
  else
    note("a terminal of type '{}' cannot show the picture: printing lines\n", type);
}

/// Not a terminal, or none to draw on: the same as `read`, lines that a log can hold.
void print_live(LiveReader &reader, LiveAngles &angles) {
  AngleText text(AngleFormat::text, angles.range_deg());
  reader.run([&](std::span<const ada4571_frame> frames) {
    std::string lines;
    text.append(lines, angles.convert(frames));
    put(lines);
    return true;
  });
}

int run(const WatchOptions &options) {
  const Live live = open_live(options.source, options.calibration);
  const Source &source = live.source;
  const Model &model = live.model;
  mention_remainder(model);
  LiveAngles angles(model, options.dynamic);
  if (Screen::is_there())
    require_room();
  LiveReader reader(source, options.reconnect, patience(options.source));
  // After the reader: ncurses leaves signals alone that are handled already.
  if (const auto screen = Screen::open()) {
    draw_live(*screen, source, reader, angles);
  } else {
    mention_no_picture();
    print_live(reader, angles);
  }
  reader.report();
  return kDone;
}

} // namespace

void add_watch(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("watch", "angles as a live picture in the terminal");
  auto options = std::make_shared<WatchOptions>();
  add_live_options(*verb, options->source, options->calibration);
  verb->add_flag("--dynamic", options->dynamic, "follow drifting offsets while it turns");
  add_reconnect_option(*verb, options->reconnect);
  example(*verb, "  iio-angle watch --calibration sensor.toml\n"
                 "  iio-angle watch --capture capture.csv --speed 0.1\n"
                 "Keys: q quits, space holds the picture, z counts angles from here, a from the\n"
                 "sensor's own zero. NO_COLOR is respected.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
