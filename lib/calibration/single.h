// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The application note's single-temperature calibration. docs/calibration.md has its misprints.
#pragma once

#include "calibration/pair_estimate.h"
#include "model/model.h"

namespace ada {

Model calibrate_single(const RecordingToFit &what, CalibrationMethod method);
Model calibrate_single(const Capture &capture, CalibrationMethod method);

/// The model that an estimate is, with its provenance: of a capture with this metadata and this
/// identity. Mismatch and quadrature error become effects where they were estimated.
Model model_of(const PairEstimate &estimate, const CaptureMetadata &meta,
               const std::string &identity, const std::string &method);

/// What no calibration is of, though an ellipse fits it: a shape that is no circle's, or a middle that
/// the stated supply cannot have. Throws ADA4571_ERROR_UNUSABLE_DATA.
void refuse_implausible(const PairEstimate &estimate, const CaptureMetadata &meta);

/// The model, unless it holds what no file may: then the capture is UNUSABLE_DATA, and it is said why.
Model possible(Model model);

/// An effect of the catalogue with its numbers; of its last parameters, those that may be absent and
/// have no number are absent. Throws ADA4571_ERROR_INTERNAL when the catalogue does not hold it or
/// counts other parameters.
EffectInstance effect_instance(std::string_view id, std::vector<double> values,
                               std::vector<double> std_errors);

} // namespace ada
