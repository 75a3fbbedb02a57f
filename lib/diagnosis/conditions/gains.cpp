// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/gains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "base/pick.h"
#include "base/solve.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

constexpr double kLeastGain = 0.1; ///< below a tenth of its length a vector tells no angle

} // namespace

std::vector<double> starts_of_records_s(const Capture &joined) {
  std::vector<double> out;
  for (std::size_t start : joined.starts)
    out.push_back(joined.time_s[start]);
  return out;
}

std::optional<double> turns_back_once_s(const Observations &data) {
  std::optional<double> out;
  int sense = 0;        // of the last row that moves
  double moved_s = 0.0; // when that was: around the turning point a shaft stands
  for (std::size_t i = 0; i < data.size(); ++i) {
    const int now = data.direction[i];
    if (now == 0)
      continue;
    if (sense != 0 && now != sense) {
      if (out)
        return std::nullopt;
      out = 0.5 * (moved_s + data.time[i]);
    }
    sense = now;
    moved_s = data.time[i];
  }
  return out;
}

StretchGains::StretchGains(std::vector<double> starts_s, const Scene &scene, const Model &model)
    : starts_s_(std::move(starts_s)), common_(with_expected(model)) {
  constexpr int kPasses = 4; // each leaves a hundredth, the size of a mismatch, of what was wrong
  for (int pass = 0; pass < kPasses; ++pass) {
    estimate(scene.all, common_);
    Observations alike = scene.all.select(scene.train);
    for (std::size_t i = 0; i < alike.size(); ++i)
      take_out(alike.time[i], alike.vsin[i], alike.vcos[i]);
    common_ = fit(alike, common_, 4).model;
  }
  estimate(scene.all, common_);
}

RandomCause StretchGains::as_cause(double nats, double moved_v2) const {
  double mean = 0.0, squares = 0.0;
  const double n = static_cast<double>(own_.size());
  for (const Own &own : own_)
    mean += own.gain / n;
  for (const Own &own : own_)
    squares += std::pow(own.gain / mean - 1.0, 2) / (n - 1.0);
  RandomCause out;
  out.effect = &the_effect([](const EffectInfo &e) {
    return e.evidence == Evidence::process && e.pattern == Pattern::gain;
  });
  out.values = {std::sqrt(squares)};
  out.std_errors = {std::sqrt(0.5 * squares / (n - 1.0))};
  out.nats = nats;
  out.slow_v2 = moved_v2;
  return out;
}

const StretchGains::Own &StretchGains::at(double time_s) const {
  const auto next = std::upper_bound(starts_s_.begin(), starts_s_.end(), time_s);
  return own_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, next - starts_s_.begin() - 1))];
}

void StretchGains::take_out(double time_s, float &vsin_v, float &vcos_v) const {
  const Own &own = at(time_s);
  vsin_v = as_float(own.sin_v + (vsin_v - own.sin_v) / own.gain);
  vcos_v = as_float(own.cos_v + (vcos_v - own.cos_v) / own.gain);
}

void StretchGains::take_out_with_centre(double time_s, float &vsin_v, float &vcos_v) const {
  const Own &own = at(time_s);
  double sin_v = 0.0, cos_v = 0.0;
  for (const Own &of : own_) {
    sin_v += of.sin_v / static_cast<double>(own_.size());
    cos_v += of.cos_v / static_cast<double>(own_.size());
  }
  vsin_v = as_float(sin_v + (vsin_v - own.sin_v) / own.gain);
  vcos_v = as_float(cos_v + (vcos_v - own.cos_v) / own.gain);
}

void StretchGains::estimate(const Observations &data, const Model &model) {
  const std::size_t records = starts_s_.size();
  const double sin_v = 0.5 * model.supply_v + model.baseline.offset_sin_v,
               cos_v = 0.5 * model.supply_v + model.baseline.offset_cos_v;
  const ResidualColumns r = residual_columns(data, model);
  std::vector<Eigen::Matrix3d> normal(records, Eigen::Matrix3d::Zero());
  std::vector<Eigen::Vector3d> right(records, Eigen::Vector3d::Zero());
  own_.assign(records, {1.0, sin_v, cos_v});
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto k = static_cast<std::size_t>(&at(data.time[i]) - own_.data());
    const Eigen::Vector3d of_sin{r.model_sin[i] - sin_v, 1.0, 0.0},
        of_cos{r.model_cos[i] - cos_v, 0.0, 1.0};
    normal[k] += of_sin * of_sin.transpose() + of_cos * of_cos.transpose();
    right[k] += of_sin * data.vsin[i] + of_cos * data.vcos[i];
  }
  for (std::size_t k = 0; k < records; ++k)
    if (const Eigen::Vector3d x = solved(normal[k], right[k]); x.allFinite())
      own_[k] = {std::max(x[0], kLeastGain), x[1], x[2]};
}

bool held_by_records(const Capture &joined, const Observations &data, const Model &model,
                     std::size_t effect) {
  constexpr double kRest = 0.01; // of the power: beside it nothing of the effect shows
  const ResidualColumns with = residual_columns(data, model),
                        without = residual_columns(data, model.without(effect));
  struct Sums {
    double moved = 0.0, along = 0.0, across = 0.0, length = 0.0;
  };
  std::vector<Sums> of(joined.starts.size());
  for (std::size_t i = 0; i < data.size(); ++i) {
    Sums &sums = of[capture_at(joined, data.time[i])];
    const double s = with.model_sin[i] - data.centre_sin_v,
                 c = with.model_cos[i] - data.centre_cos_v, ds = without.sin[i] - with.sin[i],
                 dc = without.cos[i] - with.cos[i];
    sums.moved += ds * ds + dc * dc;
    sums.along += ds * s + dc * c;
    sums.across += ds * c - dc * s;
    sums.length += s * s + c * c;
  }
  double moved = 0.0, rest = 0.0;
  for (const Sums &sums : of) {
    moved += sums.moved;
    rest += sums.moved - (sums.along * sums.along + sums.across * sums.across) /
                             std::max(sums.length, criteria::kLeastMeanSquare);
  }
  return rest < kRest * moved;
}

double scatter_of_lengths(const Capture &joined, const Observations &data, const Model &model) {
  const ResidualColumns r = residual_columns(data, model);
  std::vector<double> seen(joined.starts.size()), due(seen);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::size_t k = capture_at(joined, data.time[i]);
    seen[k] += std::pow(data.vsin[i] - data.centre_sin_v, 2) +
               std::pow(data.vcos[i] - data.centre_cos_v, 2);
    due[k] += std::pow(r.model_sin[i] - data.centre_sin_v, 2) +
              std::pow(r.model_cos[i] - data.centre_cos_v, 2);
  }
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (due[k] > 0.0) {
      const double length = std::sqrt(seen[k] / due[k]);
      sum += length;
      squares += length * length;
      n += 1.0;
    }
  const double mean = sum / std::max(n, 1.0);
  return mean > 0.0 ? std::sqrt(std::max(0.0, squares / n - mean * mean)) / mean : 0.0;
}

} // namespace ada
