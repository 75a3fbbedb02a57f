// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes held against what nobody can name.
#pragma once

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/search/search.h"

namespace ada {

/// What a search for causes begins with.
struct SearchStart {
  const Scene &scene, &judge; ///< of the training and of the held-out data
  Model baseline;             ///< without any finding
  double noise_v;
  Report report;
};

/// What has no physical name beside a model, signatures included. `left`: what `model` leaves over.
Unnamed unnamed_beside(const Scene &scene, const DataSplit &split, const Model &model,
                       const Anonymous &left, double noise_v);

/// Goes on from what was found, with what nobody can name as a part of the noise: its coefficients
/// have the variance that is left of them, which falls with every true cause and rises with every
/// false one that goes. Thins the training data to what such fits can hold and colours them, unless
/// nothing is left without a name.
SearchResult name_against_anonymous(const SearchStart &start, DataSplit &split, SearchResult found);

} // namespace ada
