// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/surroundings.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/robust.h"
#include "motion/spline.h"

namespace ada {

namespace {

constexpr std::size_t kFewestSamples = 400;
/// Rows of a piece of the spline that follows VTEMP: to begin with, and at the least.
constexpr std::size_t kRowsOfPiece = 400, kFewestOfPiece = 25;

double mean_of(const std::vector<double> &v) {
  return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

/// Samples on either side of a jump; a piece of a record is longer.
constexpr std::size_t kBeside = 4;

/// Where VTEMP jumps and stays there: faster than any temperature, two records were joined.
std::vector<std::size_t> jumps_of(const std::vector<double> &vtemp) {
  constexpr std::size_t kMost = 8;
  std::vector<double> steps;
  for (std::size_t i = 1; i < vtemp.size(); ++i)
    steps.push_back(vtemp[i] - vtemp[i - 1]);
  // Of noise the means of four on either side differ by less than single samples do.
  const double limit = gap_beyond_bulk(steps);
  const auto mean_from = [&](std::size_t first) {
    return std::accumulate(vtemp.begin() + static_cast<std::ptrdiff_t>(first),
                           vtemp.begin() + static_cast<std::ptrdiff_t>(first + kBeside), 0.0) /
           kBeside;
  };
  if (!(limit > 0.0)) // the converter's steps are wider than the noise: each would be a jump
    return {};
  std::vector<std::size_t> out;
  for (std::size_t i = kBeside; i + kBeside <= vtemp.size(); ++i)
    if (std::abs(vtemp[i] - vtemp[i - 1]) > limit && (out.empty() || i - out.back() > kBeside) &&
        std::abs(mean_from(i) - mean_from(i - kBeside)) > limit)
      out.push_back(i);
  return out.size() <= kMost ? out : std::vector<std::size_t>{};
}

/// Knots of a slow spline in about so many pieces over a capture. Between two records the
/// temperature may be any other: three pieces there, across which no cubic reaches, set both sides
/// free.
std::vector<double> slow_knots(const Capture &capture, std::size_t pieces) {
  const std::vector<double> &time = capture.time_s;
  std::vector<std::size_t> starts = capture.starts;
  if (starts.empty())
    starts.push_back(0);
  for (std::size_t at : jumps_of(capture.vtemp_v))
    if (std::none_of(starts.begin(), starts.end(),
                     [&](std::size_t s) { return std::max(s, at) - std::min(s, at) <= kBeside; }))
      starts.push_back(at);
  std::sort(starts.begin(), starts.end());
  std::vector<double> knots;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const std::size_t last = (k + 1 < starts.size() ? starts[k + 1] : time.size()) - 1;
    const double from = time[starts[k]], to = time[last];
    if (!knots.empty()) {
      const double before = knots.back(), third = (from - before) / 3.0;
      knots.push_back(before + third);
      knots.push_back(before + 2.0 * third);
    }
    const double share =
        static_cast<double>(last - starts[k] + 1) / static_cast<double>(time.size());
    const auto own = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(share * static_cast<double>(pieces))));
    const std::vector<double> inside = CubicSpline::uniform(from, to, own);
    knots.insert(knots.end(), inside.begin(), inside.end());
  }
  return knots;
}

/// VTEMP as a spline in so many pieces, fitted to these rows, and beside it, where asked for, a
/// part of VCOS about its mean.
struct Beside {
  CubicSpline spline;
  double slope = 0.0;
  Beside(const Capture &capture, const std::vector<double> &vtemp_v, std::size_t pieces,
         std::span<const char> rows, bool of_vcos)
      : spline(slow_knots(capture, pieces)), mean_(mean_of(capture.vcos_v)) {
    spline.fit(capture.time_s, vtemp_v, rows, of_vcos ? 1 : 0,
               [&](std::size_t i, double *term) { *term = capture.vcos_v[i] - mean_; });
    if (of_vcos)
      slope = spline.term_coefficients()[0];
  }
  double at(const Capture &capture, std::size_t i) const {
    return spline.value(capture.time_s[i]) + slope * (capture.vcos_v[i] - mean_);
  }

private:
  double mean_;
};

/// Pieces with which the spline follows VTEMP: twice as many as long as rows that it was not fitted
/// to, every other one, come nearer to it. What a hundredth of their mean square hides is a tenth
/// of the noise of one reading.
std::size_t pieces_for(const Capture &capture, const std::vector<double> &vtemp_v, std::size_t few,
                       std::size_t most) {
  constexpr double kFalls = 0.99;
  constexpr std::size_t kLookedAt = 40000; // rows: a hundred to each of 400 pieces
  const std::size_t n = capture.size(), every = n / kLookedAt + 1;
  most = std::min(most, n / every / kFewestOfPiece);
  std::vector<char> fitted(n);
  for (std::size_t i = 0; i < n; i += 2 * every)
    fitted[i] = 1;
  const auto left = [&](std::size_t pieces) {
    const Beside fit(capture, vtemp_v, pieces, fitted, true);
    double sum = 0.0;
    for (std::size_t i = every; i < n; i += 2 * every)
      sum += std::pow(vtemp_v[i] - fit.at(capture, i), 2);
    return sum;
  };
  std::size_t pieces = few;
  for (double now = left(pieces); 2 * pieces <= most;) {
    const double then = left(2 * pieces);
    if (!(then < kFalls * now))
      break;
    now = then;
    pieces *= 2;
  }
  return pieces;
}

/// How VTEMP follows a supply that moves: 1 for a ratiometric output, 0 for one that stands on its
/// own feet. Fitted beside a slow spline, which takes the temperature's own motion.
double vtemp_follows_supply(const Capture &capture, double vdd_mean) {
  CubicSpline spline(slow_knots(capture, 12));
  spline.fit(capture.time_s, capture.vtemp_v, {}, 1,
             [&](std::size_t i, double *term) { *term = capture.vdd_v[i] / vdd_mean - 1.0; });
  return spline.term_coefficients()[0] / mean_of(capture.vtemp_v) > 0.5 ? 1.0 : 0.0;
}

/// Whole swings of a channel about its mean: electrical periods, whatever their sense.
std::size_t swings(const std::vector<double> &v, double mean) {
  constexpr double kClear = 0.3; // of the largest departure, so that noise crosses nothing
  double largest = 0.0;
  for (double x : v)
    largest = std::max(largest, std::abs(x - mean));
  std::size_t crossings = 0;
  int side = 0;
  for (double x : v) {
    const int now = x - mean > kClear * largest ? 1 : x - mean < -kClear * largest ? -1 : side;
    crossings += side != 0 && now != side;
    side = now;
  }
  return crossings / 2;
}

/// What VTEMP keeps of VCOS.
struct Leak {
  double slope = 0.0, error = 0.0; ///< error 0: not measured
};

/// The temperature in VTEMP, what VTEMP keeps of VCOS beside it, and what neither accounts for.
struct Followed {
  CubicSpline temperature;
  Leak leak;
  std::vector<double> left;
};

/// A channel without what a slow spline in so many pieces follows of it.
std::vector<double> faster_than(const Capture &capture, const std::vector<double> &channel,
                                std::size_t pieces) {
  CubicSpline slow(slow_knots(capture, pieces));
  slow.fit(capture.time_s, channel, {}, 0, {});
  std::vector<double> out(channel.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = channel[i] - slow.value(capture.time_s[i]);
  return out;
}

double squares(const std::vector<double> &x) {
  return std::inner_product(x.begin(), x.end(), x.begin(), 0.0);
}

double squares_about_mean(const std::vector<double> &x) {
  const double mean = mean_of(x);
  double sum = 0.0;
  for (const double v : x)
    sum += std::pow(v - mean, 2);
  return sum;
}

/// A slope on a column, with an error from the sums over parts of the record: what is left over
/// need not be white.
struct Slope {
  double value, error;
};

Slope slope_on(const std::vector<double> &column, const std::vector<double> &left) {
  constexpr std::size_t kParts = 20;
  std::array<double, kParts> parts{};
  for (std::size_t i = 0; i < column.size(); ++i)
    parts[i * kParts / column.size()] += column[i] * left[i];
  double sum = 0.0, squared = 0.0;
  for (const double part : parts) {
    sum += part;
    squared += part * part;
  }
  const double all = std::max(squares(column), 1e-30);
  return {sum / all, std::sqrt(squared) / all};
}

/// How much of VSIN is in what a part of VCOS leaves of VTEMP, beyond doubt. A memory gives it
/// none, as VCOS was converted last; a temperature that goes with the shaft lags it by some angle,
/// and has none by chance only.
double carried_of_sine(const Capture &capture, std::size_t pieces,
                       const std::vector<double> &fast_cosine, const std::vector<double> &left) {
  constexpr double kErrors = 3.0;
  std::vector<double> sine = faster_than(capture, capture.vsin_v, pieces);
  const double along = std::inner_product(sine.begin(), sine.end(), fast_cosine.begin(), 0.0) /
                       std::max(squares(fast_cosine), 1e-30);
  for (std::size_t i = 0; i < sine.size(); ++i)
    sine[i] -= along * fast_cosine[i];
  const Slope slope = slope_on(sine, left);
  return std::max(0.0, std::abs(slope.value) - kErrors * slope.error);
}

/// A slow shaft would pass for a temperature: both are fitted jointly, and only what of VCOS no
/// temperature could follow measures it.
Followed follow(const Capture &capture, const std::vector<double> &vtemp_v, std::size_t few,
                std::size_t most) {
  constexpr double kEnough = 0.01;
  const std::size_t pieces = pieces_for(capture, vtemp_v, few, most);
  const std::vector<double> faster = faster_than(capture, capture.vcos_v, pieces);
  const double fast = squares(faster);
  const bool measured = fast > kEnough * squares_about_mean(capture.vcos_v);
  const Beside fit(capture, vtemp_v, pieces, {}, measured);
  Followed out{fit.spline, {}, {}};
  for (std::size_t i = 0; i < capture.size(); ++i)
    out.left.push_back(vtemp_v[i] - fit.at(capture, i));
  const double rest = squares(out.left) / static_cast<double>(capture.size());
  if (measured)
    out.leak = {fit.slope, std::hypot(std::sqrt(rest / fast),
                                      carried_of_sine(capture, pieces, faster, out.left))};
  return out;
}

/// What VTEMP keeps of VCOS where the temperature itself moves as fast as the shaft, so that no
/// spline leaves noise alone. A memory takes the same part of VCOS however finely the temperature
/// is followed; where the two merely go together, as both may with the sun, the finer spline leaves
/// less of it. So the error holds how far the part moves with the spline, from one that cannot
/// follow the shaft to the finest that leaves a tenth of VCOS, besides what VTEMP has of VSIN.
Leak steady_leak(const Capture &capture, const std::vector<double> &vtemp_v, std::size_t few,
                 std::size_t most) {
  constexpr double kEnough = 0.1;
  const double all = squares_about_mean(capture.vcos_v);
  std::vector<double> slopes;
  double error = 0.0;
  for (std::size_t pieces = few; pieces <= most; pieces *= 2) {
    const std::vector<double> faster = faster_than(capture, capture.vcos_v, pieces);
    if (!(squares(faster) > kEnough * all))
      break;
    const Beside fit(capture, vtemp_v, pieces, {}, true);
    std::vector<double> left(capture.size());
    for (std::size_t i = 0; i < left.size(); ++i)
      left[i] = vtemp_v[i] - fit.at(capture, i);
    slopes.push_back(fit.slope);
    error =
        std::hypot(slope_on(faster, left).error, carried_of_sine(capture, pieces, faster, left));
  }
  if (slopes.size() < 2)
    return {};
  const auto [least, greatest] = std::minmax_element(slopes.begin(), slopes.end());
  return {slopes.back(), std::hypot(error, *greatest - *least)};
}

/// Whether neighbouring values have something in common, as what is slow has and noise has not.
bool goes_on(const std::vector<double> &x) {
  constexpr double kErrors = 4.0;
  double squares = 0.0, next = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += x[i] * x[i];
    next += i > 0 ? x[i] * x[i - 1] : 0.0;
  }
  return next > kErrors / std::sqrt(static_cast<double>(x.size())) * squares;
}

/// VTEMP as it would be at the mean supply.
std::vector<double> vtemp_of_temperature(const Capture &capture, const SupplyOverTime &supply) {
  constexpr double kSteady = 1e-5;
  std::vector<double> out = capture.vtemp_v;
  if (supply.rms < kSteady)
    return out;
  const double follows = vtemp_follows_supply(capture, supply.mean_v);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] /= 1.0 + follows * (capture.vdd_v[i] / supply.mean_v - 1.0);
  return out;
}

std::vector<double> third_differences(const std::vector<double> &x) {
  std::vector<double> out;
  for (std::size_t i = 3; i < x.size(); ++i)
    out.push_back(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]);
  return out;
}

/// Whether what VDD does from row to row is noise of its own reading: outputs that follow the
/// supply would have as much of it in their sum, about their mid-supply each half.
bool is_own_noise(const Capture &capture) {
  constexpr double kErrors = 3.0, kHalf = 0.5;
  const std::vector<double> vdd = third_differences(capture.vdd_v),
                            sin = third_differences(capture.vsin_v),
                            cos = third_differences(capture.vcos_v);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < vdd.size(); ++i) {
    const double x = vdd[i], y = sin[i] + cos[i];
    if (!std::isfinite(x) || !std::isfinite(y))
      continue;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  if (!(xx > 0.0))
    return false;
  const double n = static_cast<double>(vdd.size());
  return xy / xx + kErrors * std::sqrt(yy / (xx * n)) < kHalf;
}

/// Mean of `reach` values on either side of each; near an end of as many as there are.
std::vector<double> running_mean(const std::vector<double> &x, std::size_t reach) {
  std::vector<double> sum(x.size() + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    sum[i + 1] = sum[i] + (x[i] - x[0]);
  std::vector<double> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t here = std::min({reach, i, x.size() - 1 - i});
    out[i] = x[0] + (sum[i + here + 1] - sum[i - here]) / (2.0 * static_cast<double>(here) + 1.0);
  }
  return out;
}

/// VDD, where its reading has noise of its own smoothed over as many rows as leave no more than
/// that noise: what is left of it stands in the model of every output.
std::vector<double> vdd_of_supply(const Capture &capture) {
  constexpr std::size_t kLongest = 256;
  constexpr double kByChance = 6.0; // over the root of the rows: three errors of the noise as found
  const std::vector<double> &vdd = capture.vdd_v;
  const double noise = noise_between(vdd);
  if (!(noise > 0.0) || !std::ranges::all_of(vdd, [](double v) { return std::isfinite(v); }) ||
      !is_own_noise(capture))
    return vdd;
  const double more = 1.0 + kByChance / std::sqrt(static_cast<double>(vdd.size()));
  std::vector<double> out = vdd;
  for (std::size_t reach = 1; reach <= kLongest && 8 * reach < vdd.size(); reach *= 2) {
    // Twicing (Tukey 1977): the mean of what the mean leaves brings back what it rounded off.
    std::vector<double> smooth = running_mean(vdd, reach), left = vdd;
    for (std::size_t i = 0; i < vdd.size(); ++i)
      left[i] -= smooth[i];
    left = running_mean(left, reach);
    double squares = 0.0;
    for (std::size_t i = 0; i < vdd.size(); ++i) {
      smooth[i] += left[i];
      squares += (vdd[i] - smooth[i]) * (vdd[i] - smooth[i]);
    }
    // Of the variance of the noise: 1 - 2/w + 5/(3 w) with a mean of w.
    const double own = 1.0 - 1.0 / (3.0 * (2.0 * static_cast<double>(reach) + 1.0));
    if (!(squares < more * more * own * noise * noise * static_cast<double>(vdd.size())))
      break;
    out = std::move(smooth);
  }
  return out;
}

} // namespace

SupplyOverTime::SupplyOverTime(const Capture &capture, std::optional<double> level_v) {
  constexpr double kConstant = 1e-7;
  if (!capture.has_vdd())
    return;
  const double mean = mean_of(capture.vdd_v);
  if (!(mean > 0.0))
    return;
  const std::vector<double> vdd = vdd_of_supply(capture);
  mean_v = mean;
  mid_shift_v = 0.5 * (mean - capture.meta.supply_v);
  double sum = 0.0;
  for (double v : vdd)
    sum += (v / mean - 1.0) * (v / mean - 1.0);
  rms = std::sqrt(sum / static_cast<double>(capture.size()));
  const double level = level_v.value_or(mean), away = std::abs(mean / level - 1.0);
  scale = rms < kConstant ? away : rms;
  if (scale < kConstant)
    return;
  unit.reserve(capture.size());
  for (double v : vdd)
    unit.push_back(static_cast<float>((v / level - 1.0) / scale));
}

Derivatives::Derivatives(const std::vector<double> &time_s, const std::vector<float> &value) {
  constexpr double kReach = 1e-3; // s
  constexpr std::size_t kLeast = 2, kMost = 1000;
  constexpr Eigen::Index kTerms = 5;
  const std::size_t n = value.size();
  rate.assign(n, 0.0f);
  bend.assign(n, 0.0f);
  const double step = n > 2 * kLeast ? median_step(time_s) : 0.0;
  if (!(step > 0.0))
    return;
  const std::size_t reach = std::min(
      static_cast<std::size_t>(std::clamp(std::round(kReach / step), 1.0 * kLeast, 1.0 * kMost)),
      (n - 1) / 2);
  // Weights of the samples about a place (Savitzky and Golay).
  const auto width = static_cast<Eigen::Index>(2 * reach + 1);
  Eigen::MatrixXd powers(width, kTerms);
  for (Eigen::Index i = 0; i < width; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(reach) - 1.0;
    for (Eigen::Index k = 0; k < kTerms; ++k)
      powers(i, k) = k == 0 ? 1.0 : powers(i, k - 1) * x;
  }
  const Eigen::MatrixXd fitted =
      (powers.transpose() * powers).ldlt().solve(powers.transpose()); // coefficients of samples
  const double unit = step * static_cast<double>(reach);
  for (std::size_t i = reach; i + reach < n; ++i) {
    double first = 0.0, second = 0.0;
    for (Eigen::Index j = 0; j < width; ++j) {
      const double v = static_cast<double>(value[i - reach + static_cast<std::size_t>(j)]);
      first += fitted(1, j) * v;
      second += fitted(2, j) * v;
    }
    rate[i] = static_cast<float>(first / unit);
    bend[i] = static_cast<float>(2.0 * second / (unit * unit));
  }
}

TemperatureOverTime::TemperatureOverTime(const Capture &capture, const SupplyOverTime &supply) {
  if (!capture.has_vtemp())
    return;
  const std::size_t n = capture.size();
  if (n < kFewestSamples) {
    vtemp_v = capture.vtemp_v;
    rate.assign(n, 0.0f);
    return;
  }
  vtemp_v = vtemp_of_temperature(capture, supply);
  const double mean_cos = mean_of(capture.vcos_v);
  // Not so fine that it could follow the shaft.
  const std::size_t slower = std::max<std::size_t>(4, swings(capture.vcos_v, mean_cos) / 2);
  const std::size_t wanted = std::clamp<std::size_t>(n / kRowsOfPiece, 4, 100);
  Followed found = follow(capture, vtemp_v, std::min(wanted, slower), slower);
  // Where a spline slower than the shaft leaves more than noise, VTEMP moves as fast as the shaft
  // does, and maybe with it: then the spline may be as fine as rows confirm. Unless VTEMP is known
  // to keep a part of VCOS, which is none of the temperature's, only what is faster still of VCOS
  // tells whether it does, if anything is.
  if (slower < wanted && goes_on(found.left)) {
    constexpr double kErrors = 5.0;
    const Leak leak = steady_leak(capture, vtemp_v, std::min(wanted, slower), wanted);
    const bool known = leak.error > 0.0 && std::abs(leak.slope) > kErrors * leak.error;
    for (std::size_t i = 0; known && i < n; ++i)
      vtemp_v[i] -= leak.slope * (capture.vcos_v[i] - mean_cos);
    found = follow(capture, vtemp_v, wanted, n / kFewestOfPiece);
    if (known)
      found.leak = leak;
  }
  rate.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    vtemp_v[i] = found.temperature.value(capture.time_s[i]);
    rate[i] = static_cast<float>(found.temperature.slope(capture.time_s[i]));
  }
  // The floor: a spline cannot be trusted beyond what the converter resolves.
  constexpr double kResolved = 2e-5;
  on_vcos = found.leak.slope;
  if (found.leak.error > 0.0)
    on_vcos_error = std::max(found.leak.error, kResolved);
}

} // namespace ada
