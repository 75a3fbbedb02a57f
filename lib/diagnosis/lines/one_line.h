// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One line of the spectrum: whose it is only a change of speed tells.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Effects whose one line is that of the effect at this place of the model as far as these samples
/// tell: a line of the time where that of the model is one of the angle, and the reverse. With
/// `variance_v2` of a reading, the other would lose them less than criteria::kRivalNats.
std::vector<const Effect *> same_line(const Observations &data, const Model &model,
                                      std::size_t effect, double variance_v2);

} // namespace ada
