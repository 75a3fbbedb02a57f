// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The live picture of `watch`: a dial with the shaft's angle, strip charts of angle and radius, and
// the numbers of the moment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/screen.h"
#include "common/watch_history.h"

namespace cli {

/// What the picture needs besides the angles.
struct WatchState {
  std::string title;
  int periods_per_turn = 2;
  double supply_v = 5.0;
  std::uint64_t lost = 0;
  bool away = false, held = false, ended = false;
  std::optional<double> zero_deg; ///< that angles are counted from
  std::string remark;
};

inline constexpr int kLeastRows = 14, kLeastColumns = 80;

void draw_watch(Screen &screen, const WatchHistory &history, const WatchState &state);

} // namespace cli
