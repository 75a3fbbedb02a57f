// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <memory>
#include <vector>

#include "common/angle_text.h"
#include "common/file_roles.h"
#include "common/live.h"
#include "common/progress.h"
#include "common/verb.h"

namespace cli {

namespace {

struct Options {
  std::string calibration, capture, output;
  bool dynamic = false;
};

constexpr std::size_t kBlock = 16384;

std::size_t sample_count(const Recording &capture) {
  auto info = initialised(ada4571_recording_info_init);
  check(ada4571_recording_get_info(capture.get(), &info));
  return info.samples;
}

/// Hands the capture's angles over, block by block.
template <class Take>
void for_each_block(const Recording &capture, const Model &model, bool dynamic, Take take) {
  const std::size_t samples = sample_count(capture);
  if (!dynamic) {
    // The whole at once: the speed at a sample comes from both of its sides.
    const auto converter = make<Converter>(ada4571_converter_new, model.get());
    std::vector<ada4571_angle> angles(samples);
    check(ada4571_converter_recording(converter.get(), capture.get(), angles.data()));
    for (std::size_t first = 0; first < samples; first += kBlock)
      take(std::span(angles).subspan(first, std::min(kBlock, samples - first)));
    return;
  }
  LiveAngles tracker(model, true);
  std::vector<ada4571_frame> frames(kBlock);
  for (std::size_t first = 0; first < samples; first += kBlock) {
    std::size_t count = 0;
    check(ada4571_recording_read(capture.get(), first, frames.data(), kBlock, &count));
    take(tracker.convert({frames.data(), count}));
  }
}

int run(const Options &options) {
  const auto model = make<Model>(ada4571_model_load, options.calibration.c_str());
  const auto capture = make<Recording>(ada4571_recording_open, options.capture.c_str());
  FileRoles().reads(options.capture, capture).reads(options.calibration).writes(options.output);
  mention_remainder(model);
  const auto out = make<File>(ada4571_file_open, options.output.c_str());
  AngleText text(AngleFormat::csv, angle_range_deg(model));
  Progress progress;
  const double samples = static_cast<double>(sample_count(capture));
  double done = 0;
  std::string lines;
  for_each_block(capture, model, options.dynamic, [&](std::span<const ada4571_angle> angles) {
    lines.clear();
    text.append(lines, angles);
    check(ada4571_file_write(out.get(), lines.data(), lines.size()));
    done += static_cast<double>(angles.size());
    progress.show(done / samples, "converting");
  });
  check(ada4571_file_commit(out.get()));
  return kDone;
}

} // namespace

void add_convert(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("convert", "angles of a capture");
  auto options = std::make_shared<Options>();
  verb->add_option("--calibration", options->calibration, "calibration or model file")
      ->required()
      ->type_name("FILE");
  verb->add_flag("--dynamic", options->dynamic, "follow drifting offsets while it turns");
  verb->add_option("CAPTURE", options->capture, "capture file, or - for standard input")
      ->type_name("")
      ->required();
  verb->add_option("-o,--output", options->output,
                   "CSV file with time_s,angle_deg,radius,status, or - for standard output")
      ->required()
      ->type_name("OUT.csv");
  example(*verb,
          "  iio-angle convert --calibration sensor.toml capture.csv -o angles.csv\n"
          "Columns: angle_deg is mechanical, in [0, 360/periods); radius is relative to the\n"
          "calibrated amplitude; status is 0 for a sound sample, else the sum of 1 radius out of\n"
          "its band, 2 at a rail, 4 invalid, 8 samples lost before this one.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
