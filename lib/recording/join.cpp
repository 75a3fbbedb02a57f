// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/join.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "base/frame.h"
#include "base/robust.h"

namespace ada {

namespace {

/// Sample periods between two captures: far more than any gap that a loss of samples leaves.
constexpr double kApart = 1000.0;

struct JoinedColumn {
  std::vector<double> Capture::*values;
  const char *name;
};
constexpr std::array<JoinedColumn, 5> kJoined{{{&Capture::vsin_v, "vsin_v"},
                                               {&Capture::vcos_v, "vcos_v"},
                                               {&Capture::vtemp_v, "vtemp_v"},
                                               {&Capture::vdd_v, "vdd_v"},
                                               {&Capture::reference_deg, "reference_deg"}}};

void require_alike(const Capture &first, const Capture &other, std::size_t number) {
  const auto refuse = [&](const std::string &what) {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                fmt::format("capture {} does not go with the first one: {}", number + 1, what));
  };
  if (other.meta.periods_per_turn != first.meta.periods_per_turn)
    refuse(fmt::format("it has {} periods per turn, not {}", other.meta.periods_per_turn,
                       first.meta.periods_per_turn));
  if (other.meta.supply_v != first.meta.supply_v)
    refuse(fmt::format("its supply is {} V, not {} V", other.meta.supply_v, first.meta.supply_v));
  if (other.meta.gain_control && first.meta.gain_control &&
      *other.meta.gain_control != *first.meta.gain_control)
    refuse("its gain control differs");
  for (const JoinedColumn &c : kJoined)
    if ((other.*c.values).empty() != (first.*c.values).empty())
      refuse(fmt::format("{} the column {}",
                         (other.*c.values).empty() ? "it has not" : "it alone has", c.name));
}

double usual_step(const Capture &c) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < c.size(); ++i)
    steps.push_back(c.time_s[i] - c.time_s[i - 1]);
  return steps.empty() ? 1e-3 : quantile(std::move(steps), 0.5);
}

} // namespace

std::shared_ptr<const Capture> join(std::span<const std::shared_ptr<const Capture>> captures) {
  if (captures.empty())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "no capture is given");
  if (captures.size() == 1)
    return captures.front();
  auto out = std::make_shared<Capture>();
  out->meta = captures.front()->meta;
  for (std::size_t k = 0; k < captures.size(); ++k) {
    const Capture &c = *captures[k];
    require_alike(*captures.front(), c, k);
    if (c.size() == 0)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, fmt::format("capture {} is empty", k + 1));
    const std::size_t start = out->size();
    out->starts.push_back(start);
    const double move = k == 0 ? 0.0 : out->time_s.back() + kApart * usual_step(c) - c.time_s.front();
    for (double t : c.time_s)
      out->time_s.push_back(t + move);
    for (const JoinedColumn &column : kJoined)
      (*out.*column.values)
          .insert((*out.*column.values).end(), (c.*column.values).begin(), (c.*column.values).end());
    if (k > 0)
      out->gaps.push_back(start);
    for (std::size_t gap : c.gaps)
      out->gaps.push_back(start + gap);
    if (k > 0)
      out->turned_rad.push_back(kAbsent);
    out->turned_rad.insert(out->turned_rad.end(), c.turned_rad.begin(), c.turned_rad.end());
    out->turned_rad.resize(out->gaps.size(), kAbsent);
    out->identity += (k > 0 ? "+" : "") + c.identity;
    if (c.meta.serial != out->meta.serial)
      out->meta.serial.clear();
    if (c.meta.noise_rms_v && out->meta.noise_rms_v)
      out->meta.noise_rms_v = std::max(*c.meta.noise_rms_v, *out->meta.noise_rms_v);
  }
  return out;
}

Capture record_of(const Capture &joined, std::size_t k) {
  const std::size_t from = joined.starts[k];
  const std::size_t to = k + 1 < joined.starts.size() ? joined.starts[k + 1] : joined.size();
  const auto cut = [&](const std::vector<double> &v) {
    return v.empty() ? v
                     : std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(from),
                                           v.begin() + static_cast<std::ptrdiff_t>(to));
  };
  Capture out;
  out.meta = joined.meta;
  out.time_s = cut(joined.time_s);
  for (const JoinedColumn &c : kJoined)
    out.*c.values = cut(joined.*c.values);
  for (std::size_t i = 0; i < joined.gaps.size(); ++i)
    if (joined.gaps[i] > from && joined.gaps[i] < to) {
      out.gaps.push_back(joined.gaps[i] - from);
      if (!joined.turned_rad.empty())
        out.turned_rad.push_back(joined.turned_rad[i]);
    }
  return out;
}

} // namespace ada
