// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/step_shape.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// The effect as it would be at one sample, had it always been there, and what is seen there.
struct Sight {
  double effect[2], seen[2], speed;
};

/// What is seen on both sides of the moment, in the order of time.
struct Beside {
  std::vector<Sight> before, after;
  bool enough() const { return before.size() >= kFewest && after.size() >= kFewest; }
  static constexpr std::size_t kFewest = 8; ///< on a side
};

/// Part of the record that is looked at on either side.
constexpr double kReach = 0.1;

/// How much of the effect is seen on one side of the moment.
struct Side {
  double part = 0.0, variance = 1.0;
};

Side look_at(const std::vector<Sight> &sights) {
  double shape2 = 0.0, seen = 0.0, left = 0.0;
  for (const Sight &s : sights)
    for (int c = 0; c < 2; ++c) {
      shape2 += s.effect[c] * s.effect[c];
      seen += s.effect[c] * s.seen[c];
      left += s.seen[c] * s.seen[c];
    }
  Side side;
  if (shape2 > 0.0) {
    side.part = seen / shape2;
    side.variance = (left - seen * side.part) / (static_cast<double>(sights.size()) * shape2);
  }
  return side;
}

/// Sum of squares that is left of what is seen by a combination of `N` functions,
/// `functions(sample, place, channel)`.
template <int N, class Functions>
double left_over(const std::vector<Sight> &sights, Functions functions) {
  using Vector = Eigen::Matrix<double, N, 1>;
  Eigen::Matrix<double, N, N> normal = Eigen::Matrix<double, N, N>::Identity() * 1e-12;
  Vector right = Vector::Zero();
  double sum = 0.0;
  for (std::size_t k = 0; k < sights.size(); ++k)
    for (int c = 0; c < 2; ++c) {
      const Vector row = functions(sights[k], k, c);
      normal += row * row.transpose();
      right += row * sights[k].seen[c];
      sum += sights[k].seen[c] * sights[k].seen[c];
    }
  return sum - right.dot(normal.ldlt().solve(right));
}

/// The same of an effect that comes in with the place, as `part(place)` of it has; what else the
/// channels do meanwhile is a line of each.
template <class Part> double left_by(const std::vector<Sight> &sights, Part part) {
  const double middle = 0.5 * static_cast<double>(sights.size());
  return left_over<6>(sights, [&](const Sight &s, std::size_t k, int c) {
    const double line = (static_cast<double>(k) - middle) / middle;
    Eigen::Matrix<double, 6, 1> row;
    row << 1 - c, (1 - c) * line, c, c * line, s.effect[c], s.effect[c] * part(k);
    return row;
  });
}

/// Without the samples on the way from one speed to another: the motion is smooth, and where the
/// speed changes at once its own is between the two for as long as it is smoothed over.
void keep_settled(std::vector<Sight> &before, std::vector<Sight> &after) {
  constexpr double kSettled = 0.1; // of the change
  const auto usual = [](const std::vector<Sight> &side) {
    std::vector<double> speeds;
    for (const Sight &s : side)
      speeds.push_back(s.speed);
    return quantile(std::move(speeds), 0.5);
  };
  const double from = usual(before), to = usual(after);
  const auto on_the_way = [&](const Sight &s) {
    const double way = (s.speed - from) / (to - from);
    return way > kSettled && way < 1.0 - kSettled;
  };
  // Where the speed only swings about, or changes all the time, there is no such way.
  if (!(std::abs(to - from) > kSettled * std::max(std::abs(from), std::abs(to))))
    return;
  for (auto *side : {&before, &after})
    if (2 * static_cast<std::size_t>(std::count_if(side->begin(), side->end(), on_the_way)) >
        side->size())
      return;
  std::erase_if(before, on_the_way);
  std::erase_if(after, on_the_way);
}

std::vector<Sight> both(const Beside &of) {
  std::vector<Sight> out = of.before;
  out.insert(out.end(), of.after.begin(), of.after.end());
  return out;
}

/// Whether an offset that follows the speed would be seen just so.
bool goes_with_the_speed(Beside of) {
  keep_settled(of.before, of.after);
  constexpr double kNoWorse = 10.0; // nats, of the noise that the step leaves
  const std::vector<Sight> sights = both(of);
  double fastest = 0.0;
  for (const Sight &s : sights)
    fastest = std::max(fastest, std::abs(s.speed));
  if (!(fastest > 0.0))
    return false;
  const double step = left_over<2>(sights, [&](const Sight &s, std::size_t k, int c) {
    return Eigen::Vector2d(s.effect[c], k >= of.before.size() ? s.effect[c] : 0.0);
  });
  const double speed = left_over<3>(sights, [&](const Sight &s, std::size_t, int c) {
    const double part = s.speed / fastest;
    return Eigen::Vector3d(s.effect[c] * Eigen::Vector3d(1.0, part, part * part));
  });
  const double n = static_cast<double>(sights.size());
  return speed < step * (1.0 + 2.0 * kNoWorse / n);
}

/// By how much a step at the moment is likelier than what comes in evenly over an eighth of the
/// samples or more, nats. Over fewer samples than a filter takes to settle it is a step as well.
double likelier_than_slopes(const Beside &of) {
  constexpr double kWays[] = {0.125, 0.25, 0.5, 1.0};
  constexpr double kPlaces[] = {-0.4, -0.2, 0.0, 0.2, 0.4}; // of the way, from the moment
  constexpr double kSettles = 64.0;
  const std::vector<Sight> sights = both(of);
  const double n = static_cast<double>(sights.size());
  const auto from = [&](std::size_t k) {
    return static_cast<double>(k) - static_cast<double>(of.before.size());
  };
  const double step = left_by(sights, [&](std::size_t k) { return from(k) >= 0.0 ? 1.0 : 0.0; });
  double least = std::numeric_limits<double>::infinity();
  for (double way : kWays) {
    if (way * n < kSettles && way < 1.0)
      continue;
    for (double place : kPlaces)
      least = std::min(least, left_by(sights, [&](std::size_t k) {
                         return std::clamp(from(k) / (way * n) - place + 0.5, 0.0, 1.0);
                       }));
  }
  return 0.5 * n * std::log(least / step);
}

/// What the samples of a part of the record, in time order, say of an effect that begins.
class Beginning {
public:
  Beginning(const Scene &scene, const Model &model, std::size_t effect, Observations part)
      : near_(std::move(part)), reference_(scene.has_reference),
        moment_(model.effects[effect].values[0]) {
    if (!reference_)
      near_ = at_own_angle(std::move(near_), model);
    Model always = model;
    always.effects[effect].values[0] = std::numeric_limits<double>::lowest();
    without_ = residual_columns(near_, model.without(effect));
    with_ = residual_columns(near_, always);
    const auto later = std::lower_bound(near_.time.begin(), near_.time.end(), moment_);
    middle = static_cast<std::size_t>(later - near_.time.begin());
  }

  std::size_t middle; ///< the first sample of those after the moment

  std::size_t size() const { return near_.size(); }
  double alpha(std::size_t k) const { return near_.alpha[k]; }

  Sight at(std::size_t k) const {
    Sight out{{without_.sin[k] - with_.sin[k], without_.cos[k] - with_.cos[k]},
              {without_.sin[k], without_.cos[k]},
              near_.omega[k]};
    if (!reference_) { // only the radius tells
      const double s = near_.vsin[k] - near_.centre_sin_v, c = near_.vcos[k] - near_.centre_cos_v;
      const double inverse = 1.0 / std::max(std::hypot(s, c), 1e-12);
      for (double *v : {out.effect, out.seen}) {
        v[0] = (v[0] * s + v[1] * c) * inverse;
        v[1] = 0.0;
      }
    }
    return out;
  }

private:
  Observations near_;
  bool reference_;
  double moment_;
  ResidualColumns without_, with_;
};

/// What is seen in the turns on both sides of the moment.
Beside turns_beside(const Scene &scene, const Model &model, std::size_t effect) {
  const double moment = model.effects[effect].values[0];
  const Beginning near(scene, model, effect, scene.all.select(samples_near(scene, moment, kReach)));
  if (near.middle == near.size())
    return {};
  // Where rough motion was left out, the turns are those beside it: a few readings between the
  // moment and such a stretch are not a turn.
  const auto beside = [&](std::size_t first, bool on) {
    std::vector<Sight> out;
    std::size_t of = first;
    for (std::size_t k = first; k < near.size(); on ? ++k : --k) { // below 0: beyond the size
      if (std::abs(near.alpha(k) - near.alpha(of)) > kTwoPi) {
        if (out.size() >= Beside::kFewest)
          break;
        of = k;
      }
      out.push_back(near.at(k));
    }
    return out;
  };
  Beside out{beside(near.middle - 1, false), beside(near.middle, true)};
  std::reverse(out.before.begin(), out.before.end());
  return out;
}

/// The same of the whole record.
Beside whole_record(const Scene &scene, const Model &model, std::size_t effect) {
  constexpr std::size_t kEnough = 4000;
  std::vector<std::uint32_t> all(scene.all.size());
  std::iota(all.begin(), all.end(), 0u);
  const Beginning whole(scene, model, effect, scene.all.select(thin(all, kEnough, 100)));
  Beside out;
  for (std::size_t k = 0; k < whole.size(); ++k)
    (k < whole.middle ? out.before : out.after).push_back(whole.at(k));
  return out;
}

} // namespace

bool begins_at_once(const Scene &scene, const Model &model, std::size_t effect,
                    bool told_from_speed) {
  constexpr double kSure = 0.15, kWhole = 0.5;
  Beside near = turns_beside(scene, model, effect);
  if (near.enough()) {
    const Side first = look_at(near.before), second = look_at(near.after);
    if (first.variance + second.variance <= kSure * kSure) {
      if (!(second.part - first.part > kWhole))
        return false;
      if (!told_from_speed || !goes_with_the_speed(std::move(near)))
        return true;
    }
  }
  // Where the speed changes at that moment, or noise hides the step there, the turns beside it do
  // not tell the two apart. In the whole record an offset that follows the speed comes again with
  // each.
  return !told_from_speed || !goes_with_the_speed(whole_record(scene, model, effect));
}

bool comes_in_slowly(const Scene &scene, const Model &model, std::size_t effect) {
  const Beside near = turns_beside(scene, model, effect);
  if (!near.enough())
    return false;
  const double here = likelier_than_slopes(near);
  if (std::abs(here) > criteria::kRivalNats)
    return here < 0.0;
  return likelier_than_slopes(whole_record(scene, model, effect)) < -criteria::kRivalNats;
}

} // namespace ada
