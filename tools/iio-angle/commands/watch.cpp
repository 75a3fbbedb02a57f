// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cstdint>
#include <cstdlib>
#include <memory>

#include <sys/ioctl.h>
#include <unistd.h>

#include "common/angle_text.h"
#include "common/live.h"
#include "common/print.h"
#include "common/source_options.h"
#include "common/verb.h"
#include "common/watch_picture.h"

namespace cli {

namespace {

struct Options {
  SourceOptions source;
  std::string calibration;
  bool dynamic = false, reconnect = true;
};

bool is_terminal() {
  const char *term = getenv("TERM");
  return isatty(STDOUT_FILENO) && term != nullptr && std::string_view(term) != "dumb";
}

int terminal_columns() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Redraws the picture in place, at most twenty times a second of sample time.
void draw_live(const Source &source, LiveReader &reader, LiveAngles &angles) {
  Picture picture(source_info(source).description, angles.range_deg());
  bool drawn = false;
  reader.run([&](std::span<const ada4571_frame> frames) {
    picture.add(angles.convert(frames));
    if (reader.away()) // what was said of that stays above the picture
      drawn = false;
    if (picture.due()) {
      const Losses losses = reader.losses();
      picture.set_lost(losses.samples + losses.missed);
      put((drawn ? picture.back_to_top() : std::string()) + picture.draw(terminal_columns()));
      drawn = true;
    }
    return true;
  });
}

/// Not a terminal: the same as `read`, lines that a log can hold.
void print_live(LiveReader &reader, LiveAngles &angles) {
  AngleText text(AngleFormat::text, angles.range_deg());
  reader.run([&](std::span<const ada4571_frame> frames) {
    std::string lines;
    text.append(lines, angles.convert(frames));
    put(lines);
    return true;
  });
}

int run(const Options &options) {
  const Source source = open_source(options.source);
  const Model model = live_model(source, options.calibration);
  mention_remainder(model);
  LiveAngles angles(model, options.dynamic);
  LiveReader reader(source, options.reconnect);
  if (is_terminal())
    draw_live(source, reader, angles);
  else
    print_live(reader, angles);
  reader.report();
  return kDone;
}

} // namespace

void add_watch(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("watch", "angles as a live picture in the terminal");
  auto options = std::make_shared<Options>();
  add_source_options(*verb, options->source);
  verb->add_option("--calibration", options->calibration,
                   "calibration or model file (default: what -s or the driver has)")
      ->type_name("FILE");
  verb->add_flag("--dynamic", options->dynamic, "follow drifting offsets while it turns");
  add_reconnect_option(*verb, options->reconnect);
  example(*verb, "  iio-angle watch --calibration sensor.toml");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
