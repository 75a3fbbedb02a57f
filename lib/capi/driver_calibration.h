// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A model as the calibbias and calibscale of an IIO driver, and back. With volts V = (raw + offset)
// * scale of an uncorrected reading, the driver's (raw + calibbias) * calibscale is centred and has
// the nominal amplitude 0.29 VDD of the data sheet's typical part (assumed):
//
//   calibbias = -O / scale   (whole counts: most drivers take no others)
//   calibscale = A_nominal / A_channel   (six decimals: what sysfs keeps)
//
// with O the offset of the channel, A_sin = A (1 + k/2) and A_cos = A (1 - k/2).
#pragma once

#include "acquisition/iio_source.h"
#include "model/model.h"

namespace ada {

/// Offsets and amplitudes only; attributes that `present` lacks stay absent.
DriverCalibration driver_calibration_of(const Model &model, const DriverCalibration &present,
                                        double supply_v);

/// Throws NOT_FOUND when the driver holds nothing but its defaults (bias 0, scale 1), FORMAT when a
/// value makes no sense.
Model model_of(const DriverCalibration &calibration, double supply_v, int periods_per_turn);

} // namespace ada
