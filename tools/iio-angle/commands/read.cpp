// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cstdint>
#include <memory>
#include <vector>

#include "common/angle_text.h"
#include "common/latency.h"
#include "common/live.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/source_options.h"
#include "common/verb.h"

namespace cli {

namespace {

struct ReadOptions {
  SourceOptions source;
  std::string calibration, format = "text";
  bool dynamic = false, latency = false, reconnect = false;
  std::uint64_t samples = 0;
  std::vector<std::size_t> buffers;
};

AngleFormat format_of(const std::string &name) {
  return name == "csv" ? AngleFormat::csv : name == "json" ? AngleFormat::json : AngleFormat::text;
}

int run(const ReadOptions &options) {
  const Live live = open_live(options.source, options.calibration);
  const Source &source = live.source;
  const Model &model = live.model;
  mention_remainder(model);
  LiveAngles angles(model, options.dynamic);
  if (options.latency) {
    measure_latency(source, angles, options.buffers, options.samples, format_of(options.format));
    return kDone;
  }
  AngleText text(format_of(options.format), angles.range_deg());
  std::uint64_t left = options.samples;
  std::string lines;
  LiveReader reader(source, options.reconnect, patience(options.source));
  reader.run([&](std::span<const ada4571_frame> frames) {
    if (options.samples > 0 && frames.size() > left)
      frames = frames.first(static_cast<std::size_t>(left));
    left -= frames.size();
    lines.clear();
    text.append(lines, angles.convert(frames));
    put(lines);
    return options.samples == 0 || left > 0;
  });
  reader.report();
  return kDone;
}

} // namespace

void add_read(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("read", "angles, live, until stopped");
  auto options = std::make_shared<ReadOptions>();
  add_live_options(*verb, options->source, options->calibration);
  verb->add_flag("--dynamic", options->dynamic, "follow drifting offsets while it turns");
  verb->add_option("--format", options->format,
                   "text: ten lines a second; csv, json: a line a sample")
      ->capture_default_str()
      ->transform(one_of({"text", "csv", "json"}))
      ->type_name("");
  verb->add_option("--samples", options->samples, "stop after so many samples")
      ->transform(whole(1))
      ->type_name("N");
  auto *latency = verb->add_flag("--latency", options->latency,
                                 "measure the time from a sample to its angle, by buffer length");
  verb->add_option("--buffers", options->buffers,
                   "buffer lengths to measure (default: from 1 to what is in use)")
      ->delimiter(',')
      ->transform(whole(1))
      ->needs(latency)
      ->type_name("N,N...");
  add_reconnect_option(*verb, options->reconnect);
  example(*verb, "  iio-angle read --calibration sensor.toml\n"
                 "  iio-angle read -s wheel --dynamic --format json | jq .angle_deg\n"
                 "  iio-angle read -s wheel --latency --buffers 1,10,100\n"
                 "  iio-angle read --capture capture.csv --speed 0 --format csv\n"
                 "Speed 0 plays a capture as fast as it is read.");
  verb->callback([options, &action] {
    if (options->latency && options->source.replays())
      throw CLI::ExcludesError("--latency", "--capture"); // the age of a sample is a device's
    action = [options] { return run(*options); };
  });
}

} // namespace cli
