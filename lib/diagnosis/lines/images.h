// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include "diagnosis/conditions/observations.h"

namespace ada {

/// Without a reference the motion is read off the pair and takes what is slow of anything that lies
/// along the circle. Of a tone at f it takes a part, and leaves an image at 2 f_e - f (f_e: the
/// frequency of the pair), as far from f_e on the other side. Gives back to each tone what its
/// image says was taken, and drops the image.
void fold_images(const Observations &data, Model &model);

} // namespace ada
