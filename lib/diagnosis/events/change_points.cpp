// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/change_points.h"
#include "diagnosis/criteria.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/angle.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// Parts of the record to look at on either side: more than the thinned samples leave out, and more
/// where that is not enough.
constexpr double kReaches[] = {0.03, 0.1, 0.3};
/// Samples that are looked at; of more only every so many.
constexpr std::size_t kMostSamples = 60000;

/// Cubic B-spline on knots -2 .. 2.
double bump(double x) {
  const double a = std::abs(x);
  if (a >= 2.0)
    return 0.0;
  const double rest = 2.0 - a;
  return a >= 1.0 ? rest * rest * rest / 6.0 : 2.0 / 3.0 - a * a * (1.0 - 0.5 * a);
}

/// How far the motion may be wrong about a moment. Without a reference it is known from the pair
/// alone, and bends where a step is not yet taken out, or at the wrong moment: splines within two
/// turns of it. Nothing with a reference.
class FreeMotion {
public:
  FreeMotion(const Scene &scene, const Observations &near, double moment) {
    constexpr double kTurns = 2.0;
    if (scene.has_reference)
      return;
    const auto later = std::lower_bound(near.time.begin(), near.time.end(), moment);
    const auto middle = static_cast<std::size_t>(later - near.time.begin());
    if (middle == near.size()) // later than all of them
      return;
    std::size_t from = middle, to = middle;
    const auto travel = [&](std::size_t i) { return std::abs(near.alpha[i] - near.alpha[middle]); };
    while (from > 0 && travel(from - 1) < kTurns * kTwoPi)
      --from;
    while (to + 1 < near.size() && travel(to + 1) < kTurns * kTwoPi)
      ++to;
    if (to - from < 2 * kTerms)
      return;
    start_ = near.time[from];
    step_ = (near.time[to] - start_) / (kTerms - 1.0);
    Terms gram = Terms::Zero();
    for (double t : near.time) {
      const Row row = row_at(t);
      gram.block<kWide, kWide>(row.first, row.first) += row.value * row.value.transpose();
    }
    constexpr double kNoSample = 1e-6; // keeps a term determined that no sample sees
    gram.diagonal().array() += kNoSample * gram.diagonal().maxCoeff();
    inverse_ = gram.topLeftCorner<kTerms, kTerms>().inverse();
  }

  /// Adds to the residual along the circle at a time.
  void add(double time, double residual) {
    if (step_ <= 0.0)
      return;
    const Row row = row_at(time);
    const Eigen::Index wide = std::min<Eigen::Index>(kWide, kTerms - row.first);
    const auto value = row.value.head(wide);
    const Column moved = inverse_.middleCols(row.first, wide) * value * residual;
    square_ += residual *
               value.dot(2.0 * fitted_.segment(row.first, wide) + moved.segment(row.first, wide));
    fitted_ += moved;
  }

  /// How much of the sum of squares the motion takes up.
  double taken_up() const { return square_; }

private:
  static constexpr Eigen::Index kTerms = 32, kWide = 4; ///< splines, and those at one time
  using Terms = Eigen::Matrix<double, kTerms + kWide, kTerms + kWide>;
  using Column = Eigen::Matrix<double, kTerms, 1>;
  struct Row {
    Eigen::Index first;
    Eigen::Matrix<double, kWide, 1> value;
  };

  Row row_at(double time) const {
    const double at = (time - start_) / step_;
    Row row{static_cast<Eigen::Index>(std::clamp(std::floor(at) - 1.0, 0.0, double{kTerms})), {}};
    for (Eigen::Index k = 0; k < kWide; ++k)
      row.value[k] = row.first + k < kTerms ? bump(at - static_cast<double>(row.first + k)) : 0.0;
    return row;
  }

  double start_ = 0.0, step_ = 0.0, square_ = 0.0;
  Eigen::Matrix<double, kTerms, kTerms> inverse_ = decltype(inverse_)::Zero();
  Column fitted_ = Column::Zero();
};

/// A residual along the circle: what the motion can take up.
double along_circle(const Observations &data, std::size_t i, double sin, double cos) {
  const double us = data.vcos[i] - data.centre_cos_v, uc = data.centre_sin_v - data.vsin[i];
  return (sin * us + cos * uc) / std::max(std::hypot(us, uc), 1e-12);
}

double radial(const Observations &data, const ResidualColumns &r, std::size_t i) {
  const double s = data.vsin[i] - data.centre_sin_v, c = data.vcos[i] - data.centre_cos_v;
  return (r.sin[i] * s + r.cos[i] * c) / std::max(std::hypot(s, c), 1e-12);
}

/// Two samples between which the step lies, where the motion was too rough for a fit: there the
/// radius still tells. `less`, `always`: the model before and after it; `from`, `to`: the ends of
/// what is left out.
std::array<double, 2> within_gap(const Scene &scene, const Model &less, const Model &always,
                                 double from, double to) {
  constexpr std::size_t kFewest = 20;
  constexpr double kSpike = 8.0; // of the noise: more says no more
  constexpr double kAlike = 2.0; // nats
  const double most = std::pow(kSpike * scene.white_noise_v, 2);
  std::vector<std::uint32_t> inside;
  for (std::size_t i = 0; i < scene.rough.size(); ++i)
    if (scene.rough.time[i] > from && scene.rough.time[i] < to)
      inside.push_back(static_cast<std::uint32_t>(i));
  if (inside.size() < kFewest)
    return {from, to};
  const Observations some = scene.rough.select(inside);
  const Observations then = at_own_angle(some, less), now = at_own_angle(some, always);
  const ResidualColumns before = residual_columns(then, less),
                        after = residual_columns(now, always);
  std::vector<double> sum{0.0}; // where the step begins after so many of them
  for (std::size_t i = 0; i < some.size(); ++i) {
    const double b = radial(then, before, i), a = radial(now, after, i);
    sum.push_back(sum.back() + std::min(b * b, most) - std::min(a * a, most));
  }
  // At some angles a step does not change the radius: it may have come anywhere there.
  const double alike = *std::min_element(sum.begin(), sum.end()) +
                       2.0 * kAlike * scene.white_noise_v * scene.white_noise_v;
  const auto good = [&](double s) { return s <= alike; };
  const auto first =
      static_cast<std::size_t>(std::find_if(sum.begin(), sum.end(), good) - sum.begin());
  const auto last =
      static_cast<std::size_t>(sum.rend() - std::find_if(sum.rbegin(), sum.rend(), good) - 1);
  return {first > 0 ? some.time[first - 1] : from, last < some.size() ? some.time[last] : to};
}

/// Rms of the moments about the best one, s, each as likely as its sum of squares says: where the
/// noise is as large as the step it may have come samples away.
double spread_of_moment(const std::vector<double> &time, const std::vector<double> &squares,
                        std::size_t best, double variance) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 1; i + 1 < squares.size(); ++i) {
    const double off_s = 0.5 * (time[i - 1] + time[i] - time[best - 1] - time[best]),
                 w = std::exp(-0.5 * (squares[i] - squares[best]) / variance);
    sum += w * off_s * off_s;
    weights += w;
  }
  return std::sqrt(sum / weights);
}

/// The moment that leaves the least sum of squares, with the size of the step as it is and the
/// motion anew for each: a sample before it is judged without the effect, one from it on with. It
/// lies between two samples, which are far apart where those between them are of no use. False when
/// the end of what was looked at is the best place.
bool set_exact_moment(const Scene &scene, Model &model, std::size_t effect, double part) {
  EffectInstance &e = model.effects[effect];
  const Observations near = scene.all.select(samples_near(scene, e.values[0], part));
  const Model less = model.without(effect);
  Model always = model;
  always.effects[effect].values[0] = std::numeric_limits<double>::lowest();
  ResidualColumns before = residual_columns(near, less), after = residual_columns(near, always);
  for (ResidualColumns *r : {&before, &after})
    for (std::size_t i = 0; i < near.size(); ++i)
      near.whiten(i, r->model_sin[i], r->model_cos[i], r->sin[i], r->cos[i]);
  const auto square = [](const ResidualColumns &r, std::size_t i) {
    return r.sin[i] * r.sin[i] + r.cos[i] * r.cos[i];
  };
  const auto along = [&](const ResidualColumns &r, std::size_t i) {
    return along_circle(near, i, r.sin[i], r.cos[i]);
  };
  FreeMotion motion(scene, near, e.values[0]);
  for (std::size_t i = 0; i < near.size(); ++i)
    motion.add(near.time[i], along(after, i));
  double sum = 0.0, total = 0.0;
  std::vector<double> squares{-motion.taken_up()}; // with the step behind so many samples
  for (std::size_t i = 0; i < near.size(); ++i) {
    total += square(after, i);
    sum += square(before, i) - square(after, i);
    motion.add(near.time[i], along(before, i) - along(after, i));
    squares.push_back(sum - motion.taken_up());
  }
  const auto least = std::min_element(squares.begin(), squares.end());
  const auto at = static_cast<std::size_t>(least - squares.begin());
  if (at == 0 || at == near.size())
    return false;
  const auto [from, to] = within_gap(scene, less, always, near.time[at - 1], near.time[at]);
  e.values[0] = 0.5 * (from + to);
  e.std_errors.resize(e.values.size());
  // Without noise there is one moment.
  const double variance = std::max(criteria::kLeastMeanSquare,
                                   (total + *least) / (2.0 * static_cast<double>(near.size())));
  e.std_errors[0] =
      std::hypot((to - from) / std::sqrt(12.0), spread_of_moment(near.time, squares, at, variance));
  return true;
}

} // namespace

std::vector<std::uint32_t> samples_near(const Scene &scene, double moment, double part) {
  const std::vector<double> &time = scene.all.time;
  double first = moment, last = moment;
  const auto next = std::lower_bound(scene.train.begin(), scene.train.end(), moment,
                                     [&](std::uint32_t i, double t) { return time[i] < t; });
  if (next != scene.train.end())
    last = time[*next];
  if (next != scene.train.begin())
    first = time[*std::prev(next)];
  const double reach = part * (time.back() - time.front());
  const auto from = std::lower_bound(time.begin(), time.end(), first - reach);
  const auto to = std::upper_bound(from, time.end(), last + reach);
  const auto count = static_cast<std::size_t>(to - from);
  const std::size_t stride = count / kMostSamples + 1;
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < count; i += stride)
    out.push_back(static_cast<std::uint32_t>(static_cast<std::size_t>(from - time.begin()) + i));
  return out;
}

bool has_moment(const Effect &effect) {
  const auto parameters = effect.info().parameters;
  return effect.info().evidence == Evidence::signal && !parameters.empty() &&
         parameters[0].name == "time_s" && parameters[0].role == Role::chosen;
}

Model with_exact_moments(const Scene &scene, Model model, std::size_t first) {
  for (std::size_t k = first; k < model.effects.size(); ++k)
    if (has_moment(*model.effects[k].effect))
      for (double part : kReaches)
        if (set_exact_moment(scene, model, k, part)) {
          if (part != kReaches[0]) // then from all samples about it
            set_exact_moment(scene, model, k, kReaches[0]);
          break;
        }
  return model;
}

} // namespace ada
