// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/stop_means.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/holdout.h"
#include "diagnosis/criteria.h"
#include "motion/kinematics.h"

namespace ada {

namespace {

/// RowsOfStop from one on, up to another.
struct RowsOfStop {
  std::size_t begin, end;
};

/// The rows of each stop. Those between two stops are of none: one or two, where most rows lie in
/// stops of far more.
std::vector<RowsOfStop> stops_of(const Capture &c) {
  constexpr std::size_t kFarFewer = 4;
  std::vector<double> alpha;
  for (double deg : c.reference_deg) {
    if (!std::isfinite(deg))
      return {};
    alpha.push_back(deg * kRadPerDeg);
  }
  unwrap(alpha, kTwoPi);
  const Stops stops = find_stops(c, alpha);
  if (!stops)
    return {};
  std::vector<RowsOfStop> out;
  for (std::size_t i = 0; i < stops.of.size(); ++i)
    if (i == 0 || stops.of[i] != stops.of[i - 1])
      out.push_back({i, i + 1});
    else
      out.back().end = i + 1;
  std::vector<std::size_t> lengths; // of the stop of each row
  for (const RowsOfStop &rows : out)
    lengths.insert(lengths.end(), rows.end - rows.begin, rows.end - rows.begin);
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::ranges::nth_element(lengths, middle);
  std::erase_if(out, [usual = *middle](const RowsOfStop &rows) {
    const std::size_t readings = rows.end - rows.begin;
    return static_cast<double>(readings) < criteria::kFewestReadings &&
           kFarFewer * readings < usual;
  });
  return out;
}

double mean(const std::vector<double> &v, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i)
    sum += v[i];
  return sum / static_cast<double>(end - begin);
}

/// Of angles, degrees.
double mean_deg(const std::vector<double> &v, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i)
    sum += wrap_centred(v[i] - v[begin], 360.0);
  return v[begin] + sum / static_cast<double>(end - begin);
}

/// What is left of the means of a channel beside the offsets, the pair, what modulates it by the
/// lowest orders of the turn, and what goes with the sense of the way to a stop.
Eigen::MatrixXd beside_smooth(const Capture &means) {
  constexpr int kMostOrders = 3;
  const int p = means.meta.periods_per_turn;
  const auto n = static_cast<Eigen::Index>(means.size());
  std::set<int> orders{p};
  for (int order = 1; order <= kMostOrders; ++order) {
    std::set<int> more = orders;
    more.insert({order, p + order, std::abs(p - order)});
    more.erase(0);
    // As many stops as numbers are left to see what those leave.
    if (static_cast<std::size_t>(n) < 2 * (3 + 2 * more.size()))
      break;
    orders = std::move(more);
  }
  const auto columns = static_cast<Eigen::Index>(3 + 2 * orders.size());
  if (n < columns + static_cast<Eigen::Index>(criteria::kFewestStops))
    return {};
  Eigen::MatrixXd x(n, columns), pair(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double alpha = means.reference_deg[static_cast<std::size_t>(i)] * kRadPerDeg;
    const double way_deg =
        i == 0 ? 0.0
               : wrap_centred(means.reference_deg[static_cast<std::size_t>(i)] -
                                  means.reference_deg[static_cast<std::size_t>(i - 1)],
                              360.0);
    const double sense = way_deg < 0.0 ? -1.0 : 1.0;
    Eigen::Index k = 0;
    x(i, k++) = 1.0;
    x(i, k++) = sense * std::cos(p * alpha);
    x(i, k++) = sense * std::sin(p * alpha);
    for (int m : orders) {
      x(i, k++) = std::cos(m * alpha);
      x(i, k++) = std::sin(m * alpha);
    }
    pair.row(i) << means.vsin_v[static_cast<std::size_t>(i)],
        means.vcos_v[static_cast<std::size_t>(i)];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(x);
  // The fit takes as many numbers from the scatter as it has.
  return (pair - x * qr.solve(pair)) *
         std::sqrt(static_cast<double>(n) / static_cast<double>(n - qr.rank()));
}

/// Second differences of what belongs to neighbouring stops: nothing of what goes slowly is in
/// them.
Eigen::MatrixXd differences(const Eigen::MatrixXd &x) {
  const Eigen::Index n = x.rows() - 2;
  return x.topRows(n) - 2.0 * x.middleRows(1, n) + x.bottomRows(n);
}

/// Highest order of the turn that places tell: in about even steps none above half of their number.
/// An order of as many waves as stops goes with how far the reference says they are off their grid.
int highest_order(const Capture &means) {
  constexpr int kHighest = 128;
  constexpr double kFew = 0.1, kEven = 0.25; // of the steps; of their median
  std::vector<double> steps_deg;
  for (std::size_t i = 1; i < means.size(); ++i)
    steps_deg.push_back(
        std::abs(wrap_centred(means.reference_deg[i] - means.reference_deg[i - 1], 360.0)));
  const double usual = quantile(steps_deg, 0.5);
  const bool even = quantile(steps_deg, kFew) > (1.0 - kEven) * usual &&
                    quantile(steps_deg, 1.0 - kFew) < (1.0 + kEven) * usual;
  return even ? std::min(kHighest, static_cast<int>(0.5 * 360.0 / usual)) : kHighest;
}

/// Whether one order of the turn, that of a worm or of a magnet, is most of what stops differ by:
/// that comes again at other places, and has names.
bool is_an_order(const Capture &means, const Eigen::MatrixXd &left) {
  // Three differences in a row have one stop in common: that many are one witness, of two channels.
  constexpr double kMostOfIt = 0.5, kChance = 1e-3, kTogether = 3.0;
  const auto n = static_cast<Eigen::Index>(means.size());
  const int highest = highest_order(means);
  const double sin_v = mean(means.vsin_v, 0, means.size()),
               cos_v = mean(means.vcos_v, 0, means.size());
  const Eigen::MatrixXd d = differences(left);
  const double all = d.squaredNorm();
  double most = 0.0;
  for (int order = 1; order <= highest; ++order) {
    Eigen::MatrixXd of_sin(n, 2), of_cos(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double alpha = means.reference_deg[at] * kRadPerDeg;
      const Eigen::RowVector2d turn(std::cos(order * alpha), std::sin(order * alpha));
      of_sin.row(i) = (means.vcos_v[at] - cos_v) * turn;
      of_cos.row(i) = -(means.vsin_v[at] - sin_v) * turn;
    }
    of_sin = differences(of_sin);
    of_cos = differences(of_cos);
    const Eigen::Matrix2d normal = of_sin.transpose() * of_sin + of_cos.transpose() * of_cos;
    const Eigen::Vector2d by = of_sin.transpose() * d.col(0) + of_cos.transpose() * d.col(1);
    most = std::max(most, by.dot(normal.completeOrthogonalDecomposition().solve(by)));
  }
  const double share = std::min(1.0, most / std::max(all, 1e-300));
  return share > kMostOfIt &&
         highest * std::pow(1.0 - share, static_cast<double>(n - 3) / kTogether) < kChance;
}

/// The line of an axis, whatever it has.
BudgetLine &line_of(std::vector<BudgetLine> &budget, Axis axis) {
  const auto at = std::find_if(budget.begin(), budget.end(),
                               [&](const BudgetLine &line) { return line.axis == axis; });
  return at != budget.end() ? *at : budget.emplace_back(BudgetLine{.axis = axis});
}

} // namespace

std::optional<StopMeans> means_of_stops(const Capture &capture) {
  // Of a random walk neighbouring stops see four times what the halves of a stop do; standard
  // deviations of the logarithm of a ratio of medians, of two channels.
  constexpr double kOfWalk = 4.0, kClear = 4.0;
  if (!capture.has_reference() || capture.starts.size() > 1)
    return {};
  const std::vector<RowsOfStop> stops = stops_of(capture);
  if (stops.size() < criteria::kFewestStops)
    return {};
  StopMeans out;
  out.means.meta = capture.meta;
  out.means.meta.at_rest = true;
  for (auto *of_readings : {&out.means.meta.noise_rms_v, &out.means.meta.sample_rate_hz})
    of_readings->reset();
  out.means.identity = capture.identity;
  out.means.data_file = capture.data_file;
  std::vector<double> halves_v2;
  std::size_t readings = 0;
  for (const auto [begin, end] : stops) {
    const std::size_t middle = begin + (end - begin) / 2;
    readings += end - begin;
    for (auto column :
         {&Capture::time_s, &Capture::vsin_v, &Capture::vcos_v, &Capture::vtemp_v, &Capture::vdd_v})
      if (!(capture.*column).empty())
        (out.means.*column).push_back(mean(capture.*column, begin, end));
    out.means.reference_deg.push_back(mean_deg(capture.reference_deg, begin, end));
    if (middle > begin) {
      double v2 = 0.0;
      for (const auto *v : {&capture.vsin_v, &capture.vcos_v})
        v2 += 0.25 * std::pow(mean(*v, begin, middle) - mean(*v, middle, end), 2);
      halves_v2.push_back(v2);
    }
  }
  const Eigen::MatrixXd left = beside_smooth(out.means);
  if (left.size() == 0 || halves_v2.size() < criteria::kFewestStops)
    return {};
  std::vector<double> steps_v2;
  double squares = 0.0;
  for (Eigen::Index k = 1; k + 1 < left.rows(); ++k) { // second differences: 1, 4 and 1 of noise
    steps_v2.push_back((left.row(k - 1) - 2.0 * left.row(k) + left.row(k + 1)).squaredNorm() / 6.0);
    squares += steps_v2.back();
  }
  const double told = static_cast<double>(steps_v2.size());
  const double noise_v2 = quantile(std::move(halves_v2), 0.5);
  if (!(std::log(quantile(std::move(steps_v2), 0.5) / std::max(kOfWalk * noise_v2, 1e-300)) >
        kClear * std::sqrt(4.0 / told)))
    return {};
  if (is_an_order(out.means, left))
    return {};
  constexpr double kRounds = 1.5; // times what even rounding does
  const double differ_v = std::sqrt(std::max(0.0, 0.5 * (squares / told - noise_v2)));
  const double step_v = std::max(converter_step(capture.vsin_v), converter_step(capture.vcos_v));
  out.errs_v = differ_v > kRounds * step_v / std::sqrt(12.0) ? differ_v : 0.0;
  out.reading_noise_v = std::sqrt(0.5 * noise_v2 * static_cast<double>(readings) /
                                  static_cast<double>(out.means.size()));
  return out;
}

double left_at_stops(const StopMeans &stops, double residual_v) {
  const double left_v2 = residual_v * residual_v - std::pow(stops.reading_noise_v, 2),
               errs_v2 = stops.errs_v * stops.errs_v;
  return left_v2 > criteria::kLittle * errs_v2 ? std::sqrt(std::min(left_v2, errs_v2)) : 0.0;
}

Diagnosis with_stops(const StopMeans &stops, double left_v, Diagnosis out) {
  if (left_v == 0.0 || out.verdict == Verdict::insufficient_data)
    return out;
  if (out.verdict == Verdict::no_discrepancy)
    out.verdict = Verdict::unexplained;
  else if (out.verdict == Verdict::explained)
    out.verdict = Verdict::partly_explained;
  BudgetLine &noise = line_of(out.budget, Axis::noise);
  const double moved_v = std::min(left_v, noise.rms_v);
  noise.rms_v = noise.unnamed_rms_v =
      std::max(stops.reading_noise_v, std::sqrt(noise.rms_v * noise.rms_v - moved_v * moved_v));
  BudgetLine &angle = line_of(out.budget, Axis::angle);
  // Of means the curve weighs by its own scatter, and the noise is that of the length alone: what
  // the stops err by is not in it. Of all readings it is, and nothing counts twice.
  const double along_v = out.readings_a_stop > 1.0 ? left_v : moved_v;
  angle.rms_v = std::hypot(angle.rms_v, along_v);
  angle.unnamed_rms_v = std::hypot(angle.unnamed_rms_v, along_v);
  std::stable_sort(out.budget.begin(), out.budget.end(),
                   [](const BudgetLine &a, const BudgetLine &b) { return a.rms_v > b.rms_v; });
  out.structure.push_back(
      {std::string(axis_name(Axis::angle)),
       fmt::format("{:.3g} mV rms are the same in all readings of a stop and change from stop to "
                   "stop: the table does not stand where it says, or the sensor errs there; the "
                   "same stops once more tell whether it comes again, and the table turned on the "
                   "shaft whose it is",
                   1e3 * left_v),
       left_v});
  std::stable_sort(out.structure.begin(), out.structure.end(),
                   [](const Structure &a, const Structure &b) { return a.rms_v > b.rms_v; });
  return out;
}

} // namespace ada
