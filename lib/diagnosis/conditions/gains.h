// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Several records of one sensor whose pairs differ in length: between them a magnet, an air gap or
// a gain was changed.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/noise/random_causes.h"
#include "model/model.h"

namespace ada {

/// The pair of each stretch: its length over that of a model, and the centre that it turns about,
/// V.
class StretchGains {
public:
  /// Least squares of all stretches together, in turns of what is each one's own (length, centre)
  /// and what they have in common (the model, with what every pair has): a length that is wrong
  /// bends the common shape, and the other way round. `starts_s`: when each begins, ascending.
  StretchGains(std::vector<double> starts_s, const Scene &scene, const Model &model);

  /// The model with what every pair has, as all stretches have it in common.
  const Model &common() const { return common_; }

  struct Own {
    double gain, sin_v, cos_v;
  };
  const std::vector<Own> &own() const { return own_; }

  /// The cause of the catalogue that this is: the scatter of the lengths over their mean.
  RandomCause as_cause(double nats, double moved_v2) const;

  /// Gives a sample the length that the model has.
  void take_out(double time_s, float &vsin_v, float &vcos_v) const;
  /// And the centre that the stretches have in the mean.
  void take_out_with_centre(double time_s, float &vsin_v, float &vcos_v) const;

private:
  std::vector<double> starts_s_;
  std::vector<Own> own_;
  Model common_;

  const Own &at(double time_s) const;
  void estimate(const Observations &data, const Model &model);
};

/// When each record of several begins, s.
std::vector<double> starts_of_records_s(const Capture &joined);

/// When the shaft turns back, s, where it does so once.
std::optional<double> turns_back_once_s(const Observations &data);

/// Whether a length and a zero angle of each record's own could take all that an effect of the model
/// moves, as they can of what a filter does at one speed each.
bool held_by_records(const Capture &joined, const Observations &data, const Model &model,
                     std::size_t effect);

/// By how much the lengths of the pair over those of a model differ from record to record, rms over
/// their mean, whatever the zero angles are.
double scatter_of_lengths(const Capture &joined, const Observations &data, const Model &model);

} // namespace ada
