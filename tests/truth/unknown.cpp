// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "unknown.h"
#include "random.h"
#include "wander.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace truth {
namespace {

std::vector<double> random_moments(Random &random, double duration, std::size_t count) {
  std::vector<double> moments(count);
  for (double &t : moments)
    t = random.uniform(0.02, 0.98) * duration;
  std::sort(moments.begin(), moments.end());
  return moments;
}

using Maker = void (*)(Unknown &, Random &, const Motion &, double rate, double duration,
                       double noise);

/// Some cycles in the capture, slow against the rotation; never a whole number of them, so
/// that it does not look like a harmonic of anything.
double slow_frequency(Random &random, double duration) {
  return (static_cast<double>(5 + random.index(12)) + random.uniform(0.2, 0.8)) / duration;
}

void offset_random_walk(Unknown &u, Random &random, const Motion &, double, double duration,
                        double noise) {
  const double rms = noise * random.uniform(4, 10);
  auto sine = std::make_shared<Track>(random_walk(random, duration, 2000, rms));
  auto cosine = std::make_shared<Track>(random_walk(random, duration, 2000, rms));
  u.offset = [=](Channel c, double t) { return c == Channel::sine ? (*sine)(t) : (*cosine)(t); };
}

void amplitude_telegraph(Unknown &u, Random &random, const Motion &, double, double duration,
                         double) {
  const double drop = random.uniform(0.006, 0.015);
  auto moments = std::make_shared<std::vector<double>>(
      random_moments(random, duration, 15 + random.index(30)));
  u.gain = [=](double t) {
    const auto passed = std::upper_bound(moments->begin(), moments->end(), t) - moments->begin();
    return passed % 2 == 0 ? 1.0 : 1.0 - drop;
  };
}

void flicker_noise(Unknown &u, Random &random, const Motion &, double rate, double duration,
                   double noise) {
  const double rms = noise * random.uniform(3, 6);
  const auto points = static_cast<std::size_t>(rate * duration) + 1;
  auto sine = std::make_shared<Track>(flicker(random, duration, points, rms));
  auto cosine = std::make_shared<Track>(flicker(random, duration, points, rms));
  u.offset = [=](Channel c, double t) { return c == Channel::sine ? (*sine)(t) : (*cosine)(t); };
}

void rotating_pattern(Unknown &u, Random &random, const Motion &, double, double duration, double) {
  const double amplitude = random.uniform(0.15, 0.4) * kDegree;
  const double order = static_cast<double>(3 + random.index(3));
  const double rate = kTurn * slow_frequency(random, duration) * random.sign();
  u.angle = [=](double t, double magnet) {
    return amplitude * std::sin(order * magnet + rate * t);
  };
}

void crossover(Unknown &u, Random &random, const Motion &, double, double, double) {
  const double band = random.uniform(0.012, 0.03);
  u.transfer = [=](Channel, double, double signal) {
    return std::copysign(std::max(0.0, std::abs(signal) - band), signal);
  };
}

void angle_detents(Unknown &u, Random &random, const Motion &, double, double, double) {
  const double pull = random.uniform(0.08, 0.2);
  auto detents = std::make_shared<std::vector<double>>();
  double at = 0.0;
  while (at < kTurn) {
    detents->push_back(at);
    at += random.uniform(2.0, 10.0) * kDegree;
  }
  detents->push_back(kTurn);
  u.angle = [=](double, double magnet) {
    const double wrapped = magnet - kTurn * std::floor(magnet / kTurn);
    auto above = std::upper_bound(detents->begin(), detents->end() - 1, wrapped);
    const double low = *(above - 1);
    const double high = *above;
    return -pull * (wrapped - (wrapped - low < high - wrapped ? low : high));
  };
}

void bit_weight(Unknown &u, Random &random, const Motion &, double, double, double noise) {
  // Two neighbouring bits have wrong weights: codes go missing or double at every carry.
  const int first = 11 + static_cast<int>(random.index(3));
  const double excess = noise * random.uniform(4, 8);
  u.code = [=](double volts) {
    const auto code = static_cast<unsigned>(std::lround(volts / 5.0 * 65536.0));
    const double error =
        ((code >> first) & 1U ? excess : 0.0) + ((code >> (first - 1)) & 1U ? -0.6 * excess : 0.0);
    return std::round((volts + error) / 5.0 * 65536.0) * 5.0 / 65536.0;
  };
}

void chirped_tone(Unknown &u, Random &random, const Motion &, double rate, double duration,
                  double noise) {
  const double amplitude = noise * random.uniform(6, 14);
  const double low = random.uniform(0.02, 0.08) * rate;
  const double high = random.uniform(0.2, 0.4) * rate;
  const double balance = random.uniform(-1, 1);
  u.offset = [=](Channel c, double t) {
    const double phase = kTurn * (low * t + (high - low) * t * t / (2 * duration));
    return amplitude * (c == Channel::sine ? 1.0 : balance) * std::sin(phase);
  };
}

void acceleration_gain(Unknown &u, Random &random, const Motion &motion, double, double duration,
                       double) {
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i)
    largest = std::max(largest, std::abs(motion.acceleration(duration * i / 1000)));
  const double factor = random.sign() * random.uniform(0.008, 0.02) / largest;
  u.gain = [=](double t) { return 1 + factor * motion.acceleration(t); };
}

void dropouts(Unknown &u, Random &random, const Motion &, double rate, double duration, double) {
  struct Burst {
    double begin, end;
    bool sine;
  };
  auto bursts = std::make_shared<std::vector<Burst>>();
  for (double t : random_moments(random, duration, 8 + random.index(15)))
    bursts->push_back({t, t + random.uniform(5, 60) / rate, random.chance(0.5)});
  const double left = random.uniform(0.3, 0.8);
  u.transfer = [=](Channel c, double t, double signal) {
    for (const Burst &burst : *bursts)
      if (t >= burst.begin && t < burst.end && (c == Channel::sine) == burst.sine)
        return left * signal;
    return signal;
  };
}

void wandering_tone(Unknown &u, Random &random, const Motion &, double rate, double duration,
                    double noise) {
  const double amplitude = noise * random.uniform(6, 14);
  const double centre = random.uniform(0.08, 0.3) * rate;
  // The frequency wanders by many resolutions of the capture: its phase is a random walk's sum.
  auto phase = std::make_shared<Track>(random_walk(random, duration, 400, random.uniform(25, 60)));
  u.offset = [=](Channel c, double t) {
    const double angle = kTurn * centre * t + (*phase)(t);
    return amplitude * (c == Channel::sine ? std::sin(angle) : std::cos(angle));
  };
}

void gain_wander(Unknown &u, Random &random, const Motion &, double, double duration, double) {
  const double size = random.uniform(0.004, 0.012);
  const double rate = kTurn * slow_frequency(random, duration);
  u.gain = [=](double t) { return 1 + size * std::sin(rate * t); };
}

void quadrature_wander(Unknown &u, Random &random, const Motion &, double, double duration,
                       double) {
  const double size = random.uniform(0.4, 1.0) * kDegree;
  const double rate = kTurn * slow_frequency(random, duration);
  u.quadrature = [=](double t) { return size * std::sin(rate * t); };
}

void speed_offset(Unknown &u, Random &random, const Motion &motion, double, double duration,
                  double noise) {
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i)
    largest = std::max(largest, std::abs(motion.speed(duration * i / 1000)));
  const double sine = random.sign() * noise * random.uniform(10, 30) / largest;
  const double cosine = random.sign() * noise * random.uniform(10, 30) / largest;
  u.offset = [=](Channel c, double t) {
    return (c == Channel::sine ? sine : cosine) * std::abs(motion.speed(t));
  };
}

void torsional_ringing(Unknown &u, Random &random, const Motion &, double rate, double duration,
                       double) {
  auto hits =
      std::make_shared<std::vector<double>>(random_moments(random, duration, 6 + random.index(8)));
  const double amplitude = random.uniform(0.3, 1.0) * kDegree;
  const double omega = kTurn * std::min(random.uniform(8, 40), rate / 15);
  const double decay = random.uniform(6, 20) / omega;
  u.angle = [=](double t, double) {
    double sum = 0.0;
    for (double hit : *hits)
      if (t > hit && t < hit + 20 * decay)
        sum += amplitude * std::exp(-(t - hit) / decay) * std::sin(omega * (t - hit));
    return sum;
  };
}

struct Entry {
  UnknownKind kind;
  Maker make;
};

const std::vector<Entry> &entries() {
  static const std::vector<std::string> none;
  static const std::vector<Entry> table = {
      {{"offset-random-walk", {}, none, {"offset-wander", "flicker-noise"}}, offset_random_walk},
      {{"amplitude-telegraph", {}, none, none}, amplitude_telegraph},
      {{"flicker-noise", {}, {"excess-noise"}, {"flicker-noise", "offset-wander"}}, flicker_noise},
      {{"rotating-pattern", {true, false, false}, none, none}, rotating_pattern},
      {{"crossover-dead-band",
        {},
        {"cubic-nonlinearity", "weak-field", "harmonic-distortion"},
        none},
       crossover},
      {{"angle-detents",
        {true, false, false},
        {"field-direction-error", "stray-field", "sensor-off-axis", "reference-eccentricity"},
        none},
       angle_detents},
      {{"adc-bit-weight",
        {},
        {"excess-noise", "harmonic-distortion", "cubic-nonlinearity", "quadratic-nonlinearity",
         "weak-field", "amplitude-mismatch"},
        none},
       bit_weight},
      {{"chirped-tone", {}, none, none}, chirped_tone},
      {{"acceleration-gain", {false, true, true}, none, none}, acceleration_gain},
      {{"channel-dropouts", {}, {"impulse-noise"}, none}, dropouts},
      {{"wandering-tone", {}, none, none}, wandering_tone},
      {{"gain-wander", {}, none, {"gain-wander"}}, gain_wander},
      {{"quadrature-wander", {}, none, none}, quadrature_wander},
      {{"speed-offset", {false, true, true}, none, none}, speed_offset},
      {{"torsional-ringing", {true, false, false}, none, none}, torsional_ringing},
  };
  return table;
}

} // namespace

const std::vector<UnknownKind> &unknown_kinds() {
  static const std::vector<UnknownKind> kinds = [] {
    std::vector<UnknownKind> list;
    for (const Entry &entry : entries())
      list.push_back(entry.kind);
    return list;
  }();
  return kinds;
}

Unknown make_unknown(const std::string &name, std::uint64_t seed, const Motion &motion, double rate,
                     double duration, double noise) {
  Unknown unknown;
  Random random(seed, 20);
  for (const Entry &entry : entries()) {
    if (entry.kind.name == name) {
      unknown.name = name;
      entry.make(unknown, random, motion, rate, duration, noise);
    }
  }
  return unknown;
}

} // namespace truth
