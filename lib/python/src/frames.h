// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Frames and angles as structured numpy arrays, whose memory the library reads and writes itself.
#pragma once

#include <pybind11/numpy.h>

#include "call.h"

namespace binding {

/// An array that is taken only as it lies: another type or layout is refused, never copied.
using Frames = py::array_t<ada4571_frame, py::array::c_style>;
using Angles = py::array_t<ada4571_angle, py::array::c_style>;

inline Frames as_frames(const py::object &given) {
  if (!py::isinstance<Frames>(given))
    throw py::type_error("frames are a contiguous array of ada4571.frame_dtype, as blocks() and "
                         "Recording.frames give them");
  return py::reinterpret_borrow<Frames>(given);
}

} // namespace binding
