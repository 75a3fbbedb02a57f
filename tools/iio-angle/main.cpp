// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// iio-angle: the verb table and the dispatch. Each verb is a file in commands/.
#include <algorithm>
#include <exception>
#include <string_view>

#include <fmt/format.h>

#include "common/handles.h"
#include "common/print.h"
#include "common/verb.h"

namespace {

constexpr void (*kVerbs[])(CLI::App &, cli::Action &) = {
    cli::add_list,      cli::add_record,  cli::add_read,      cli::add_watch,
    cli::add_calibrate, cli::add_convert, cli::add_import,    cli::add_simulate,
    cli::add_emulate,   cli::add_diagnose, cli::add_check,    cli::add_pins,
    cli::add_catalogue, cli::add_figures, cli::add_study,     cli::add_definitions};

void describe(CLI::App &app) {
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.set_version_flag("--version", std::string("iio-angle ") + ada4571_version());
  app.footer("A first angle, without hardware:\n"
             "  iio-angle simulate --seed 1 -o capture.csv\n"
             "  iio-angle calibrate single capture.csv -o sensor.toml\n"
             "  iio-angle convert --calibration sensor.toml capture.csv -o angles.csv\n"
             "With hardware: iio-angle list, then record, calibrate single, and read.\n"
             "`iio-angle VERB --help` shows the options of a verb and an example.\n"
             "Exit status: 0 done, 1 the data or the device is unusable, 2 wrong usage.");
}

/// The first word of the command line when it is no verb; CLI11 would only say that one is missing.
const char *unknown_verb(const CLI::App &app, int argc, char **argv) {
  if (argc < 2 || argv[1][0] == '-')
    return nullptr;
  const auto verbs = app.get_subcommands([](const CLI::App *) { return true; });
  const bool known = std::any_of(verbs.begin(), verbs.end(), [argv](const CLI::App *verb) {
    return verb->get_name() == argv[1];
  });
  return known ? nullptr : argv[1];
}

/// An empty word is a shell's variable that was not set: passed over, it would lose what was asked
/// for.
void refuse_empty_words(int argc, char **argv) {
  for (int i = 1; i < argc; ++i)
    if (const std::string_view word = argv[i];
        word.empty() || (word.starts_with("--") && word.ends_with('=')))
      throw cli::Failure(cli::kWrongUsage,
                         fmt::format("nothing is given {} '{}'", word.empty() ? "after" : "by",
                                     word.empty() ? argv[i - 1] : argv[i]));
}

int run(int argc, char **argv) {
  cli::open_standard_descriptors();
  refuse_empty_words(argc, argv);
  CLI::App app{"Angles from analog sine/cosine angle sensors (ADA4571 and its kind)", "iio-angle"};
  cli::Action action;
  describe(app);
  for (const auto &add : kVerbs)
    add(app, action);
  if (const char *word = unknown_verb(app, argc, argv))
    throw cli::Failure(cli::kWrongUsage,
                       fmt::format("there is no verb '{}'; `iio-angle --help` lists them", word));
  int status = cli::kDone;
  try {
    app.parse(argc, argv);
    status = action();
  } catch (const CLI::ParseError &e) {
    // CLI11 prints help and version to standard output and mistakes to standard error.
    status = app.exit(e) == 0 ? cli::kDone : cli::kWrongUsage;
  }
  cli::flush_output();
  return status;
}

} // namespace

int main(int argc, char **argv) {
  try {
    return run(argc, argv);
  } catch (const cli::ClosedPipe &) {
    return cli::end_by_closed_pipe();
  } catch (const cli::Failure &e) {
    cli::note("iio-angle: {}\n", e.what());
    return e.exit_status();
  } catch (const std::exception &e) {
    cli::note("iio-angle: {}\n", e.what());
    return cli::kUnusable;
  }
}
