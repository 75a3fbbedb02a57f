// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include "calibration/recording_to_fit.h"
#include "capi/handles.h"

namespace ada::capi {

/// What a fit to a recording takes, and the fit once it was made: a calibration and the check after
/// it share them.
inline const RecordingToFit &to_fit(const ada4571_recording &recording) {
  if (!recording.to_fit)
    recording.to_fit = std::make_shared<const RecordingToFit>(*recording.impl);
  return *recording.to_fit;
}

} // namespace ada::capi
