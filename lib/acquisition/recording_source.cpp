// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/recording_source.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/error.h"

namespace ada {

namespace {

SourceInfo describe(const Capture &capture) {
  const CaptureMetadata &meta = capture.meta;
  SourceInfo info;
  info.description = "recording" + (meta.origin.empty() ? "" : " of " + meta.origin);
  info.serial = meta.serial;
  info.sample_rate_hz = meta.sample_rate_hz.value_or(0.0);
  info.supply_v = meta.supply_v;
  info.periods_per_turn = meta.periods_per_turn;
  info.has_vtemp = capture.has_vtemp();
  info.has_vdd = capture.has_vdd();
  info.has_reference = capture.has_reference();
  info.gain_control = meta.gain_control;
  if (meta.adc_bits)
    info.adc_bits = static_cast<int>(std::lround(*meta.adc_bits));
  return info;
}

class RecordingSource final : public Source {
public:
  explicit RecordingSource(std::shared_ptr<const Capture> capture)
      : capture_(std::move(capture)), info_(describe(*capture_)) {}

  const SourceInfo &info() const override { return info_; }

  void start() override {
    next_ = 0;
    started_ = true;
    statistics_ = {};
    cancelled_ = false;
  }

  ReadResult read(std::span<Frame> out, std::chrono::milliseconds) override {
    if (cancelled_)
      return {ReadOutcome::cancelled, 0};
    if (!started_)
      throw Error(ADA4571_ERROR_STATE, "the source is not started");
    if (out.empty())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "room for at least one frame is needed");
    const std::size_t n = std::min(out.size(), capture_->size() - next_);
    if (n == 0)
      return {ReadOutcome::end, 0};
    for (std::size_t i = 0; i < n; ++i)
      out[i] = frame(next_ + i);
    count_gaps(next_, next_ + n);
    next_ += n;
    statistics_.frames += n;
    return {ReadOutcome::frames, n};
  }

  void cancel() noexcept override { cancelled_ = true; }
  void stop() noexcept override { started_ = false; }
  SourceStatistics statistics() const override { return statistics_; }

private:
  Frame frame(std::size_t i) const {
    const Capture &c = *capture_;
    Frame f = empty_frame();
    f.time_s = c.time_s[i];
    f.vsin_v = c.vsin_v[i];
    f.vcos_v = c.vcos_v[i];
    if (c.has_vtemp())
      f.vtemp_v = c.vtemp_v[i];
    if (c.has_vdd())
      f.vdd_v = c.vdd_v[i];
    if (c.has_reference())
      f.reference_deg = c.reference_deg[i];
    return f;
  }

  /// Gaps whose first sample lies in [begin, end); what is missing, where the rate is known.
  void count_gaps(std::size_t begin, std::size_t end) {
    const auto &gaps = capture_->gaps;
    const auto first = std::lower_bound(gaps.begin(), gaps.end(), std::max<std::size_t>(begin, 1));
    const auto last = std::lower_bound(first, gaps.end(), end);
    for (auto gap = first; gap != last; ++gap) {
      ++statistics_.gaps;
      const double step = capture_->time_s[*gap] - capture_->time_s[*gap - 1];
      const double periods = std::round(step * info_.sample_rate_hz);
      if (periods > 1.0 && periods < 1e15)
        statistics_.lost += static_cast<std::uint64_t>(periods) - 1;
    }
  }

  std::shared_ptr<const Capture> capture_;
  SourceInfo info_;
  SourceStatistics statistics_;
  std::size_t next_ = 0;
  bool started_ = false;
  std::atomic<bool> cancelled_{false};
};

} // namespace

std::unique_ptr<Source> make_recording_source(std::shared_ptr<const Capture> capture) {
  return std::make_unique<RecordingSource>(std::move(capture));
}

} // namespace ada
