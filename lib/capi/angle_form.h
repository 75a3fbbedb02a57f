// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include "base/error.h"
#include "conversion/angle_file.h"

namespace ada::capi {

inline AngleForm angle_form_of(ada4571_angle_form form) {
  switch (form) {
  case ADA4571_ANGLES_BY_NAME:
    return AngleForm::by_name;
  case ADA4571_ANGLES_TEXT:
    return AngleForm::text;
  case ADA4571_ANGLES_SIGMF:
    return AngleForm::sigmf;
  }
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "form is not an ada4571_angle_form");
}

} // namespace ada::capi
