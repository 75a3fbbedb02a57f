// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The public header alone, first and twice, as C++11.
#include "ada4571.h"

static_assert(ADA4571_OK == 0, "success is zero");
static_assert(sizeof(ada4571_frame) == 6 * sizeof(double), "a frame has no padding");

int main() {
  return ada4571_last_error() != nullptr ? 0 : 1;
}
