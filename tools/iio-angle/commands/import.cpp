// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "common/file_roles.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/verb.h"

namespace cli {

namespace {

constexpr double kMostRate_hz = 1e9; ///< of the library

using Import = std::unique_ptr<ada4571_import, Freed<ada4571_import_free>>;

/// One channel as the command line has it; a column that was not given is looked for.
struct Column {
  const char *name, *help;
  ada4571_import_column ada4571_import_options::*target;
  std::string column{};
};

struct ImportOptions {
  std::string input, output, separator, decimal, reference_unit, time_unit, serial;
  int header_lines = -1;
  double rate_hz = 0, supply_v = 5;
  int periods = 2;
  std::vector<std::string> scales, offsets;
  std::vector<Column> columns = {
      {"time", "column of the time", &ada4571_import_options::time},
      {"sin", "column of VSIN", &ada4571_import_options::vsin},
      {"cos", "column of VCOS", &ada4571_import_options::vcos},
      {"temp", "column of VTEMP, in volts", &ada4571_import_options::vtemp},
      {"vdd", "column of VDD", &ada4571_import_options::vdd},
      {"reference", "column of a reference encoder", &ada4571_import_options::reference}};
  bool explain = false;
};

const std::map<std::string, double> kTimeUnits = {
    {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60.0}};
const std::map<std::string, double> kAngleUnits = {
    {"deg", 1.0}, {"rad", 180 / std::numbers::pi}, {"turn", 360.0}};
const std::map<std::string, std::string> kSeparators = {
    {"comma", ","}, {"semicolon", ";"}, {"tab", "\t"}, {"blank", " "}, {"bar", "|"}};

/// The words, and the marks that they stand for; the option gets the mark.
CLI::Validator separator() {
  std::vector<std::string> words;
  for (const auto &[word, mark] : kSeparators)
    words.push_back(word);
  return {[known = one_of(words)](std::string &text) -> std::string {
            const bool is_mark = std::any_of(kSeparators.begin(), kSeparators.end(),
                                             [&](const auto &pair) { return pair.second == text; });
            std::string wrong = is_mark ? "" : known(text);
            if (!is_mark && wrong.empty())
              text = kSeparators.at(text);
            return wrong;
          },
          "{" + CLI::detail::join(words, ",") + "}"};
}

/// "sin=0.001": the factor or the offset of a channel.
void apply(const ImportOptions &options, const std::vector<std::string> &pairs, const char *option,
           double ada4571_import_column::*field, ada4571_import_options &out) {
  for (const std::string &pair : pairs) {
    const auto equals = pair.find('=');
    const auto column =
        std::find_if(options.columns.begin(), options.columns.end(),
                     [&](const Column &c) { return pair.substr(0, equals) == c.name; });
    double value = NAN;
    if (equals == pair.npos || column == options.columns.end() ||
        !CLI::detail::lexical_cast(pair.substr(equals + 1), value) || !std::isfinite(value))
      throw Failure(kWrongUsage,
                    fmt::format("{}: '{}' must be a channel (time, sin, cos, temp, vdd, reference), "
                                "= and a number, as in sin=0.001",
                                option, pair));
    out.*column->target.*field = value;
  }
}

/// What the library wants to know, with the option that it asks for before it: "say which" is no
/// help to who does not know how.
std::string option_first(const CLI::App &verb, const std::string &sentence) {
  for (std::size_t at = sentence.find(" --"); at != sentence.npos;
       at = sentence.find(" --", at + 1)) {
    const std::size_t end = sentence.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at + 1);
    const std::string name = sentence.substr(at + 1, end == sentence.npos ? end : end - at - 1);
    if (verb.get_option_no_throw(name) != nullptr)
      return name + ": " + sentence;
  }
  return sentence;
}

Import open_import(const CLI::App &verb, const ImportOptions &options) {
  auto wanted = initialised(ada4571_import_options_init);
  wanted.separator = options.separator.empty() ? nullptr : options.separator.c_str();
  wanted.decimal = options.decimal.empty() ? nullptr : options.decimal.c_str();
  wanted.header_lines = options.header_lines;
  wanted.sample_rate_hz = options.rate_hz;
  wanted.supply_v = options.supply_v;
  wanted.periods_per_turn = options.periods;
  for (const Column &column : options.columns)
    if (!column.column.empty())
      (wanted.*column.target).column = column.column == "none" ? "" : column.column.c_str();
  if (!options.time_unit.empty())
    wanted.time.scale = kTimeUnits.at(options.time_unit);
  if (!options.reference_unit.empty())
    wanted.reference.scale = kAngleUnits.at(options.reference_unit);
  apply(options, options.scales, "--scale", &ada4571_import_column::scale, wanted);
  apply(options, options.offsets, "--offset", &ada4571_import_column::offset, wanted);
  try {
    return make_as_asked<Import>(ada4571_import_open, options.input.c_str(),
                                 static_cast<const ada4571_import_options *>(&wanted));
  } catch (const Failure &e) {
    if (e.exit_status() != kWrongUsage)
      throw;
    throw Failure(kWrongUsage,
                  option_first(verb, e.what()) + std::string("; see `iio-angle import --help`"));
  }
}

/// The first bytes of a file, or of what waits in standard input, which stays there; nothing of
/// another pipe, for what is taken from it is gone.
std::string first_bytes(const std::string &path) {
  constexpr std::size_t kEnough = 32;
  std::array<char, kEnough> bytes{};
  ssize_t got = 0;
  std::error_code error;
  if (path != "-") {
    if (!std::filesystem::is_regular_file(path, error))
      return {};
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), kEnough);
    got = file.gcount();
  } else if (std::array<int, 2> copy{};
             (got = ::pread(STDIN_FILENO, bytes.data(), kEnough, 0)) < 0 &&
             ::pipe2(copy.data(), O_CLOEXEC) == 0) {
    got = ::tee(STDIN_FILENO, copy[1], kEnough, 0);
    if (got > 0)
      got = ::read(copy[0], bytes.data(), kEnough);
    ::close(copy[0]);
    ::close(copy[1]);
  }
  return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

/// One of this program's own recordings, in either form: only its form is to change.
bool is_capture(const std::string &path) {
  constexpr std::string_view kMagic = "# ada4571-capture/", kByteOrderMark = "\xEF\xBB\xBF";
  if (path.ends_with(".sigmf-meta") || path.ends_with(".sigmf-data"))
    return true;
  std::string begin = first_bytes(path);
  if (begin.starts_with(kByteOrderMark))
    begin.erase(0, kByteOrderMark.size());
  return begin.starts_with(kMagic);
}

/// numpy's form tells its size first, and is read by place.
void refuse_piped_numpy(const std::string &path) {
  if (path == "-" && first_bytes(path).starts_with("\x93NUMPY"))
    throw Failure(kUnusable, "standard input: numpy's .npy is read from a file that has a name");
}

int change_form(const CLI::App &verb, const ImportOptions &options) {
  for (const CLI::Option *option : verb.get_options())
    if (option->count() > 0 && option->nonpositional() && !option->check_lname("output"))
      throw Failure(kWrongUsage, fmt::format("{}: {} is a capture already: this is for files of "
                                             "other programs",
                                             option->get_name(), options.input));
  const auto recording = open_capture(options.input);
  FileRoles().reads(options.input, recording).writes(options.output);
  check_usage(ada4571_recording_save(recording.get(), options.output.c_str()));
  return kDone;
}

std::string base_name(const std::string &path) {
  return path.substr(path.rfind('/') + 1);
}

Writer open_writer(const Import &import, const ImportOptions &options) {
  auto info = initialised(ada4571_recording_info_init);
  check(ada4571_import_get_info(import.get(), &info));
  const std::string origin =
      options.input == "-" ? "import" : "import of " + base_name(options.input);
  info.origin = origin.c_str();
  info.serial = options.serial.c_str();
  return make_as_asked<Writer>(ada4571_writer_open, options.output.c_str(),
                               static_cast<const ada4571_recording_info *>(&info));
}

int run(const CLI::App &verb, const ImportOptions &options) {
  FileRoles().reads(options.input).writes(options.output);
  if (is_capture(options.input))
    return change_form(verb, options);
  refuse_piped_numpy(options.input);
  const Import import = open_import(verb, options);
  remark(ada4571_import_text(import.get()));
  if (options.explain)
    return kDone;
  const Writer writer = open_writer(import, options);
  Progress progress;
  std::vector<ada4571_frame> frames(4096);
  std::uint64_t samples = 0;
  for (std::size_t count = frames.size(); count == frames.size();) {
    check(ada4571_import_read(import.get(), frames.data(), frames.size(), &count));
    check(ada4571_writer_write(writer.get(), frames.data(), count));
    samples += count;
    progress.show(fmt::format("{} samples", samples));
  }
  progress.clear();
  check(ada4571_writer_finish(writer.get()));
  note("{} samples\n", samples);
  return kDone;
}

void add_text_options(CLI::App &verb, ImportOptions &options) {
  verb.add_option("--separator", options.separator,
                  "what is between the columns (default: detected)")
      ->transform(separator())
      ->type_name("");
  verb.add_option("--decimal", options.decimal, "decimal mark, . or , (default: detected)")
      ->transform(one_of({".", ","}).description(""))
      ->type_name("MARK");
  verb.add_option("--skip", options.header_lines, "lines before the first row (default: detected)")
      ->transform(whole(0, 100000))
      ->type_name("N");
}

void add_value_options(CLI::App &verb, ImportOptions &options) {
  for (Column &column : options.columns)
    verb.add_option(std::string("--") + column.name, column.column,
                    std::string(column.help) + ": its name or its number, or none")
        ->type_name("COLUMN");
  verb.add_option("--rate", options.rate_hz, "sample rate, instead of a column of times")
      ->transform(positive("Hz"))
      ->transform(between(0.0, kMostRate_hz, "Hz"))
      ->type_name("HZ");
  verb.add_option("--time-unit", options.time_unit, "unit of the times (default: by the file, or s)")
      ->transform(one_of({"s", "ms", "us", "ns", "min"}))
      ->type_name("");
  verb.add_option("--reference-unit", options.reference_unit,
                  "unit of the reference (default: by the file)")
      ->transform(one_of({"deg", "rad", "turn"}))
      ->type_name("");
  verb.add_option("--scale", options.scales,
                  "factor from the numbers of a channel to volts, seconds or degrees, as in "
                  "sin=0.001; may be given again")
      ->allow_extra_args(false)
      ->type_name("CHANNEL=FACTOR");
  verb.add_option("--offset", options.offsets, "number to add after the factor; may be given again")
      ->allow_extra_args(false)
      ->type_name("CHANNEL=VALUE");
  verb.add_option("--supply", options.supply_v, "supply of the sensor, in V")
      ->capture_default_str()
      ->transform(positive("V"))
      ->type_name("V");
  verb.add_option("--periods", options.periods,
                  "electrical periods a turn: 2 for AMR, 1 for GMR, TMR and Hall")
      ->capture_default_str()
      ->transform(whole(1, 65536)) // as a capture may have
      ->type_name("N");
  verb.add_option("--serial", options.serial, "serial number of the sensor")->type_name("TEXT");
}

} // namespace

void add_import(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand(
      "import", "a capture from the CSV of an oscilloscope or DAQ, or from numpy's .npy");
  auto options = std::make_shared<ImportOptions>();
  verb->add_option("FILE", options->input,
                   "file of another program, or - for standard input; a capture gets the other form")
      ->type_name("")
      ->required();
  auto *output = verb->add_option("-o,--output", options->output,
                                  "capture file: .csv, .sigmf-meta, or - for standard output")
                     ->transform(capture_name())
                     ->type_name("CAPTURE");
  auto *explain = verb->add_flag("--explain", options->explain,
                                 "only say how the file is understood, and write nothing");
  add_value_options(*verb, *options);
  add_text_options(*verb, *options);
  verb->parse_complete_callback([output, explain] {
    if (output->count() + explain->count() == 0)
      throw CLI::RequiredError("--output");
  });
  example(*verb,
          "  iio-angle import --sin CH1 --cos CH2 scope.csv -o capture.csv\n"
          "  iio-angle import --sin 2 --cos 3 --rate 10000 --scale sin=0.001 --scale cos=0.001 \\\n"
          "      daq.txt -o capture.sigmf-meta\n"
          "  iio-angle import capture.csv -o capture.sigmf-meta\n"
          "What was detected is said on standard error; what cannot be detected is\n"
          "asked for.");
  verb->callback([options, verb, &action] { action = [options, verb] { return run(*verb, *options); }; });
}

} // namespace cli
