// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/latency.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "common/print.h"
#include "common/source_options.h"
#include "common/stop.h"

namespace cli {

namespace {

constexpr double kFinest_s = 1e-6;
constexpr double kSeconds = 2.0;
constexpr std::uint64_t kBuffers = 50;
/// The first buffers wait for the converter to start and are not counted.
constexpr std::uint64_t kStartBuffers = 3;
constexpr std::size_t kBarWidth = 50;

double now_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Measurement {
  std::size_t buffer_frames = 0;
  double buffer_s = 0; ///< 0 where the rate is unknown
  LatencyHistogram latency;
  double wake_ups_per_s = 0, processor_share = 0;

  double worst_per_buffer() const { return latency.worst_s() / buffer_s; }
};

/// Age of the frames of a block, by the clock of the device's timestamps.
class Ages {
public:
  explicit Ages(const Source &source)
      : source_(source), clock_(source_info(source).timestamp_clock) {
    if (clock_ < 0)
      throw Failure(kUnusable, "the samples have no timestamps of a clock of this machine: enable "
                               "the channel timestamp, and measure where the converter is");
  }
  void add(std::span<const ada4571_angle> angles, LatencyHistogram &latency) {
    timespec now{};
    clock_gettime(clock_, &now);
    if (first_ns_ == 0) {
      auto statistics = initialised(ada4571_source_statistics_init);
      check(ada4571_source_get_statistics(source_.get(), &statistics));
      first_ns_ = statistics.first_timestamp_ns;
    }
    const double since_first_s =
        1e-9 * static_cast<double>(now.tv_sec * std::int64_t{1000000000} + now.tv_nsec - first_ns_);
    for (const ada4571_angle &angle : angles)
      latency.add(since_first_s - angle.time_s);
  }

private:
  const Source &source_;
  clockid_t clock_;
  std::int64_t first_ns_ = 0;
};

Measurement measure(const Source &source, LiveAngles &angles, std::size_t frames,
                    std::uint64_t samples) {
  check(ada4571_source_set_buffer(source.get(), frames));
  const ada4571_source_info info = source_info(source);
  Measurement m;
  m.buffer_frames = info.buffer_frames;
  m.buffer_s =
      info.sample_rate_hz > 0 ? static_cast<double>(m.buffer_frames) / info.sample_rate_hz : 0.0;
  if (samples == 0)
    samples = std::max(kBuffers * m.buffer_frames,
                       static_cast<std::uint64_t>(std::ceil(kSeconds * info.sample_rate_hz)));
  const std::uint64_t start = kStartBuffers * m.buffer_frames;
  Ages ages(source);
  std::uint64_t seen = 0, wake_ups = 0;
  double began_s = 0, began_cpu_s = 0;
  LiveReader reader(source, false);
  reader.run([&](std::span<const ada4571_frame> block) {
    const auto converted = angles.convert(block);
    if (block.empty())
      return true;
    if (seen >= start) {
      ages.add(converted, m.latency);
      ++wake_ups;
    } else {
      began_s = now_s(CLOCK_MONOTONIC);
      began_cpu_s = now_s(CLOCK_PROCESS_CPUTIME_ID);
    }
    seen += block.size();
    return seen < start + samples;
  });
  if (reader.ended())
    throw Failure(kUnusable, "the samples of the device were over before the latency was measured: "
                             "fewer --samples may do");
  const double elapsed_s = now_s(CLOCK_MONOTONIC) - began_s;
  m.wake_ups_per_s = static_cast<double>(wake_ups) / elapsed_s;
  m.processor_share = (now_s(CLOCK_PROCESS_CPUTIME_ID) - began_cpu_s) / elapsed_s;
  return m;
}

std::string ratio(const Measurement &m) {
  return m.buffer_s > 0 ? fmt::format("{:.2f}", m.worst_per_buffer()) : "-";
}

void append_text(std::string &out, const Measurement &m) {
  const auto ms = [](double s) { return 1e3 * s; };
  fmt::format_to(std::back_inserter(out),
                 "buffer of {} samples, {:.3f} ms: latency {:.3f} ms median, {:.3f} ms 99 %, "
                 "{:.3f} ms worst ({} of the buffer); {:.0f} wake-ups a second, {:.1f} % of a "
                 "processor\n",
                 m.buffer_frames, ms(m.buffer_s), ms(m.latency.quantile_s(0.5)),
                 ms(m.latency.quantile_s(0.99)), ms(m.latency.worst_s()), ratio(m),
                 m.wake_ups_per_s, 100 * m.processor_share);
  const std::vector<double> shares = m.latency.octaves();
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] > 0)
      fmt::format_to(std::back_inserter(out), "  {:>11.3f} ms  {:5.1f} %  {}\n",
                     ms(LatencyHistogram::octave_s(i)), 100 * shares[i],
                     std::string(static_cast<std::size_t>(std::ceil(shares[i] * kBarWidth)), '#'));
}

constexpr const char *kCsvHeader = "buffer_frames,buffer_s,samples,median_s,p99_s,worst_s,"
                                   "worst_per_buffer,wake_ups_per_s,processor_share\n";

void append_csv(std::string &out, const Measurement &m) {
  fmt::format_to(std::back_inserter(out), "{},{:.9f},{},{:.9f},{:.9f},{:.9f},{},{:.3f},{:.6f}\n",
                 m.buffer_frames, m.buffer_s, m.latency.count(), m.latency.quantile_s(0.5),
                 m.latency.quantile_s(0.99), m.latency.worst_s(), m.buffer_s > 0 ? ratio(m) : "nan",
                 m.wake_ups_per_s, m.processor_share);
}

void append_json(std::string &out, const Measurement &m) {
  std::string bins;
  const std::vector<double> shares = m.latency.octaves();
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] > 0)
      fmt::format_to(std::back_inserter(bins), "{}{{\"from_s\":{:.9f},\"share\":{:.6f}}}",
                     bins.empty() ? "" : ",", LatencyHistogram::octave_s(i), shares[i]);
  fmt::format_to(std::back_inserter(out),
                 "{{\"buffer_frames\":{},\"buffer_s\":{:.9f},\"samples\":{},\"median_s\":{:.9f},"
                 "\"p99_s\":{:.9f},\"worst_s\":{:.9f},\"worst_per_buffer\":{},"
                 "\"wake_ups_per_s\":{:.3f},\"processor_share\":{:.6f},\"histogram\":[{}]}}\n",
                 m.buffer_frames, m.buffer_s, m.latency.count(), m.latency.quantile_s(0.5),
                 m.latency.quantile_s(0.99), m.latency.worst_s(),
                 m.buffer_s > 0 ? ratio(m) : "null", m.wake_ups_per_s, m.processor_share, bins);
}

std::vector<std::size_t> usual_lengths(std::size_t in_use) {
  std::vector<std::size_t> lengths;
  for (std::size_t n = 1; n < in_use; n *= 8)
    lengths.push_back(n);
  lengths.push_back(std::max<std::size_t>(in_use, 1));
  return lengths;
}

} // namespace

void LatencyHistogram::add(double seconds) {
  const double octaves = std::log2(std::max(seconds, kFinest_s) / kFinest_s);
  const auto bin = std::min(static_cast<std::size_t>(octaves * kSteps), counts_.size() - 1);
  ++counts_[bin];
  ++count_;
  worst_s_ = std::max(worst_s_, seconds);
}

double LatencyHistogram::quantile_s(double share) const {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    sum += counts_[i];
    if (static_cast<double>(sum) >= wanted && sum > 0)
      return std::min(worst_s_, kFinest_s * std::exp2(static_cast<double>(i + 1) / double{kSteps}));
  }
  return worst_s_;
}

std::vector<double> LatencyHistogram::octaves() const {
  std::vector<double> shares(kOctaves, 0.0);
  for (std::size_t i = 0; i < counts_.size() && count_ > 0; ++i)
    shares[i / kSteps] += static_cast<double>(counts_[i]) / static_cast<double>(count_);
  return shares;
}

double LatencyHistogram::octave_s(std::size_t octave) {
  return kFinest_s * std::exp2(static_cast<double>(octave));
}

void measure_latency(const Source &source, LiveAngles &angles, std::vector<std::size_t> lengths,
                     std::uint64_t samples, AngleFormat format) {
  if (lengths.empty())
    lengths = usual_lengths(source_info(source).buffer_frames);
  if (format == AngleFormat::csv)
    put(kCsvHeader);
  for (const std::size_t length : lengths) {
    const Measurement m = measure(source, angles, length, samples);
    if (m.latency.count() == 0) // stopped before there was anything to tell
      break;
    std::string text;
    format == AngleFormat::csv    ? append_csv(text, m)
    : format == AngleFormat::json ? append_json(text, m)
                                  : append_text(text, m);
    put(text);
    if (StopSignal::requested())
      break;
  }
}

} // namespace cli
