// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The handles that more than one section of the C API needs; all others are private to their file.
#pragma once

#include <memory>
#include <string>

#include "acquisition/raw_frames.h"
#include "acquisition/source.h"
#include "model/effect.h"
#include "model/model.h"
#include "recording/recording.h"

namespace ada {
class Simulation;
struct RecordingToFit;
} // namespace ada

namespace ada::capi {
/// A parameter as callers see it; defined in model.cpp.
ada4571_parameter to_parameter(const ParameterInfo &info, double value, double std_error);
/// The block that was read last, and the form of all of them (UNSUPPORTED where there are none);
/// defined in source.cpp.
const RawFrames &block_of(const ada4571_source &source);
const RawForm &raw_form_of(const ada4571_source &source);
} // namespace ada::capi

struct ada4571_model {
  ada::Model impl;
};

/// Recordings are immutable once open, so a handle shares them.
struct ada4571_recording {
  std::shared_ptr<const ada::Recording> impl;
  mutable std::string metadata_value{}; ///< what ada4571_recording_metadata gave last
  mutable ada::Block block{};           ///< of which ada4571_recording_read gave frames last
  mutable std::shared_ptr<const ada::RecordingToFit> to_fit{}; ///< once one was needed
};

struct ada4571_simulation {
  std::shared_ptr<const ada::Simulation> impl;
};
