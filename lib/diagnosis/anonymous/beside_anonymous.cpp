// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/beside_anonymous.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "diagnosis/criteria.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/fit.h"

namespace ada {

Observations thinned(const Observations &train) {
  std::vector<std::uint32_t> all(train.size());
  std::iota(all.begin(), all.end(), 0u);
  Observations out = train;
  out.keep(thin(all, criteria::kAnonymousTrain, 100));
  return out;
}

double nats_beside(const Anonymous &left) {
  return -0.5 * left.from.told() *
         std::log(std::max(left.selection.noise_v2, criteria::kLeastMeanSquare));
}

double nats_beside_anonymous(const Scene &scene, const DataSplit &split, const Model &model) {
  return nats_beside(anonymous_of(scene, split, model));
}

namespace {

/// Columns of the anonymous part that repeat with the angle.
std::vector<Eigen::Index> angle_columns(const Anonymous &of) {
  std::vector<Eigen::Index> out;
  for (Eigen::Index column : of.selection.columns)
    if (of.basis.groups()[static_cast<std::size_t>(column / 2)].axis == Axis::angle)
      out.push_back(column);
  return out;
}

/// What one more column without a name takes, beside others, of the mean square that is left, V^2.
double taken_by(Eigen::Index column, const Anonymous &of, std::vector<Eigen::Index> beside) {
  const double before = select(of.basis, of.from, beside).noise_v2;
  beside.push_back(column);
  return before - select(of.basis, of.from, std::move(beside)).noise_v2;
}

} // namespace

bool takes_most(const DataSplit &split, const Model &with, const Model &without,
                const Effect &cause, const Anonymous &beside_without) {
  const double free = beside_without.selection.noise_v2;
  const auto most = [&](double left, double left_without, const std::vector<Eigen::Index> &beside) {
    const double nats = 0.5 * beside_without.from.told() *
                        std::log(std::max(left_without, criteria::kLeastMeanSquare) /
                                 std::max(left, criteria::kLeastMeanSquare));
    if (nats < criteria::kLeastNats || left - free >= criteria::kOfRival * (left_without - free))
      return false;
    const auto &columns = beside_without.selection.columns;
    // A function of what the cause goes with says the same without its law. Where the law leaves
    // next to nothing, one that leaves less is no rival.
    const bool nearly_all = left - free < criteria::kNextToNothing * (left_without - free);
    const auto says_the_same = [&](Eigen::Index column) {
      const Axis axis = beside_without.basis.groups()[static_cast<std::size_t>(column / 2)].axis;
      return nearly_all && axis != Axis::angle && axis_name(axis) == cause.info().axis;
    };
    return std::none_of(columns.begin(), columns.end(), [&](Eigen::Index column) {
      return !says_the_same(column) &&
             std::find(beside.begin(), beside.end(), column) == beside.end() &&
             taken_by(column, beside_without, beside) > left_without - left + free;
    });
  };
  if (most(left_v2(split, with), left_v2(split, without), {}))
    return true;
  const std::vector<Eigen::Index> angle = angle_columns(beside_without);
  return !angle.empty() && shows_beyond_angle(cause) &&
         most(left_beside_angle(split, with, beside_without),
              left_beside_angle(split, without, beside_without), angle);
}

Taken taken(const Scene &scene, DataSplit split, const Model &model, std::size_t effect) {
  split.train = thinned(split.train);
  split.train.coloured.reset();
  const Model less = fit(split.train, model.without(effect), kRefit).model;
  const Model with = fit(split.train, model, kRefit).model;
  return {takes_most(split, with, less, *model.effects[effect].effect,
                     anonymous_of(scene, split, less)),
          1.0 - left_v2(split, with) / std::max(left_v2(split, less), criteria::kLeastMeanSquare)};
}

} // namespace ada
