// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cmath>

#include <fmt/format.h>

#include "common/handles.h"
#include "common/print.h"
#include "common/verb.h"

namespace cli {

namespace {

int run() {
  for (std::size_t i = 0; i < ada4571_catalogue_count(); ++i) {
    auto effect = initialised(ada4571_effect_info_init);
    check(ada4571_catalogue_get(i, &effect));
    print("{}  ({})\n  {}\n", effect.id, effect.stage, effect.cause);
    for (std::size_t j = 0; j < effect.parameters; ++j) {
      auto p = initialised(ada4571_parameter_init);
      check(ada4571_catalogue_parameter(i, j, &p));
      const std::string fallback = std::isnan(p.value) ? "absent" : fmt::format("{:g}", p.value);
      print("    {:<16} {:<8} default {}\n", p.name, p.unit, fallback);
    }
  }
  return kDone;
}

} // namespace

void add_catalogue(CLI::App &app, Action &action) {
  auto *verb =
      app.add_subcommand("catalogue", "the effects that a model can hold, with their parameters");
  example(*verb, "  iio-angle catalogue | less");
  verb->callback([&action] { action = run; });
}

} // namespace cli
