// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/forward.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>

#include "base/angle.h"
#include "base/sincos.h"

namespace ada {

namespace {

/// e^(j p x) of the direction of (fx, fy): its unit vector to the power of p, by squaring.
void electrical(Wave &w) {
  if (w.periods == 2) {
    for (std::size_t i = 0; i < w.n; ++i) {
      const double x = w.fx[i], y = w.fy[i];
      const double inverse = 1.0 / (x * x + y * y);
      w.ex[i] = (x * x - y * y) * inverse;
      w.ey[i] = 2.0 * x * y * inverse;
    }
    return;
  }
  double x[kWaveBlock], y[kWaveBlock];
  for (std::size_t i = 0; i < w.n; ++i) {
    const double inverse = 1.0 / std::sqrt(w.fx[i] * w.fx[i] + w.fy[i] * w.fy[i]);
    x[i] = w.fx[i] * inverse;
    y[i] = w.fy[i] * inverse;
  }
  to_power(w.n, static_cast<unsigned>(w.periods), x, y, w.ex, w.ey);
}

std::vector<double> delays_of(const Taps &taps) {
  std::vector<double> out;
  for (const auto *of : {&taps.sin, &taps.cos})
    for (const Tap &tap : *of)
      if (std::find(out.begin(), out.end(), tap.delay_s) == out.end())
        out.push_back(tap.delay_s);
  return out;
}

} // namespace

ForwardModel::ForwardModel(const Model &model, AlphaIs alpha)
    : baseline_(model.baseline), mid_v_(0.5 * model.supply_v),
      temp_reference_v_(model.vtemp_reference_v), periods_(model.periods_per_turn) {
  if (model.remainder) {
    remainder_ = model.remainder->series(baseline_.amplitude_v);
    remainder_periods_ = model.remainder->electrical ? periods_ : 1.0;
  }
  std::vector<Step> bridge, chain;
  for (EffectInstance &e : in_physical_order(model.effects)) {
    e.effect->dynamics(e.values, taps_);
    apart_rad_ += e.effect->channels_apart_rad(e.values);
    Step step{Step::effect_acts, e.effect, std::move(e.values)};
    switch (e.effect->info().stage) {
    case Stage::motion:
      motion_.push_back(std::move(step));
      break;
    case Stage::field:
      way_.push_back(std::move(step));
      break;
    case Stage::bridge:
      bridge.push_back(std::move(step));
      break;
    case Stage::chain:
      chain.push_back(std::move(step));
      break;
    case Stage::record:
      if (alpha == AlphaIs::reference) // undone in the reverse of the order in which they act
        reference_.insert(reference_.begin(), step);
      later_.push_back(std::move(step));
      break;
    case Stage::sampler:
    case Stage::converter:
      later_.push_back(std::move(step));
      break;
    }
  }
  field_is_magnet_ = way_.empty();
  way_.push_back({Step::field_to_vector, nullptr, {}});
  std::move(bridge.begin(), bridge.end(), std::back_inserter(way_));
  way_.push_back({Step::vector_to_volts, nullptr, {}});
  std::move(chain.begin(), chain.end(), std::back_inserter(way_));
  if (!remainder_.empty())
    way_.push_back({Step::remainder, nullptr, {}});
  highest_ = highest_harmonic();
}

double ForwardModel::highest_harmonic() const {
  // What has no order of its own, such as a weak field, has a hundredth of the amplitude there at
  // the most. An order of the turn lies on either side of the fundamental.
  double out = 4.0;
  for (const Step &step : way_) {
    if (!step.effect)
      continue;
    const EffectInfo &info = step.effect->info();
    if (info.spoils == Spoils::peaks)
      return std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < info.parameters.size(); ++k)
      if (info.parameters[k].name == "order")
        out = std::max(out, 1.0 + step.values[k]);
  }
  return std::max(out, 1.0 + static_cast<double>(remainder_.size()));
}

Wave ForwardModel::wave() const {
  Wave w;
  w.amplitude_v = baseline_.amplitude_v;
  w.mid_v = mid_v_;
  w.periods = periods_;
  w.apart_rad = apart_rad_;
  return w;
}

void ForwardModel::leave_magnet(Wave &w, double delay_s, const double *shaft) const {
  for (std::size_t i = 0; i < w.n; ++i) {
    double a = shaft[i];
    if (delay_s != 0.0) {
      a -= w.at.omega[i] * delay_s;
      if (w.at.accel)
        a += 0.5 * w.at.accel[i] * delay_s * delay_s;
    }
    w.alpha[i] = a;
    w.temp[i] = w.at.temp ? w.at.temp[i] - temp_reference_v_ : 0.0;
  }
  w.delay_s = delay_s;
  sincos_of(w.alpha, w.n, w.fy, w.fx);
}

void ForwardModel::act(const Step &step, Wave &w) const {
  switch (step.kind) {
  case Step::effect_acts:
    step.effect->apply(step.values, w);
    break;
  case Step::field_to_vector:
    if (field_is_magnet_ && periods_ != 2) { // the field points where the magnet does
      double x[kWaveBlock];
      for (std::size_t i = 0; i < w.n; ++i)
        x[i] = periods_ * w.alpha[i];
      sincos_of(x, w.n, w.ey, w.ex);
    } else
      electrical(w);
    std::copy(w.ex, w.ex + w.n, w.c);
    std::copy(w.ey, w.ey + w.n, w.s);
    break;
  case Step::vector_to_volts:
    for (std::size_t i = 0; i < w.n; ++i) {
      w.s[i] *= baseline_.amplitude_v;
      w.c[i] *= baseline_.amplitude_v;
      w.offset_s[i] = w.offset_c[i] = 0.0;
      w.add_offset(i, baseline_.offset_sin_v, baseline_.offset_cos_v);
    }
    break;
  case Step::remainder:
    add_remainder(w);
    break;
  }
}

void ForwardModel::add_remainder(Wave &w) const {
  double x[kWaveBlock];
  for (std::size_t i = 0; i < w.n; ++i)
    x[i] = remainder_periods_ * w.alpha[i];
  add_fourier_pair(x, w.n, remainder_, w.s, w.c);
}

void ForwardModel::motion(Wave &w, double *shaft, float *speed) const {
  std::copy(w.at.alpha, w.at.alpha + w.n, shaft);
  if (!reference_.empty()) {
    // The reference's own ripple is in its speed as well. That speed is a mean over its reach: it
    // is taken for the shaft's by what the shaft does while the reference moves by as much. A
    // delay, which is undone last, is one of the shaft's own speed.
    constexpr double kLittle = 1e-4;
    const float *const of_reference = w.at.omega;
    double reach[kWaveBlock], behind[kWaveBlock], ahead[kWaveBlock];
    for (std::size_t i = 0; i < w.n; ++i) {
      reach[i] = of_reference == nullptr
                     ? kLittle
                     : std::max(kLittle, std::abs(of_reference[i]) * w.at.speed_reach_s);
      behind[i] = w.at.alpha[i] - reach[i];
      ahead[i] = w.at.alpha[i] + reach[i];
    }
    const auto to_reading = [&](double sign) {
      if (w.at.moved != nullptr)
        for (double *angle : {shaft, behind, ahead})
          for (std::size_t i = 0; i < w.n; ++i)
            angle[i] -= sign * static_cast<double>(w.at.moved[i]);
    };
    to_reading(1.0);
    for (const Step &step : reference_) {
      for (double *angle : {shaft, behind, ahead})
        step.effect->shaft_from_reference(step.values, w.at, {angle, w.n});
      if (of_reference == nullptr)
        continue;
      for (std::size_t i = 0; i < w.n; ++i)
        speed[i] = static_cast<float>(of_reference[i] * (ahead[i] - behind[i]) / (2.0 * reach[i]));
      w.at.omega = speed;
    }
    to_reading(-1.0);
    w.at.alpha = shaft;
  }
  std::copy(shaft, shaft + w.n, w.alpha);
  for (const Step &step : motion_)
    step.effect->apply(step.values, w);
}

void ForwardModel::magnet_angle(const Conditions &at, double *alpha) const {
  Wave w;
  double shaft[kWaveBlock];
  float speed[kWaveBlock];
  for (std::size_t first = 0; first < at.n; first += kWaveBlock) {
    w.n = std::min(kWaveBlock, at.n - first);
    w.at = at.slice(first, w.n);
    motion(w, shaft, speed);
    std::copy(w.alpha, w.alpha + w.n, alpha + first);
  }
}

void ForwardModel::begin(const Conditions &at, Wave &w, Motion &m) const {
  w.n = at.n;
  w.at = at;
  motion(w, m.shaft, m.speed);
  for (std::size_t i = 0; i < w.n; ++i)
    m.shaft[i] = w.alpha[i] + baseline_.angle_zero_deg * kRadPerDeg;
}

void ForwardModel::Copies::add(const Taps &taps, double delay_s, const Wave &w) {
  for (const Tap &tap : taps.sin)
    if (tap.delay_s == delay_s)
      for (std::size_t i = 0; i < w.n; ++i)
        s[i] += tap.weight * w.s[i];
  for (const Tap &tap : taps.cos)
    if (tap.delay_s == delay_s)
      for (std::size_t i = 0; i < w.n; ++i)
        c[i] += tap.weight * w.c[i];
}

/// Those that this block needs, at its speeds.
Taps ForwardModel::copies(const Wave &w) const {
  double fastest = 0.0;
  for (std::size_t i = 0; i < w.n; ++i)
    fastest = std::max(fastest, std::abs(static_cast<double>(w.at.omega[i])));
  return std::isfinite(highest_) ? taps_.fewest(highest_ * fastest * w.periods) : taps_;
}

void ForwardModel::finish(Wave &w, double *vsin_v, double *vcos_v) const {
  for (std::size_t i = 0; i < w.n; ++i) {
    w.s[i] += mid_v_;
    w.c[i] += mid_v_;
  }
  for (const Step &step : later_)
    act(step, w);
  std::copy(w.s, w.s + w.n, vsin_v);
  std::copy(w.c, w.c + w.n, vcos_v);
}

void ForwardModel::block(const Conditions &at, double *vsin_v, double *vcos_v, Wave &w) const {
  Motion m;
  begin(at, w, m);
  if (taps_.trivial()) {
    leave_magnet(w, 0.0, m.shaft);
    for (const Step &step : way_)
      act(step, w);
  } else {
    Copies sum;
    const Taps taps = copies(w);
    for (double delay_s : delays_of(taps)) {
      leave_magnet(w, delay_s, m.shaft);
      for (const Step &step : way_)
        act(step, w);
      sum.add(taps, delay_s, w);
    }
    std::copy(sum.s, sum.s + w.n, w.s);
    std::copy(sum.c, sum.c + w.n, w.c);
  }
  finish(w, vsin_v, vcos_v);
}

void ForwardModel::evaluate(const Conditions &at, double *vsin_v, double *vcos_v) const {
  Wave w = wave();
  for (std::size_t first = 0; first < at.n; first += kWaveBlock) {
    const std::size_t count = std::min(kWaveBlock, at.n - first);
    block(at.slice(first, count), vsin_v + first, vcos_v + first, w);
  }
}

ForwardFamily::ForwardFamily(const Model &first, AlphaIs alpha)
    : alpha_(alpha), first_(first, alpha) {}

std::size_t ForwardFamily::in_common(const ForwardModel &other) const {
  using Step = ForwardModel::Step;
  const ForwardModel &a = first_, &b = other;
  if (a.motion_ != b.motion_ || a.reference_ != b.reference_ || a.periods_ != b.periods_ ||
      a.mid_v_ != b.mid_v_ || a.temp_reference_v_ != b.temp_reference_v_ ||
      a.baseline_.angle_zero_deg != b.baseline_.angle_zero_deg || a.taps_ != b.taps_ ||
      (!a.taps_.trivial() && a.highest_ != b.highest_))
    return kNone;
  const bool same_size = a.baseline_.amplitude_v == b.baseline_.amplitude_v,
             same_volts = same_size && a.baseline_.offset_sin_v == b.baseline_.offset_sin_v &&
                          a.baseline_.offset_cos_v == b.baseline_.offset_cos_v;
  std::size_t same = 0;
  for (; same < std::min(a.way_.size(), b.way_.size()); ++same) {
    const Step &step = a.way_[same];
    if (step != b.way_[same])
      break;
    // What a step takes from the model rather than from the one before it.
    if ((step.kind == Step::field_to_vector &&
         (a.field_is_magnet_ != b.field_is_magnet_ || a.apart_rad_ != b.apart_rad_)) ||
        (step.kind == Step::vector_to_volts && !same_volts) ||
        (step.kind == Step::remainder &&
         (a.remainder_periods_ != b.remainder_periods_ || a.remainder_ != b.remainder_)))
      break;
  }
  return same;
}

void ForwardFamily::add(const Model &other) {
  ForwardModel model(other, alpha_);
  const std::size_t same = in_common(model);
  std::size_t kept = kNone;
  if (same != kNone) {
    const auto at = std::find(places_.begin(), places_.end(), same);
    kept = static_cast<std::size_t>(at - places_.begin());
    if (at == places_.end())
      places_.push_back(same);
  }
  others_.push_back({std::move(model), same, kept});
}

namespace {

/// Of a wave that was kept, what the stages behind that place read. Before the vector there is the
/// field only, and behind the bridge nothing asks for it.
void take_up(const Wave &kept, bool has_vector, bool has_volts, Wave &w) {
  const auto array = [&](auto member) { std::copy_n(kept.*member, kept.n, w.*member); };
  w.n = kept.n;
  w.at = kept.at;
  w.mid_v = kept.mid_v;
  w.periods = kept.periods;
  w.turns = kept.turns;
  w.delay_s = kept.delay_s;
  array(&Wave::alpha);
  array(&Wave::temp);
  if (!has_volts) {
    array(&Wave::fx);
    array(&Wave::fy);
  }
  if (!has_vector)
    return;
  for (auto member : {&Wave::ex, &Wave::ey, &Wave::c, &Wave::s})
    array(member);
  if (has_volts) {
    array(&Wave::offset_s);
    array(&Wave::offset_c);
  }
}

} // namespace

void ForwardFamily::evaluate(const Conditions &at, const Take &take) const {
  double s[kWaveBlock], c[kWaveBlock];
  ForwardModel::Motion m;
  TurnsOfBlock turns;
  Wave w = first_.wave();
  w.turns = &turns;
  first_.begin(at, w, m);
  const Taps taps = first_.taps_.trivial() ? first_.taps_ : first_.copies(w);
  const std::vector<double> delays = delays_of(taps);
  // Not set to zero: each is written before it is read.
  const auto kept = std::make_unique_for_overwrite<Wave[]>(places_.size() * delays.size());
  const auto behind = [&](ForwardModel::Step::Kind kind, std::size_t steps) {
    return std::any_of(first_.way_.begin(),
                       first_.way_.begin() + static_cast<std::ptrdiff_t>(steps),
                       [kind](const auto &step) { return step.kind == kind; });
  };
  const auto go_on = [&](const ForwardModel &model, std::size_t from, auto start, auto keep) {
    ForwardModel::Copies sum;
    for (std::size_t d = 0; d < delays.size(); ++d) {
      start(d);
      for (std::size_t k = from; k < model.way_.size(); ++k) {
        keep(d, k);
        model.act(model.way_[k], w);
      }
      keep(d, model.way_.size());
      if (!taps.trivial())
        sum.add(taps, delays[d], w);
    }
    if (!taps.trivial()) {
      std::copy(sum.s, sum.s + w.n, w.s);
      std::copy(sum.c, sum.c + w.n, w.c);
    }
    model.finish(w, s, c);
  };
  go_on(
      first_, 0, [&](std::size_t d) { first_.leave_magnet(w, delays[d], m.shaft); },
      [&](std::size_t d, std::size_t k) {
        for (std::size_t place = 0; place < places_.size(); ++place)
          if (places_[place] == k)
            kept[place * delays.size() + d] = w;
      });
  take(0, s, c);
  for (std::size_t k = 0; k < others_.size(); ++k) {
    const Other &other = others_[k];
    if (other.same == kNone) {
      w = other.model.wave();
      other.model.block(at, s, c, w); // its angle may be another: it keeps nothing
    } else {
      go_on(
          other.model, other.same,
          [&](std::size_t d) {
            take_up(kept[other.kept * delays.size() + d],
                    behind(ForwardModel::Step::field_to_vector, other.same),
                    behind(ForwardModel::Step::vector_to_volts, other.same), w);
            w.amplitude_v = other.model.baseline_.amplitude_v;
            w.apart_rad = other.model.apart_rad_;
          },
          [](std::size_t, std::size_t) {});
    }
    take(k + 1, s, c);
  }
}

} // namespace ada
