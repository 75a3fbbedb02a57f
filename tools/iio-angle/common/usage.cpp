// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/usage.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/handles.h"
#include "common/spelling.h"

namespace cli {

namespace {

using Verbs = std::vector<const CLI::App *>;

Verbs all_parts(const CLI::App &app) {
  return app.get_subcommands([](const CLI::App *) { return true; });
}

/// The verb that was being parsed, `calibrate single` say.
const CLI::App &innermost(const CLI::App &app) {
  for (const CLI::App *part : app.get_subcommands())
    if (!part->get_name().empty())
      return innermost(*part);
  return app;
}

/// "iio-angle calibrate single".
std::string full_name(const CLI::App &verb) {
  const CLI::App *parent = verb.get_parent();
  return parent == nullptr ? verb.get_name() : full_name(*parent) + " " + verb.get_name();
}

std::string help_of(const CLI::App &verb) {
  return full_name(verb) + " --help";
}

std::string missing_verb(const CLI::App &verb) {
  std::string names;
  for (const std::string &name : verb_names(verb))
    names += (names.empty() ? "" : ", ") + name;
  return fmt::format("a verb is missing: {}; see `{}`", names, help_of(verb));
}

std::string too_many(const CLI::App &verb, const std::string &word) {
  return fmt::format("'{}' is one argument too many; see `{}`", word, help_of(verb));
}

std::string unknown_word(const CLI::App &verb, const std::string &word) {
  if (word.size() > 1 && word.front() == '-') {
    const std::string name = word.substr(0, word.find('='));
    const std::vector<std::string> known = option_names(verb);
    if (std::find(known.begin(), known.end(), name) != known.end())
      return fmt::format("{}: the options of {} stand behind its name", name, full_name(verb));
    return fmt::format("{}: {} has no such option{}", name, full_name(verb),
                       did_you_mean(name, known, help_of(verb)));
  }
  const auto verbs = verb_names(verb);
  if (!verbs.empty())
    return fmt::format("'{}' is no verb of {}{}", word, full_name(verb),
                       did_you_mean(word, verbs, help_of(verb)));
  return too_many(verb, word);
}

/// Behind `help` stands a verb and nothing else: --help itself would pass over what it does not
/// know.
void require_verbs(const CLI::App &app, const std::vector<std::string> &words) {
  const CLI::App *verb = &app;
  for (const std::string &word : words) {
    const CLI::App *part = find_verb(*verb, word);
    if (part == nullptr && word != "--help" && word != "-h")
      throw Failure(kWrongUsage,
                    word.starts_with('-') ? too_many(*verb, word) : unknown_word(*verb, word));
    verb = part != nullptr ? part : verb;
  }
}

/// What was left over, options first: the value of a mistyped option is left over as well, and
/// what is missing may be missing because of it.
const std::string *leftover(const std::vector<std::string> &words) {
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string &word) {
    return word.size() > 1 && word.front() == '-' && word != "--";
  });
  return option != words.end() ? &*option : words.empty() ? nullptr : &words.front();
}

} // namespace

std::vector<std::string> verb_names(const CLI::App &app) {
  std::vector<std::string> names;
  for (const CLI::App *part : all_parts(app))
    if (!part->get_name().empty() && !part->get_group().empty())
      names.push_back(part->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App &verb) {
  std::vector<std::string> names;
  for (const CLI::Option *option : verb.get_options()) {
    for (const std::string &name : option->get_lnames())
      names.push_back("--" + name);
    for (const std::string &name : option->get_snames())
      names.push_back("-" + name);
  }
  for (const CLI::App *part : all_parts(verb))
    if (part->get_name().empty())
      for (std::string &name : option_names(*part))
        names.push_back(std::move(name));
  return names;
}

const CLI::App *find_verb(const CLI::App &app, const std::string &name) {
  for (const CLI::App *part : all_parts(app))
    if (!name.empty() && part->get_name() == name)
      return part;
  return nullptr;
}

std::vector<std::string> words_of(const CLI::App &app, int argc, char **argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    require_verbs(app, words);
    words.push_back("--help");
  }
  // CLI11 would only say that a verb is missing.
  if (!words.empty() && words.front().find_first_not_of('-') == 0 &&
      find_verb(app, words.front()) == nullptr)
    throw Failure(kWrongUsage, unknown_word(app, words.front()));
  std::reverse(words.begin(), words.end());
  return words;
}

std::string usage_error(const CLI::App &app, const CLI::ParseError &error) {
  const CLI::App &verb = innermost(app);
  const std::string text = error.what();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if (code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError ||
      code == CLI::ExitCodes::RequiresError) {
    const std::vector<std::string> left = app.remaining(true);
    // A mistyped verb takes all options behind it along.
    if (!left.empty() && !verb_names(verb).empty())
      return unknown_word(verb, left.front());
    if (const std::string *word = leftover(left))
      return unknown_word(verb, *word);
  }
  if (code == CLI::ExitCodes::RequiredError && text.starts_with("A subcommand"))
    return missing_verb(verb);
  if (code == CLI::ExitCodes::RequiredError)
    return fmt::format("{}; see `{}`", text, help_of(verb));
  if (code == CLI::ExitCodes::ArgumentMismatch && text.find(": ") != text.npos)
    return fmt::format("{}: {}; see `{}`", text.substr(0, text.find(": ")),
                       text.find("received") != text.npos ? "given more than once"
                                                          : "a value is missing",
                       help_of(verb));
  if (code == CLI::ExitCodes::ExcludesError)
    if (const std::size_t at = text.find(" excludes "); at != text.npos)
      return fmt::format("{}: does not go with {}", text.substr(0, at), text.substr(at + 10));
  if (code == CLI::ExitCodes::RequiresError)
    if (const std::size_t at = text.find(" requires "); at != text.npos)
      return fmt::format("{}: needs {}", text.substr(0, at), text.substr(at + 10));
  // A name that is no option's says nothing: "NAME: 'x' is no effect".
  for (const CLI::Option *option : verb.get_options())
    if (code == CLI::ExitCodes::ValidationError && option->get_positional() &&
        text.starts_with(option->get_name(true, false) + ": "))
      return text.substr(text.find(": ") + 2);
  return text;
}

} // namespace cli
