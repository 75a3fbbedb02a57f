// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A channel stops at a level below its peak: the output stage or the converter runs out of range.

#include "model/effects/common.h"

namespace ada {
namespace {

constexpr std::array<ParameterInfo, 3> kParameters{
    ParameterInfo{"low_v", "V", std::numeric_limits<double>::quiet_NaN(), -kInf, kInf, Role::fitted,
                  1e-3},
    ParameterInfo{"high_v", "V", 3.8, -kInf, kInf, Role::fitted, 1e-3},
    // Absent where both channels stop at the same levels.
    ParameterInfo{"channel", "channel", std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0,
                  Role::chosen}};

constexpr std::array<Separation, 1> kSeparations{
    {{"cubic-nonlinearity",
      "capture at another amplitude (gain control, supply): clipping keeps its level in volts"}}};

constexpr EffectInfo kInfo{.id = "clipping",
                           .cause = "The outputs stop at a level below the peak of the signal.",
                           .stage = Stage::chain,
                           .parameters = kParameters,
                           .correctable = true,
                           .separations = kSeparations,
                           .spoils = Spoils::peaks};

class Clipping final : public Effect {
public:
  const EffectInfo &info() const override { return kInfo; }
  std::string contradiction(Values v) const override {
    return v[0] > v[1] ? "low_v must not be above high_v" : ""; // never true of NaN
  }
  void apply(Values v, Wave &w) const override {
    const double low = std::isnan(v[0]) ? -kInf : v[0] - w.mid_v;
    const double high = std::isnan(v[1]) ? kInf : v[1] - w.mid_v;
    for (double channel : {0.0, 1.0}) {
      if (!std::isnan(v[2]) && v[2] != channel)
        continue;
      double *signal = channel_of(w, channel);
      for (std::size_t i = 0; i < w.n; ++i)
        signal[i] = std::min(std::max(signal[i], low), high);
    }
  }
  /// Only the side that clips is fitted; the other is not a number.
  std::vector<double> to_coordinates(Values v) const override {
    std::vector<double> x;
    for (double level : v.first(2))
      if (std::isfinite(level))
        x.push_back(level);
    return x;
  }
  std::vector<double> from_coordinates(Values v, std::span<const double> x) const override {
    std::vector<double> out(v.begin(), v.end());
    std::size_t k = 0;
    for (double &level : std::span(out).first(2))
      level = std::isfinite(level) ? x[k++] : std::nan("");
    return out;
  }
  std::vector<double> steps(Values v) const override {
    return std::vector<double>(to_coordinates(v).size(), 1e-3);
  }
  /// A channel that stops at a level stays on it, which is seen, and never passes it by more
  /// than noise. Isolated spikes may. While the model leaves more than noise against a
  /// reference, the fit may lay the level below the true one by as much; without one a motion
  /// read off the pair bends along.
  bool refuted(Values v, const Residual &r) const override {
    constexpr double kNoise = 4.5;    // standard deviations: by chance 3 in a million samples
    // Shares of the samples that may be spikes: alone or two together, and more in a row.
    constexpr double kSpikes = 0.02, kInRows = 0.002;
    constexpr std::size_t kAlone = 2;
    double left_v2 = 0.0;
    for (std::size_t i = 0; i < r.time.size(); ++i)
      left_v2 += 0.5 * (r.sin_v[i] * r.sin_v[i] + r.cos_v[i] * r.cos_v[i]);
    left_v2 /= static_cast<double>(std::max<std::size_t>(1, r.time.size()));
    const double beyond_noise_v = std::sqrt(std::max(0.0, left_v2 - r.noise_v * r.noise_v));
    const double reach = kNoise * r.noise_v + (r.has_reference ? beyond_noise_v : 0.0);
    std::size_t beyond = 0, in_rows = 0;
    for (double channel : {0.0, 1.0}) {
      if (!std::isnan(v[2]) && v[2] != channel)
        continue;
      std::size_t row = 0;
      for (const double read : channel < 0.5 ? r.read_sin_v : r.read_cos_v) {
        const bool is_beyond = read < v[0] - reach || read > v[1] + reach; // never true of NaN
        row = is_beyond ? row + 1 : 0;
        beyond += is_beyond;
        in_rows += row == kAlone + 1 ? row : row > kAlone;
      }
    }
    const auto n = static_cast<double>(r.time.size());
    return static_cast<double>(beyond) > 2.0 + kSpikes * n ||
           static_cast<double>(in_rows) > 2.0 + kInRows * n || !lie_on_levels(r, v);
  }
  std::vector<std::vector<double>> guesses(const Residual &r) const override {
    return find_clipping(r);
  }
  bool screen(Screened &look) const override { return screen_cut_peaks(look, *this); }
};

} // namespace

const Effect &clipping() {
  static const Clipping effect;
  return effect;
}

} // namespace ada
