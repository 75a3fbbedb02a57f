// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A model beside the best one that names nothing: where the simulation is wrong, how much of that
// has a name, and what is carried without one.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/anonymous/discrepancy.h"
#include "diagnosis/search/data_split.h"
#include "diagnosis/words/result.h"

namespace ada {

/// What a model leaves over, by axis.
struct Anonymous {
  Basis basis;
  Products from;
  Selection selection;
  std::vector<SpectralLine> lines; ///< that the basis has
  std::vector<double> steps_s;     ///< moments of its steps, the largest first
  int orders = 0;                  ///< that it was asked for
  bool any() const { return !selection.columns.empty(); }
};

/// What an anonymous model is fitted to and judged on.
struct Halves {
  Observations train, heldout;
  ResidualColumns train_left, heldout_left;
  bool judged_apart = false; ///< by a second capture
  bool operator==(const Halves &) const = default;
};

/// The last answers of anonymous_of, by all that they were computed from: many questions repeat one
/// of the two before. And what the bases of all of them have in common. For one thread.
class RecentAnonymous {
public:
  struct Question {
    const Scene *scene;
    Halves halves;
    double zero_rad;
    Asked asked;
    bool operator==(const Question &) const = default;
  };
  const Anonymous *find(const Question &question) const;
  void keep(Question question, const Anonymous &answer);
  SumsOfHalves &sums() { return sums_; }

private:
  std::vector<std::pair<Question, Anonymous>> kept_; ///< the latest last
  SumsOfHalves sums_;
};

/// The anonymous model of what `model` leaves over. Steps in time and lines of the spectrum are
/// looked for in what the other axes leave. Without speed, temperature and supply: as a process
/// that follows none of them would have it.
Anonymous anonymous_of(const Scene &scene, const DataSplit &split, const Model &model,
                       Asked asked = {});

/// The same with the columns that were chosen for another model and the prior that their
/// coefficients had there, in place of its own choice.
Anonymous anonymous_alike(const Scene &scene, const DataSplit &split, const Model &model,
                          const Anonymous &other);

/// A residual of `model` without what goes with any other axis than the angle: what changes with
/// the direction, say, is another one each time that the shaft passes a place, and hides what is
/// the same.
ResidualColumns of_the_angle_alone(const Anonymous &left, const Observations &data,
                                   const Model &model, ResidualColumns residual);

/// Held-out mean square, V^2 of a channel, that a model leaves beside what repeats with the angle,
/// of the orders that `other` has. The baseline is fitted along: it does not wait for those orders.
double left_beside_angle(const DataSplit &split, const Model &model, const Anonymous &other);

/// How well a model does together with its anonymous part.
Quality quality_with(const Anonymous &left, const DataSplit &split, const Model &model);

/// The budget: `whole` is of the baseline, `unnamed` of the model with all that has a name.
std::vector<BudgetLine> budget_of(const Anonymous &whole, const Anonymous &unnamed);

/// Noise that the anonymous model leaves, by channel and along and across the vector, V rms.
NoiseShape noise_shape(const Anonymous &left, const DataSplit &split, const Model &model);

/// The model with what repeats with the angle and has no name, fitted to `data` together with the
/// baseline; without one where held-out data did not confirm any. `weight_along`: how much less
/// what lies along the vector weighs.
Model with_remainder(const Scene &scene, const Anonymous &left, const Observations &data,
                     Model model, double weight_along = 1.0);

/// What the remainder of a model turns the vector by at each sample, rad, mechanical.
std::vector<double> turned_by_remainder(const Observations &data, const Model &model);

/// The same, rms over the data, in degrees.
double remainder_angle_rms(const Observations &data, const Model &model);

} // namespace ada
