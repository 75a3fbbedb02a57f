// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <memory>
#include <utility>

#include "acquisition/config.h"
#include "acquisition/iio_source.h"
#include "acquisition/pins.h"
#include "acquisition/recording_source.h"
#include "capi/driver_calibration.h"
#include "capi/guard.h"
#include "capi/handles.h"
#include "conversion/frame_converter.h"
#include "model/model_file.h"
#include "simulation/simulation.h"

using namespace ada;
using namespace ada::capi;

struct ada4571_source {
  std::unique_ptr<Source> impl;
  PinsConfig pins;              ///< of the stored configuration
  std::string calibration_file; ///< of the stored configuration, empty: none
  std::optional<bool> gain_control;
  RawFrames block{}; ///< that ada4571_source_read_block gave last

  Model at_its_supply(const Model &model) const {
    const SourceInfo &info = impl->info();
    return model_for(model, {"source", true, info.periods_per_turn, info.supply_v, info.has_vtemp});
  }

  /// Calibration attributes and a storable address belong to an IIO device only.
  IioSource &device(const char *what) const {
    auto *iio = dynamic_cast<IioSource *>(impl.get());
    if (!iio)
      throw Error(ADA4571_ERROR_UNSUPPORTED, std::string("only an IIO device has ") + what);
    return *iio;
  }
};

/// The strings of a list live in it.
struct ada4571_device_list {
  std::vector<IioListEntry> entries;
};

namespace {

IioSourceOptions translate(const ada4571_source_options &o) {
  IioSourceOptions out;
  if (o.uri)
    out.uri = o.uri;
  out.device = text_or_empty(o.device);
  out.channels = {text_or_empty(o.sin_channel), text_or_empty(o.cos_channel),
                  text_or_empty(o.temp_channel), text_or_empty(o.vdd_channel)};
  out.trigger = text_or_empty(o.trigger);
  out.sample_rate_hz = o.sample_rate_hz;
  out.supply_v = o.supply_v;
  out.periods_per_turn = o.periods_per_turn;
  out.buffer_frames = o.buffer_frames;
  out.latency_s = o.latency_s;
  return out;
}

/// The state of GC where a stored configuration names the pin and it can be read. A line that
/// another program holds, or may not be read, leaves it unknown: no reason not to capture.
std::optional<bool> read_gain_control(const PinsConfig &config) {
  if (!config.gc)
    return std::nullopt;
  try {
    return Pins(make_gpio_chips(), config).get(Pins::Pin::gc);
  } catch (const Error &) {
    return std::nullopt;
  }
}

ada4571_read_outcome translate(ReadOutcome outcome) {
  switch (outcome) {
  case ReadOutcome::frames:
    return ADA4571_READ_FRAMES;
  case ReadOutcome::timeout:
    return ADA4571_READ_TIMEOUT;
  case ReadOutcome::end:
    return ADA4571_READ_END;
  case ReadOutcome::cancelled:
    return ADA4571_READ_CANCELLED;
  }
  return ADA4571_READ_END;
}

} // namespace

const RawFrames &ada::capi::block_of(const ada4571_source &source) {
  return source.block;
}

const RawForm &ada::capi::raw_form_of(const ada4571_source &source) {
  const std::optional<RawForm> &form = source.device("blocks").raw_form();
  if (!form)
    throw Error(ADA4571_ERROR_UNSUPPORTED, "the device gives no timestamps with its samples, so it "
                                           "has no blocks");
  return *form;
}

extern "C" {

void ada4571_source_options_init(ada4571_source_options *options) {
  if (!options)
    return;
  const IioSourceOptions defaults;
  *options = {};
  options->struct_size = sizeof *options;
  options->sample_rate_hz = defaults.sample_rate_hz;
  options->supply_v = defaults.supply_v;
  options->periods_per_turn = defaults.periods_per_turn;
  options->buffer_frames = defaults.buffer_frames;
  options->latency_s = defaults.latency_s;
}

void ada4571_source_info_init(ada4571_source_info *info) {
  if (!info)
    return;
  *info = {};
  info->struct_size = sizeof *info;
  info->description = info->serial = "";
  info->gain_control = -1;
  info->timestamp_clock = -1;
}

void ada4571_block_init(ada4571_block *block) {
  if (!block)
    return;
  *block = {};
  block->struct_size = sizeof *block;
}

void ada4571_source_statistics_init(ada4571_source_statistics *statistics) {
  if (!statistics)
    return;
  *statistics = {};
  statistics->struct_size = sizeof *statistics;
}

ada4571_status ada4571_open(const char *name, ada4571_source **source) {
  return guard([&] {
    require(name, "name");
    require(source, "source");
    StoredConfig config = load_config(name);
    auto handle = std::make_unique<ada4571_source>();
    handle->impl = open_iio_source(config.source);
    handle->gain_control = read_gain_control(config.pins);
    handle->pins = std::move(config.pins);
    handle->calibration_file = std::move(config.calibration_file);
    *source = handle.release();
  });
}

ada4571_status ada4571_source_open(const ada4571_source_options *options, ada4571_source **source) {
  return guard([&] {
    require_struct(options, "options");
    require(source, "source");
    auto handle = std::make_unique<ada4571_source>();
    handle->impl = open_iio_source(translate(*options));
    *source = handle.release();
  });
}

ada4571_status ada4571_source_open_recording(const ada4571_recording *recording,
                                             ada4571_source **source) {
  return guard([&] {
    require(recording, "recording");
    require(source, "source");
    auto handle = std::make_unique<ada4571_source>();
    handle->impl = make_recording_source(recording->impl->whole());
    *source = handle.release();
  });
}

ada4571_status ada4571_source_open_replay(const ada4571_recording *recording, double speed,
                                          ada4571_source **source) {
  return guard([&] {
    require(recording, "recording");
    require(source, "source");
    check_speed(speed);
    auto handle = std::make_unique<ada4571_source>();
    handle->impl = make_recording_source(recording->impl->whole(), speed);
    *source = handle.release();
  });
}

ada4571_status ada4571_source_open_simulation(const ada4571_simulation *simulation, int realtime,
                                              ada4571_source **source) {
  return guard([&] {
    require(simulation, "simulation");
    require(source, "source");
    auto handle = std::make_unique<ada4571_source>();
    handle->impl = simulation->impl->source(realtime != 0);
    *source = handle.release();
  });
}

ada4571_status ada4571_source_get_info(const ada4571_source *source, ada4571_source_info *info) {
  return guard([&] {
    require(source, "source");
    require_struct(info, "info");
    const SourceInfo &i = source->impl->info();
    const std::optional<bool> gain = source->gain_control ? source->gain_control : i.gain_control;
    info->description = i.description.c_str();
    info->serial = i.serial.c_str();
    info->sample_rate_hz = i.sample_rate_hz;
    info->supply_v = i.supply_v;
    info->periods_per_turn = i.periods_per_turn;
    info->has_vtemp = i.has_vtemp;
    info->has_vdd = i.has_vdd;
    info->has_reference = i.has_reference;
    info->gain_control = gain ? int{*gain} : -1;
    info->buffer_frames = i.buffer_frames;
    info->timestamp_clock = i.timestamp_clock;
  });
}

ada4571_status ada4571_source_start(ada4571_source *source) {
  return guard([&] {
    require(source, "source");
    source->block = {};
    source->impl->start();
  });
}

ada4571_status ada4571_source_set_buffer(ada4571_source *source, size_t frames) {
  return guard([&] {
    require(source, "source");
    source->device("buffers").set_buffer_frames(frames);
  });
}

ada4571_status ada4571_source_read(ada4571_source *source, ada4571_frame *frames, size_t capacity,
                                   int timeout_ms, size_t *count, ada4571_read_outcome *outcome) {
  return guard([&] {
    require(source, "source");
    require(frames, "frames");
    require(count, "count");
    require(outcome, "outcome");
    if (capacity == 0)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "capacity must be at least 1");
    source->block = {};
    const ReadResult result =
        source->impl->read({frames, capacity}, std::chrono::milliseconds(timeout_ms));
    *count = result.count;
    *outcome = translate(result.outcome);
  });
}

ada4571_status ada4571_source_read_block(ada4571_source *source, size_t capacity, int timeout_ms,
                                         ada4571_block *block, ada4571_read_outcome *outcome) {
  return guard([&] {
    require(source, "source");
    require_struct(block, "block");
    require(outcome, "outcome");
    if (capacity == 0)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "capacity must be at least 1");
    source->block = {};
    RawFrames frames;
    const ReadOutcome result =
        source->device("blocks").read_raw(capacity, std::chrono::milliseconds(timeout_ms), frames);
    source->block = frames;
    block->count = frames.count;
    block->first_time_s = frames.count > 0 ? frames.time_s(0) : 0.0;
    block->last_time_s = frames.count > 0 ? frames.time_s(frames.count - 1) : 0.0;
    *outcome = translate(result);
  });
}

ada4571_status ada4571_source_block_time(const ada4571_source *source, size_t index,
                                         double *time_s) {
  return guard([&] {
    require(source, "source");
    require(time_s, "time_s");
    if (index >= source->block.count)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "index is past the last frame of the block");
    *time_s = source->block.time_s(index);
  });
}

ada4571_status ada4571_source_get_fd(ada4571_source *source, int *fd) {
  return guard([&] {
    require(source, "source");
    require(fd, "fd");
    *fd = source->impl->poll_fd();
  });
}

ada4571_status ada4571_source_cancel(ada4571_source *source) {
  return guard([&] {
    require(source, "source");
    source->impl->cancel();
  });
}

ada4571_status ada4571_source_stop(ada4571_source *source) {
  return guard([&] {
    require(source, "source");
    source->block = {};
    source->impl->stop();
  });
}

ada4571_status ada4571_source_get_statistics(const ada4571_source *source,
                                             ada4571_source_statistics *statistics) {
  return guard([&] {
    require(source, "source");
    require_struct(statistics, "statistics");
    const SourceStatistics s = source->impl->statistics();
    statistics->frames = s.frames;
    statistics->lost = s.lost;
    statistics->gaps = s.gaps;
    statistics->first_timestamp_ns = s.first_timestamp_ns;
    statistics->bad_times = s.bad_times;
  });
}

ada4571_status ada4571_model_for_source(const ada4571_model *model, const ada4571_source *source,
                                        ada4571_model **out) {
  return guard([&] {
    require(model, "model");
    require(source, "source");
    require(out, "out");
    *out = new ada4571_model{source->at_its_supply(model->impl)};
  });
}

ada4571_status ada4571_source_read_calibration(ada4571_source *source, ada4571_model **model) {
  return guard([&] {
    require(source, "source");
    require(model, "model");
    if (!source->calibration_file.empty()) {
      *model = new ada4571_model{source->at_its_supply(read_model(source->calibration_file))};
      return;
    }
    const auto *iio = dynamic_cast<IioSource *>(source->impl.get());
    if (!iio)
      throw Error(ADA4571_ERROR_NOT_FOUND, "a recording or simulation stores no calibration");
    const SourceInfo &info = iio->info();
    *model = new ada4571_model{model_of(source->device("").read_driver_calibration(), info.supply_v,
                                        info.periods_per_turn)};
  });
}

ada4571_status ada4571_source_write_calibration(ada4571_source *source,
                                                const ada4571_model *model) {
  return guard([&] {
    require(source, "source");
    require(model, "model");
    IioSource &device = source->device("calibbias and calibscale");
    const DriverCalibration present = device.read_driver_calibration();
    device.write_driver_calibration(
        driver_calibration_of(model->impl, present, device.info().supply_v));
  });
}

ada4571_status ada4571_source_save_config(const ada4571_source *source, const char *name,
                                          const char *calibration_path) {
  return guard([&] {
    require(source, "source");
    require(name, "name");
    StoredConfig config;
    config.source = source->device("an address that can be stored").resolved_options();
    config.pins = source->pins;
    config.calibration_file = source->calibration_file;
    if (const std::optional<StoredConfig> before = load_config_if_any(name)) {
      if (!config.pins.gc && !config.pins.pd)
        config.pins = before->pins;
      if (config.calibration_file.empty())
        config.calibration_file = before->calibration_file;
    }
    if (calibration_path) {
      config.calibration_file = calibration_path;
      if (*calibration_path)
        read_model(calibration_path); // never a name behind which there is none
    }
    save_config(name, config);
  });
}

void ada4571_source_free(ada4571_source *source) {
  delete source;
}

ada4571_status ada4571_device_list_new(const char *uri, ada4571_device_list **list) {
  return guard([&] {
    require(list, "list");
    *list = new ada4571_device_list{list_iio_devices(uri ? uri : "local:")};
  });
}

size_t ada4571_device_list_count(const ada4571_device_list *list) {
  return list ? list->entries.size() : 0;
}

ada4571_status ada4571_device_list_get(const ada4571_device_list *list, size_t index,
                                       ada4571_device *device) {
  return guard([&] {
    require(list, "list");
    require(device, "device");
    if (index >= list->entries.size())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "index is past the last device");
    const IioListEntry &entry = list->entries[index];
    ada4571_device out{};
    out.struct_size = sizeof out;
    out.id = entry.device.id.c_str();
    out.name = entry.device.name.c_str();
    out.label = entry.device.label.c_str();
    out.channels = entry.channels.c_str();
    out.sin_channel = entry.sin.c_str();
    out.cos_channel = entry.cos.c_str();
    out.temp_channel = entry.temp.c_str();
    out.vdd_channel = entry.vdd.c_str();
    out.labelled = entry.labelled;
    *device = out;
  });
}

void ada4571_device_list_free(ada4571_device_list *list) {
  delete list;
}

} // extern "C"
