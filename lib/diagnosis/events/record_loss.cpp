// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Lost samples: made in a simulated capture.

#include <algorithm>

#include "model/residual.h"

namespace ada {

void drop_rows(std::size_t events, std::size_t samples, Rng &rng, Capture &capture) {
  const std::size_t n = capture.size();
  events = std::min(events, samples);
  if (events == 0 || n < 2 * (samples + events))
    return;
  // Shares of the loss and places of the events; one row at least stays between two events.
  std::vector<std::size_t> share(events, samples / events);
  share.back() += samples % events;
  std::vector<char> keep(n, 1);
  const std::size_t room = n / events;
  for (std::size_t k = 0; k < events; ++k) {
    std::uniform_int_distribution<std::size_t> place(1, room - share[k] - 1);
    const std::size_t first = k * room + place(rng);
    std::fill_n(keep.begin() + static_cast<std::ptrdiff_t>(first), share[k], char{0});
  }
  std::size_t left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!keep[i])
      continue;
    // Time is left alone: the clock of the record runs on unbroken.
    for (auto *column : {&capture.vsin_v, &capture.vcos_v, &capture.vtemp_v, &capture.vdd_v,
                         &capture.reference_deg})
      if (!column->empty())
        (*column)[left] = (*column)[i];
    ++left;
  }
  for (auto *column : {&capture.time_s, &capture.vsin_v, &capture.vcos_v, &capture.vtemp_v,
                       &capture.vdd_v, &capture.reference_deg})
    if (!column->empty())
      column->resize(left);
}

} // namespace ada
