// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cstdint>
#include <memory>
#include <vector>

#include "common/handles.h"
#include "common/print.h"
#include "common/verb.h"

namespace cli {

namespace {

struct Options {
  std::vector<std::string> names;
  std::string directory = ".";
  std::uint64_t seed = 1;
};

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  while (const char *name = ada4571_figure_name(names.size()))
    names.emplace_back(name);
  return names;
}

int run(const Options &options) {
  for (const std::string &name : options.names.empty() ? all_names() : options.names) {
    check_usage(ada4571_figure_write(name.c_str(), options.seed, options.directory.c_str()));
    print("{}/{}.csv\n", options.directory, name);
  }
  return kDone;
}

} // namespace

void add_figures(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("figures", "the application note's figures, from the simulation");
  auto options = std::make_shared<Options>();
  std::string names;
  for (const std::string &name : all_names())
    names += (names.empty() ? "" : ", ") + name;
  verb->add_option("NAME", options->names, names + " (default: all)");
  verb->add_option("-o,--output", options->directory, "folder to write to")
      ->capture_default_str()
      ->check(CLI::ExistingDirectory)
      ->type_name("DIRECTORY");
  verb->add_option("--seed", options->seed, "seed of everything random")
      ->capture_default_str()
      ->type_name("N");
  example(*verb, "  iio-angle figures mismatch -o /tmp");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
