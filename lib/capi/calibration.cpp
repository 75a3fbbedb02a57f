// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "calibration/dual.h"
#include "calibration/single.h"
#include "capi/guard.h"
#include "capi/handles.h"
#include "capi/to_fit.h"

namespace {

ada::CalibrationMethod method_of(ada4571_calibration_method method) {
  switch (method) {
  case ADA4571_CALIBRATE_FIT:
    return ada::CalibrationMethod::fit;
  case ADA4571_CALIBRATE_MEAN:
    return ada::CalibrationMethod::mean;
  case ADA4571_CALIBRATE_EXTREMA:
    return ada::CalibrationMethod::extrema;
  }
  throw ada::Error(ADA4571_ERROR_INVALID_ARGUMENT, "method is not an ada4571_calibration_method");
}

} // namespace

extern "C" {

ada4571_status ada4571_calibrate_single(const ada4571_recording *recording,
                                        ada4571_calibration_method method, ada4571_model **model) {
  return ada::capi::guard([&] {
    ada::capi::require(recording, "recording");
    ada::capi::require(model, "model");
    *model = new ada4571_model{
        ada::calibrate_single(ada::capi::to_fit(*recording), method_of(method))};
  });
}

ada4571_status ada4571_calibrate_dual(const ada4571_recording *cold, const ada4571_recording *hot,
                                      ada4571_calibration_method method, ada4571_model **model) {
  return ada::capi::guard([&] {
    ada::capi::require(cold, "cold");
    ada::capi::require(hot, "hot");
    ada::capi::require(model, "model");
    *model = new ada4571_model{ada::calibrate_dual(*cold->impl, *hot->impl, method_of(method))};
  });
}

} // extern "C"
