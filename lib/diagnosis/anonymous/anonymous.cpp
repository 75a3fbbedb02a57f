// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/anonymous.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numeric>
#include <optional>

#include "base/angle.h"
#include "diagnosis/anonymous/steps.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/edges.h"
#include "diagnosis/lines/line.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/candidates.h"
#include "model/forward.h"

namespace ada {

namespace {

double zero_of(const Model &model) {
  return model.baseline.angle_zero_deg * kRadPerDeg;
}

/// Held-out data of a second capture with the angle moved to the zero of the first.
Observations at_zero_of(const Model &model, Observations data) {
  const double move = zero_of(as_seen_by(data, model)) - zero_of(model);
  for (double &a : data.alpha)
    a += move;
  return data;
}

/// The data at the angle of the shaft, which the reference reads with its errors. What repeats with
/// the angle repeats with the shaft's.
Observations at_shaft(const Model &model, Observations data) {
  Model of_reference = model;
  std::erase_if(of_reference.effects,
                [](const EffectInstance &e) { return e.effect->info().stage != Stage::record; });
  std::vector<double> shaft(data.size());
  ForwardModel(of_reference, AlphaIs::reference).magnet_angle(data.conditions(), shaft.data());
  data.alpha = std::move(shaft);
  return data;
}

Observations some_of(const Observations &data, std::size_t most) {
  std::vector<std::uint32_t> all(data.size());
  std::iota(all.begin(), all.end(), 0u);
  Observations out = data.select(thin(all, most, 100));
  out.coloured.reset();
  return out;
}

Halves halves_of(const DataSplit &split, const Model &model) {
  Halves out{some_of(split.train, criteria::kAnonymousTrain),
             some_of(split.heldout, criteria::kAnonymousHeldout),
             {},
             {},
             split.second_capture};
  if (split.second_capture)
    out.heldout = at_zero_of(model, std::move(out.heldout));
  out.train_left = residual_columns(out.train, model);
  out.heldout_left = residual_columns(out.heldout, model);
  out.train = at_shaft(model, std::move(out.train));
  out.heldout = at_shaft(model, std::move(out.heldout));
  return out;
}

int most_orders(const Scene &scene, const Halves &halves, int wanted) {
  const Observations &train = halves.train;
  double places = 0.0; // all readings of a stop tell as much of the angle as one of them
  for (std::size_t i = 0; i < train.size(); ++i)
    if (!scene.stops || i == 0 ||
        std::abs(train.alpha[i] - train.alpha[i - 1]) > criteria::kStopMovesRad)
      places += 1.0;
  int left =
      std::max(1, static_cast<int>(places / (halves.judged_apart ? criteria::kPlacesPerOrder
                                                                 : criteria::kSamplesPerOrder)));
  int out = 0;
  for (int n = 1; n <= wanted && left > 0; ++n)
    if (!in_turns(scene) || has_order(scene, n)) {
      out = n;
      --left;
    }
  return out;
}

Anonymous with_basis(const Scene &scene, const Halves &halves, double zero_rad, int orders,
                     const std::vector<SpectralLine> &lines, const std::vector<double> &steps_s,
                     Asked asked, RecentAnonymous *recent) {
  Anonymous out;
  out.basis = generic_basis(scene, halves.train, zero_rad, most_orders(scene, halves, orders),
                            lines, steps_s, asked);
  out.from = products(out.basis, halves.train, halves.train_left, halves.heldout,
                      halves.heldout_left, recent ? &recent->sums() : nullptr);
  if (scene.radius_only)
    out.from.silent = 0.5 * out.from.n_heldout;
  out.lines = lines;
  out.steps_s = steps_s;
  out.orders = orders;
  return out;
}

Anonymous chosen(Anonymous from) {
  from.selection = select(from.basis, from.from);
  return from;
}

/// The strongest lines of what the selection leaves. Tones first, and taken out: in the frame that
/// turns with the vector each of them would be two lines.
std::vector<SpectralLine> lines_of(const Scene &scene, const Halves &halves, const Anonymous &left,
                                   const Model &model) {
  ResidualColumns rest = halves.train_left;
  subtract(left.basis, left.selection, halves.train, rest);
  const Residual view = residual_view(scene, halves.train, rest, std::sqrt(left.selection.train_v2),
                                      model.baseline.amplitude_v);
  std::vector<SpectralLine> out;
  for (const auto &values : find_tones(view))
    out.push_back({values[0], false});
  const std::size_t tones = out.size();
  for (std::size_t k = 0; k < tones; ++k)
    take_out_line(halves.train.time, out[k].frequency_hz, rest.sin, rest.cos);
  for (double hz : find_modulations(view)) // a view of the same columns
    out.push_back({hz, true});
  return out;
}

/// Takes the selection out of a residual, all but what is slow in time, which would follow a step,
/// and the steps themselves.
void subtract_all_but_slow(const Anonymous &left, const Observations &data, ResidualColumns &rest) {
  Selection without;
  std::vector<double> values;
  for (std::size_t k = 0; k < left.selection.columns.size(); ++k) {
    const Eigen::Index column = left.selection.columns[k];
    const Modulation &by = left.basis.terms()[static_cast<std::size_t>(column / 2)].modulation;
    if (by.kind == Modulation::trend || by.kind == Modulation::step)
      continue;
    without.columns.push_back(column);
    values.push_back(left.selection.values[static_cast<Eigen::Index>(k)]);
  }
  without.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  subtract(left.basis, without, data, rest);
}

/// Where so few periods went by, or are fitted to, that none is usual, an edge tells a step. The
/// orders of the turn would follow it: it is looked for before them, among all samples.
std::vector<StepPlace> edges_of(const Scene &scene, const Model &model) {
  std::vector<std::uint32_t> some(scene.all.size());
  std::iota(some.begin(), some.end(), 0u);
  // Evenly: from run to run a line would reach over what lies between them.
  const Observations data = scene.all.select(thin(some, criteria::kAnonymousTrain, 1));
  const ResidualColumns rest = residual_columns(data, model);
  const std::size_t reach = reach_of_edges(data.size(), scene.rounds(1.0), model.periods_per_turn);
  std::vector<StepPlace> out;
  for (const Edge &edge :
       find_edges(data.time, rest.sin, rest.cos, data.direction, reach, criteria::kMostSteps))
    out.push_back({data.time[edge.at - reach], data.time[edge.at + reach - 1]});
  return out;
}

/// Moments of steps, in all samples: an event belongs to the capture and not to a part of it.
std::vector<double> steps_of(const Scene &scene, const Halves &halves, const Anonymous &left,
                             const Model &model) {
  ResidualColumns rest = halves.train_left;
  subtract_all_but_slow(left, halves.train, rest);
  auto places = find_steps(left.basis, halves.train, rest, scene.rounds(1.0 / scene.periods));
  if (!places)
    places = edges_of(scene, model);
  std::vector<double> out;
  for (const StepPlace &place : *places) {
    const auto &time = scene.all.time;
    const auto index = [&](double t) {
      return static_cast<std::uint32_t>(std::lower_bound(time.begin(), time.end(), t) -
                                        time.begin());
    };
    std::vector<std::uint32_t> some(index(place.to_s) - index(place.from_s));
    if (some.size() < 2)
      continue;
    std::iota(some.begin(), some.end(), index(place.from_s));
    Observations near = scene.all.select(some);
    ResidualColumns there = residual_columns(near, model);
    near = at_shaft(model, std::move(near));
    subtract_all_but_slow(left, near, there);
    out.push_back(moment_of_step(left.basis, near, there));
  }
  return out;
}

/// Whether held-out data need the steps. They come before all other columns, and so take what the
/// angle explains as well where it is given no chance.
bool needs_its_steps(const Anonymous &with, const Anonymous &without) {
  const double least = criteria::kLeastMeanSquare;
  const double nats =
      0.5 * with.from.told() *
      std::log((without.selection.noise_v2 + least) / (with.selection.noise_v2 + least));
  const double more = static_cast<double>(with.selection.columns.size()) -
                      static_cast<double>(without.selection.columns.size());
  return nats > criteria::kNatsPerCoordinate * more;
}

Anonymous compute(const Scene &scene, const Halves &halves, const Model &model, Asked asked,
                  RecentAnonymous *recent) {
  std::vector<double> steps;
  const auto with = [&](int orders, const std::vector<SpectralLine> &lines) {
    return chosen(with_basis(scene, halves, zero_of(model), orders, lines, steps, asked, recent));
  };
  const int unit = in_turns(scene) ? scene.periods : 1;
  Anonymous out = with(std::max(criteria::kMostOrders, criteria::kMostPeriods * unit), {});
  if (!asked.over_time)
    return out;
  std::optional<Anonymous> without; // any step, where there are some
  // A step that was not known has bent what else was fitted: with it known look once more.
  for (int look = 0; look < 2; ++look) {
    std::vector<double> seen = steps_of(scene, halves, out, model);
    if (seen.size() <= steps.size())
      break;
    steps = std::move(seen);
    Anonymous more = with(std::max(2, out.selection.orders[0]), {});
    if (!without)
      without = std::move(out);
    out = std::move(more);
  }
  if (without && !needs_its_steps(out, *without)) {
    steps.clear();
    out = *std::move(without);
  }
  if (!asked.speed || halves.train.size() < criteria::kFewestForLines)
    return out;
  const std::vector<SpectralLine> lines = lines_of(scene, halves, out, model);
  return lines.empty() ? out : with(std::max(2, out.selection.orders[0]), lines);
}

} // namespace

const Anonymous *RecentAnonymous::find(const Question &question) const {
  const auto at = std::find_if(kept_.rbegin(), kept_.rend(),
                               [&](const auto &kept) { return kept.first == question; });
  return at != kept_.rend() ? &at->second : nullptr;
}

void RecentAnonymous::keep(Question question, const Anonymous &answer) {
  constexpr std::size_t kMost = 6;
  if (kept_.size() == kMost)
    kept_.erase(kept_.begin());
  kept_.emplace_back(std::move(question), answer);
}

Anonymous anonymous_of(const Scene &scene, const DataSplit &split, const Model &model,
                       Asked asked) {
  asked.over_time = asked.over_time && !split.second_capture;
  RecentAnonymous::Question question{&scene, halves_of(split, model), zero_of(model), asked};
  if (const Anonymous *known = split.recent ? split.recent->find(question) : nullptr)
    return *known;
  Anonymous out = compute(scene, question.halves, model, asked, split.recent.get());
  if (split.recent)
    split.recent->keep(std::move(question), out);
  return out;
}

Anonymous anonymous_alike(const Scene &scene, const DataSplit &split, const Model &model,
                          const Anonymous &other) {
  Anonymous out =
      with_basis(scene, halves_of(split, model), zero_of(model), other.orders, other.lines,
                 other.steps_s, {.over_time = !split.second_capture}, split.recent.get());
  out.selection = select(out.basis, out.from, other.selection.columns, other.selection.ridge);
  return out;
}

ResidualColumns of_the_angle_alone(const Anonymous &left, const Observations &data,
                                   const Model &model, ResidualColumns residual) {
  Selection others;
  std::vector<double> values;
  for (std::size_t k = 0; k < left.selection.columns.size(); ++k) {
    const Eigen::Index column = left.selection.columns[k];
    if (left.basis.groups()[static_cast<std::size_t>(column / 2)].axis == Axis::angle)
      continue;
    others.columns.push_back(column);
    values.push_back(left.selection.values[static_cast<Eigen::Index>(k)]);
  }
  if (others.columns.empty())
    return residual;
  others.values = Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values));
  subtract(left.basis, others, at_shaft(model, data), residual);
  return residual;
}

double left_beside_angle(const DataSplit &split, const Model &model, const Anonymous &other) {
  const Halves halves = halves_of(split, model);
  Basis basis(other.basis.periods(), zero_of(model));
  basis.scale_to(halves.train);
  basis.add(Axis::angle, kOfBaseline, 0);
  basis.add(Axis::angle, kOfBaseline, other.basis.periods());
  const auto &groups = other.basis.groups();
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (groups[k].axis == Axis::angle && groups[k].order != kOfBaseline &&
        std::find(other.selection.columns.begin(), other.selection.columns.end(),
                  static_cast<Eigen::Index>(groups[k].first)) != other.selection.columns.end())
      basis.add(groups[k].axis, groups[k].order, other.basis.terms()[k].exponent,
                other.basis.terms()[k].modulation);
  const Products from =
      products(basis, halves.train, halves.train_left, halves.heldout, halves.heldout_left,
               split.recent ? &split.recent->sums() : nullptr);
  std::vector<Eigen::Index> all(static_cast<std::size_t>(from.train.rows() - 1));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return select(basis, from, std::move(all)).noise_v2;
}

Quality quality_with(const Anonymous &left, const DataSplit &split, const Model &model) {
  Quality out;
  out.residual_rms_v = std::sqrt(left.selection.noise_v2);
  const double variance = std::max(left.selection.noise_v2, criteria::kLeastMeanSquare);
  out.log_likelihood = std::log(split.heldout.weight_along) - std::log(kTwoPi * variance) - 1.0;
  if (!split.has_reference)
    return out;
  Halves halves = halves_of(split, model);
  ResidualColumns &r = halves.heldout_left;
  subtract(left.basis, left.selection, halves.heldout, r);
  double sum = 0.0;
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double s = r.model_sin[i] - halves.heldout.centre_sin_v;
    const double c = r.model_cos[i] - halves.heldout.centre_cos_v;
    const double turn = (r.sin[i] * c - r.cos[i] * s) / std::max(s * s + c * c, 1e-12);
    sum += turn * turn;
  }
  out.angle_error_rms_deg =
      std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, r.sin.size()))) * kDegPerRad /
      model.periods_per_turn;
  return out;
}

std::vector<BudgetLine> budget_of(const Anonymous &whole, const Anonymous &unnamed) {
  std::vector<BudgetLine> out;
  for (std::size_t k = 0; k + 1 < kAxes; ++k) {
    const double all = std::max(0.0, whole.selection.share_v2[k]);
    const double left = std::max(0.0, unnamed.selection.share_v2[k]);
    if (all <= 0.0 && left <= 0.0)
      continue;
    // What a name takes from one axis it may give to another: a line of the budget never has more
    // without a name than in all.
    const double rms2 = std::max(all, left);
    out.push_back({static_cast<Axis>(k), std::sqrt(rms2), std::sqrt(rms2 - left), std::sqrt(left)});
  }
  const double noise = std::sqrt(unnamed.selection.noise_v2);
  out.push_back({Axis::noise, noise, 0.0, noise});
  std::stable_sort(out.begin(), out.end(),
                   [](const BudgetLine &a, const BudgetLine &b) { return a.rms_v > b.rms_v; });
  return out;
}

NoiseShape noise_shape(const Anonymous &left, const DataSplit &split, const Model &model) {
  Halves halves = halves_of(split, model);
  ResidualColumns &r = halves.heldout_left;
  subtract(left.basis, left.selection, halves.heldout, r);
  NoiseShape out;
  std::vector<double> along, across;
  along_and_across(halves.heldout, r, along, across);
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    out.sin_v += r.sin[i] * r.sin[i];
    out.cos_v += r.cos[i] * r.cos[i];
    out.along_v += along[i] * along[i];
    out.across_v += across[i] * across[i];
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, r.sin.size()));
  for (double *v : {&out.sin_v, &out.cos_v, &out.along_v, &out.across_v})
    *v = std::sqrt(*v / n);
  // Where only the radius is judged, what lies across it is the motion's: noise is taken for white.
  if (split.heldout.disturbed == Direction::motion)
    out.sin_v = out.cos_v = out.across_v = out.along_v = out_of_figure_rms_v(halves.heldout, r);
  return out;
}

namespace {

/// The solution in which every order of the angle has a variance of its own before any data, in the
/// place of the one that all columns share: of many orders most may be nothing, and what they share
/// would make the large ones smaller. The variances are those under which the data are likeliest,
/// by MacKay's iteration (Neural Computation 4, 1992, p. 415) from the shared one. `ridged`: the
/// products with that one; `noise_v2`: mean square of what is left.
Eigen::VectorXd each_order_as_large_as_it_is(const Basis &basis, const Eigen::MatrixXd &gram,
                                             Eigen::MatrixXd ridged, double noise_v2) {
  const Eigen::Index m = ridged.rows();
  std::map<int, std::vector<Eigen::Index>> orders;
  for (const Group &g : basis.groups())
    if (g.axis == Axis::angle && g.order != kOfBaseline)
      for (std::size_t k = 0; k < g.count; ++k)
        orders[g.order].push_back(static_cast<Eigen::Index>(g.first + k));
  Eigen::VectorXd values;
  constexpr int kPasses = 5; // ten give the same angles to a thousandth
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::LDLT<Eigen::MatrixXd> solver(ridged);
    values = solver.solve(gram.topRightCorner(m, 1));
    const Eigen::VectorXd variances =
        noise_v2 * solver.solve(Eigen::MatrixXd::Identity(m, m)).diagonal();
    for (const auto &[order, columns] : orders) {
      const double square = values(columns).squaredNorm();
      double told = 0.0; // how many of the values the data tell, rather than what was before them
      for (Eigen::Index k : columns)
        told += 1.0 - std::clamp((ridged(k, k) - gram(k, k)) * variances[k] / noise_v2, 0.0, 1.0);
      const double ridge = told * noise_v2 / std::max(square, 1e-300);
      for (Eigen::Index k : columns)
        ridged(k, k) =
            gram(k, k) + std::clamp(ridge, criteria::kRidge * gram(k, k), 1e6 * gram(k, k));
    }
  }
  return values;
}

/// How the outputs are wired, which is the last thing that happens to a pair.
EllipseParts wiring_of(const Model &model) {
  EllipseParts out;
  for (const EffectInstance &e : model.effects)
    if (e.effect->info().stage == Stage::record)
      e.effect->fold(e.values, out);
  return out;
}

/// What a model leaves of data, and these at the angle of the shaft, both as the outputs would be
/// with their wires put right: the remainder is added before those.
ResidualColumns left_at_shaft(const Model &model, Observations &data) {
  ResidualColumns out = residual_columns(data, model);
  data = at_shaft(model, std::move(data));
  const EllipseParts wiring = wiring_of(model);
  const auto turn_over = [&](auto &read, double &centre_v, std::vector<double> &left,
                             std::vector<double> &has) {
    for (auto &v : read)
      v = static_cast<std::remove_reference_t<decltype(v)>>(model.supply_v) - v;
    for (double &v : has)
      v = model.supply_v - v;
    for (double &v : left)
      v = -v;
    centre_v = model.supply_v - centre_v;
    data.figure[1] = -data.figure[1];
  };
  if (wiring.sin_inverted)
    turn_over(data.vsin, data.centre_sin_v, out.sin, out.model_sin);
  if (wiring.cos_inverted)
    turn_over(data.vcos, data.centre_cos_v, out.cos, out.model_cos);
  if (wiring.swapped) {
    std::swap(data.vsin, data.vcos);
    std::swap(data.centre_sin_v, data.centre_cos_v);
    std::swap(data.figure[0], data.figure[2]);
    std::swap(out.sin, out.cos);
    std::swap(out.model_sin, out.model_cos);
  }
  return out;
}

} // namespace

Model with_remainder(const Scene &scene, const Anonymous &left, const Observations &data,
                     Model model, double weight_along) {
  const int orders = left.selection.orders[static_cast<std::size_t>(Axis::angle)];
  // Without a reference nothing tells a ripple of the shaft from one of the sensor, but where it
  // comes with the poles of a ring: what may be the shaft's is not corrected, as with the causes
  // that have a name.
  if (orders == 0 || (!scene.has_reference && (scene.radius_only || scene.periods <= 2)))
    return model;
  Observations some = some_of(data, criteria::kRemainderSamples);
  if (weight_along != 1.0) {
    some.disturbed = Direction::radius;
    some.weight_along = weight_along;
  }
  const ResidualColumns r = left_at_shaft(model, some);
  // What the other axes hold is fitted beside it, and so cannot leak into it; the baseline moves
  // along.
  const int p = scene.periods;
  Basis basis(p, zero_of(model));
  basis.scale_to(some);
  basis.add(Axis::angle, kOfBaseline, 0);
  basis.add(Axis::angle, kOfBaseline, p);
  const auto &groups = left.basis.groups();
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const bool in =
        std::find(left.selection.columns.begin(), left.selection.columns.end(),
                  static_cast<Eigen::Index>(groups[k].first)) != left.selection.columns.end();
    if (in && groups[k].order != kOfBaseline)
      basis.add(groups[k].axis, groups[k].order, left.basis.terms()[k].exponent,
                left.basis.terms()[k].modulation);
  }
  const Eigen::MatrixXd gram = gram_of(basis, some, r);
  const Eigen::Index m = gram.rows() - 1;
  const Eigen::MatrixXd a = ridged(gram.topLeftCorner(m, m), left.selection.ridge,
                                   basis.stiffness(), 2.0 * static_cast<double>(some.size()));
  // On a part of a turn the orders are not apart, and a variance for each is nothing that was seen.
  const Eigen::VectorXd values =
      scene.seen_turns < criteria::kNearlyATurn
          ? Eigen::VectorXd(a.ldlt().solve(gram.topRightCorner(m, 1)))
          : each_order_as_large_as_it_is(basis, gram, a, left.selection.noise_v2);
  if (!values.allFinite())
    return model;

  const double amplitude = model.baseline.amplitude_v;
  PeriodicRemainder remainder;
  remainder.electrical = !scene.has_reference;
  // Exponentials of each term on the angle axis: a modulation has one on either side.
  struct Exponential {
    int exponent;
    std::complex<double> value;
  };
  const auto exponentials = [&](std::size_t k) -> std::vector<Exponential> {
    const Basis::Term &t = basis.terms()[k];
    const std::complex<double> c(values[static_cast<Eigen::Index>(2 * k)] / amplitude,
                                 values[static_cast<Eigen::Index>(2 * k + 1)] / amplitude);
    const std::complex<double> j(0.0, 1.0);
    const int up = t.exponent + t.modulation.order, down = t.exponent - t.modulation.order;
    if (t.modulation.kind == Modulation::angle_cos)
      return {{up, 0.5 * c}, {down, 0.5 * c}};
    if (t.modulation.kind == Modulation::angle_sin)
      return {{up, -0.5 * j * c}, {down, 0.5 * j * c}};
    return {{t.exponent, c}};
  };
  // Without a reference nobody knows in which electrical period of the turn a reading lies.
  const int unit = remainder.electrical ? p : 1;
  std::vector<Exponential> carried;
  int highest = 0;
  for (std::size_t k = 2; k < basis.terms().size(); ++k)
    if (basis.groups()[k].axis == Axis::angle)
      for (const Exponential &e : exponentials(k))
        if (e.exponent != 0 && e.exponent % unit == 0 &&
            std::abs(e.exponent) / unit <= static_cast<int>(PeriodicRemainder::kHighestOrder)) {
          carried.push_back(e);
          highest = std::max(highest, std::abs(e.exponent) / unit);
        }
  for (auto *v : {&remainder.sin_cos, &remainder.sin_sin, &remainder.cos_cos, &remainder.cos_sin})
    v->assign(static_cast<std::size_t>(highest), 0.0);
  for (const Exponential &e : carried) {
    const std::size_t n = static_cast<std::size_t>(std::abs(e.exponent) / unit);
    const double sign = e.exponent > 0 ? 1.0 : -1.0;
    remainder.cos_cos[n - 1] += e.value.real(); // re cos(m x) - im sin(m x)
    remainder.cos_sin[n - 1] -= sign * e.value.imag();
    remainder.sin_sin[n - 1] += sign * e.value.real(); // re sin(m x) + im cos(m x)
    remainder.sin_cos[n - 1] += e.value.imag();
  }
  if (highest > 0)
    model.remainder = std::move(remainder);
  model.baseline.offset_cos_v += values[0];
  model.baseline.offset_sin_v += values[1];
  model.baseline.amplitude_v += values[2];
  model.baseline.angle_zero_deg += values[3] / (amplitude * p) * kDegPerRad;
  return model;
}

std::vector<double> turned_by_remainder(const Observations &data, const Model &model) {
  Model without = model;
  without.remainder.reset();
  const ResidualColumns all = residual_columns(data, model), rest = residual_columns(data, without);
  // The wires may make the pair go round the other way.
  const EllipseParts wiring = wiring_of(model);
  const bool mirrored = wiring.swapped != (wiring.sin_inverted != wiring.cos_inverted);
  const double sense = mirrored ? -1.0 : 1.0;
  std::vector<double> out;
  for (std::size_t i = 0; i < all.sin.size(); ++i) {
    const double s = rest.model_sin[i] - data.centre_sin_v;
    const double c = rest.model_cos[i] - data.centre_cos_v;
    const double ds = all.model_sin[i] - rest.model_sin[i];
    const double dc = all.model_cos[i] - rest.model_cos[i];
    out.push_back(sense * (ds * c - dc * s) / std::max(s * s + c * c, 1e-12) /
                  model.periods_per_turn);
  }
  return out;
}

double remainder_angle_rms(const Observations &data, const Model &model) {
  return std::sqrt(mean_square(turned_by_remainder(data, model))) * kDegPerRad;
}

} // namespace ada
