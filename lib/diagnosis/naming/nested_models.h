// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From the baseline up, one finding at a time: what each of them gains.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// Wald's statistic of a finding over the number of its coordinates: of its own, and beyond what
/// the best of all places that it could have been found at has by chance. `as_said`: of its own, by
/// errors that count what other causes may be in its place.
struct Clearness {
  double own, beyond_chance, as_said;
};

struct NestedModels {
  Model baseline, extended;
  std::vector<Model> models;     ///< the baseline first, then the model after each finding
  std::optional<Finding> supply; ///< one that is not recorded: it weighs every later step
  std::vector<Finding> findings; ///< in the order of `found`
  /// How clearly each finding differs from none, in the square of standard errors (Wald's test over
  /// its coordinates, a mean of them).
  std::vector<Clearness> clearness;
  SplitQuality first, last;
  bool by_direction = false; ///< the direction alone tells the figure of the extended model
};

/// Findings in the order of their size, each step fitted to the training part and judged on the
/// rest. Leaves `parts` weighed as what was found asks for.
NestedModels nested_models(const Scene &scene, DataSplit &split, const SearchResult &found);

/// The fit in which residuals along the vector weigh by their own scatter, and what has no name
/// lies along it alone; nothing where more than noise is left across. `bent`: what lies along it
/// may have bent `model` so far that as much is left across.
std::optional<FitResult> fit_by_direction(DataSplit split, Model model, bool bent = false);
/// How clear the causes of a model are by the length alone, with a weight of what lies across the
/// vector that makes both scatter alike; none where the fit does not determine them.
std::vector<Clearness> clear_by_length(DataSplit split, const Model &start, double weight_across);
/// Whether more than noise is left along the vector.
bool leaves_length(const Observations &data, const Model &model);
/// Whether the angle of held-out data is clearly better by the one than by the other.
bool is_clearly_closer(const DataSplit &split, const Model &apart, const Model &alike);

/// Residual along the radius at the angle that the pair itself gives with a model: what is no
/// matter of the motion. From its mean over each electrical period: a length that drifts says
/// nothing of the ellipse.
struct RadiusLeft {
  double rms_v;
  /// Independent samples, of which it holds as many as its differences from sample to sample have
  /// of its mean square: white noise all of them, a slow process few.
  double samples;
};
RadiusLeft radius_left(const Observations &data, const Model &model);

/// Nats by which the radius is likelier with the other model, of Gaussian noise of unknown size.
inline double nats_between(const RadiusLeft &one, const RadiusLeft &other) {
  return std::min(one.samples, other.samples) * std::log(one.rms_v / std::max(other.rms_v, 1e-12));
}

/// The model with all that every pair has, where a reference errs by more than what is left along
/// the vector and hides a part of it, and the length of held-out data shows that it is there.
/// Nothing otherwise.
std::optional<Model> with_what_the_length_shows(const DataSplit &split, const Model &model);

/// Adds what a person reads: the cause in a sentence, and what would tell it from its rivals.
void put_in_words(Finding &finding);

} // namespace ada
