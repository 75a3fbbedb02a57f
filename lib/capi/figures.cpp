// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/figures.h"
#include "capi/guard.h"

using namespace ada;
using namespace ada::capi;

extern "C" {

ada4571_status ada4571_figure_write(const char *name, uint64_t seed, const char *directory) {
  return guard([&] {
    require(name, "name");
    require(directory, "directory");
    write_figure(name, seed, directory);
  });
}

const char *ada4571_figure_name(size_t index) {
  const auto names = figure_names();
  return index < names.size() ? names[index].data() : nullptr; // literals, so they end with zero
}

} // extern "C"
