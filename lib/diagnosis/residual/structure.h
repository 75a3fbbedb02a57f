// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The last look: what no cause took out, and where it lives.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"
#include "diagnosis/words/result.h"
#include "model/model.h"

namespace ada {

struct LeftOver {
  std::vector<Structure> structure;
  std::vector<Structure> of_rows; ///< what rows are wrong: no random cause accounts for them
  double unexplained_rms_v = 0.0;
  bool bursts = false; ///< samples in a row are left over
  bool of_few_rows = false; ///< all that `structure` says is that something goes on
};

/// What a last look may take for explained.
struct Explained {
  double noise_v = 0.0;        ///< white noise, excess-noise included
  double second_order_v = 0.0; ///< products of what was found
  bool noise_stated = false;   ///< by the capture; otherwise it is the residual's own
  bool supply_inferred = false;
  int orders = 0; ///< that the model without names has of what goes with the angle
};

/// Leaves in `scene.all` a few long runs of what no spike stands out of, without a reference at
/// the pair's own angle. Returns what the angle showed before that.
std::vector<Structure> keep_for_last_look(Scene &scene, const Model &model, double noise_v);

/// Whiteness is judged on everything that is kept, held out or not. `last`: quality of the model
/// with what noise causes take out; `angle`: what keep_for_last_look returned.
LeftOver left_over(const Scene &scene, const DataSplit &split, const Model &model,
                   const Explained &explained, const SplitQuality &last,
                   const std::vector<Structure> &angle);

/// Products of what was found are not modelled to the last term: rms to expect of them, V.
double second_order_floor(const Model &model, const SearchResult &found);

} // namespace ada
