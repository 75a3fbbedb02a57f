// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/onset.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/fit.h"
#include "diagnosis/moments.h"

namespace ada {

namespace {

/// The effect as it would be at one sample, had it always been there, and what is seen there.
struct Sight {
  double effect[2], seen[2], speed;
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

/// Sum of squares that is left where the effect's size may be a constant and, on top of it, a step
/// (`terms` of 2) or a second-order polynomial of the speed (3).
double left_over(const std::vector<Sight> &before, const std::vector<Sight> &after, double fastest,
                 int terms) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-12;
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (const auto *side : {&before, &after})
    for (const Sight &s : *side) {
      const double speed = s.speed / fastest;
      const Eigen::Vector3d basis = terms == 2
                                        ? Eigen::Vector3d(1.0, side == &after ? 1.0 : 0.0, 0.0)
                                        : Eigen::Vector3d(1.0, speed, speed * speed);
      for (int c = 0; c < 2; ++c) {
        const Eigen::Vector3d row = basis * s.effect[c];
        normal += row * row.transpose();
        right += row * s.seen[c];
        sum += s.seen[c] * s.seen[c];
      }
    }
  return sum - right.dot(normal.ldlt().solve(right));
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

/// Whether an offset that follows the speed would be seen just so.
bool goes_with_the_speed(std::vector<Sight> before, std::vector<Sight> after) {
  keep_settled(before, after);
  constexpr double kNoWorse = 10.0; // nats, of the noise that the step leaves
  double fastest = 0.0;
  for (const auto *side : {&before, &after})
    for (const Sight &s : *side)
      fastest = std::max(fastest, std::abs(s.speed));
  if (!(fastest > 0.0))
    return false;
  const double step = left_over(before, after, fastest, 2);
  const double speed = left_over(before, after, fastest, 3);
  const double n = static_cast<double>(before.size() + after.size());
  return speed < step * (1.0 + 2.0 * kNoWorse / n);
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

} // namespace

bool begins_at_once(const Scene &scene, const Model &model, std::size_t effect) {
  constexpr std::size_t kFewest = 8, kEnough = 4000;
  constexpr double kSure = 0.15, kWhole = 0.5;
  const double moment = model.effects[effect].values[0];
  const Beginning near(scene, model, effect, scene.all.select(samples_near(scene, moment, kReach)));
  if (near.middle == near.size())
    return true;
  // Where rough motion was left out, the turns are those beside it: a few readings between the
  // moment and such a stretch are not a turn.
  const auto beside = [&](std::size_t first, bool on) {
    std::vector<Sight> out;
    std::size_t of = first;
    for (std::size_t k = first; k < near.size(); on ? ++k : --k) { // below 0: beyond the size
      if (std::abs(near.alpha(k) - near.alpha(of)) > kTwoPi) {
        if (out.size() >= kFewest)
          break;
        of = k;
      }
      out.push_back(near.at(k));
    }
    return out;
  };
  std::vector<Sight> before = beside(near.middle - 1, false), after = beside(near.middle, true);
  if (before.size() < kFewest || after.size() < kFewest)
    return true;
  const Side first = look_at(before), second = look_at(after);
  if (first.variance + second.variance > kSure * kSure)
    return true;
  if (!(second.part - first.part > kWhole))
    return false;
  if (!goes_with_the_speed(std::move(before), std::move(after)))
    return true;
  // Where the speed changes at that moment the turns beside it do not tell the two apart. In the
  // whole record an offset that follows the speed comes again with each speed.
  std::vector<std::uint32_t> all(scene.all.size());
  std::iota(all.begin(), all.end(), 0u);
  const Beginning whole(scene, model, effect, scene.all.select(thin(all, kEnough, 100)));
  std::vector<Sight> sooner, later;
  for (std::size_t k = 0; k < whole.size(); ++k)
    (k < whole.middle ? sooner : later).push_back(whole.at(k));
  return !goes_with_the_speed(std::move(sooner), std::move(later));
}

} // namespace ada
