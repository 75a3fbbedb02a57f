// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A model together with what has no name beside it.
#pragma once

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/search/data_split.h"

namespace ada {

inline constexpr int kRefit = 6; ///< iterations of a fit that goes on from one of nearly the same

/// Training data of a size that coloured fits can hold.
Observations thinned(const Observations &train);

/// Held-out log likelihood, nats, of a model together with what has no name beside it.
double nats_beside(const Anonymous &left);
double nats_beside_anonymous(const Scene &scene, const DataSplit &split, const Model &model);

/// Whether what a cause adds takes more of what is left above the noise than any shape does by
/// chance, and no single column without a name takes more still: that would be nearer to what is
/// there. A cause that shows beyond the angle is also held against what is left there only.
bool takes_most(const DataSplit &split, const Model &with, const Model &without,
                const Effect &cause, const Anonymous &beside_without);

/// What an effect of the model takes of held-out data.
struct Taken {
  /// More of what is left above the noise without it than any shape takes by chance, and no single
  /// column without a name is nearer to what is there.
  bool most;
  double of_left; ///< part of all that is left without it, noise and all
};
Taken taken(const Scene &scene, DataSplit split, const Model &model, std::size_t effect);

} // namespace ada
