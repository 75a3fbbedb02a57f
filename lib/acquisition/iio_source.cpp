// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/iio_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>

#include "acquisition/capture_stream.h"
#include "acquisition/frame_assembler.h"
#include "acquisition/iio_attributes.h"
#include "acquisition/sample_clock.h"
#include "base/error.h"

namespace ada {

namespace {

using std::chrono::milliseconds;
using Clock = CaptureStream::Clock;

constexpr std::size_t kFramesWithoutRate = 64;
constexpr std::size_t kMostFrames = 1u << 16, kMostFramesAsked = 1u << 24;
/// How long a frame waits for its buffer where nobody asks for less.
constexpr double kLatency_s = 0.05;
/// The kernel's FIFO comes from kmalloc, which ends at 4 MiB on most machines.
constexpr std::size_t kKernelBytes = 4u << 20;
/// What the kernel holds for a reader that is late.
constexpr double kKernelSeconds = 1.0;
constexpr milliseconds kShortestNetworkTimeout{5000};
/// Frames converted channel by channel at a time: they stay in the first-level cache.
constexpr std::size_t kPiece = 256;

/// One signal of the pair and its companions: where its volts go in a frame.
struct Signal {
  ElementDecoder decoder;
  double Frame::*target = nullptr;
  std::size_t element = 0; ///< position in the layout
};

/// All that is found on the device; made anew after a loss.
struct Opened {
  std::unique_ptr<IioContext> context;
  IioDevice device;
  ChannelChoice choice;
  std::vector<std::string> scan;   ///< ids of the enabled channels in scan order
  std::vector<ScanFormat> formats; ///< theirs
  std::vector<Signal> signals;
  std::optional<std::pair<ElementDecoder, std::size_t>> timestamp; ///< with its element
  SourceInfo info;
};

/// Counts sleep, and nobody sets it.
std::int64_t own_clock_ns() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::string with_hint(const Error &e, const std::string &uri) {
  return e.what() + (e.status() == ADA4571_ERROR_PERMISSION ? permission_hint(uri) : "");
}

void plan_scan(Opened &o) {
  std::vector<std::pair<std::size_t, double Frame::*>> wanted{{o.choice.sin, &Frame::vsin_v},
                                                              {o.choice.cos, &Frame::vcos_v}};
  if (o.choice.temp)
    wanted.emplace_back(*o.choice.temp, &Frame::vtemp_v);
  if (o.choice.vdd)
    wanted.emplace_back(*o.choice.vdd, &Frame::vdd_v);
  if (o.choice.timestamp)
    wanted.emplace_back(*o.choice.timestamp, nullptr);
  const auto &channels = o.device.channels;
  std::sort(wanted.begin(), wanted.end(), [&](const auto &a, const auto &b) {
    return channels[a.first].index < channels[b.first].index;
  });
  for (const auto &[position, target] : wanted) {
    const IioChannel &channel = channels[position];
    const std::size_t element = o.scan.size();
    o.scan.push_back(channel.id);
    o.formats.push_back(channel.format);
    if (target)
      o.signals.push_back(
          {ElementDecoder(channel.format, read_scale(*o.context, o.device, channel), channel.id),
           target, element});
    else
      o.timestamp = {ElementDecoder(channel.format, {}, channel.id), element};
  }
}

/// Timestamps of the monotonic clock cannot be set back. Not every kernel has the attribute and not
/// every user may write it; either is fine.
void prefer_monotonic_clock(Opened &o) {
  constexpr const char *kClock = "current_timestamp_clock";
  const auto now = o.context->read(o.device.id, "", kClock);
  if (now && !now->starts_with("monotonic"))
    o.context->write(o.device.id, "", kClock, "monotonic");
}

void describe_source(Opened &o, const IioSourceOptions &options) {
  const IioChannel &sin = o.device.channels[o.choice.sin];
  o.info.description = options.uri + " " + display_name(o.device);
  o.info.serial = o.context->attribute("hw_serial");
  o.info.sample_rate_hz = options.sample_rate_hz > 0.0
                              ? write_sample_rate(*o.context, o.device, sin, options.sample_rate_hz)
                              : read_sample_rate(*o.context, o.device, sin);
  o.info.supply_v = options.supply_v;
  o.info.periods_per_turn = options.periods_per_turn;
  o.info.has_vtemp = o.choice.temp.has_value();
  o.info.has_vdd = o.choice.vdd.has_value();
  o.info.adc_bits = static_cast<int>(sin.format.bits);
  if (o.timestamp && is_this_machine(*o.context, options.uri))
    o.info.timestamp_clock = read_timestamp_clock(*o.context, o.device);
  if (!o.timestamp && o.info.sample_rate_hz <= 0.0)
    throw Error(ADA4571_ERROR_UNSUPPORTED,
                display_name(o.device) + " has neither timestamps nor a sampling frequency: give "
                                         "the sample rate");
}

Opened open_device(const IioSourceOptions &options) {
  Opened o;
  o.context = open_iio_context(options.uri);
  const std::vector<IioDevice> devices = o.context->devices();
  o.device = choose_device(devices, options.device, options.channels);
  o.choice = choose_channels(o.device, options.channels);
  plan_scan(o);
  if (!options.trigger.empty()) // before the buffer: a running buffer keeps its trigger
    o.context->set_trigger(o.device.id, options.trigger);
  prefer_monotonic_clock(o);
  describe_source(o, options);
  return o;
}

void check(const IioSourceOptions &options) {
  const auto refuse = [](const char *why) { throw Error(ADA4571_ERROR_INVALID_ARGUMENT, why); };
  if (!(options.sample_rate_hz >= 0.0 && options.sample_rate_hz <= 1e9))
    refuse("sample_rate_hz must be from 0 to 1e9");
  if (!(options.supply_v > 0.0 && options.supply_v <= 50.0))
    refuse("supply_v must be greater than 0 and at most 50");
  if (options.periods_per_turn < 1 || options.periods_per_turn > 64)
    refuse("periods_per_turn must be from 1 to 64");
  if (options.buffer_frames > kMostFramesAsked)
    refuse("buffer_frames must be at most 16777216");
  if (!(options.latency_s >= 0.0 && options.latency_s <= 60.0))
    refuse("latency_s must be from 0 to 60");
}

class IioSourceImpl final : public IioSource {
public:
  explicit IioSourceImpl(const IioSourceOptions &options)
      : options_(options), opened_(open_device(options)), clock_(opened_.info.sample_rate_hz) {
    opened_.info.buffer_frames = buffer_frames();
  }

  const SourceInfo &info() const override { return opened_.info; }
  SourceStatistics statistics() const override { return clock_.statistics(); }

  void start() override;
  ReadResult read(std::span<Frame> out, milliseconds timeout) override;
  int poll_fd() override;
  void cancel() noexcept override;
  void stop() noexcept override;

  void set_buffer_frames(std::size_t frames) override;
  DriverCalibration read_driver_calibration() override;
  void write_driver_calibration(const DriverCalibration &calibration) override;
  IioSourceOptions resolved_options() const override;

private:
  /// What makes the descriptor of an event loop readable; `again` for all but the arrival of data.
  struct Loop {
    Readiness readiness;
    WakeUp again;
  };

  ReadResult read_frames(std::span<Frame> out, milliseconds timeout);
  void reopen_after_loss();
  std::size_t buffer_frames() const;
  unsigned kernel_buffers(std::size_t frames) const;
  std::unique_ptr<CaptureStream> make_stream();
  std::size_t convert(std::span<Frame> out);
  void convert_piece(std::span<const std::byte> bytes, std::span<Frame> out);
  const IioChannel &channel(std::size_t i) const { return opened_.device.channels[i]; }

  IioSourceOptions options_;
  Opened opened_;
  SampleClock clock_;
  FrameAssembler assembler_;
  FrameLayout layout_;        ///< of the block in hand
  std::int64_t block_ns_ = 0; ///< when it came, by our own clock
  bool lost_ = false;         ///< device or server are gone; start() opens anew

  Cancellation cancellation_; ///< raised by other threads; lowered by start()
  std::unique_ptr<Loop> loop_;  ///< once somebody asked for it
  std::unique_ptr<CaptureStream> stream_;
};

std::size_t IioSourceImpl::buffer_frames() const {
  std::size_t frames = options_.buffer_frames;
  const double wait_s = options_.latency_s > 0.0 ? options_.latency_s : kLatency_s;
  if (frames == 0 && opened_.info.sample_rate_hz > 0.0)
    frames = static_cast<std::size_t>(
        std::clamp(opened_.info.sample_rate_hz * wait_s, 1.0, double(kMostFrames)));
  else if (frames == 0)
    frames = options_.latency_s > 0.0 ? 1 : kFramesWithoutRate;
  // libiio 0.24 sizes its buffer by a frame that may be too short (scan_format.h). A multiple of
  // the true frame makes the two end together, so that the kernel is never asked for half a frame.
  if (!opened_.timestamp) {
    const std::size_t unit = compute_layout(opened_.formats).frame_bytes;
    frames = (frames + unit - 1) / unit * unit;
  }
  return frames;
}

void IioSourceImpl::set_buffer_frames(std::size_t frames) {
  IioSourceOptions changed = options_;
  changed.buffer_frames = frames;
  check(changed);
  options_ = changed;
  opened_.info.buffer_frames = buffer_frames();
}

unsigned IioSourceImpl::kernel_buffers(std::size_t frames) const {
  const std::size_t frame_bytes = compute_layout(opened_.formats).frame_bytes;
  const double rate = std::max(opened_.info.sample_rate_hz, 20.0 * static_cast<double>(frames));
  unsigned count = static_cast<unsigned>(
      std::clamp(std::ceil(kKernelSeconds * rate / static_cast<double>(frames)), 4.0, 64.0));
  while (count > 1 && std::bit_ceil(frames * count) * frame_bytes > kKernelBytes)
    --count;
  return count;
}

std::unique_ptr<CaptureStream> IioSourceImpl::make_stream() {
  const std::size_t frames = buffer_frames();
  const std::string name = display_name(opened_.device);
  IioContext *context = opened_.context.get();
  if (context->is_local()) {
    auto buffer =
        context->create_buffer(opened_.device.id, opened_.scan, frames, kernel_buffers(frames));
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
  auto factory = [this, context](std::size_t n, milliseconds wait) {
    context->set_timeout(wait);
    return context->create_buffer(opened_.device.id, opened_.scan, n, kernel_buffers(n));
  };
  return make_threaded_stream(cancellation_, std::move(factory), frames, timeout, block_bytes,
                              blocks, options_.uri + " " + name);
}

void IioSourceImpl::reopen_after_loss() {
  try {
    opened_ = open_device(options_);
    opened_.info.buffer_frames = buffer_frames();
  } catch (const Error &e) {
    const bool away = e.status() == ADA4571_ERROR_NOT_FOUND;
    throw Error(away ? ADA4571_ERROR_DISCONNECTED : e.status(), e.what());
  }
  lost_ = false;
}

void IioSourceImpl::start() {
  stop();
  try {
    if (lost_ || !opened_.context) {
      lost_ = true;
      reopen_after_loss();
    }
    clock_ = SampleClock(opened_.info.sample_rate_hz);
    layout_ = compute_layout(opened_.formats);
    assembler_.reset(layout_.frame_bytes);
    stream_ = make_stream();
    cancellation_.lower();
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
  if (!loop_)
    return read_frames(out, timeout);
  try {
    const ReadResult result = read_frames(out, timeout);
    if (result.outcome == ReadOutcome::timeout)
      loop_->again.clear();
    else
      loop_->again.ring();
    return result;
  } catch (...) {
    loop_->again.ring();
    throw;
  }
}

ReadResult IioSourceImpl::read_frames(std::span<Frame> out, milliseconds timeout) {
  if (cancellation_.raised())
    return {ReadOutcome::cancelled, 0};
  if (!stream_)
    throw Error(ADA4571_ERROR_STATE, "the source is not started");
  if (out.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "room for at least one frame is needed");
  const auto deadline =
      timeout < milliseconds(0) ? Clock::time_point::max() : Clock::now() + timeout;
  try {
    for (;;) {
      if (const std::size_t n = convert(out); n > 0)
        return {ReadOutcome::frames, n};
      CaptureBlock block;
      switch (stream_->next(block, deadline)) {
      case CaptureStream::Event::cancelled:
        return {ReadOutcome::cancelled, 0};
      case CaptureStream::Event::timeout:
        return {ReadOutcome::timeout, 0};
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

DriverCalibration IioSourceImpl::read_driver_calibration() {
  if (!opened_.context)
    throw Error(ADA4571_ERROR_DISCONNECTED, "the device is gone; start again when it is back");
  DriverCalibration out;
  out.sin =
      ada::read_driver_calibration(*opened_.context, opened_.device, channel(opened_.choice.sin));
  out.cos =
      ada::read_driver_calibration(*opened_.context, opened_.device, channel(opened_.choice.cos));
  if (!out.sin.bias && !out.sin.scale && !out.cos.bias && !out.cos.scale)
    throw Error(ADA4571_ERROR_NOT_FOUND,
                display_name(opened_.device) + " has neither calibbias nor calibscale");
  return out;
}

void IioSourceImpl::write_driver_calibration(const DriverCalibration &calibration) {
  if (!opened_.context)
    throw Error(ADA4571_ERROR_DISCONNECTED, "the device is gone; start again when it is back");
  try {
    ada::write_driver_calibration(*opened_.context, opened_.device, channel(opened_.choice.sin),
                                  channel(opened_.choice.cos), calibration);
  } catch (const Error &e) {
    throw Error(e.status(), with_hint(e, options_.uri));
  }
}

IioSourceOptions IioSourceImpl::resolved_options() const {
  IioSourceOptions out = options_;
  if (!opened_.context)
    return out;
  // A label or a name that is the only one of its kind; the id may change from boot to boot.
  const std::vector<IioDevice> devices = opened_.context->devices();
  const auto unique = [&](std::string IioDevice::*member) {
    const std::string &value = opened_.device.*member;
    return !value.empty() && std::count_if(devices.begin(), devices.end(),
                                           [&](const auto &d) { return d.*member == value; }) == 1;
  };
  out.device = unique(&IioDevice::label)  ? opened_.device.label
               : unique(&IioDevice::name) ? opened_.device.name
                                          : opened_.device.id;
  const auto id = [&](std::size_t i) {
    return channel(i).label.empty() ? channel(i).id : channel(i).label;
  };
  out.channels.sin = id(opened_.choice.sin);
  out.channels.cos = id(opened_.choice.cos);
  out.channels.temp = opened_.choice.temp ? id(*opened_.choice.temp) : "";
  out.channels.vdd = opened_.choice.vdd ? id(*opened_.choice.vdd) : "";
  return out;
}

} // namespace

std::unique_ptr<IioSource> open_iio_source(const IioSourceOptions &options) {
  check(options);
  try {
    return std::make_unique<IioSourceImpl>(options);
  } catch (const Error &e) {
    throw Error(e.status(), with_hint(e, options.uri));
  }
}

std::vector<IioListEntry> list_iio_devices(const std::string &uri) {
  std::unique_ptr<IioContext> context;
  try {
    context = open_iio_context(uri);
  } catch (const Error &e) {
    if (uri.starts_with("local:") && e.status() == ADA4571_ERROR_NOT_FOUND)
      return {};
    throw;
  }
  std::vector<IioListEntry> out;
  for (IioDevice &device : context->devices()) {
    if (!has_usable_pair(device))
      continue;
    IioListEntry entry{std::move(device), {}, {}, {}, {}, {}, false};
    entry.channels = list_channels(entry.device);
    entry.labelled = labels_name_pair(entry.device);
    for (const IioChannel &c : entry.device.channels) {
      if (!c.is_voltage || c.is_output || c.index < 0)
        continue;
      for (const auto &[label, id] :
           {std::pair("vsin", &entry.sin), std::pair("vcos", &entry.cos),
            std::pair("vtemp", &entry.temp), std::pair("vdd", &entry.vdd)})
        if (c.label == label && id->empty())
          *id = c.id;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

} // namespace ada
