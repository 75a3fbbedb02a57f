// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/several.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "base/angle.h"
#include "base/pick.h"
#include "diagnosis/conditions/reference_zero.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/fit.h"
#include "motion/surroundings.h"
#include "recording/join.h"

namespace ada {

namespace {

/// Appends the columns that belong to the motion; those of temperature and supply come from the
/// whole.
void append(Observations &to, const Observations &from) {
  const auto add = [](auto &a, const auto &b) { a.insert(a.end(), b.begin(), b.end()); };
  add(to.time, from.time);
  add(to.vsin, from.vsin);
  add(to.vcos, from.vcos);
  add(to.alpha, from.alpha);
  add(to.omega, from.omega);
  add(to.accel, from.accel);
  add(to.direction, from.direction);
  add(to.travel, from.travel);
  add(to.moved, from.moved);
  add(to.temp, from.temp);
  add(to.temp_rate, from.temp_rate);
  add(to.supply, from.supply);
  add(to.supply_rate, from.supply_rate);
  add(to.supply_bend, from.supply_bend);
}

template <class Column> Column picked(const Column &from, const std::vector<std::uint32_t> &index) {
  Column out;
  if (!from.empty())
    for (std::uint32_t i : index)
      out.push_back(from[i]);
  return out;
}

/// Temperature and supply of the whole: one mean and one scale for all records.
void take_surroundings(const Capture &joined, Scene &scene, std::optional<double> vdd_level_v) {
  Observations &all = scene.all;
  SupplyOverTime supply(joined, vdd_level_v);
  TemperatureOverTime temperature(joined, supply);
  const Derivatives of_supply(joined.time_s, supply.unit);
  all.mid_shift_v = supply.mid_shift_v;
  scene.supply_rms = supply.rms;
  all.supply = picked(supply.unit, scene.index);
  all.supply_rate = picked(of_supply.rate, scene.index);
  all.supply_bend = picked(of_supply.bend, scene.index);
  all.temp = as_floats(picked(temperature.vtemp_v, scene.index));
  all.temp_rate = picked(temperature.rate, scene.index);
  all.vtemp_on_vcos = temperature.on_vcos;
  all.vtemp_on_vcos_error = temperature.on_vcos_error;
  scene.why_no_temperature.clear();
  describe_temperature(joined, scene);
}

void move_by(std::vector<std::uint32_t> &places, std::size_t by) {
  for (std::uint32_t &i : places)
    i += static_cast<std::uint32_t>(by);
}

void append(std::vector<std::uint32_t> &to, const std::vector<std::uint32_t> &from) {
  to.insert(to.end(), from.begin(), from.end());
}

} // namespace

void move_angle(Scene &scene, double by_rad) {
  for (Observations *o : {&scene.all, &scene.spiked, &scene.rough, &scene.bursts}) {
    o->moved.resize(o->size(), 0.0f);
    for (std::size_t i = 0; i < o->size(); ++i) {
      o->alpha[i] += by_rad;
      o->moved[i] += static_cast<float>(by_rad);
    }
  }
}

Scene prepare_several(const Capture &joined, bool needs_split, const Model *known,
                      std::optional<double> vdd_level_v) {
  Scene out;
  const std::size_t records = joined.starts.size();
  const bool whole_records = needs_split && records >= criteria::kFewestRecords;
  std::optional<ReferenceZero> first;
  double noise2 = 0.0;
  bool steady = records > 1;
  for (std::size_t k = 0; k < records; ++k) {
    const Capture record = record_of(joined, k);
    Scene scene = prepare_record(record, needs_split && !whole_records, known);
    if (!scene.insufficient.empty()) {
      scene.insufficient = fmt::format("capture {}: {}", k + 1, scene.insufficient);
      return scene;
    }
    if (scene.has_reference || scene.periods > 1) {
      ReferenceZero zero(scene);
      // The first one as well, by nothing: all records have the same columns.
      move_angle(scene, !first                ? 0.0
                        : scene.has_reference ? first->move_of(zero)
                                              : first->period_of(zero));
      if (!first)
        first = std::move(zero);
    }
    steady = steady && scene.has_reference && !scene.several_speeds && !scene.both_directions;
    const std::size_t start = joined.starts[k], before = out.all.size();
    move_by(scene.index, start);
    move_by(scene.spiked_index, start);
    if (whole_records) {
      scene.train.resize(scene.all.size());
      std::iota(scene.train.begin(), scene.train.end(), 0u);
      if (k % 3 == 1)
        scene.train.swap(scene.heldout);
    }
    move_by(scene.train, before);
    move_by(scene.heldout, before);
    noise2 += scene.white_noise_v * scene.white_noise_v / static_cast<double>(records);
    if (k == 0) {
      out = std::move(scene);
      continue;
    }
    append(out.all, scene.all);
    append(out.spiked, scene.spiked);
    append(out.rough, scene.rough);
    append(out.bursts, scene.bursts);
    append(out.index, scene.index);
    for (const auto &[first_row, end_row] : scene.stuck)
      out.stuck.emplace_back(first_row + start, end_row + start);
    append(out.spiked_index, scene.spiked_index);
    append(out.train, scene.train);
    append(out.heldout, scene.heldout);
    out.wrong_rows += scene.wrong_rows;
    out.episodes += scene.episodes;
    out.dead.insert(out.dead.end(), scene.dead.begin(), scene.dead.end());
    out.stale += scene.stale;
    for (const auto &[of, more] : {std::pair(&out.held_reference, &scene.held_reference),
                                   std::pair(&out.repeated, &scene.repeated)})
      for (const RowRange &r : *more)
        of->push_back({r.first + start, r.end + start});
    move_by(scene.own_jumps.rows, start);
    out.own_jumps += scene.own_jumps;
    out.coarse_step_v = std::max(out.coarse_step_v, scene.coarse_step_v);
    for (ScreenFinding &f : scene.screened) // what several records show is said once
      if (std::none_of(out.screened.begin(), out.screened.end(),
                       [&](const ScreenFinding &o) { return o.effect == f.effect; }))
        out.screened.push_back(std::move(f));
    if (scene.radius_only && !out.radius_only)
      judge_radius_only(out);
  }
  out.capture = &joined;
  out.lag_in_zeros = steady;
  out.stops = {};
  out.white_noise_v = std::sqrt(noise2);
  take_surroundings(joined, out, vdd_level_v);
  if (whole_records)
    out.unit = HoldoutUnit::records;
  describe_motion(out);
  return out;
}

} // namespace ada
