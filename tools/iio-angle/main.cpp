// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// iio-angle: the verb table and the dispatch. Each verb is a file in commands/.
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "common/complete.h"
#include "common/file_roles.h"
#include "common/handles.h"
#include "common/help_text.h"
#include "common/print.h"
#include "common/usage.h"
#include "common/verb.h"

namespace {

constexpr void (*kVerbs[])(CLI::App &, cli::Action &) = {
    cli::add_list,      cli::add_record,  cli::add_read,      cli::add_watch,
    cli::add_calibrate, cli::add_convert, cli::add_import,    cli::add_simulate,
    cli::add_emulate,   cli::add_diagnose, cli::add_check,    cli::add_pins,
    cli::add_catalogue, cli::add_figures, cli::add_study,     cli::add_definitions};

void describe(CLI::App &app) {
  app.require_subcommand(1);
  app.formatter(std::make_shared<cli::HelpText>());
  app.get_formatter()->column_width(34);
  app.set_version_flag("-V,--version", std::string("iio-angle ") + ada4571_version());
  app.footer("A first angle, without hardware:\n"
             "  iio-angle simulate --seed 1 -o capture.csv\n"
             "  iio-angle calibrate single capture.csv -o sensor.toml\n"
             "  iio-angle convert --calibration sensor.toml capture.csv -o angles.csv\n"
             "With hardware: iio-angle list, then record, calibrate single, and read.\n"
             "`iio-angle help VERB` shows the options of a verb and an example; the manual page\n"
             "iio-angle-VERB says more.\n"
             "Exit status: 0 done, 1 the data or the device is unusable, 2 wrong usage.");
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
  CLI::App app{"Angles from analog sine/cosine angle sensors (ADA4571 and its kind)", "iio-angle"};
  cli::Action action;
  describe(app);
  for (const auto &add : kVerbs)
    add(app, action);
  if (cli::complete(app, argc, argv))
    return cli::kDone;
  refuse_empty_words(argc, argv);
  std::vector<std::string> words = cli::words_of(app, argc, argv);
  int status = cli::kDone;
  try {
    app.parse(words);
    status = action();
  } catch (const CLI::Success &e) {
    app.exit(e); // help or version, to standard output
  } catch (const CLI::ParseError &e) {
    cli::keep_remarks_out_of({argv + 1, argv + argc});
    throw cli::Failure(cli::kWrongUsage, cli::usage_error(app, e));
  }
  cli::flush_output();
  return status;
}

} // namespace

int main(int argc, char **argv) {
  try {
    return run(argc, argv);
  } catch (const cli::Failure &e) {
    cli::note("iio-angle: {}\n", e.what());
    return e.exit_status();
  } catch (const std::exception &e) {
    cli::note("iio-angle: {}\n", e.what());
    return cli::kUnusable;
  }
}
