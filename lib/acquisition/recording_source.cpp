// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/recording_source.h"

#include <algorithm>
#include <cmath>

#include "acquisition/pace.h"
#include "base/error.h"
#include "base/text.h"

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
  RecordingSource(std::shared_ptr<const Capture> capture, double speed)
      : capture_(std::move(capture)), info_(describe(*capture_)), pace_(speed) {}

  const SourceInfo &info() const override { return info_; }

  void start() override {
    next_ = 0;
    started_ = true;
    statistics_ = {};
    pace_.start();
  }

  ReadResult read(std::span<Frame> out, std::chrono::milliseconds timeout) override {
    if (pace_.cancelled())
      return {ReadOutcome::cancelled, 0};
    if (!started_)
      throw Error(ADA4571_ERROR_STATE, "the source is not started");
    if (out.empty())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "room for at least one frame is needed");
    if (next_ == capture_->size())
      return {ReadOutcome::end, 0};
    switch (pace_.wait(since_first_s(next_), timeout)) {
    case Pace::Wake::cancelled:
      return {ReadOutcome::cancelled, 0};
    case Pace::Wake::timeout:
      return {ReadOutcome::timeout, 0};
    case Pace::Wake::due:
      break;
    }
    const std::size_t n = due_frames(out.size());
    for (std::size_t i = 0; i < n; ++i)
      out[i] = capture_->frame(next_ + i);
    count_gaps(next_, next_ + n);
    next_ += n;
    statistics_.frames += n;
    // The end comes with the last frame: nothing is known of when one more would be due.
    pace_.announce(since_first_s(std::min(next_, capture_->size() - 1)));
    return {ReadOutcome::frames, n};
  }

  int poll_fd() override { return pace_.fd(); }
  void cancel() noexcept override { pace_.cancel(); }
  void stop() noexcept override {
    started_ = false;
    pace_.stop();
  }
  SourceStatistics statistics() const override { return statistics_; }

private:
  double since_first_s(std::size_t i) const {
    return capture_->time_s[i] - capture_->time_s.front();
  }

  /// From the next on, at least that one, at most `room`.
  std::size_t due_frames(std::size_t room) const {
    const auto &times = capture_->time_s;
    const auto begin = times.begin() + static_cast<std::ptrdiff_t>(next_);
    const auto most = begin + static_cast<std::ptrdiff_t>(std::min(room, times.size() - next_));
    const auto end = std::upper_bound(begin + 1, most, times.front() + pace_.elapsed_s());
    return static_cast<std::size_t>(end - begin);
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
  Pace pace_;
};

} // namespace

std::unique_ptr<Source> make_recording_source(std::shared_ptr<const Capture> capture,
                                              double speed) {
  return std::make_unique<RecordingSource>(std::move(capture), speed);
}

void check_speed(double speed) {
  if (!(speed > 0.0 && speed <= kMostSpeed))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "the speed of a replay must be above 0 and at most " + shortest(kMostSpeed));
}

} // namespace ada
