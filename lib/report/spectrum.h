// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Spectral density over frequencies that are evenly spaced on a logarithmic axis: mean and largest
/// of each step, so that a line stays one.
struct Spectrum {
  struct Density {
    std::vector<double> mean, peak; ///< uV/sqrt(Hz), mean of both channels
  };
  std::vector<double> frequency_hz;
  double highest_hz = 0.0;      ///< half the sample rate
  std::vector<Density> density; ///< one a model
};

/// Welch's estimate: averaged spectra of windowed stretches without gaps, as long as there are
/// enough of them. Empty where no stretch is long enough.
Spectrum residual_spectrum(const Observations &data, const std::vector<const Model *> &models);

} // namespace ada
