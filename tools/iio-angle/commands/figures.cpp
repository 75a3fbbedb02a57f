// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cstdint>
#include <memory>
#include <vector>

#include "common/file_roles.h"
#include "common/handles.h"
#include "common/known_names.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/verb.h"

namespace cli {

namespace {

struct FiguresOptions {
  std::vector<std::string> names;
  std::string directory = ".";
  std::uint64_t seed = 1;
};

int run(const FiguresOptions &options) {
  const std::vector<std::string> names = options.names.empty() ? figure_names() : options.names;
  FileRoles().writes(options.directory + "/" + names.front() + ".csv");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string &name = names[i];
    {
      Busy busy(fmt::format("figure {} of {}: {}", i + 1, names.size(), name));
      check_usage(ada4571_figure_write(name.c_str(), options.seed, options.directory.c_str()));
    }
    print("{}/{}.csv\n", options.directory, name);
  }
  return kDone;
}

} // namespace

void add_figures(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("figures", "the application note's figures, from the simulation");
  auto options = std::make_shared<FiguresOptions>();
  std::string names;
  for (const std::string &name : figure_names())
    names += (names.empty() ? "" : ", ") + name;
  verb->add_option("NAME", options->names, names + " (default: all)")
      ->transform(one_of(figure_names(), "figure").description(""));
  verb->add_option("-o,--output", options->directory, "folder to write to")
      ->capture_default_str()
      ->check(CLI::ExistingDirectory)
      ->type_name("DIRECTORY");
  verb->add_option("--seed", options->seed, "seed of everything random")
      ->capture_default_str()
      ->transform(whole(0))
      ->type_name("N");
  example(*verb, "  iio-angle figures mismatch -o /tmp");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
