// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <vector>

#include "recording/capture.h"

namespace ada {

/// The electrical angle of a pair as it was read, rad in (-pi, pi], about the middle of the bulk of
/// either channel: before anything is known of its ellipse.
std::vector<double> own_angle(const Capture &capture);

} // namespace ada
