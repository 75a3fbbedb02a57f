// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

#include "base/angle.h"
#include "base/pick.h"
#include "base/robust.h"
#include "base/sincos.h"
#include "base/solve.h"
#include "diagnosis/criteria.h"
#include "diagnosis/edges.h"
#include "diagnosis/spectrum.h"
#include "model/residual.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

constexpr double kAbsentLevel = std::numeric_limits<double>::quiet_NaN();

/// Below this what comes with time cannot be told from what comes with the angle, but for what is
/// faster than any angle.
constexpr double kFewestRounds = criteria::kFewestTurnsToRepeat;

/// How often the shaft comes round, whatever its sense: by a turn, or to and fro over a part of
/// one.
double rounds_of(const Residual &r) {
  double speed = 0.0;
  for (double w : r.omega)
    speed += std::abs(w) / static_cast<double>(r.omega.size());
  const auto [low, high] = std::minmax_element(r.alpha.begin(), r.alpha.end());
  const double travel = speed * (r.time.back() - r.time.front());
  return travel / std::clamp(2.0 * (*high - *low), std::numeric_limits<double>::min(), kTwoPi);
}

/// Tangential part of the residual as a mechanical angle, rad.
double angle_residual(const Residual &r, std::size_t i) {
  const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
  const double radius2 = std::max(c * c + s * s, 1e-12);
  return (r.sin_v[i] * c - r.cos_v[i] * s) / (radius2 * r.periods);
}

/// Power and quadrature sums of both channels at one frequency.
struct Line {
  double power;
  std::array<double, 4> amplitudes; ///< sine, cosine of VSIN; sine, cosine of VCOS
};

/// `phase` gives rad for sample i.
template <class Phase> Line line_along(const Residual &r, Phase phase) {
  std::array<double, 4> sum{};
  for_each_sincos(r.time.size(), phase, [&](std::size_t i, double s, double c) {
    sum[0] += r.sin_v[i] * s;
    sum[1] += r.sin_v[i] * c;
    sum[2] += r.cos_v[i] * s;
    sum[3] += r.cos_v[i] * c;
  });
  Line line{0.0, sum};
  for (double &a : line.amplitudes) {
    a *= 2.0 / static_cast<double>(r.time.size());
    line.power += a * a;
  }
  return line;
}

Line line_at(const Residual &r, double frequency) {
  return line_along(r, [&](std::size_t i) { return kTwoPi * frequency * r.time[i]; });
}

/// Of the resolution: what lies nearer to an order of the turn is not told from it. A line's main
/// lobe ends at 1, its error beside another line's lobes included at 3.
constexpr double kOrderWidth = 3.0;

/// Turns a second of a shaft that comes round at even intervals, however it turns within each: what
/// repeats with its angle then repeats in time. 0: it does not, or came round too seldom to tell.
double comes_round(const Residual &r) {
  constexpr std::size_t kFewest = 4; // times that it is seen to pass the same angle
  constexpr double kEven = 0.01;     // of a turn
  constexpr double kStep = 0.25;     // of a turn; beyond it some turns lie between two samples
  struct Pass {
    double turn, time;
  };
  std::vector<Pass> passes;
  for (std::size_t i = 1; i < r.alpha.size(); ++i) {
    const double before = (r.alpha[i - 1] - r.alpha.front()) / kTwoPi;
    const double after = (r.alpha[i] - r.alpha.front()) / kTwoPi;
    const double turn = std::floor(std::max(before, after));
    if (turn > std::min(before, after) && std::abs(after - before) < kStep)
      passes.push_back(
          {turn, r.time[i - 1] + (r.time[i] - r.time[i - 1]) * (turn - before) / (after - before)});
  }
  if (passes.size() < kFewest || passes.back().turn == passes.front().turn)
    return 0.0;
  const double rate =
      (passes.back().turn - passes.front().turn) / (passes.back().time - passes.front().time);
  const bool even = std::ranges::all_of(passes, [&](const Pass &p) {
    return std::abs((p.time - passes.front().time) * rate - (p.turn - passes.front().turn)) < kEven;
  });
  return even ? std::abs(rate) : 0.0;
}

/// The order of the turn that a frequency is near at a speed at which the capture dwells; 0: none.
int order_near(const Residual &r, double frequency, double resolution) {
  // Speeds at which the capture dwells, each with the width of its orders: what the reference reads
  // wrong ripples its speed as well, and whether the line follows the angle is asked apart.
  constexpr double kDwells = 0.02;
  std::vector<double> speed;
  for (double w : r.omega)
    speed.push_back(std::abs(w) / kTwoPi);
  std::sort(speed.begin(), speed.end());
  for (double q : {0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95}) {
    const auto at = [&](double share) {
      return speed[static_cast<std::size_t>(share * static_cast<double>(speed.size() - 1))];
    };
    const double f = at(q);
    if (f < resolution || at(q + 0.04) - at(q - 0.04) > kDwells * f) // only passed through
      continue;
    const double order = std::round(frequency / f);
    if (order >= 1.0 &&
        std::abs(frequency - order * f) < kOrderWidth * resolution + kDwells * order * f)
      return static_cast<int>(order);
  }
  return 0;
}

/// Two channels a quarter of a period apart and of one size: something that turns, such as a gain
/// that wanders, or a pickup that happens to reach the wires so.
bool rotates(const Line &tone) {
  const auto &a = tone.amplitudes;
  const double s = std::hypot(a[0], a[1]), c = std::hypot(a[2], a[3]);
  const double in_phase = (a[0] * a[2] + a[1] * a[3]) / std::max(s * c, 1e-30);
  return std::abs(in_phase) < 0.34 && std::max(s, c) < 1.3 * std::min(s, c);
}

/// The residual as it would be if the model's pair drew a circle: what turns with the vector then
/// has two equal channels a quarter of a period apart, however unlike those of the pair are.
struct Rounded {
  std::array<std::vector<double>, 4> column;
  Residual view;

  explicit Rounded(const Residual &r) : view(r) {
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < r.time.size(); ++i) {
      const Eigen::Vector2d x(r.model_sin_v[i] - r.centre_sin_v, r.model_cos_v[i] - r.centre_cos_v);
      spread += x * x.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
    axes.computeDirect(spread);
    if (!(axes.eigenvalues()[0] > kFlattest * axes.eigenvalues()[1]))
      return;
    const Eigen::Matrix2d round = std::sqrt(0.5 * spread.trace()) * axes.operatorInverseSqrt();
    const auto turn = [&](const auto &sin, const auto &cos, double sin0, double cos0,
                          std::size_t to) {
      for (std::size_t i = 0; i < sin.size(); ++i) {
        const Eigen::Vector2d x = round * Eigen::Vector2d(sin[i] - sin0, cos[i] - cos0);
        column[to].push_back(x[0] + sin0);
        column[to + 1].push_back(x[1] + cos0);
      }
    };
    turn(r.sin_v, r.cos_v, 0.0, 0.0, 0);
    turn(r.model_sin_v, r.model_cos_v, r.centre_sin_v, r.centre_cos_v, 2);
    view.sin_v = column[0];
    view.cos_v = column[1];
    view.model_sin_v = column[2];
    view.model_cos_v = column[3];
  }

private:
  /// Of the mean squares along the two axes: what is flatter is no turn of the pair.
  static constexpr double kFlattest = 0.05;
};

/// The samples at the speed that the shaft has most, with the frequency of the pair there, Hz.
struct MostlyAt {
  std::vector<std::size_t> samples;
  double turning;
};

MostlyAt mostly_at(const Residual &r) {
  constexpr double kOneSpeed = 0.02; // from the slowest to the fastest of them
  std::vector<double> sorted(r.omega.begin(), r.omega.end());
  std::sort(sorted.begin(), sorted.end());
  std::size_t from = 0, most = 0;
  double slowest = 0.0, fastest = 0.0;
  for (std::size_t to = 0; to < sorted.size(); ++to) {
    while (sorted[to] - sorted[from] > kOneSpeed * std::abs(sorted[to]))
      ++from;
    if (to - from + 1 > most) {
      most = to - from + 1;
      slowest = sorted[from];
      fastest = sorted[to];
    }
  }
  MostlyAt out{{}, std::abs(0.5 * (slowest + fastest)) * r.periods / kTwoPi};
  for (std::size_t i = 0; i < r.omega.size(); ++i)
    if (r.omega[i] >= slowest && r.omega[i] <= fastest)
      out.samples.push_back(i);
  return out;
}

bool goes_to_and_fro(const Residual &r) {
  const auto [low, high] = std::minmax_element(r.omega.begin(), r.omega.end());
  return *low < 0.0 && *high > 0.0;
}

/// Whether a line rotates with the pair. Of a shaft that goes to and fro it does so one way and
/// then the other, which together is a line that stands: it is asked in one sense.
bool rotates_with_pair(const Residual &r, const MostlyAt &at, double frequency, const Line &line) {
  if (!goes_to_and_fro(r))
    return rotates(line);
  Residual one = r;
  std::array<std::vector<double>, 3> column;
  for (std::size_t i : at.samples) {
    column[0].push_back(r.time[i]);
    column[1].push_back(r.sin_v[i]);
    column[2].push_back(r.cos_v[i]);
  }
  one.time = column[0];
  one.sin_v = column[1];
  one.cos_v = column[2];
  return rotates(line_at(one, frequency));
}

/// Whether a line that rotates is a gain or an angle that wanders: seen from the turning pair that
/// lies along the radius or across it, while a pickup turns about the pair and shows in both alike.
bool one_sided(const Residual &r, const MostlyAt &at, double frequency) {
  constexpr double kAlike = 0.25;
  double strongest = 0.0;
  bool out = false;
  for (double f : {std::abs(frequency - at.turning), frequency + at.turning}) {
    std::complex<double> radial, tangential;
    for_each_sincos(
        at.samples.size(), [&](std::size_t k) { return kTwoPi * f * r.time[at.samples[k]]; },
        [&](std::size_t k, double sine, double cosine) {
          const std::size_t i = at.samples[k];
          const double c = r.model_cos_v[i] - r.centre_cos_v;
          const double s = r.model_sin_v[i] - r.centre_sin_v;
          const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
          const std::complex<double> wave(inverse * cosine, inverse * sine);
          radial += wave * (r.cos_v[i] * c + r.sin_v[i] * s);
          tangential += wave * (r.sin_v[i] * c - r.cos_v[i] * s);
        });
    const double u = std::norm(radial), v = std::norm(tangential);
    if (u + v > strongest) {
      strongest = u + v;
      out = std::min(u, v) < kAlike * std::max(u, v);
    }
  }
  return out;
}

/// Along the radius alone a tone is two lines, one on either side of the pair's frequency, which
/// follow the pair's speed; a gain that swings is one that stands still, and two in the channels. A
/// tone that turns, seen from a pair of one speed, is such a gain.
class AlongRadius {
public:
  explicit AlongRadius(const Residual &r) : r_(r) {
    for (std::size_t i = 0; i < r.time.size(); ++i) {
      const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
      const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
      cos_.push_back(inverse * c);
      sin_.push_back(inverse * s);
      along_.push_back(r.cos_v[i] * cos_.back() + r.sin_v[i] * sin_.back());
      along_v2_ += along_.back() * along_.back();
      across_v2_ += std::pow(r.sin_v[i] * cos_.back() - r.cos_v[i] * sin_.back(), 2);
      fastest_hz_ = std::max(fastest_hz_, std::abs(double{r.omega[i]}) * r.periods / kTwoPi);
    }
    add_power_over_time(
        r.time, r.sample_period_s, [&](std::size_t i) { return along_[i]; }, spectrum_);
  }

  /// Whether the residual says little across the vector: nothing is left there where the angle is
  /// the pair's own, and not much where the motion is hardly known.
  bool is_most() const {
    constexpr double kLittle = 0.25; // of power
    return across_v2_ < kLittle * along_v2_;
  }

  /// `slow`: from the pair one of a tone's two lines lies where whatever changes slowly does.
  bool is_gain(double frequency, bool slow) const {
    // What a tone takes beyond one line: of that, as no ellipse of the pair gives to a gain; of one
    // that is no line, as its fellow has by itself; and so that chance gives it to its two more
    // columns in no case that anybody meets.
    constexpr double kOfLine = 0.02, kOfSlow = 0.25, kNats = 10.0;
    const double wide = spectrum_.bin_hz; // the lines beside it, however slow the pair is
    double strongest = 0.0;
    for (const double side : {-1.0, 1.0}) {
      const double reach = side * (fastest_hz_ + wide);
      strongest = std::max(strongest, strongest_of_gain(std::min(frequency, frequency + reach),
                                                        std::max(frequency, frequency + reach)));
    }
    const double tone = of_tone(frequency), left = along_v2_ - tone;
    const double nats = 0.5 * static_cast<double>(along_.size()) *
                        std::log1p((tone - strongest) / std::max(left, 1e-30));
    return tone < (1.0 + (slow ? kOfSlow : kOfLine)) * strongest || nats < kNats;
  }

private:
  /// What the columns take of the radius, V^2. `columns`: of sample i with the sine and cosine of
  /// the phase there.
  template <int N, class Columns> double taken(double frequency, Columns columns) const {
    Eigen::Matrix<double, N, N> normal = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, 1> onto = Eigen::Matrix<double, N, 1>::Zero();
    for_each_sincos(
        along_.size(), [&](std::size_t i) { return kTwoPi * frequency * r_.time[i]; },
        [&](std::size_t i, double s, double c) {
          const Eigen::Matrix<double, N, 1> row = columns(i, s, c);
          normal += row * row.transpose();
          onto += along_[i] * row;
        });
    return onto.cwiseProduct(solved(normal, onto)).sum();
  }
  /// The most about a frequency that is known to half a line of the spectrum.
  template <int N, class Columns> double most_taken(double frequency, Columns columns) const {
    constexpr int kSteps = 5; // on either side; half of one loses less than a hundredth
    double best = 0.0;
    for (int step = -kSteps; step <= kSteps; ++step)
      best = std::max(best, taken<N>(frequency + 0.5 * step / kSteps * spectrum_.bin_hz, columns));
    return best;
  }
  double of_tone(double frequency) const {
    return most_taken<4>(frequency, [this](std::size_t i, double s, double c) {
      return Eigen::Vector4d(sin_[i] * s, sin_[i] * c, cos_[i] * s, cos_[i] * c);
    });
  }
  double strongest_of_gain(double from_hz, double to_hz) const {
    const auto &power = spectrum_.power;
    const auto bin = [&](double hz) {
      return std::clamp<std::size_t>(static_cast<std::size_t>(std::max(0.0, hz) / spectrum_.bin_hz),
                                     1, power.size() - 1);
    };
    const auto peak = std::max_element(power.begin() + static_cast<std::ptrdiff_t>(bin(from_hz)),
                                       power.begin() + static_cast<std::ptrdiff_t>(bin(to_hz)) + 1);
    return most_taken<2>(static_cast<double>(peak - power.begin()) * spectrum_.bin_hz,
                         [](std::size_t, double s, double c) { return Eigen::Vector2d(s, c); });
  }

  const Residual &r_;
  std::vector<double> cos_, sin_, along_;
  double fastest_hz_ = 0.0, along_v2_ = 0.0, across_v2_ = 0.0;
  PowerOverTime spectrum_;
};

/// Whether a line has a fellow on the other side of the pair's own frequency: something then
/// modulates the pair, and neither is a tone.
bool has_fellow(const Residual &r, const MostlyAt &at, double frequency) {
  constexpr double kAlike = 0.3, kWidths = 3.0;
  const auto power = [&](double f) {
    std::complex<double> sin, cos;
    for_each_sincos(
        at.samples.size(), [&](std::size_t k) { return kTwoPi * f * r.time[at.samples[k]]; },
        [&](std::size_t k, double sine, double cosine) {
          const std::complex<double> wave(cosine, sine);
          sin += wave * r.sin_v[at.samples[k]];
          cos += wave * r.cos_v[at.samples[k]];
        });
    return std::norm(sin) + std::norm(cos);
  };
  const double here = power(frequency);
  // The lines of so few samples are as wide as this.
  const double width = 1.0 / (static_cast<double>(at.samples.size()) * r.sample_period_s);
  for (double fellow : {std::abs(2.0 * at.turning - frequency), 2.0 * at.turning + frequency})
    if (std::abs(fellow - frequency) > kWidths * width && power(fellow) > kAlike * here)
      return true;
  return false;
}

/// Whether for most of the record a frequency lies so near to that of the pair that from the
/// turning vector it is seen as a slow change of gain and angle, which what is slow in time holds
/// as well.
bool slow_beside_pair(const Residual &r, double frequency) {
  constexpr double kMost = 0.5;
  const double span = r.time.back() - r.time.front();
  const double band = 0.5 * criteria::kMostTrends / span; // half waves
  std::size_t near = 0;
  for (double w : r.omega)
    near += std::abs(std::abs(w) * r.periods / kTwoPi - frequency) < band;
  return static_cast<double>(near) > kMost * static_cast<double>(r.omega.size());
}

/// Whether a line is more than an order of the turn beside it, or than something else whose `phase`
/// in rad is given, which may grow and fall over the
/// record, as with the temperature: that leaves more than half of what both take. Where the record
/// is too short to tell the two apart, either takes all.
template <class Phase> bool told_from(const Residual &r, Phase phase, double frequency) {
  constexpr int kOfOrder = 6; // a parabola over the record of either phase
  using Row = Eigen::Matrix<double, kOfOrder + 2, 1>;
  Eigen::Matrix<double, kOfOrder + 2, kOfOrder + 2> normal;
  Eigen::Matrix<double, kOfOrder + 2, 2> onto;
  normal.setZero();
  onto.setZero();
  std::vector<std::array<double, 2>> of_order(r.time.size());
  for_each_sincos(r.time.size(), phase, [&](std::size_t i, double s, double c) {
    of_order[i] = {s, c};
  });
  const double middle = 0.5 * (r.time.front() + r.time.back()),
               half = std::max(0.5 * (r.time.back() - r.time.front()), 1e-12);
  for_each_sincos(
      r.time.size(), [&](std::size_t i) { return kTwoPi * frequency * r.time[i]; },
      [&](std::size_t i, double s, double c) {
        const auto &[sine, cosine] = of_order[i];
        const double x = (r.time[i] - middle) / half;
        Row row;
        row << sine, cosine, x * sine, x * cosine, x * x * sine, x * x * cosine, s, c;
        normal += row * row.transpose();
        onto += row * Eigen::RowVector2d(r.sin_v[i], r.cos_v[i]);
      });
  const auto taken = [&](Eigen::Index columns) { // by the first of them, V^2
    const Eigen::MatrixXd a = normal.topLeftCorner(columns, columns), b = onto.topRows(columns);
    return (b.array() * solved(a, b).array()).sum();
  };
  const double both = taken(kOfOrder + 2);
  return both - taken(kOfOrder) > 0.5 * both;
}

bool told_from_order(const Residual &r, int order, double frequency) {
  return told_from(
      r, [&](std::size_t i) { return order * r.alpha[i]; }, frequency);
}

/// Hz at which a shaft that goes to and fro evenly comes back: whatever repeats with its angle is
/// then a sum of lines at the multiples. 0: it moves otherwise, over whole turns, or too seldom for
/// the multiples to lie apart.
double comes_back(const Residual &r) {
  constexpr double kEven = 0.8;   // of the mean square of the motion in one line
  constexpr double kFewest = 8.0; // times
  if (r.arc_turns() > 1.0)
    return 0.0;
  const double n = static_cast<double>(r.time.size());
  const double mean = std::accumulate(r.alpha.begin(), r.alpha.end(), 0.0) / std::max(1.0, n);
  PowerOverTime motion;
  add_power_over_time(
      r.time, r.sample_period_s, [&](std::size_t i) { return r.alpha[i] - mean; }, motion);
  if (motion.power.size() < 4)
    return 0.0;
  const auto peak = std::max_element(motion.power.begin() + 2, motion.power.end() - 1);
  const auto share = [&](double hz) { // of the motion
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d onto = Eigen::Vector2d::Zero();
    double all = 0.0;
    for_each_sincos(
        r.time.size(), [&](std::size_t i) { return kTwoPi * hz * r.time[i]; },
        [&](std::size_t i, double s, double c) {
          const Eigen::Vector2d row(s, c);
          normal += row * row.transpose();
          onto += (r.alpha[i] - mean) * row;
          all += (r.alpha[i] - mean) * (r.alpha[i] - mean);
        });
    return onto.cwiseProduct(solved(normal, onto)).sum() / std::max(all, 1e-30);
  };
  double best = 0.0, at = 0.0;
  for (double beside = -0.6; beside < 0.65; beside += 0.1) {
    const double hz = (static_cast<double>(peak - motion.power.begin()) + beside) * motion.bin_hz;
    if (const double of = share(hz); of > best) {
      best = of;
      at = hz;
    }
  }
  const double span = r.time.back() - r.time.front();
  return best > kEven && at * span > kFewest ? at : 0.0;
}

/// Whether a line swings while the record goes on, and not from one stretch of it to the next: what
/// lies between two stretches nobody saw, and levels of a few stretches are on a tone of some
/// frequency by chance. It then keeps most of its power where each stretch has a mean of its own.
bool swings_within_stretches(const Residual &r, double frequency) {
  constexpr double kGap = 0.5;  // of a period
  constexpr double kMost = 0.5; // of power
  Eigen::Matrix4d all = Eigen::Matrix4d::Zero(), within = Eigen::Matrix4d::Zero();
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  double n = 0.0;
  std::size_t stretches = 0;
  const auto end_stretch = [&] {
    within += products - mean * mean.transpose() / std::max(1.0, n);
    all += products;
    mean.setZero();
    products.setZero();
    n = 0.0;
    ++stretches;
  };
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    if (i > 0 && (r.time[i] - r.time[i - 1]) * frequency > kGap)
      end_stretch();
    double s, c;
    sincos(kTwoPi * frequency * r.time[i], &s, &c);
    const Eigen::Vector4d row(s, c, r.sin_v[i], r.cos_v[i]);
    mean += row;
    products += row * row.transpose();
    n += 1.0;
  }
  end_stretch();
  if (stretches == 1)
    return true;
  const auto taken = [](const Eigen::Matrix4d &m) {
    const Eigen::MatrixXd a = m.topLeftCorner<2, 2>(), b = m.topRightCorner<2, 2>();
    return (b.array() * solved(a, b).array()).sum();
  };
  return taken(within) > kMost * taken(all);
}

/// A line at an order of a steady rotation is no tone when the residual follows the angle as well.
bool turns_with_shaft(const Residual &r, int order, const Line &tone) {
  return order != 0 &&
         line_along(r, [&](std::size_t i) { return order * r.alpha[i]; }).power > 0.2 * tone.power;
}

/// Highest order of the turn that a named cause may have.
double highest_named(const Residual &r) {
  return (criteria::kNamedPeriods + 1) * r.periods;
}

/// Whether what repeats with the angle may make a line of this frequency while the shaft goes to
/// and fro: of an order n over a way of amplitude A it makes such up to n A, and little beyond (the
/// Bessel functions of a frequency modulation).
bool of_way_there_and_back(const Residual &r, double back_hz, double frequency) {
  constexpr double kBeyond = 2.0, kWidth = 1.0; // of the resolution: the line's main lobe
  if (!(back_hz > 0.0))
    return false;
  const double multiple = std::round(frequency / back_hz);
  const double span = r.time.back() - r.time.front();
  const double highest = highest_named(r) * 0.5 * kTwoPi * r.arc_turns() + kBeyond;
  return multiple >= 1.0 && multiple <= highest &&
         std::abs(frequency - multiple * back_hz) < kWidth / span &&
         !told_from(
             r, [&](std::size_t i) { return kTwoPi * multiple * back_hz * r.time[i]; }, frequency);
}

/// Whether a line at a multiple of the period stands out of those at the multiples beside it: what
/// a converter makes of its channel has many of about one size.
bool stands_alone(const Residual &r, int order, const Line &line) {
  constexpr int kBeside = 6;
  constexpr double kOut = 4.0; // of power, of the strongest of them
  double strongest = 0.0;
  for (int k = 1; k <= kBeside; ++k)
    for (int beside : {order - k * r.periods, order + k * r.periods})
      if (beside > 0)
        strongest = std::max(
            strongest, line_along(r, [&](std::size_t i) { return beside * r.alpha[i]; }).power);
  return line.power > kOut * strongest;
}

/// Whether a cause that goes with the angle could make a line at an order of a steady rotation. To
/// the highest named order it could. Beyond, what a channel makes of its own value comes at
/// multiples of the period and may be in that channel alone, and an error of the angle, whatever
/// its order, turns the pair to and fro and so has a fellow. A line of both channels beyond those,
/// without one, is a tone, though it keeps step with the shaft as the mains do with a motor. `few`:
/// the shaft came round too seldom for a line to be at an order by more than chance. What a channel
/// makes of its own value there is the steps of its converter, of which there are many lines.
bool may_be_of_the_angle(const Residual &r, const MostlyAt &at, int order, double frequency,
                         const Line &line, bool few) {
  constexpr double kInBoth = 0.2;
  const auto &a = line.amplitudes;
  const double sin = std::hypot(a[0], a[1]), cos = std::hypot(a[2], a[3]);
  const bool of_channel =
      order % r.periods == 0 || std::min(sin, cos) < kInBoth * std::max(sin, cos);
  return order <= highest_named(r) || has_fellow(r, at, frequency) ||
         (of_channel && !(few && stands_alone(r, order, line)));
}

/// Whether the shaft came round too seldom to tell a tone from what repeats with the angle: at one
/// speed the two are one but for the width of a line.
bool too_few_rounds_for_lines(const Residual &r) {
  return rounds_of(r) < (r.several_speeds ? kFewestRounds : criteria::kFewestUnits);
}

constexpr std::size_t kFewestForTones = 256; // samples, of a spectrum that shows a line

/// The two strongest lines of the spectrum above a frequency in Hz that `skip` lets pass, with
/// their frequencies.
template <class Skip>
std::vector<std::pair<double, Line>> strongest_lines(const Residual &r, double above_hz,
                                                     Skip skip) {
  const std::size_t n = r.time.size();
  const double span = n > 1 ? r.time.back() - r.time.front() : 0.0;
  if (n < kFewestForTones || !(r.sample_period_s > 0.0) || span <= 0.0)
    return {};
  const double resolution = 1.0 / span;
  PowerOverTime spectrum;
  for (const std::span<const double> channel : {r.sin_v, r.cos_v})
    add_power_over_time(
        r.time, r.sample_period_s, [&](std::size_t i) { return channel[i]; }, spectrum);
  const double bin = spectrum.bin_hz;
  const std::vector<float> &power = spectrum.power;
  // Every so manieth line tells the median of many: an odd stride meets no comb of lines.
  constexpr std::size_t kEnough = 8192;
  std::vector<float> some;
  for (std::size_t k = 1; k < power.size(); k += (power.size() / kEnough) | 1)
    some.push_back(power[k]);
  const double floor = quantile(std::move(some), 0.5);
  std::vector<std::pair<double, std::size_t>> peaks;
  const auto first =
      static_cast<std::size_t>(std::ceil(std::max(4.0 * resolution, above_hz) / bin));
  for (std::size_t k = std::max<std::size_t>(first, 2); k + 1 < power.size(); ++k)
    if (power[k] > 12.0 * floor && power[k] >= power[k - 1] && power[k] >= power[k + 1])
      peaks.emplace_back(power[k], k);
  std::sort(peaks.rbegin(), peaks.rend());
  std::vector<std::pair<double, Line>> out;
  std::size_t looked_at = 0;
  for (const auto &[p, k] : peaks) {
    if (out.size() == 2 || ++looked_at > 40)
      break;
    // The bin is coarse for a fit over the whole span: climb to the top of the line.
    double centre = static_cast<double>(k) * bin, step = 0.25 * bin;
    Line best = line_at(r, centre);
    if (skip(centre, best)) // most are; that shows at the bin already
      continue;
    for (int pass = 0; pass < 3; ++pass, step *= 0.25) {
      const double from = centre;
      for (int d = -4; d <= 4; ++d) {
        const Line line = line_at(r, from + d * step);
        if (line.power > best.power) {
          best = line;
          centre = from + d * step;
        }
      }
    }
    if (!skip(centre, best))
      out.emplace_back(centre, best);
  }
  return out;
}

/// Whether a line is stronger seen from the turning pair, along the radius or across it: there a
/// gain or an angle that swings is one line, of which either channel has the two beside it.
bool is_of_the_turning_pair(const Residual &r, double frequency, const Line &line) {
  std::vector<double> along, across;
  double turning = 0.0; // of the pair, Hz
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double c = r.model_cos_v[i] - r.centre_cos_v, s = r.model_sin_v[i] - r.centre_sin_v;
    const double inverse = 1.0 / std::max(std::hypot(c, s), 1e-9);
    along.push_back(inverse * (r.cos_v[i] * c + r.sin_v[i] * s));
    across.push_back(inverse * (r.sin_v[i] * c - r.cos_v[i] * s));
    turning += std::abs(double{r.omega[i]}) * r.periods / kTwoPi;
  }
  turning /= static_cast<double>(std::max<std::size_t>(1, r.time.size()));
  Residual turned = r;
  turned.sin_v = along;
  turned.cos_v = across;
  double strongest = 0.0;
  for (double f : {frequency - turning, frequency, frequency + turning}) {
    const auto a = line_at(turned, f).amplitudes;
    strongest = std::max({strongest, a[0] * a[0] + a[1] * a[1], a[2] * a[2] + a[3] * a[3]});
  }
  return strongest > line.power;
}

/// Of some lines, the strongest first, those that stand still and stand out of all that is left
/// beside them once they are taken out, as a tone does and none of the many lines of a function of
/// the angle.
void keep_single_lines(Residual r, std::vector<std::pair<double, Line>> &lines) {
  constexpr double kBeside = 1.5; // of the frequency
  constexpr double kOut = 10.0;   // of power
  std::array<std::vector<double>, 2> left{std::vector(r.sin_v.begin(), r.sin_v.end()),
                                          std::vector(r.cos_v.begin(), r.cos_v.end())};
  r.sin_v = left[0];
  r.cos_v = left[1];
  const auto spectrum = [&] {
    PowerOverTime out;
    for (const std::vector<double> &x : left)
      add_power_over_time(
          r.time, r.sample_period_s, [&](std::size_t i) { return x[i]; }, out);
    return out;
  };
  PowerOverTime before = spectrum();
  std::erase_if(lines, [&](const auto &found) {
    const double frequency = found.first;
    const Line line = line_at(r, frequency);
    const bool turning = rotates(line) || is_of_the_turning_pair(r, frequency, line);
    for (std::size_t i = 0; i < left[0].size(); ++i) {
      double s, c;
      sincos(kTwoPi * frequency * r.time[i], &s, &c);
      for (std::size_t k : {0, 1})
        left[k][i] -= line.amplitudes[2 * k] * s + line.amplitudes[2 * k + 1] * c;
    }
    PowerOverTime after = spectrum();
    const auto strongest = [&](const PowerOverTime &of) {
      const auto at = [&](double hz) {
        return of.power.begin() + std::min(static_cast<std::ptrdiff_t>(of.power.size()),
                                           static_cast<std::ptrdiff_t>(hz / of.bin_hz));
      };
      const auto first = at(frequency / kBeside), end = at(frequency * kBeside);
      return first < end ? *std::max_element(first, end) : 0.0F;
    };
    const bool many = strongest(before) < kOut * strongest(after);
    before = std::move(after);
    return many || turning;
  });
}

/// Where the mean changes most between a short stretch before and one after, all in one sense of
/// rotation: what depends on speed or sense changes there too and is no step. 0: nowhere clearly.
std::size_t sudden_step(const Residual &r, const std::vector<double> &a,
                        const std::vector<double> &b) {
  // A round at least, so that what repeats with the angle cancels.
  const std::size_t n = r.time.size();
  const auto reach = static_cast<std::size_t>(static_cast<double>(n) /
                                              std::clamp(rounds_of(r), kFewestRounds, 25.0));
  std::vector<std::size_t> turned(n + 1, 0); // changes of sense so far
  for (std::size_t i = 1; i < n; ++i)
    turned[i + 1] = turned[i] + (r.sense[i] != r.sense[i - 1]);
  double best = 0.0;
  std::size_t at = 0;
  std::vector<double> sizes;
  for (std::size_t k = reach; k + reach <= n; ++k) {
    const auto change = [&](const std::vector<double> &sum) {
      return (sum[k + reach] - 2.0 * sum[k] + sum[k - reach]) / static_cast<double>(reach);
    };
    const double size = std::hypot(change(a), change(b));
    sizes.push_back(size);
    if (size > best && turned[k + reach] == turned[k - reach + 1]) {
      best = size;
      at = k;
    }
  }
  return best > 6.0 * quantile(std::move(sizes), 0.5) ? at : 0;
}

/// The split with the largest sum of squares between the means of both parts. 0: none.
std::size_t largest_split(const std::vector<double> &a, const std::vector<double> &b) {
  const std::size_t n = a.size() - 1, margin = std::max<std::size_t>(20, n / 200);
  double best = 0.0;
  std::size_t at = 0;
  for (std::size_t k = margin; k + margin <= n; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(n);
    const double da = a[k] - share * a[n], db = b[k] - share * b[n];
    const double gain = (da * da + db * db) / (share * (1.0 - share));
    if (gain > best) {
      best = gain;
      at = k;
    }
  }
  return at;
}

} // namespace

std::vector<StepGuess> find_steps(const Residual &r, StepIn where) {
  const std::size_t n = r.time.size();
  constexpr std::size_t kFewest = 40; // twice the margin of a split
  if (n < kFewest)
    return {};
  std::vector<double> of_a(n), of_b(n);
  for (std::size_t i = 0; i < n; ++i) {
    of_a[i] = where == StepIn::angle ? angle_residual(r, i) : r.sin_v[i];
    of_b[i] = where == StepIn::angle ? 0.0 : r.cos_v[i];
  }
  constexpr std::size_t kMostEdges = 2;
  std::vector<StepGuess> out;
  const double rounds = rounds_of(r);
  const std::size_t reach = reach_of_edges(n, rounds, r.periods);
  if (rounds < criteria::kFewestUnits)
    for (const Edge &edge : find_edges(r.time, of_a, of_b, r.sense, reach, kMostEdges))
      out.push_back({r.time[edge.at], edge.first, edge.second});
  // Of rows so far apart that no edge shows, the means of two parts may still tell, where the
  // motion is not the pair's own.
  if (rounds < kFewestRounds && !(r.has_reference && reach == kFewestOfEdge))
    return out;
  // Running sums of both components.
  std::vector<double> a(n + 1, 0.0), b(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    a[i + 1] = a[i] + of_a[i];
    b[i + 1] = b[i] + of_b[i];
  }
  const std::size_t sudden = rounds < kFewestRounds ? 0 : sudden_step(r, a, b);
  for (std::size_t at : {sudden, largest_split(a, b)}) {
    if (at == 0)
      continue;
    const double left = static_cast<double>(at), right = static_cast<double>(n - at);
    out.push_back(
        {r.time[at], (a[n] - a[at]) / right - a[at] / left, (b[n] - b[at]) / right - b[at] / left});
  }
  return out;
}

std::vector<std::vector<double>> find_tones(const Residual &residual) {
  if (residual.time.size() < kFewestForTones)
    return {};
  Rounded rounded(residual);
  const Residual &r = rounded.view;
  const double span = r.time.back() - r.time.front();
  const double round = comes_round(r), back = comes_back(r);
  const bool few = too_few_rounds_for_lines(r);
  // Of a long record in few rounds, tones of up to so many half periods in all: there is one line
  // to look for, and many spectra to do it.
  constexpr double kMostHalfPeriods = 131072.0;
  if (few)
    rounded.view.sample_period_s = std::max(r.sample_period_s, span / kMostHalfPeriods);
  std::optional<MostlyAt> most;
  std::optional<AlongRadius> along;
  std::vector<std::vector<double>> tones;
  const auto no_tone = [&](double frequency, const Line &line) {
    if (!most)
      most = mostly_at(r);
    const auto of_round = static_cast<int>(round > 0.0 ? std::round(frequency / round) : 0.0);
    const int of_speed = order_near(r, frequency, 1.0 / span);
    const bool near_round =
        of_round >= 1 && std::abs(frequency - of_round * round) < kOrderWidth / span;
    const bool at_round = near_round && !told_from_order(r, of_round, frequency);
    const bool at_speed = turns_with_shaft(r, of_speed, line) ||
                          (of_speed != 0 && !(near_round && of_speed == of_round) &&
                           !told_from_order(r, of_speed, frequency));
    if (((at_round || at_speed) &&
         may_be_of_the_angle(r, *most, near_round || !at_speed ? of_round : of_speed, frequency,
                             line, few)) ||
        of_way_there_and_back(r, back, frequency) || !swings_within_stretches(r, frequency))
      return true;
    // Near the pair's own frequency a gain, an angle or a mismatch that changes slowly is a line as
    // well, and of a shaft that turns on never one of a single channel without a fellow.
    const bool slow = slow_beside_pair(r, frequency);
    if (slow && (few || goes_to_and_fro(r)))
      return true;
    if (!along)
      along.emplace(r);
    if (along->is_most())
      return along->is_gain(frequency, slow);
    const bool turns = rotates_with_pair(r, *most, frequency, line),
               fellow = (turns || slow) && has_fellow(r, *most, frequency);
    return (slow && (turns || fellow)) ||
           (turns && (fellow || one_sided(r, *most, frequency)) && along->is_gain(frequency, slow));
  };
  double fastest = 0.0;
  if (few)
    for (double w : r.omega)
      fastest = std::max(fastest, std::abs(w) / kTwoPi);
  const double above_hz = fastest * highest_named(r);
  auto lines = strongest_lines(r, above_hz, no_tone);
  if (few)
    keep_single_lines(r, lines);
  for (const auto &[frequency, line] : lines) {
    const auto a = line_at(residual, frequency).amplitudes;
    tones.push_back({frequency, std::hypot(a[0], a[1]), std::hypot(a[2], a[3]),
                     std::atan2(a[1], a[0]) * kDegPerRad, std::atan2(a[3], a[2]) * kDegPerRad});
  }
  return tones;
}

std::vector<double> find_modulations(const Residual &r) {
  if (too_few_rounds_for_lines(r))
    return {};
  std::vector<double> along(r.time.size()), across(r.time.size());
  for_each_sincos(
      r.time.size(), [&](std::size_t i) { return r.periods * r.alpha[i]; },
      [&](std::size_t i, double s, double c) {
        along[i] = r.cos_v[i] * c + r.sin_v[i] * s;
        across[i] = r.sin_v[i] * c - r.cos_v[i] * s;
      });
  Residual turned = r;
  turned.cos_v = along;
  turned.sin_v = across;
  std::vector<double> out;
  for (const auto &line : strongest_lines(turned, 0.0, [](double, const Line &) { return false; }))
    out.push_back(line.first);
  return out;
}

std::vector<std::vector<double>> find_clipping(const Residual &r) {
  // Of a sine that stops at 90 to 97 % of its peak about a tenth lies on the stop: the level is
  // seen at its middle. The channel with the higher peak says it for both.
  const auto quantiles = [&](double at) {
    return std::array<double, 2>{
        quantile(std::vector(r.read_sin_v.begin(), r.read_sin_v.end()), at),
        quantile(std::vector(r.read_cos_v.begin(), r.read_cos_v.end()), at)};
  };
  const std::array low = quantiles(0.04), high = quantiles(0.96);
  std::vector<std::vector<double>> out;
  const auto add = [&](double bottom, double top, double channel) {
    out.push_back({kAbsentLevel, top, channel});
    out.push_back({bottom, kAbsentLevel, channel});
    out.push_back({bottom, top, channel});
  };
  add(std::min(low[0], low[1]), std::max(high[0], high[1]), kAbsentLevel);
  for (int k : {0, 1})
    add(low[static_cast<std::size_t>(k)], high[static_cast<std::size_t>(k)], k);
  return out;
}

void find_spikes(std::span<const double> residual, double threshold, double floor_v,
                 std::vector<std::size_t> &places) {
  places = standing_out(residual, threshold, floor_v);
}

double slowest_speed(const Residual &r) {
  return r.slowest.get(
      [&] { return r.has_reference ? 0.0 : slowest_of_range(as_doubles(r.omega)); });
}

} // namespace ada
