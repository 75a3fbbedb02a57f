// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <chrono>
#include <memory>

#include <fmt/format.h>

#include "common/live.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/source_options.h"
#include "common/verb.h"

namespace cli {

namespace {

struct RecordOptions {
  SourceOptions source;
  double duration_s = 0;
  std::uint64_t samples = 0;
  bool resume = false, reconnect = false;
  std::string output;
};

bool is_sigmf(const std::string &path) {
  return path.ends_with(".sigmf-meta") || path.ends_with(".sigmf-data");
}

/// A recording's file, and whether it takes the device's blocks or frames in volts.
struct Output {
  Writer writer;
  bool blocks = false;
};

/// The recording of the device's own words; nothing where device or recording are of another kind.
Writer open_blocks(const Source &source, const RecordOptions &options,
                   const ada4571_recording_info &header) {
  ada4571_writer *writer = nullptr;
  const ada4571_status status = ada4571_writer_open_blocks(
      options.output.c_str(), &header, source.get(), int{options.resume}, &writer);
  if (status != ADA4571_ERROR_UNSUPPORTED)
    check_usage(status);
  return Writer(writer);
}

Output open_output(const Source &source, const RecordOptions &options) {
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
  const ada4571_recording_info *wanted = &header;
  const char *path = options.output.c_str();
  if (!is_sigmf(options.output))
    return {make_as_asked<Writer>(ada4571_writer_open, path, wanted), false};
  if (Writer writer = open_blocks(source, options, header))
    return {std::move(writer), true};
  return {make_as_asked<Writer>(ada4571_writer_open_growing, path, wanted, int{options.resume}),
          false};
}

/// Writes frames until as many, or as long, as was asked for.
class Recorder {
public:
  Recorder(const RecordOptions &options, const Source &source)
      : options_(options), source_(source), output_(open_output(source, options)),
        bytes_a_frame_(converter_bytes(source_info(source))) {}

  /// Reads until there is enough, or until it has taken too long.
  void run(LiveReader &reader) {
    if (output_.blocks)
      reader.run_blocks([this](const DeviceBlock &block) { return take(block); });
    else
      reader.run([this](std::span<const ada4571_frame> frames) { return take(frames); });
  }

  void finish() {
    progress_.clear();
    if (count_ == 0)
      throw Failure(kUnusable, "no sample came, so nothing was written");
    check(ada4571_writer_finish(output_.writer.get()));
    note("{} samples, {:.3f} s\n", count_, last_s_ - first_s_);
  }

  /// What came before a device was lost is sound. What could not be written is no reason to say
  /// another thing than why.
  void keep() {
    if (count_ > 0 && writable_)
      finish();
  }

  /// Not as long as asked for, since the source has no more.
  void require_complete() const {
    // The last sample stands for a period, too: a second at 1 kHz ends at 0.999 s.
    const double covered_s = (last_s_ - first_s_) * static_cast<double>(count_) /
                             static_cast<double>(std::max<std::uint64_t>(count_ - 1, 1));
    if (!complete_ && (options_.samples > 0 || covered_s + kRounding_s < options_.duration_s))
      throw Failure(kUnusable,
                    fmt::format("the samples of the device were over after {} of them, {:.3f} s: "
                                "what was asked for is not there",
                                count_, last_s_ - first_s_));
  }

  /// Not as long as asked for, though the time for it is over by our own clock.
  void require_in_time() const {
    if (!complete_ && late())
      throw Failure(
          kUnusable,
          fmt::format("ended by this machine's clock: {:.1f} s after the first sample the "
                      "device had sent {:.3f} s of {:g} s",
                      seconds_since_first(), last_s_ - first_s_, options_.duration_s));
  }

private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kRounding_s = 1e-9; ///< timestamps are in nanoseconds
  /// What comes late, by buffers, slow lines and a clock that is off, is still waited for.
  static constexpr double kLate = 1.1, kLate_s = 5;

  bool take(std::span<const ada4571_frame> frames) {
    return take(
        frames.size(), [&](std::size_t i) { return frames[i].time_s; },
        [&](std::size_t n) {
          return ada4571_writer_write(output_.writer.get(), frames.data(), n);
        });
  }

  bool take(const DeviceBlock &block) {
    const auto time_s = [&](std::size_t i) {
      if (i + 1 == block.count)
        return block.last_s;
      double time = block.first_s - block.shift_s;
      if (i > 0)
        check(ada4571_source_block_time(source_.get(), i, &time));
      return time + block.shift_s;
    };
    return take(block.count, time_s, [&](std::size_t n) {
      return ada4571_writer_write_block(output_.writer.get(), source_.get(), n, block.shift_s);
    });
  }

  /// So many frames of these times, which do not decrease. False when there is enough, or when it
  /// has taken too long.
  template <class Time, class Write> bool take(std::size_t count, Time time_s, Write write) {
    if (count == 0)
      return !late();
    if (count_ == 0) {
      first_s_ = time_s(0);
      began_ = Clock::now();
    }
    const std::size_t n = wanted_of(count, time_s);
    writable_ = false;
    check(write(n));
    writable_ = true;
    count_ += n;
    if (n > 0)
      last_s_ = time_s(n - 1);
    show_progress();
    complete_ = n < count || (options_.samples > 0 && count_ == options_.samples);
    return !complete_ && !late();
  }

  template <class Time> std::size_t wanted_of(std::size_t count, Time time_s) const {
    std::size_t n = count;
    if (options_.samples > 0)
      n = static_cast<std::size_t>(std::min<std::uint64_t>(n, options_.samples - count_));
    const double end_s = first_s_ + options_.duration_s - kRounding_s;
    if (!(options_.duration_s > 0) || n == 0 || time_s(n - 1) < end_s)
      return n;
    std::size_t low = 0; // frames below are wanted, from n on they are not
    while (low < n) {
      const std::size_t middle = low + (n - low) / 2;
      if (time_s(middle) < end_s)
        low = middle + 1;
      else
        n = middle;
    }
    return n;
  }

  double seconds_since_first() const {
    return std::chrono::duration<double>(Clock::now() - began_).count();
  }

  bool late() const {
    return options_.duration_s > 0 && count_ > 0 &&
           seconds_since_first() > kLate * options_.duration_s + kLate_s;
  }

  void show_progress() {
    if (!progress_.due()) // no word, no allocation
      return;
    const double length_s = last_s_ - first_s_;
    const double megabytes = static_cast<double>(count_) * bytes_a_frame_ / 1e6;
    const std::string what = fmt::format("{} samples, {:.1f} s, {:.1f} MB/s", count_, length_s,
                                         megabytes / std::max(seconds_since_first(), 1.0));
    if (options_.samples > 0)
      progress_.show(static_cast<double>(count_) / static_cast<double>(options_.samples), what);
    else if (options_.duration_s > 0)
      progress_.show(length_s / options_.duration_s, what);
    else
      progress_.show(what);
  }

  const RecordOptions &options_;
  const Source &source_;
  Output output_;
  double bytes_a_frame_; ///< as the converter gives them
  Progress progress_;
  std::uint64_t count_ = 0;
  bool complete_ = false, writable_ = true;
  double first_s_ = 0, last_s_ = 0;
  Clock::time_point began_;
};

/// Without a sample rate nothing can stand in for timestamps that make no sense.
void require_times(const Source &source, const Losses &losses) {
  if (source_info(source).sample_rate_hz <= 0 && losses.bad_times * 100 > losses.frames)
    throw Failure(kUnusable, "the device's timestamps make no sense, and its sample rate is not "
                             "known: the times of this recording cannot be used");
}

int run(const RecordOptions &options) {
  const Source source = open_source(options.source);
  Recorder recorder(options, source);
  // To the end of the verb: what was captured is kept, however often a signal comes.
  LiveReader reader(source, options.reconnect);
  try {
    recorder.run(reader);
  } catch (const Failure &) {
    recorder.keep();
    throw;
  }
  recorder.finish();
  reader.report();
  require_times(source, reader.losses());
  if (reader.ended())
    recorder.require_complete();
  recorder.require_in_time();
  return kDone;
}

} // namespace

void add_record(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("record", "buffered capture to a file");
  auto options = std::make_shared<RecordOptions>();
  add_source_options(*verb, options->source);
  auto *length =
      verb->add_option_group("length", "default: until Ctrl-C, which also ends it earlier");
  auto *duration = length->add_option("--duration", options->duration_s, "seconds");
  duration->transform(positive("s"))->type_name("S");
  length->add_option("--samples", options->samples, "number of samples")
      ->excludes(duration)
      ->transform(whole(1))
      ->type_name("N");
  verb->add_option("-o,--output", options->output,
                   "capture file: .csv, .sigmf-meta, or - for standard output")
      ->required()
      ->transform(capture_name())
      ->type_name("CAPTURE");
  verb->add_flag("--continue", options->resume,
                 "go on in the SigMF recording of that name, after a gap, if there is one");
  add_reconnect_option(*verb, options->reconnect);
  example(
      *verb,
      "  iio-angle record --duration 10s -o capture.csv\n"
      "  iio-angle record -u ip:192.168.1.20 -d ad7380 --sin voltage0 --cos voltage1 \\\n"
      "      --samples 1000000 -o capture.sigmf-meta\n"
      "A .csv appears when it is complete. A SigMF recording is on the disk from its first sample\n"
      "on, and a crash costs a second at most: use it for long recordings.");
  verb->callback([options, &action] {
    if (options->resume && !is_sigmf(options->output))
      throw CLI::ValidationError("--continue",
                                 "only a SigMF recording (.sigmf-meta) can be continued");
    action = [options] { return run(*options); };
  });
}

} // namespace cli
