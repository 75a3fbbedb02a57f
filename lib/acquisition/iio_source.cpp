// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/iio_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <ctime>

#include "acquisition/capture_stream.h"
#include "acquisition/frame_assembler.h"
#include "acquisition/iio_attributes.h"
#include "acquisition/iio_opened_device.h"
#include "acquisition/sample_clock.h"
#include "base/error.h"

namespace ada {

namespace {

using std::chrono::milliseconds;
using Clock = CaptureStream::Clock;

constexpr milliseconds kShortestNetworkTimeout{5000};
/// Frames converted channel by channel at a time: they stay in the first-level cache.
constexpr std::size_t kPiece = 256;

/// Counts sleep, and nobody sets it.
std::int64_t own_clock_ns() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::optional<RawForm> raw_form_of(const OpenedDevice &opened) {
  if (!opened.timestamp)
    return std::nullopt;
  const auto &[stamp, element] = *opened.timestamp;
  if (stamp.format() != ScanFormat{.bits = 64,
                                   .storage = 64,
                                   .is_signed = true,
                                   .big_endian = std::endian::native == std::endian::big})
    return std::nullopt;
  const FrameLayout layout = compute_layout(opened.formats);
  RawForm out{{}, layout.offsets[element], layout.frame_bytes};
  for (const Signal &signal : opened.signals)
    out.channels.push_back({signal.target, signal.decoder.format(), signal.decoder.scale(),
                            layout.offsets[signal.element]});
  return out;
}

std::string with_hint(const Error &e, const std::string &uri) {
  return e.what() + (e.status() == ADA4571_ERROR_PERMISSION ? permission_hint(uri) : "");
}

class IioSourceImpl final : public IioSource {
public:
  explicit IioSourceImpl(const IioSourceOptions &options)
      : options_(options), opened_(open_iio_device(options)), raw_form_(raw_form_of(opened_)),
        clock_(opened_.info.sample_rate_hz) {
    opened_.info.buffer_frames = buffer_frames(opened_, options_);
  }

  ~IioSourceImpl() override { set_rate_back(opened_); }

  const SourceInfo &info() const override { return opened_.info; }
  SourceStatistics statistics() const override { return clock_.statistics(); }

  void start() override;
  ReadResult read(std::span<Frame> out, milliseconds timeout) override;
  const std::optional<RawForm> &raw_form() const override { return raw_form_; }
  ReadOutcome read_raw(std::size_t most, milliseconds timeout, RawFrames &out) override;
  int poll_fd() override;
  void cancel() noexcept override;
  void stop() noexcept override;

  void set_buffer_frames(std::size_t frames) override;
  DriverCalibration read_driver_calibration() override;
  void write_driver_calibration(const DriverCalibration &calibration) override;
  IioSourceOptions resolved_options() const override {
    return opened_.context ? named_as_found(opened_, options_) : options_;
  }

private:
  /// What makes the descriptor of an event loop readable; `again` for all but the arrival of data.
  struct Loop {
    Readiness readiness;
    WakeUp again;
  };

  /// Waits until `take`, which is called for what is in hand, has taken some.
  template <class Take> ReadOutcome read_until(Take take, milliseconds timeout);
  template <class Take> ReadOutcome wait_until(Take take, milliseconds timeout);
  void reopen_after_loss();
  std::unique_ptr<CaptureStream> make_stream();
  std::size_t convert(std::span<Frame> out);
  void convert_piece(std::span<const std::byte> bytes, std::span<Frame> out);
  bool take_raw(std::size_t most, RawFrames &out);
  std::span<const std::byte> in_raw_form(std::span<const std::byte> bytes);

  IioSourceOptions options_;
  OpenedDevice opened_;
  std::optional<RawForm> raw_form_;
  std::vector<std::int64_t> times_ns_; ///< of raw frames whose timestamps do not tell
  FrameLayout raw_layout_;             ///< of raw_form_
  std::vector<std::byte> rearranged_;  ///< raw frames, where a server sends further channels
  SampleClock clock_;
  FrameAssembler assembler_;
  FrameLayout layout_;        ///< of the block in hand
  std::int64_t block_ns_ = 0; ///< when it came, by our own clock
  bool lost_ = false;         ///< device or server are gone; start() opens anew

  Cancellation cancellation_;  ///< raised by other threads; lowered when start() begins
  std::unique_ptr<Loop> loop_; ///< once somebody asked for it
  std::unique_ptr<CaptureStream> stream_;
};

void IioSourceImpl::set_buffer_frames(std::size_t frames) {
  IioSourceOptions changed = options_;
  changed.buffer_frames = frames;
  check_options(changed);
  options_ = changed;
  opened_.info.buffer_frames = buffer_frames(opened_, options_);
}

std::unique_ptr<CaptureStream> IioSourceImpl::make_stream() {
  const std::size_t frames = buffer_frames(opened_, options_);
  const std::string name = display_name(opened_.device);
  IioContext *context = opened_.context.get();
  if (context->is_local()) {
    auto buffer = context->create_buffer(opened_.device.id, opened_.scan, frames,
                                         kernel_buffers(opened_, frames), cancellation_);
    if (buffer->poll_fd() >= 0)
      return make_polled_stream(cancellation_, std::move(buffer),
                                "/sys/bus/iio/devices/" + opened_.device.id, name);
  }
  const double rate = opened_.info.sample_rate_hz;
  const double block_ms = rate > 0.0 ? 1e3 * static_cast<double>(frames) / rate : 0.0;
  // The client gives the server half of its time-out; four blocks must fit into that.
  const milliseconds timeout = std::max(
      kShortestNetworkTimeout, milliseconds(static_cast<long>(std::min(60000.0, 8.0 * block_ms))));
  const std::size_t block_bytes = frames * compute_layout(opened_.formats).frame_bytes;
  const std::size_t blocks =
      std::clamp<std::size_t>((16u << 20) / std::max<std::size_t>(1, block_bytes), 2, 32);
  auto factory = [this, context](std::size_t n, milliseconds wait,
                                 const Cancellation &cancellation) {
    context->set_timeout(wait);
    return context->create_buffer(opened_.device.id, opened_.scan, n, kernel_buffers(opened_, n),
                                  cancellation);
  };
  return make_threaded_stream(cancellation_, std::move(factory), frames, timeout, block_bytes,
                              blocks, options_.uri + " " + name);
}

void IioSourceImpl::reopen_after_loss() {
  try {
    opened_ = open_iio_device(options_, &cancellation_);
    opened_.info.buffer_frames = buffer_frames(opened_, options_);
    raw_form_ = raw_form_of(opened_);
  } catch (const Error &e) {
    const bool away = e.status() == ADA4571_ERROR_NOT_FOUND;
    throw Error(away ? ADA4571_ERROR_DISCONNECTED : e.status(), e.what());
  }
  lost_ = false;
}

void IioSourceImpl::start() {
  stop();
  cancellation_.lower(); // before the first wait: a cancel meanwhile is for this start
  try {
    if (lost_ || !opened_.context) {
      lost_ = true;
      reopen_after_loss();
    }
    layout_ = compute_layout(opened_.formats);
    assembler_.reset(layout_.frame_bytes);
    raw_layout_ = layout_;
    if (raw_form_)
      times_ns_.reserve(opened_.info.buffer_frames);
    clock_ = SampleClock(opened_.info.sample_rate_hz, own_clock_ns());
    stream_ = make_stream();
    opened_.rate_before.reset(); // it is in use
    if (loop_)
      stream_->announce_to(loop_->readiness);
  } catch (const Error &e) {
    lost_ = lost_ || e.status() == ADA4571_ERROR_DISCONNECTED;
    throw Error(e.status(), with_hint(e, options_.uri));
  }
}

void IioSourceImpl::stop() noexcept {
  stream_.reset();
  if (loop_)
    loop_->again.clear();
}

void IioSourceImpl::cancel() noexcept {
  cancellation_.raise();
}

int IioSourceImpl::poll_fd() {
  if (!loop_) {
    auto loop = std::make_unique<Loop>();
    loop->readiness.watch(cancellation_.fd());
    loop->readiness.watch(loop->again.fd());
    if (stream_) {
      stream_->announce_to(loop->readiness);
      loop->again.ring(); // frames may be in hand already
    }
    loop_ = std::move(loop);
  }
  return loop_->readiness.fd();
}

ReadResult IioSourceImpl::read(std::span<Frame> out, milliseconds timeout) {
  if (out.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "room for at least one frame is needed");
  std::size_t count = 0;
  const auto take = [&] { return (count = convert(out)) > 0; };
  const ReadOutcome outcome = read_until(take, timeout);
  return {outcome, count};
}

ReadOutcome IioSourceImpl::read_raw(std::size_t most, milliseconds timeout, RawFrames &out) {
  if (!raw_form_)
    throw Error(ADA4571_ERROR_UNSUPPORTED, display_name(opened_.device) +
                                               " has no timestamps of 64 bits: its frames have to "
                                               "be read one by one");
  out = {};
  return read_until([&] { return take_raw(most, out); }, timeout);
}

template <class Take> ReadOutcome IioSourceImpl::read_until(Take take, milliseconds timeout) {
  if (!loop_)
    return wait_until(take, timeout);
  try {
    const ReadOutcome outcome = wait_until(take, timeout);
    if (outcome == ReadOutcome::timeout)
      loop_->again.clear();
    else
      loop_->again.ring();
    return outcome;
  } catch (...) {
    loop_->again.ring();
    throw;
  }
}

template <class Take> ReadOutcome IioSourceImpl::wait_until(Take take, milliseconds timeout) {
  if (cancellation_.raised())
    return ReadOutcome::cancelled;
  if (!stream_)
    throw Error(ADA4571_ERROR_STATE, "the source is not started");
  const auto deadline =
      timeout < milliseconds(0) ? Clock::time_point::max() : Clock::now() + timeout;
  try {
    for (;;) {
      if (take())
        return ReadOutcome::frames;
      CaptureBlock block;
      switch (stream_->next(block, deadline)) {
      case CaptureStream::Event::cancelled:
        return ReadOutcome::cancelled;
      case CaptureStream::Event::timeout:
        return ReadOutcome::timeout;
      case CaptureStream::Event::end:
        return ReadOutcome::end;
      case CaptureStream::Event::data:
        if (block.layout->frame_bytes != layout_.frame_bytes ||
            block.layout->offsets != layout_.offsets) {
          layout_ = *block.layout;
          assembler_.reset(layout_.frame_bytes);
        }
        block_ns_ = own_clock_ns();
        assembler_.feed(block.bytes);
      }
    }
  } catch (const Error &e) {
    lost_ = lost_ || e.status() == ADA4571_ERROR_DISCONNECTED;
    throw;
  }
}

std::size_t IioSourceImpl::convert(std::span<Frame> out) {
  std::size_t done = 0;
  while (done < out.size()) {
    const auto bytes = assembler_.take(std::min(kPiece, out.size() - done));
    if (bytes.empty())
      break;
    const std::size_t n = bytes.size() / layout_.frame_bytes;
    convert_piece(bytes, out.subspan(done, n));
    done += n;
  }
  return done;
}

void IioSourceImpl::convert_piece(std::span<const std::byte> bytes, std::span<Frame> out) {
  constexpr std::size_t kFrameStride = sizeof(Frame) / sizeof(double);
  static_assert(sizeof(Frame) % sizeof(double) == 0);
  const std::size_t stride = layout_.frame_bytes;
  std::fill(out.begin(), out.end(), empty_frame());
  for (const Signal &signal : opened_.signals)
    signal.decoder.volts(bytes.data() + layout_.offsets[signal.element], stride, out.size(),
                         &(out.front().*signal.target), kFrameStride);
  if (!opened_.timestamp) {
    for (Frame &frame : out)
      frame.time_s = clock_.accept_untimed();
    return;
  }
  const auto &[decoder, element] = *opened_.timestamp;
  const std::byte *at = bytes.data() + layout_.offsets[element];
  for (std::size_t i = 0; i < out.size(); ++i, at += stride)
    out[i].time_s = clock_.accept(decoder.raw(at), block_ns_);
}

/// What every raw frame costs is in here, so there is no work a sample.
bool IioSourceImpl::take_raw(std::size_t most, RawFrames &out) {
  const auto bytes = assembler_.take(most);
  if (bytes.empty())
    return false;
  out.form = &*raw_form_;
  out.count = bytes.size() / layout_.frame_bytes;
  out.bytes = in_raw_form(bytes);
  const std::byte *const stamps = out.bytes.data() + raw_form_->timestamp_byte;
  if (const auto origin =
          clock_.accept_even(stamps, raw_form_->frame_bytes, out.count, block_ns_)) {
    out.origin_ns = *origin;
    out.longest_step_ns = clock_.longest_even_step_ns();
    return true;
  }
  constexpr double kNanoseconds = 1e9;
  times_ns_.resize(out.count);
  for (std::size_t i = 0; i < out.count; ++i)
    times_ns_[i] = std::llround(clock_.accept(out.timestamp(i), block_ns_) * kNanoseconds);
  out.times_ns = times_ns_;
  out.origin_ns = static_cast<std::int64_t>(static_cast<std::uint64_t>(out.timestamp(0)) -
                                            static_cast<std::uint64_t>(times_ns_[0]));
  return true;
}

/// Of a server that sends what other clients want as well, only what is ours.
std::span<const std::byte> IioSourceImpl::in_raw_form(std::span<const std::byte> bytes) {
  const FrameLayout &ours = raw_layout_;
  if (ours.frame_bytes == layout_.frame_bytes && ours.offsets == layout_.offsets)
    return bytes;
  const std::size_t count = bytes.size() / layout_.frame_bytes;
  rearranged_.assign(count * ours.frame_bytes, std::byte{});
  for (std::size_t e = 0; e < opened_.formats.size(); ++e) {
    const std::byte *from = bytes.data() + layout_.offsets[e];
    std::byte *to = rearranged_.data() + ours.offsets[e];
    for (std::size_t i = 0; i < count; ++i, from += layout_.frame_bytes, to += ours.frame_bytes)
      std::memcpy(to, from, opened_.formats[e].element_bytes());
  }
  return rearranged_;
}

DriverCalibration IioSourceImpl::read_driver_calibration() {
  if (!opened_.context)
    throw Error(ADA4571_ERROR_DISCONNECTED, "the device is gone; start again when it is back");
  DriverCalibration out;
  out.sin = ada::read_driver_calibration(*opened_.context, opened_.device,
                                         opened_.channel(opened_.choice.sin));
  out.cos = ada::read_driver_calibration(*opened_.context, opened_.device,
                                         opened_.channel(opened_.choice.cos));
  if (!out.sin.bias && !out.sin.scale && !out.cos.bias && !out.cos.scale)
    throw Error(ADA4571_ERROR_NOT_FOUND,
                display_name(opened_.device) + " has neither calibbias nor calibscale");
  return out;
}

void IioSourceImpl::write_driver_calibration(const DriverCalibration &calibration) {
  if (!opened_.context)
    throw Error(ADA4571_ERROR_DISCONNECTED, "the device is gone; start again when it is back");
  try {
    ada::write_driver_calibration(*opened_.context, opened_.device,
                                  opened_.channel(opened_.choice.sin),
                                  opened_.channel(opened_.choice.cos), calibration);
  } catch (const Error &e) {
    throw Error(e.status(), with_hint(e, options_.uri));
  }
}

} // namespace

std::unique_ptr<IioSource> open_iio_source(const IioSourceOptions &options) {
  check_options(options);
  try {
    return std::make_unique<IioSourceImpl>(options);
  } catch (const Error &e) {
    throw Error(e.status(), with_hint(e, options.uri));
  }
}

} // namespace ada
