// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What is left over in a capture of too few rows for means over angle, time and temperature.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/words/result.h"
#include "model/model.h"

namespace ada {

/// Lines that come with the rows, as the steps of a motor give that turns the shaft from one
/// reading to the next: along the vector and, beside a reference, across it. `least_rms_v` of a
/// channel is worth a word.
std::vector<Structure> find_lines_of_rows(const Scene &scene, const Observations &data,
                                          const ResidualColumns &residual, double least_rms_v,
                                          int orders);

/// Part that such lines have of what the model leaves across the vector, beside a reference: that
/// is no noise, although neighbours do not share it. 0 of more rows, where the line finders look.
double share_of_lines_across(const Scene &scene, const Model &model);

} // namespace ada
