// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include "report/view.h"

namespace ada {

/// Welch's estimate: averaged spectra of windowed stretches without gaps. Empty where no stretch is
/// long enough.
Spectrum residual_spectrum(const Observations &data, const std::vector<const Model *> &models);

} // namespace ada
