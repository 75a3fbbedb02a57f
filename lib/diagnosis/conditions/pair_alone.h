// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Beside a reference that is none of this shaft (health/reference_share.h) a pair that draws its
// circle is judged by itself: that is worth more than a model that is bent to a stranger.
#pragma once

#include <optional>
#include <vector>

#include "calibration/ellipse_fit.h"
#include "recording/capture.h"

namespace ada {

bool draws_its_circle(const Capture &capture);

Capture without_reference(Capture capture);

/// The ellipse that readings draw by themselves; none where they show too little of one.
std::optional<EllipseFit> own_ellipse(const std::vector<double> &vsin,
                                      const std::vector<double> &vcos);

/// How far the readings lie off the ellipse that they draw, rms, V; infinite where they draw none.
double off_own_figure_v(const Capture &capture);

} // namespace ada
