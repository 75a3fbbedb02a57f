// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The strip charts of `watch`: angle and radius over the last seconds.
#pragma once

#include "common/dots.h"
#include "common/screen.h"
#include "common/watch_history.h"

namespace cli {

struct Place {
  int row, column, rows, columns;
};

/// The angle is counted from `zero_deg`. Each axis covers what there is; the angle's has the whole
/// range where the shaft turns.
void draw_charts(Screen &screen, const WatchHistory &history, double zero_deg, const Place &place);

} // namespace cli
