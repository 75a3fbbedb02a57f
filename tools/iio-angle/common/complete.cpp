// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/complete.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/known_names.h"
#include "common/print.h"
#include "common/usage.h"

namespace cli {

namespace {

struct Candidate {
  std::string word, what;
};
using Candidates = std::vector<Candidate>;

const Candidate kFiles{":files", ""};

Candidates plain(const std::vector<std::string> &words) {
  Candidates out;
  for (const std::string &word : words)
    out.push_back({word, ""});
  return out;
}

/// The words between the braces of what one_of() notes down.
std::vector<std::string> choices_of(const CLI::Option &option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == type.npos || close == type.npos)
    return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// Names while the name is typed; "NAME:parameter=" after the colon and each comma.
Candidates effects(const std::string &current) {
  const std::size_t colon = current.find(':');
  if (colon == current.npos)
    return plain(effect_names());
  const std::size_t begun = current.find_last_of(":,") + 1;
  Candidates out;
  for (const std::string &name : parameter_names(current.substr(0, colon)))
    out.push_back({current.substr(0, begun) + name + "=", ""});
  return out;
}

using Source = std::function<Candidates(const std::string &current)>;

/// Where the values of an option, or of a positional argument, come from; by its name.
Source values_of(const std::string &name, const CLI::App &verb) {
  if (name == "--effect")
    return effects;
  if (name == "--motion")
    return [](const std::string &) { return plain(motion_examples()); };
  if (name == "--temperature")
    return [](const std::string &) { return plain(temperature_examples()); };
  if (name == "--stored" || name == "--save")
    return [](const std::string &) { return plain(stored_names()); };
  if (name == "--uri")
    return [](const std::string &) { return plain({"local:", "ip:", "usb:"}); };
  if (name == "NAME" && verb.get_name() == "catalogue")
    return [](const std::string &) { return plain(effect_names()); };
  if (name == "NAME" && verb.get_name() == "figures")
    return [](const std::string &) { return plain(figure_names()); };
  return [](const std::string &) { return Candidates{}; };
}

/// Whether file names go where this option's value does: by the name of its type.
bool takes_file(const CLI::Option &option) {
  const std::string type =
      option.get_positional() ? option.get_name(true, false) : option.get_type_name();
  for (const char *word : {"FILE", "CAPTURE", "OUT", "DIRECTORY", "COLD", "HOT", "STUDY", "PART"})
    if (type.find(word) != type.npos)
      return true;
  return false;
}

Candidates values(const CLI::Option &option, const CLI::App &verb, const std::string &current) {
  const std::string name = option.get_lnames().empty() ? option.get_name(true, false)
                                                       : "--" + option.get_lnames().front();
  Candidates out = plain(choices_of(option));
  if (out.empty())
    out = values_of(name, verb)(current);
  if (out.empty() && takes_file(option))
    out.push_back(kFiles);
  return out;
}

void for_each_option(const CLI::App &verb, const std::function<void(const CLI::Option &)> &take) {
  for (const CLI::Option *option : verb.get_options())
    take(*option);
  for (const CLI::App *part : verb.get_subcommands([](const CLI::App *) { return true; }))
    if (part->get_name().empty())
      for_each_option(*part, take);
}

const CLI::Option *find_option(const CLI::App &verb, const std::string &name) {
  const CLI::Option *found = nullptr;
  for_each_option(verb, [&](const CLI::Option &option) {
    const bool is = name.starts_with("--")  ? option.check_lname(name.substr(2))
                    : name.starts_with('-') ? option.check_sname(name.substr(1))
                                            : false;
    found = is ? &option : found;
  });
  return found;
}

bool takes_value(const CLI::Option *option) {
  return option != nullptr && option->get_items_expected_max() > 0;
}

Candidates option_candidates(const CLI::App &verb) {
  Candidates out;
  for_each_option(verb, [&](const CLI::Option &option) {
    const std::string &text = option.get_description();
    for (const std::string &name : option.get_lnames())
      out.push_back({"--" + name, text.substr(0, text.find(" ("))});
  });
  return out;
}

Candidates verb_candidates(const CLI::App &verb) {
  Candidates out;
  for (const std::string &name : verb_names(verb))
    out.push_back({name, find_verb(verb, name)->get_description()});
  return out;
}

/// The positional argument that comes after as many; the last one may take many.
const CLI::Option *positional(const CLI::App &verb, std::size_t index) {
  const CLI::Option *last = nullptr;
  std::size_t seen = 0;
  for_each_option(verb, [&](const CLI::Option &option) {
    if (option.get_positional() && seen++ <= index)
      last = &option;
  });
  const bool many = last != nullptr && last->get_items_expected_max() > 1;
  return seen > index || many ? last : nullptr;
}

/// "--option=" before each, where the current word begins so.
Candidates with_prefix(Candidates candidates, const std::string &prefix) {
  for (Candidate &candidate : candidates)
    if (candidate.word != kFiles.word)
      candidate.word = prefix + candidate.word;
  return candidates;
}

Candidates candidates(const CLI::App &app, std::vector<std::string> words) {
  const std::string current = words.empty() ? "" : words.back();
  if (!words.empty())
    words.pop_back();
  const bool help = !words.empty() && words.front() == "help";
  if (help)
    words.erase(words.begin());
  const CLI::App *verb = &app;
  const CLI::Option *pending = nullptr; ///< waits for its value
  std::size_t arguments = 0;
  for (const std::string &word : words) {
    const CLI::App *part = pending == nullptr ? find_verb(*verb, word) : nullptr;
    if (pending != nullptr)
      pending = nullptr;
    else if (word.size() > 1 && word.front() == '-')
      pending = takes_value(find_option(*verb, word)) ? find_option(*verb, word) : nullptr;
    else if (part != nullptr)
      verb = part;
    else
      ++arguments;
  }
  if (pending != nullptr)
    return values(*pending, *verb, current);
  if (const std::size_t equals = current.find('=');
      current.starts_with("--") && equals != current.npos) {
    const CLI::Option *option = find_option(*verb, current.substr(0, equals));
    return takes_value(option) ? with_prefix(values(*option, *verb, current.substr(equals + 1)),
                                             current.substr(0, equals + 1))
                               : Candidates{};
  }
  if (current.starts_with('-'))
    return option_candidates(*verb);
  Candidates out = verb_candidates(*verb);
  if (help || !out.empty())
    return out;
  const CLI::Option *next = positional(*verb, arguments);
  return next != nullptr ? values(*next, *verb, current) : Candidates{};
}

} // namespace

bool complete(const CLI::App &app, int argc, char **argv) {
  if (argc < 3 || argv[1] != std::string_view("complete") || argv[2] != std::string_view("--"))
    return false;
  const std::vector<std::string> words(argv + 3, argv + argc);
  const std::string current = words.empty() ? "" : words.back();
  for (const Candidate &candidate : candidates(app, words))
    if (candidate.word == kFiles.word || candidate.word.starts_with(current))
      print("{}{}{}\n", candidate.word, candidate.what.empty() ? "" : "\t", candidate.what);
  return true;
}

} // namespace cli
