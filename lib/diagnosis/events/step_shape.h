// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether what a fit takes for a step begins like one. Offsets that settle, and offsets that come
// with the speed, are fitted best by a step at some moment, and are none.
#pragma once

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Whether the data bear out that an effect with a moment begins at once there: within a turn
/// before it nothing of it is seen, within a turn after it all, and no smooth function of the speed
/// does as well. True where too little is seen to say. Not `told_from_speed`: such a function may
/// do as well, which two speeds that follow one another once always let it.
bool begins_at_once(const Scene &scene, const Model &model, std::size_t effect,
                    bool told_from_speed = true);

/// Whether such an effect of a model that lacks nothing else of that size comes in evenly over an
/// eighth of the rows of the turns on both sides of its moment or more, and over 64 of them, rather
/// than at once; where they do not tell, over an eighth of the record or more. False where too
/// little is seen to say.
bool comes_in_slowly(const Scene &scene, const Model &model, std::size_t effect);

} // namespace ada
