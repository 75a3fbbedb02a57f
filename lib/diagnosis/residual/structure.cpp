// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/residual/structure.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "base/text.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/spikes.h"
#include "diagnosis/residual/repetition.h"
#include "diagnosis/residual/whiteness.h"
#include "diagnosis/search/fit.h"
#include "model/residual.h"

namespace ada {

namespace {

constexpr std::size_t kLookedAt = 300000, kLookedAtRun = 25000;
constexpr double kPeakStandsOut = 6.0;     ///< standard deviations
constexpr double kOfNoise = 0.12;          ///< the least structure that is worth a word
constexpr double kMoreThanItsNoise = 1.15; ///< of a residual that is not white

/// Single rows in which the reference is wrong: no cause, and not the sensor's.
Structure of_wrong_rows(const Scene &scene, double amplitude_v) {
  const WrongRows &rows = scene.wrong_rows;
  // What they would make of both channels, spread over the record.
  const double rms_rad = std::sqrt(rows.squares_rad2 / static_cast<double>(scene.capture->size()));
  return {"time",
          fmt::format("the reference alone is wrong in {} of {} rows, by up to {:.3g} deg: they "
                      "are left out",
                      rows.count, scene.capture->size(), rows.worst_rad * kDegPerRad),
          scene.periods * rms_rad * amplitude_v / std::numbers::sqrt2};
}

/// Jumps of the pair's own angle, where it is followed by nothing else.
Structure of_own_jumps(const Scene &scene, const Model &model) {
  const OwnJumps &j = scene.own_jumps;
  std::string where = j.forward != 0 ? times_text(j.forward) + " forward" : "";
  if (j.backward != 0)
    where += (where.empty() ? "" : " and ") + times_text(j.backward) + " back";
  return {
      "time",
      fmt::format("the angle jumps from one reading to the next, {}, by up to {:.3g} deg, first at "
                  "{:.6g} s, and goes on at the same speed: no shaft turns so, {}",
                  where, j.largest_rad * kDegPerRad, j.first_s,
                  j.to_and_fro() ? "the rows are out of order or come from several clocks"
                                 : "rows may be missing"),
      model.baseline.amplitude_v * scene.periods *
          std::sqrt(j.squares_rad2 / (2.0 * static_cast<double>(scene.capture->size())))};
}

/// Rows that repeat the reading before them: no cause, and not the sensor's.
Structure of_stale_rows(const Scene &scene) {
  const auto n = static_cast<double>(scene.capture->size());
  return {
      "time",
      fmt::format("{} of {} rows repeat the reading before them to the last bit while the shaft "
                  "goes on: the driver had no new one for them; they are left out, of the figures "
                  "as well",
                  scene.stale.count, scene.capture->size()),
      std::sqrt(scene.stale.squares_v2 / (2.0 * n))};
}

/// Rows that are not of their moment: of the reference, or all that they hold. The pair is then
/// anywhere on its circle of what they say.
Structure of_wrong_stretches(const Scene &scene, const std::vector<RowRange> &ranges,
                             const char *what, const char *why, double amplitude_v) {
  std::size_t longest = 0;
  for (const RowRange &r : ranges)
    longest = std::max(longest, r.size());
  return {"time",
          fmt::format("{} {}, first at {:.4g} s, for {} rows at most: {}; these {} of {} rows are "
                      "left out, of the figures as well",
                      times_text(ranges.size()), what, scene.capture->time_s[ranges.front().first],
                      longest, why, rows_of(ranges), scene.capture->size()),
          std::abs(amplitude_v) * std::sqrt(static_cast<double>(rows_of(ranges)) /
                                            static_cast<double>(scene.capture->size()))};
}

/// Two ranges of a channel's readings that do not join.
Structure of_gap(const LevelGap &gap) {
  return {
      "angle",
      fmt::format("{} is never between {:.4g} V and {:.4g} V: each of the {} times that it passes "
                  "there it jumps by {:.3g} V while the other channel goes on: two ranges of its "
                  "readings do not join, as where the bytes or the sign of a reading are put "
                  "together wrongly, or an amplifier changes its range; no cause is named before "
                  "that is mended",
                  gap.of_cos ? "VCOS" : "VSIN", gap.low_v, gap.high_v, gap.crossings, gap.jump_v),
      0.5 * gap.jump_v / std::numbers::sqrt2}; // of one channel, half up and half down
}

/// An end of the record without power: no cause, and none of the sensor's errors.
Structure of_dead_outputs(const DeadOutputs &dead, const Scene &scene) {
  const auto n = static_cast<double>(scene.capture->size());
  return {
      "time",
      fmt::format("{} {:.4g} s{} both outputs stand at {:.4g} V and {:.4g} V, off the curve that "
                  "they draw: no power, power-down, or an open ground; these {} of {:.0f} rows "
                  "are left out, of the figures as well",
                  dead.to_end ? "from" : "up to", dead.at_s, dead.to_end ? " on" : "", dead.sin_v,
                  dead.cos_v, dead.count, n),
      dead.off_v * std::sqrt(static_cast<double>(dead.count) / (2.0 * n))};
}

/// Stretches in which the pair is not the sensor's: no cause, and none of its errors.
Structure of_episodes(const Scene &scene) {
  const Episodes &e = scene.episodes;
  const auto n = static_cast<double>(scene.capture->size());
  return {
      "time",
      fmt::format(
          "{} the pair leaves its curve or its reference, from {:.4g} s on, by up to {:.3g} V and "
          "for {:.3g} s at most, {}, and comes back: a contact, a cable, or a "
          "value that was held; these {} of {} rows are left out, of the figures as well",
          times_text(e.count), e.first_s, e.worst_v, e.longest_s,
          e.at_one_place ? "at one place of the turn by more than a magnet does" : "at any angle",
          e.samples, scene.capture->size()),
      std::sqrt(e.squares_v2 / (2.0 * n))};
}

} // namespace

std::vector<Structure> keep_for_last_look(Scene &scene, const Model &model, double noise_v) {
  std::vector<std::uint32_t> some(scene.all.size());
  std::iota(some.begin(), some.end(), 0u);
  scene.all.keep(thin(some, kLookedAt, kLookedAtRun));
  const ResidualColumns r = residual_columns(scene.all, model);
  std::vector<char> hit(scene.all.size(), 0);
  std::vector<std::size_t> places;
  for (const auto *v : {&r.sin, &r.cos}) {
    find_spikes(*v, kPeakStandsOut, noise_v, places);
    for (std::size_t i : places)
      hit[i] = 1;
  }
  std::vector<std::uint32_t> keep;
  for (std::size_t i = 0; i < hit.size(); ++i)
    if (!hit[i])
      keep.push_back(static_cast<std::uint32_t>(i));
  scene.all.keep(keep);
  std::vector<Structure> angle;
  if (scene.has_reference)
    return angle;
  if (!scene.radius_only)
    angle = find_jitter(scene.all, residual_columns(scene.all, model));
  scene.all = at_own_angle(std::move(scene.all), model);
  return angle;
}

namespace {

/// Whether the power of what is left goes on from row to row, as of a burst, or of noise that has
/// its place.
bool power_goes_on(const ResidualColumns &rest) {
  std::vector<double> power;
  for (std::size_t i = 0; i < rest.sin.size(); ++i)
    power.push_back(rest.sin[i] * rest.sin[i] + rest.cos[i] * rest.cos[i]);
  const double n = static_cast<double>(power.size());
  const double middle = std::accumulate(power.begin(), power.end(), 0.0) / std::max(n, 1.0);
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < power.size(); ++i) {
    squares += std::pow(power[i] - middle, 2);
    if (i > 0)
      products += (power[i] - middle) * (power[i - 1] - middle);
  }
  return products * std::sqrt(n) > criteria::kClearErrors * squares;
}

/// Whether what is left goes on neither from row to row nor from place to place in the turn, nor
/// does its power.
bool is_white(const Observations &data, const Model &model) {
  const auto goes_on = [](const ResidualColumns &r) {
    return goes_on_v(r) > 0.0 || power_goes_on(r);
  };
  const ResidualColumns rest = residual_columns(data, model);
  if (goes_on(rest))
    return false;
  std::vector<std::size_t> order(data.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t i) { return wrap(data.alpha[i], kTwoPi); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  ResidualColumns by_place;
  for (const std::size_t i : order) {
    by_place.sin.push_back(rest.sin[i]);
    by_place.cos.push_back(rest.cos[i]);
  }
  return !goes_on(by_place);
}

} // namespace

LeftOver left_over(const Scene &scene, const DataSplit &split, const Model &model,
                   const Explained &explained, const SplitQuality &last,
                   const std::vector<Structure> &angle) {
  LeftOver out;
  // Where the pair is its own reference nothing is left across, and a channel has half the power.
  const double left =
      last.in_sample.residual_rms_v * (scene.radius_only ? std::numbers::sqrt2 : 1.0);
  const double sigma = std::min(left, std::max(explained.noise_v, scene.white_noise_v));
  // A supply that is only inferred leaves its fast part over.
  if (!explained.supply_inferred) {
    out.structure =
        find_structure(scene, scene.all, residual_columns(scene.all, model), model, sigma,
                       kOfNoise * sigma + explained.second_order_v, explained.orders);
    const double least = sigma + explained.second_order_v;
    const std::vector<Structure> bursts = find_bursts(scene, model, least);
    out.bursts = !bursts.empty();
    for (const auto &more : {angle, find_structure_in_rough(scene, model, least), bursts})
      out.structure.insert(out.structure.end(), more.begin(), more.end());
  }
  // Too few rows for the tests of what it goes with. Of stops each has an error of its own.
  if (out.structure.empty() && !explained.supply_inferred && !scene.stops &&
      scene.all.size() < criteria::kFewestForMeans)
    if (const double left_v = goes_on_v(residual_columns(scene.all, model));
        left_v > explained.second_order_v) {
      out.of_few_rows = true;
      out.structure.push_back(
          {"time",
           fmt::format("{:.3g} mV rms go on from row to row, as no white noise does; "
                       "these rows are too few to tell with what",
                       1e3 * left_v),
           left_v});
    }
  for (const DeadOutputs &dead : scene.dead)
    out.of_rows.push_back(of_dead_outputs(dead, scene));
  if (scene.episodes.count != 0)
    out.of_rows.push_back(of_episodes(scene));
  if (scene.own_jumps.count_as_structure(scene.radius_only))
    out.of_rows.push_back(of_own_jumps(scene, model));
  if (!scene.held_reference.empty())
    out.of_rows.push_back(of_wrong_stretches(
        scene, scene.held_reference, "the reference keeps its value while the pair turns on",
        "its counter, its cable, a coupling with play, or the transfer of its value",
        model.baseline.amplitude_v));
  if (!scene.repeated.empty())
    out.of_rows.push_back(of_wrong_stretches(
        scene, scene.repeated, "a block of rows is that of an earlier moment to the last bit",
        "a buffer was delivered twice, or read before it was filled", model.baseline.amplitude_v));
  if (scene.stale.count != 0)
    out.of_rows.push_back(of_stale_rows(scene));
  if (scene.gap)
    out.of_rows.push_back(of_gap(*scene.gap));
  if (scene.wrong_rows.count != 0)
    out.of_rows.push_back(of_wrong_rows(scene, model.baseline.amplitude_v));
  const double rest2 = last.heldout.residual_rms_v * last.heldout.residual_rms_v -
                       explained.noise_v * explained.noise_v;
  out.unexplained_rms_v = rest2 > 0.0 ? std::sqrt(rest2) : 0.0;
  if (!out.structure.empty() || !out.of_rows.empty() || explained.supply_inferred)
    return out;
  const double rms = scene.has_reference ? last.heldout.residual_rms_v
                                         : rms_in_any_direction(split.heldout, model, false);
  const bool more =
      rms > std::hypot(kMoreThanItsNoise * explained.noise_v, explained.second_order_v);
  // What the noise was measured from may be few readings itself. Of stops each has an error of its
  // own, of which there is one for all of its readings.
  const double nats = scene.stops
                          ? 0.0
                          : static_cast<double>(split.heldout.size()) *
                                std::log(std::max(rms, explained.noise_v) / explained.noise_v);
  // The first look is the least of many medians of differences, each of which is off by this over
  // the root of the rows: 1.2 for a median, 1.4 for what neighbours have in common.
  constexpr double kOfFirstLook = 1.7, kSigmas = 5.0;
  const double allowed =
      1.0 + kSigmas * kOfFirstLook / std::sqrt(1.0 + static_cast<double>(scene.all.size()));
  if (more && !explained.noise_stated && nats > criteria::kNatsOfNoise &&
      (rms > allowed * explained.noise_v || !is_white(scene.all, model)))
    out.structure.push_back({"time",
                             fmt::format("{:.3g} mV rms are left where the readings have a noise "
                                         "of {:.3g} mV, and nothing shows what they go with",
                                         1e3 * rms, 1e3 * explained.noise_v),
                             std::sqrt(rms * rms - explained.noise_v * explained.noise_v)});
  if (more && explained.noise_stated)
    out.structure.push_back({"time",
                             "the residual is larger than the stated noise, yet not white noise "
                             "of both channels",
                             out.unexplained_rms_v});
  return out;
}

double second_order_floor(const Model &model, const SearchResult &found) {
  constexpr double kPart = 0.3, kMost = 5e-4; // of the product; of the amplitude
  const double offsets = std::hypot(model.baseline.offset_sin_v, model.baseline.offset_cos_v);
  double sum = 0.0, bent = 0.0; // bent: of what makes of an ellipse something else
  for (std::size_t k = 0; k < found.order.size(); ++k) {
    const EffectInfo &info = found.fit.model.effects[found.order[k]].effect->info();
    if (info.recorded)
      continue;
    sum += found.contribution[k];
    bent += info.affine ? 0.0 : found.contribution[k];
  }
  const double amplitude = model.baseline.amplitude_v;
  return std::min(kPart * bent * (sum + offsets) / amplitude, kMost * amplitude);
}

} // namespace ada
