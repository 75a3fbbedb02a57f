// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/spread_sample.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/parallel.h"

namespace ada {

namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): equally distributed for successive numbers.
std::uint64_t scattered(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

void append(Capture &out, const Block &block) {
  for (const Column &column : kColumns) {
    const auto from = block.*column.block;
    std::vector<double> &to = out.*column.values;
    to.insert(to.end(), from.begin(), from.end());
  }
}

/// One stretch, which may lie in several blocks.
struct Stretch {
  Block block;
  Capture samples;
};

void read_stretch(const Recording &recording, std::size_t first, std::size_t count, Stretch &out) {
  out.samples = {};
  while (count > 0) {
    const std::size_t k = recording.block_of(first);
    recording.read(k, first - recording.block_begin(k), count, kAllColumns, out.block);
    append(out.samples, out.block);
    first += out.block.count;
    count -= out.block.count;
  }
}

} // namespace

std::size_t sample_place(std::size_t size, std::size_t most, std::size_t stretch,
                         std::size_t place) {
  if (size <= most)
    return place;
  const std::size_t length = size / (most / stretch), part = place / stretch;
  return part * length + static_cast<std::size_t>(scattered(part) % (length - stretch + 1)) +
         place % stretch;
}

std::shared_ptr<const Capture> spread_sample(const Recording &recording, std::size_t most,
                                             std::size_t stretch, bool named) {
  const std::size_t size = recording.size();
  if (size <= most)
    return recording.whole();
  Capture out = recording.facts();
  out.gaps.clear();
  if (named)
    out.identity = recording.identity();
  in_order<Stretch>(
      most / stretch,
      [&](std::size_t part, Stretch &s) {
        read_stretch(recording, sample_place(size, most, stretch, part * stretch), stretch, s);
      },
      [&](std::size_t part, const Stretch &s) {
        if (part > 0)
          out.gaps.push_back(out.size());
        for (const Column &column : kColumns) {
          const std::vector<double> &from = s.samples.*column.values;
          std::vector<double> &to = out.*column.values;
          to.insert(to.end(), from.begin(), from.end());
        }
      });
  return std::make_shared<const Capture>(std::move(out));
}

} // namespace ada
