// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An IIO device made ready for a capture: which channels, how their bytes become volts, how large
// the buffers are.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/iio_source.h"

namespace ada {

/// One signal of the pair and its companions: where its volts go in a frame.
struct Signal {
  ElementDecoder decoder;
  double Frame::*target = nullptr;
  std::size_t element = 0; ///< position in the layout
};

/// All that is found on the device; made anew after a loss.
struct OpenedDevice {
  std::unique_ptr<IioContext> context;
  IioDevice device;
  ChannelChoice choice;
  std::vector<std::string> scan;   ///< ids of the enabled channels in scan order
  std::vector<ScanFormat> formats; ///< theirs
  std::vector<Signal> signals;
  std::optional<std::pair<ElementDecoder, std::size_t>> timestamp; ///< with its element
  SourceInfo info;
  std::optional<double> rate_before; ///< that opening has changed

  const IioChannel &channel(std::size_t i) const { return device.channels[i]; }
};

/// Throws INVALID_ARGUMENT for a number out of its range.
void check_options(const IioSourceOptions &options);

/// Finds device and channels, sets trigger, rate and clock; `cancellation` as for
/// open_iio_context().
OpenedDevice open_iio_device(const IioSourceOptions &options,
                             const Cancellation *cancellation = nullptr);

/// Leaves a device that was opened and never read at the rate at which it was found.
void set_rate_back(OpenedDevice &opened) noexcept;

/// Frames of a buffer: as many as asked for, else as many as the latency allows.
std::size_t buffer_frames(const OpenedDevice &opened, const IioSourceOptions &options);

/// How many such buffers the kernel is asked for.
unsigned kernel_buffers(const OpenedDevice &opened, std::size_t frames);

/// The device and the channels as found, under names that outlive a boot where there are such.
IioSourceOptions named_as_found(const OpenedDevice &opened, const IioSourceOptions &options);

} // namespace ada
