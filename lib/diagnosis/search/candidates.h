// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How much of a residual each effect of the catalogue could explain, to first order and in one
// pass over the data, with everything already in the model free to move.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

struct Candidate {
  const Effect *effect;
  Model start;         ///< the model with the effect added, moved by the linear solution
  double gain;         ///< expected fall of the sum of squares, V^2
  std::size_t freedom; ///< coordinates that it adds
  bool visible;        ///< whether this capture can show it as such
  /// The same with other guesses of the effect, with their gains, best first: the best may have a
  /// number that the capture does not determine, as the lower of two levels that is never reached.
  std::vector<std::pair<double, Model>> others;
};

/// Whether only a motion that is known shows the effect: it turns the angle and leaves the radius
/// as it is.
bool needs_motion(const Effect &effect);

/// What effects are shown: the residual of `data` against `model` with the facts of the scene. The
/// columns must outlive the result.
struct ResidualColumns;
Residual residual_view(const Scene &scene, const Observations &data, const ResidualColumns &columns,
                       double noise_v, double amplitude_v);

/// Whether a capture can show an effect as such. One that it cannot may be an alternative of what
/// looks the same, and never leads.
bool can_show(const Scene &scene, const Model &model, const Effect &effect);

/// Best variant of each effect, by gain, best first: also of those that this capture cannot show as
/// such, but which may look like another. `signatures`: with shapes whose physical cause is open.
std::vector<Candidate> candidates(const Scene &scene, const Observations &data, const Model &model,
                                  bool signatures);

} // namespace ada
