// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Beside a reference that is none of this shaft (health/reference_share.h) a pair that draws its
// circle is judged by itself: that is worth more than a model that is bent to a stranger.
#pragma once

#include "recording/capture.h"

namespace ada {

bool draws_its_circle(const Capture &capture);

Capture without_reference(Capture capture);

} // namespace ada
