// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/tally.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/angle.h"
#include "base/parallel.h"
#include "base/robust.h"
#include "conversion/block_converter.h"
#include "conversion/sample_status.h"
#include "health/criteria.h"
#include "simulation/simulation.h"

namespace ada::health {

namespace {

/// Samples that a jump of VTEMP is seen by, on either side.
constexpr std::size_t kSeven = 7;

/// Whether a sample lies farther from the middle of its neighbours than the sensor itself may err.
bool disturbs(const Capture &c, std::size_t i, double amplitude_v) {
  if (i == 0 || i + 1 >= c.size())
    return true;
  const double sin_v = c.vsin_v[i] - 0.5 * (c.vsin_v[i - 1] + c.vsin_v[i + 1]);
  const double cos_v = c.vcos_v[i] - 0.5 * (c.vcos_v[i - 1] + c.vcos_v[i + 1]);
  return !(std::hypot(sin_v, cos_v) <=
           kAccuracyDeg * c.meta.periods_per_turn * kRadPerDeg * amplitude_v);
}

/// A place of the pair that may prove to be a spike.
struct Candidate {
  std::size_t sample = 0;
  double radius = 0;
  bool disturbs = false;
};

/// Where samples stand out, numbered through the recording.
struct Found {
  PairPlaces pair;
  std::vector<std::size_t> vtemp, vdd, reference;
  std::vector<Candidate> candidates; ///< those of the pair
};

void add_radius(Tally &t, double radius) {
  if (!std::isfinite(radius))
    return;
  t.least_radius = std::min(t.least_radius, radius);
  t.greatest_radius = std::max(t.greatest_radius, radius);
}

/// A block, with what it needs of its neighbours, and what is counted in it.
struct Counted {
  AngleBlock angles;
  Block side;
  Capture around; ///< the block and its halo on either side, as far as there are
  Tally tally;
  Found found;
};

class Counter {
public:
  Counter(const Recording &recording, const Model &yardstick, const SpikeFinder &spikes,
          const VtempJumps &jumps, double usual_s)
      : recording_(recording), converter_(yardstick, recording), spikes_(spikes), jumps_(jumps),
        usual_s_(usual_s),
        amplitude_v_(yardstick.at_supply(recording.meta().supply_v).baseline.amplitude_v) {
    recording.jumps(); // once, before the threads ask for it
  }

  Tally run() {
    Tally all;
    Found found;
    in_order<Counted>(
        recording_.blocks(), [this](std::size_t k, Counted &c) { count(k, c); },
        [&](std::size_t, Counted &c) {
          append(all, c.tally);
          append(found, all, c.found);
        });
    all.far_are_many = spikes_.far_is_wrong() && spikes_.is_structure(all.far);
    all.spikes =
        all.far_are_many ? std::move(found.pair.far) : spikes_.spikes(std::move(found.pair));
    all.vtemp_spikes = spikes_.spikes(std::move(found.vtemp));
    all.vdd_spikes = spikes_.spikes(std::move(found.vdd));
    all.reference_spikes = spikes_.spikes(std::move(found.reference));
    std::size_t row = 0, next = 0;
    for (const Candidate &c : found.candidates) {
      if (!std::binary_search(all.spikes.begin(), all.spikes.end(), c.sample)) {
        add_radius(all, c.radius);
        continue;
      }
      if (!c.disturbs)
        continue;
      Faults &faults = all.disturbing;
      ++faults.count;
      row = c.sample == next ? row + 1 : 1;
      next = c.sample + 1;
      if (row > faults.longest) {
        faults.longest = row;
        faults.longest_first = next - row;
      }
    }
    return all;
  }

private:
  void count(std::size_t k, Counted &c) const {
    recording_.read(k, kAllColumns, c.angles.block);
    converter_.convert(c.angles);
    c.tally = {};
    const std::size_t before = gather(k, c);
    find_spikes(before, c);
    count_faults(before, c);
    count_steps(before, c);
    count_vtemp(before, c);
    if (recording_.size() > kPathSamples)
      pick_pairs(c.angles.block, recording_.size(), kPathSamples, c.tally.path);
  }

  /// Returns how many samples stand before those of the block.
  std::size_t gather(std::size_t k, Counted &c) const {
    for (const Column &column : kColumns)
      (c.around.*column.values).clear();
    c.around.meta = recording_.meta();
    std::size_t before = 0;
    if (k > 0) {
      const std::size_t size = recording_.block_begin(k) - recording_.block_begin(k - 1);
      before = std::min(SpikeFinder::kHalo, size);
      recording_.read(k - 1, size - before, before, kAllColumns, c.side);
      add(c.side, c.around);
    }
    add(c.angles.block, c.around);
    if (k + 1 < recording_.blocks()) {
      recording_.read(k + 1, 0, SpikeFinder::kHalo, kAllColumns, c.side);
      add(c.side, c.around);
    }
    return before;
  }

  static void add(const Block &from, Capture &to) {
    for (const Column &column : kColumns)
      (to.*column.values)
          .insert((to.*column.values).end(), (from.*column.block).begin(),
                  (from.*column.block).end());
  }

  void find_spikes(std::size_t before, Counted &c) const {
    const std::size_t first = c.angles.block.first, count = c.angles.count();
    const auto of_block = [&](std::vector<std::size_t> places) {
      std::erase_if(places, [&](std::size_t i) { return i < before || i >= before + count; });
      for (std::size_t &i : places)
        i = i - before + first;
      return places;
    };
    PairPlaces pair = spikes_.pair(c.around);
    Found &found = c.found;
    found.reference = of_block(spikes_.reference(c.around, pair));
    found.pair = {of_block(std::move(pair.off)),
                  of_block(std::move(pair.along)),
                  of_block(std::move(pair.far)),
                  {}};
    c.tally.far = found.pair.far.size();
    const std::vector<std::size_t> reversals = of_block(std::move(pair.reversals));
    c.tally.reversals = reversals.size();
    c.tally.first_reversal = reversals.empty() ? 0 : reversals.front();
    found.vtemp = of_block(spikes_.vtemp(c.around.vtemp_v));
    found.vdd = of_block(spikes_.vdd(c.around.vdd_v));
    found.candidates.clear();
    for (const std::size_t sample : found.pair.all())
      found.candidates.push_back(
          {sample, c.angles.radius[sample - first],
           std::binary_search(found.pair.far.begin(), found.pair.far.end(), sample) ||
               disturbs(c.around, sample - first + before, amplitude_v_)});
  }

  void count_faults(std::size_t before, Counted &c) const {
    const double supply = recording_.meta().supply_v, margin = kRailMargin * supply;
    const auto at_rail = [&](double v) {
      return std::abs(v) <= margin || std::abs(v - supply) <= margin;
    };
    const auto is_beyond = [&](double v) { return beyond_supply(v, supply); };
    const Capture &a = c.around;
    Tally &t = c.tally;
    const std::array<FaultRow *, 6> rows = {&t.rails,   &t.beyond,   &t.radius,
                                            &t.invalid, &t.same_sin, &t.same_cos};
    std::size_t sound = 0; // samples since the last faulty one
    const std::size_t n = c.angles.count();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t k = before + i;
      const double vsin = a.vsin_v[k], vcos = a.vcos_v[k];
      const unsigned faulty = (unsigned{at_rail(vsin)} | unsigned{at_rail(vcos)}) |
                              (unsigned{is_beyond(vsin)} | unsigned{is_beyond(vcos)}) << 1 |
                              unsigned{(c.angles.status[i] & ADA4571_SAMPLE_RADIUS) != 0} << 2 |
                              unsigned{(c.angles.status[i] & ADA4571_SAMPLE_INVALID) != 0} << 3 |
                              unsigned{k > 0 && vsin == a.vsin_v[k - 1]} << 4 |
                              unsigned{k > 0 && vcos == a.vcos_v[k - 1]} << 5;
      if (faulty == 0) { // nearly always: nothing six times over is counted at once
        ++sound;
        continue;
      }
      for (std::size_t r = 0; r < rows.size(); ++r) {
        rows[r]->add_sound(sound);
        rows[r]->add((faulty >> r & 1) != 0);
      }
      sound = 0;
    }
    for (FaultRow *row : rows)
      row->add_sound(sound);
    for (std::size_t i = 0; i < n; ++i)
      t.usable += std::isfinite(a.vsin_v[before + i]) && std::isfinite(a.vcos_v[before + i]);
    add_radii(c);
  }

  /// Those of all samples but the candidates.
  static void add_radii(Counted &c) {
    const auto radius = std::span<const double>(c.angles.radius).first(c.angles.count());
    std::size_t i = 0;
    const auto add_until = [&](std::size_t end) {
      double least = c.tally.least_radius, greatest = c.tally.greatest_radius;
      for (; i < end; ++i)
        if (std::isfinite(radius[i])) {
          least = std::min(least, radius[i]);
          greatest = std::max(greatest, radius[i]);
        }
      c.tally.least_radius = least;
      c.tally.greatest_radius = greatest;
    };
    for (const Candidate &candidate : c.found.candidates) {
      add_until(candidate.sample - c.angles.block.first);
      ++i;
    }
    add_until(radius.size());
  }

  void count_steps(std::size_t before, Counted &c) const {
    TimeSteps &s = c.tally.steps;
    const Capture &a = c.around;
    for (std::size_t i = before == 0 ? 1 : 0; i < c.angles.count(); ++i) {
      const double dt = a.time_s[before + i] - a.time_s[before + i - 1];
      const std::size_t sample = c.angles.block.first + i;
      if (dt == 0 && s.standing++ == 0)
        s.first_standing = sample;
      if (!(dt >= 0) && s.back++ == 0)
        s.first_back = sample;
      if (!(c.angles.status[i] & ADA4571_SAMPLE_GAP))
        continue;
      ++s.gaps;
      s.lost += std::max(std::round(dt / usual_s_) - 1, 0.0);
      s.longest_gap_s = std::max(s.longest_gap_s, dt);
    }
  }

  void count_vtemp(std::size_t before, Counted &c) const {
    const Capture &a = c.around;
    if (!a.has_vtemp())
      return;
    Tally &t = c.tally;
    for (std::size_t i = 0; i < c.angles.count(); ++i) {
      const std::size_t n = before + i;
      t.same_vtemp.add(n > 0 && a.vtemp_v[n] == a.vtemp_v[n - 1]);
      if (jumps_.after(a, n) && t.vtemp_jumps++ == 0)
        t.first_vtemp_jump =
            c.angles.block.first + i + 1 + kSeven / 2; // most of the seven are there
    }
  }

  /// Beyond what is rare in the recording nobody asks which they are.
  void append(std::vector<std::size_t> &all, const std::vector<std::size_t> &found) const {
    if (!spikes_.is_structure(all.size()))
      all.insert(all.end(), found.begin(), found.end());
  }

  void append(Found &all, Tally &tally, const Found &found) const {
    const auto may_be_spike = [this](const std::vector<std::size_t> &before,
                                     const std::vector<std::size_t> &now, std::size_t sample) {
      return !spikes_.is_structure(before.size()) &&
             std::binary_search(now.begin(), now.end(), sample);
    };
    for (const Candidate &c : found.candidates)
      if (may_be_spike(all.pair.off, found.pair.off, c.sample) ||
          may_be_spike(all.pair.along, found.pair.along, c.sample) ||
          may_be_spike(all.pair.far, found.pair.far, c.sample))
        all.candidates.push_back(c);
      else
        add_radius(tally, c.radius);
    append(all.pair.off, found.pair.off);
    append(all.pair.along, found.pair.along);
    append(all.pair.far, found.pair.far);
    append(all.vtemp, found.vtemp);
    append(all.vdd, found.vdd);
    append(all.reference, found.reference);
  }

  static void append(Tally &all, const Tally &t) {
    all.rails.append(t.rails);
    all.beyond.append(t.beyond);
    all.radius.append(t.radius);
    all.invalid.append(t.invalid);
    all.same_sin.append(t.same_sin);
    all.same_cos.append(t.same_cos);
    all.usable += t.usable;
    all.same_vtemp.append(t.same_vtemp);
    if (all.vtemp_jumps == 0)
      all.first_vtemp_jump = t.first_vtemp_jump;
    all.vtemp_jumps += t.vtemp_jumps;
    all.far += t.far;
    if (all.reversals == 0)
      all.first_reversal = t.first_reversal;
    all.reversals += t.reversals;
    all.least_radius = std::min(all.least_radius, t.least_radius);
    all.greatest_radius = std::max(all.greatest_radius, t.greatest_radius);
    TimeSteps &s = all.steps;
    if (s.back == 0)
      s.first_back = t.steps.first_back;
    if (s.standing == 0)
      s.first_standing = t.steps.first_standing;
    s.back += t.steps.back;
    s.standing += t.steps.standing;
    s.gaps += t.steps.gaps;
    s.lost += t.steps.lost;
    s.longest_gap_s = std::max(s.longest_gap_s, t.steps.longest_gap_s);
    all.path.append(t.path);
  }

  const Recording &recording_;
  BlockConverter converter_;
  const SpikeFinder &spikes_;
  const VtempJumps &jumps_;
  double usual_s_, amplitude_v_;
};

} // namespace

namespace {

double median_of_seven(const std::vector<double> &x, std::size_t first) {
  const auto begin = x.begin() + static_cast<std::ptrdiff_t>(first);
  return quantile(std::vector<double>(begin, begin + kSeven), 0.5);
}

/// From the seven samples that end with one to the seven after it.
double median_step(const std::vector<double> &x, std::size_t i) {
  return median_of_seven(x, i + 1) - median_of_seven(x, i + 1 - kSeven);
}

} // namespace

VtempJumps::VtempJumps(const Capture &sample) {
  if (!sample.has_vtemp() || sample.size() < 2 * kSeven)
    return;
  const double degree_v = kVtempFractionPerDegree * sample.meta.supply_v;
  std::vector<double> usual;
  const std::size_t stride = sample.size() / kPathSamples * kSeven + kSeven;
  for (std::size_t i = kSeven - 1; i + kSeven < sample.size(); i += stride)
    usual.push_back(std::abs(median_step(sample.vtemp_v, i)));
  limit_v_ =
      std::max({kVtempJumpDeg * degree_v, kVtempJumpOverUsual * quantile(std::move(usual), 0.5),
                kVtempJumpOverUsual * noise_between(sample.vtemp_v)});
  slope_v_s_ = kVtempJumpDegPerS * degree_v;
}

bool VtempJumps::after(const Capture &stretch, std::size_t i) const {
  const std::vector<double> &v = stretch.vtemp_v, &t = stretch.time_s;
  if (i + 1 < kSeven || i + kSeven >= v.size())
    return false;
  // The middle of seven to the middle of the next: where not even these differ, most do not.
  const std::size_t from = i - kSeven / 2, to = i + 1 + kSeven / 2;
  if (std::abs(v[to] - v[from]) <= limit_v_ / 2)
    return false;
  const double step = std::abs(median_step(v, i));
  return step > limit_v_ && step > slope_v_s_ * (t[to] - t[from]);
}

void FaultRow::end_row(std::size_t length, std::size_t end) {
  if (length > faults_.longest)
    faults_ = {faults_.count, length, end - length};
}

void FaultRow::add_sound(std::size_t samples) {
  samples_ += samples;
  if (samples > 0)
    trailing_ = 0;
}

void FaultRow::add(bool faulty) {
  ++samples_;
  if (!faulty) {
    trailing_ = 0;
    return;
  }
  ++faults_.count;
  ++trailing_;
  if (trailing_ == samples_)
    leading_ = samples_;
  end_row(trailing_, samples_);
}

void FaultRow::append(const FaultRow &next) {
  end_row(trailing_ + next.leading_, samples_ + next.leading_);
  if (next.faults_.longest > faults_.longest)
    faults_ = {faults_.count, next.faults_.longest, samples_ + next.faults_.longest_first};
  faults_.count += next.faults_.count;
  if (leading_ == samples_)
    leading_ += next.leading_;
  trailing_ = next.trailing_ == next.samples_ ? trailing_ + next.samples_ : next.trailing_;
  samples_ += next.samples_;
}

Tally take_tally(const Recording &recording, const Model &yardstick, const SpikeFinder &spikes,
                 const VtempJumps &jumps, double usual_s) {
  return Counter(recording, yardstick, spikes, jumps, usual_s).run();
}

} // namespace ada::health
