// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "common/live.h"
#include "common/progress.h"
#include "common/source_options.h"
#include "common/verb.h"

namespace cli {

namespace {

struct Options {
  SourceOptions source;
  double duration_s = 0;
  std::uint64_t samples = 0;
  std::string output;
};

Writer open_writer(const Source &source, const std::string &path) {
  const auto info = source_info(source);
  auto header = initialised(ada4571_recording_info_init);
  header.supply_v = info.supply_v;
  header.periods_per_turn = info.periods_per_turn;
  header.gain_control = info.gain_control;
  if (info.sample_rate_hz > 0)
    header.sample_rate_hz = info.sample_rate_hz;
  header.has_vtemp = info.has_vtemp;
  header.has_vdd = info.has_vdd;
  header.has_reference = info.has_reference;
  header.serial = info.serial;
  header.origin = info.description;
  return make<Writer>(ada4571_writer_open, path.c_str(),
                      static_cast<const ada4571_recording_info *>(&header));
}

/// Writes frames until as many, or as long, as was asked for.
class Recorder {
public:
  Recorder(const Options &options, Writer writer) : options_(options), writer_(std::move(writer)) {}

  /// False when there is enough.
  bool take(std::span<const ada4571_frame> frames) {
    if (frames.empty())
      return true;
    if (count_ == 0)
      first_s_ = frames.front().time_s;
    std::size_t n = frames.size();
    if (options_.samples > 0)
      n = static_cast<std::size_t>(std::min<std::uint64_t>(n, options_.samples - count_));
    if (options_.duration_s > 0) {
      const double end_s = first_s_ + options_.duration_s - kRounding_s;
      n = std::min<std::size_t>(
          n, std::find_if(frames.begin(), frames.end(), [end_s](const ada4571_frame &f) {
               return f.time_s >= end_s;
             }) - frames.begin());
    }
    check(ada4571_writer_write(writer_.get(), frames.data(), n));
    count_ += n;
    if (n > 0)
      last_s_ = frames[n - 1].time_s;
    progress_.show(fraction(), fmt::format("{} samples, {:.1f} s", count_, last_s_ - first_s_));
    return n == frames.size() && (options_.samples == 0 || count_ < options_.samples);
  }

  void finish() {
    progress_.clear();
    if (count_ == 0)
      throw Failure(kUnusable, "no sample came, so nothing was written");
    check(ada4571_writer_finish(writer_.get()));
    fmt::print(stderr, "{} samples, {:.3f} s\n", count_, last_s_ - first_s_);
  }

  bool complete() const { return fraction() >= 1; }
  std::uint64_t count() const { return count_; }

private:
  static constexpr double kRounding_s = 1e-9; ///< timestamps are in nanoseconds

  double fraction() const {
    return options_.samples > 0
               ? static_cast<double>(count_) / static_cast<double>(options_.samples)
               : (last_s_ - first_s_) / options_.duration_s;
  }

  const Options &options_;
  Writer writer_;
  Progress progress_;
  std::uint64_t count_ = 0;
  double first_s_ = 0, last_s_ = 0;
};

int run(const Options &options) {
  const Source source = open_source(options.source);
  Recorder recorder(options, open_writer(source, options.output));
  try {
    read_blocks(source,
                [&](std::span<const ada4571_frame> frames) { return recorder.take(frames); });
  } catch (const Failure &failure) {
    // What came before a device was lost is sound: keep it, and still say that it is short.
    if (recorder.count() > 0)
      recorder.finish();
    throw;
  }
  recorder.finish();
  report_losses(source);
  return kDone;
}

} // namespace

void add_record(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("record", "buffered capture to a file");
  auto options = std::make_shared<Options>();
  add_source_options(*verb, options->source);
  auto *length = verb->add_option_group("length", "how much; Ctrl-C ends it earlier");
  length->add_option("--duration", options->duration_s, "seconds")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  length->add_option("--samples", options->samples, "number of samples")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  length->require_option(1);
  verb->add_option("-o,--output", options->output,
                   "capture file: .csv, .sigmf-meta, or - for standard output")
      ->required()
      ->type_name("CAPTURE");
  example(*verb,
          "  iio-angle record --duration 10 -o capture.csv\n"
          "  iio-angle record -u ip:192.168.1.20 -d ad7380 --sin voltage0 --cos voltage1 \\\n"
          "      --samples 1000000 -o capture.sigmf-meta");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
