// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// truth-capture: writes a capture with a hidden effect, and what is hidden in it.

#include "outside.h"
#include "scenario.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>

namespace {

constexpr const char *kUsage =
    R"(usage: truth-capture [options] -o CAPTURE.csv
  --list                 categories, and what --effect takes in each
  --category NAME        default single
  --effect NAME          default: drawn
  --scale X              factor on the size of what single to four hide, default 1
  --seed N               default: drawn; printed in any case
  -o FILE                the capture
  --truth FILE           what is hidden in it, as JSON
  --second FILE          another capture of the same sensor, without what belongs to the
                         recording, the drive, the reference or one moment
  --second-reference     the second capture gets the exact angle as its reference_deg even
                         when the first has no reference
)";

struct Arguments {
  truth::Options options;
  std::uint64_t seed = 0;
  bool has_seed = false;
  bool list = false;
  bool second_reference = false;
  std::string output, truth, second;
};

Arguments parse(int argc, char **argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    auto value = [&]() -> std::string {
      if (++i >= argc)
        throw std::invalid_argument(name + " needs a value");
      return argv[i];
    };
    if (name == "--list")
      arguments.list = true;
    else if (name == "--second-reference")
      arguments.second_reference = true;
    else if (name == "--category")
      arguments.options.category = value();
    else if (name == "--effect")
      arguments.options.effect = value();
    else if (name == "--scale")
      arguments.options.scale = std::stod(value());
    else if (name == "--seed") {
      arguments.seed = std::stoull(value());
      arguments.has_seed = true;
    } else if (name == "-o")
      arguments.output = value();
    else if (name == "--truth")
      arguments.truth = value();
    else if (name == "--second")
      arguments.second = value();
    else
      throw std::invalid_argument("unknown argument " + name);
  }
  if (!arguments.list && arguments.output.empty())
    throw std::invalid_argument("no output given");
  return arguments;
}

void print_list() {
  auto show = [](const char *title, const std::vector<std::string> &names) {
    std::cout << title << '\n';
    for (const std::string &name : names)
      std::cout << "  " << name << '\n';
  };
  show("categories:", truth::categories());
  show("effects of single, two, three, four, tiny:", truth::causes());
  show("effects of bench:", truth::bench_causes());
  show("effects of outside:", truth::outside_kinds());
  show("effects of ambiguous:", truth::ambiguous_cases());
  std::cout << "effects of unknown:\n";
  for (const truth::UnknownKind &kind : truth::unknown_kinds())
    std::cout << "  " << kind.name << '\n';
}

void write_capture(const std::string &path, const truth::Bench &bench, bool exact_reference) {
  std::ofstream out(path, std::ios::binary);
  truth::write_text(out, bench, truth::simulate(bench), exact_reference);
  if (!out.flush())
    throw std::runtime_error("cannot write " + path);
}

void run(Arguments arguments) {
  if (arguments.list) {
    print_list();
    return;
  }
  if (!arguments.has_seed)
    arguments.seed = std::random_device{}();
  const truth::Scenario scenario = truth::random_scenario(arguments.seed, arguments.options);
  std::cerr << "seed " << arguments.seed << ", " << arguments.options.category << ": "
            << scenario.description << '\n';
  write_capture(arguments.output, scenario.bench, false);
  if (!arguments.truth.empty()) {
    std::ofstream out(arguments.truth, std::ios::binary);
    truth::write_json(out, scenario.expectation, arguments.options.category, scenario.description,
                      arguments.seed);
    if (!out.flush())
      throw std::runtime_error("cannot write " + arguments.truth);
  }
  if (!arguments.second.empty()) {
    const truth::Bench second = truth::second_capture(scenario);
    write_capture(arguments.second, second,
                  arguments.second_reference || second.record.has_reference);
  }
}

} // namespace

int main(int argc, char **argv) {
  Arguments arguments;
  try {
    arguments = parse(argc, argv);
  } catch (const std::exception &error) {
    std::cerr << "truth-capture: " << error.what() << '\n' << kUsage;
    return 2;
  }
  try {
    run(arguments);
  } catch (const std::invalid_argument &error) {
    std::cerr << "truth-capture: " << error.what() << '\n';
    return 2;
  } catch (const std::exception &error) {
    std::cerr << "truth-capture: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
