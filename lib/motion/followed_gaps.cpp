// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "motion/followed_gaps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/angle.h"
#include "base/parallel.h"
#include "base/robust.h"

namespace ada {

namespace {

struct Point {
  double s, c;
};

/// Counts how often a path goes around the origin: it turns by the angle between its ends and by a
/// whole turn for each time that it crosses the half line at +-pi.
class Path {
public:
  void to(Point p) {
    if ((p.s < 0.0) != (at_.s < 0.0) && crosses(at_, p))
      turns_ += p.s < 0.0 ? 1 : -1;
    at_ = p;
  }
  void begin(Point p) {
    first_ = at_ = p;
    turns_ = 0;
  }
  /// The path of `next`, behind this one.
  void append(const Path &next) {
    to(next.first_);
    turns_ += next.turns_;
    at_ = next.at_;
  }
  double turned_rad() const {
    return static_cast<double>(turns_) * kTwoPi + std::atan2(at_.s, at_.c) -
           std::atan2(first_.s, first_.c);
  }

private:
  static bool crosses(Point a, Point b) { return (a.c * b.s - b.c * a.s) * (b.s - a.s) < 0.0; }

  Point first_{}, at_{};
  long turns_ = 0;
};

/// The part of one block that lies in one gap.
struct Part {
  std::size_t gap;
  Path path;
  bool any = false;
};

struct Parts {
  Block block;
  std::vector<Part> parts;
};

/// Far from the circle a sample does not say where the pair is.
bool believed(Point p) {
  const double r2 = p.s * p.s + p.c * p.c;
  return r2 > 0.25 && r2 < 4.0;
}

Part part_of(const Block &block, const RoughCircle &circle, const LeftOut &gap,
             std::size_t number) {
  Part out{number, {}};
  const std::size_t from = std::max(gap.before, block.first) - block.first;
  const std::size_t to = std::min(gap.after + 1, block.first + block.count) - block.first;
  for (std::size_t i = from; i < to; ++i) {
    const Point p{(block.vsin_v[i] - circle.middle_sin_v) / circle.half_sin_v,
                  (block.vcos_v[i] - circle.middle_cos_v) / circle.half_cos_v};
    if (!believed(p))
      continue;
    if (out.any)
      out.path.to(p);
    else
      out.path.begin(p);
    out.any = true;
  }
  return out;
}

} // namespace

RoughCircle::RoughCircle(const Capture &some) {
  const auto measure = [](const std::vector<double> &v, double &middle, double &half) {
    const Reach reach = bulk(v);
    middle = 0.5 * (reach.low + reach.high);
    half = std::max(0.5 * reach.width(), 1e-9);
  };
  measure(some.vsin_v, middle_sin_v, half_sin_v);
  measure(some.vcos_v, middle_cos_v, half_cos_v);
}

std::vector<double> turned_in(const Recording &recording, const RoughCircle &circle,
                              std::span<const LeftOut> left_out) {
  std::vector<std::optional<Path>> paths(left_out.size());
  in_order<Parts>(
      recording.blocks(),
      [&](std::size_t k, Parts &out) {
        out.parts.clear();
        const std::size_t begin = recording.block_begin(k), end = recording.block_begin(k + 1);
        auto gap = std::lower_bound(left_out.begin(), left_out.end(), begin,
                                    [](const LeftOut &g, std::size_t i) { return g.after < i; });
        if (gap == left_out.end() || gap->before >= end)
          return;
        recording.read(k, kPairColumns, out.block);
        for (; gap != left_out.end() && gap->before < end; ++gap)
          out.parts.push_back(
              part_of(out.block, circle, *gap, static_cast<std::size_t>(gap - left_out.begin())));
      },
      [&](std::size_t, const Parts &found) {
        for (const Part &part : found.parts) {
          std::optional<Path> &path = paths[part.gap];
          if (!part.any)
            continue;
          if (path)
            path->append(part.path);
          else
            path = part.path;
        }
      });
  std::vector<double> out;
  for (const std::optional<Path> &path : paths)
    out.push_back(path ? path->turned_rad() : 0.0);
  return out;
}

void follow_through_gaps(const Capture &capture, double period, std::span<double> angle) {
  double more = 0.0;
  for (std::size_t k = 0; k < capture.turned_rad.size(); ++k) {
    const std::size_t from = capture.gaps[k];
    const std::size_t to = k + 1 < capture.gaps.size() ? capture.gaps[k + 1] : angle.size();
    // What was added before is in the sample before, and not yet in this one.
    const double step = angle[from] - (angle[from - 1] - more);
    if (std::isfinite(capture.turned_rad[k]))
      more += period * std::round((capture.turned_rad[k] - step) / period);
    for (std::size_t i = from; i < to; ++i)
      angle[i] += more;
  }
}

} // namespace ada
