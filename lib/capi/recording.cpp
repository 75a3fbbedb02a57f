// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "capi/guard.h"
#include "capi/handles.h"
#include "recording/capture_file.h"
#include "recording/growing_writer.h"
#include "recording/metadata.h"

struct ada4571_writer {
  std::unique_ptr<ada::CaptureWriter> impl; ///< null once finished, or after a failed write
};

namespace {

using ada::capi::guard;
using ada::capi::require;
using ada::capi::require_struct;

double or_nan(const std::optional<double> &value) {
  return value.value_or(ada::kAbsent);
}

std::optional<double> or_nothing(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

/// Sample i, from the block that the handle holds or that it then reads.
ada::Frame frame_of(const ada4571_recording &recording, std::size_t i) {
  ada::Block &block = recording.block;
  if (i < block.first || i - block.first >= block.count)
    recording.impl->read(recording.impl->block_of(i), ada::kAllColumns, block);
  return ada::frame_at(block, i - block.first);
}

ada4571_recording_info to_info(const ada::Recording &recording) {
  const ada::CaptureMetadata &meta = recording.meta();
  ada4571_recording_info info;
  info.struct_size = sizeof info;
  info.samples = recording.size();
  info.duration_s = recording.last_time_s() - recording.first_time_s();
  info.supply_v = meta.supply_v;
  info.periods_per_turn = meta.periods_per_turn;
  info.gain_control = meta.gain_control ? int{*meta.gain_control} : -1;
  info.noise_rms_v = or_nan(meta.noise_rms_v);
  info.sample_rate_hz = or_nan(meta.sample_rate_hz);
  info.adc_bits = or_nan(meta.adc_bits);
  info.adc_reference_v = or_nan(meta.adc_reference_v);
  info.has_vtemp = recording.channels().vtemp;
  info.has_vdd = recording.channels().vdd;
  info.has_reference = recording.channels().reference;
  info.serial = meta.serial.c_str();
  info.origin = meta.origin.c_str();
  info.data_file = recording.facts().data_file.c_str();
  return info;
}

ada::CaptureMetadata from_info(const ada4571_recording_info &info) {
  ada::CaptureMetadata meta;
  meta.supply_v = info.supply_v;
  meta.periods_per_turn = info.periods_per_turn;
  if (info.gain_control >= 0)
    meta.gain_control = info.gain_control != 0;
  meta.noise_rms_v = or_nothing(info.noise_rms_v);
  meta.sample_rate_hz = or_nothing(info.sample_rate_hz);
  meta.adc_bits = or_nothing(info.adc_bits);
  meta.adc_reference_v = or_nothing(info.adc_reference_v);
  meta.serial = ada::capi::text_or_empty(info.serial);
  meta.origin = ada::capi::text_or_empty(info.origin);
  return meta;
}

ada::ChannelSet channels_of(const ada4571_recording_info &info) {
  return {info.has_vtemp != 0, info.has_vdd != 0, info.has_reference != 0};
}

constexpr double kMostShift_s = 4e9;

ada::CaptureWriter &open_writer(ada4571_writer *writer) {
  require(writer, "writer");
  if (!writer->impl)
    throw ada::Error(ADA4571_ERROR_STATE,
                     "the recording is already finished, or its writing failed");
  return *writer->impl;
}

} // namespace

extern "C" {

void ada4571_recording_info_init(ada4571_recording_info *info) {
  if (info == nullptr)
    return;
  *info = to_info(*ada::recording_of(std::make_shared<const ada::Capture>()));
  info->serial = info->origin = info->data_file = nullptr; // not into the one above, which is gone
}

ada4571_status ada4571_recording_open(const char *path, ada4571_recording **recording) {
  return guard([&] {
    require(path, "path");
    require(recording, "recording");
    *recording = new ada4571_recording{ada::open_recording(path)};
  });
}

ada4571_status ada4571_recording_get_info(const ada4571_recording *recording,
                                          ada4571_recording_info *info) {
  return guard([&] {
    require(recording, "recording");
    require_struct(info, "info");
    *info = to_info(*recording->impl);
  });
}

const char *ada4571_recording_metadata(const ada4571_recording *recording, const char *key) {
  const char *value = nullptr;
  guard([&] {
    require(recording, "recording");
    require(key, "key");
    if (auto found = ada::find_metadata(recording->impl->meta(), key)) {
      recording->metadata_value = std::move(*found);
      value = recording->metadata_value.c_str();
    }
  });
  return value;
}

ada4571_status ada4571_recording_read(const ada4571_recording *recording, size_t first,
                                      ada4571_frame *frames, size_t capacity, size_t *count) {
  return guard([&] {
    require(recording, "recording");
    require(count, "count");
    if (capacity > 0)
      require(frames, "frames");
    const size_t size = recording->impl->size();
    const size_t wanted = std::min(first < size ? size - first : 0, capacity);
    for (size_t i = 0; i < wanted; ++i)
      frames[i] = frame_of(*recording, first + i);
    *count = wanted;
  });
}

ada4571_status ada4571_recording_save(const ada4571_recording *recording, const char *path) {
  return guard([&] {
    require(recording, "recording");
    require(path, "path");
    ada::write_recording(*recording->impl, path);
  });
}

void ada4571_recording_free(ada4571_recording *recording) {
  delete recording;
}

ada4571_status ada4571_writer_open(const char *path, const ada4571_recording_info *info,
                                   ada4571_writer **writer) {
  return guard([&] {
    require(path, "path");
    require_struct(info, "info");
    require(writer, "writer");
    auto impl = ada::open_capture_writer(path, from_info(*info), channels_of(*info));
    *writer = new ada4571_writer{std::move(impl)};
  });
}

ada4571_status ada4571_writer_open_growing(const char *path, const ada4571_recording_info *info,
                                           int resume, ada4571_writer **writer) {
  return guard([&] {
    require(path, "path");
    require_struct(info, "info");
    require(writer, "writer");
    auto impl = ada::open_growing_writer(path, from_info(*info), channels_of(*info), resume != 0);
    *writer = new ada4571_writer{std::move(impl)};
  });
}

ada4571_status ada4571_writer_metadata(ada4571_writer *writer, const char *key, const char *value) {
  return guard([&] {
    ada::CaptureWriter &impl = open_writer(writer);
    require(key, "key");
    require(value, "value");
    impl.metadata(key, value);
  });
}

ada4571_status ada4571_writer_write(ada4571_writer *writer, const ada4571_frame *frames,
                                    size_t count) {
  return guard([&] {
    ada::CaptureWriter &impl = open_writer(writer);
    if (count > 0)
      require(frames, "frames");
    try {
      impl.write({frames, count});
    } catch (...) {
      writer->impl.reset(); // a file with a part missing must not appear, whatever comes next
      throw;
    }
  });
}

ada4571_status ada4571_writer_open_blocks(const char *path, const ada4571_recording_info *info,
                                          const ada4571_source *source, int resume,
                                          ada4571_writer **writer) {
  return guard([&] {
    require(path, "path");
    require_struct(info, "info");
    require(source, "source");
    require(writer, "writer");
    auto impl = ada::open_growing_raw_writer(path, from_info(*info),
                                             ada::capi::raw_form_of(*source), resume != 0);
    *writer = new ada4571_writer{std::move(impl)};
  });
}

ada4571_status ada4571_writer_write_block(ada4571_writer *writer, const ada4571_source *source,
                                          size_t count, double shift_s) {
  return guard([&] {
    ada::CaptureWriter &impl = open_writer(writer);
    require(source, "source");
    const ada::RawFrames &block = ada::capi::block_of(*source);
    if (count > block.count)
      throw ada::Error(ADA4571_ERROR_INVALID_ARGUMENT,
                       "count is more than the block that was read last has frames");
    if (!(std::fabs(shift_s) <= kMostShift_s))
      throw ada::Error(ADA4571_ERROR_INVALID_ARGUMENT, "shift_s must be from -4e9 to 4e9");
    try {
      impl.write_raw(block.first(count), std::llround(shift_s * 1e9));
    } catch (...) {
      writer->impl.reset(); // as above
      throw;
    }
  });
}

ada4571_status ada4571_writer_finish(ada4571_writer *writer) {
  return guard([&] {
    open_writer(writer).finish();
    writer->impl.reset();
  });
}

void ada4571_writer_free(ada4571_writer *writer) {
  delete writer;
}

} // extern "C"
