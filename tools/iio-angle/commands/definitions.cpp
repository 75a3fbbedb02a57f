// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The verbs and options as JSON: what the man pages and the reference of the documentation are made
// of. It serves the build and does not stand among the verbs of --help.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/handles.h"
#include "common/print.h"
#include "common/verb.h"

namespace cli {

namespace {

using Json = nlohmann::ordered_json;

bool is_help(const CLI::Option &option) {
  return option.check_lname("help") || option.check_lname("version");
}

/// CLI11 writes what is checked behind the type's name: "V:POSITIVE", ":{text,csv,json}".
Json describe_option(const CLI::Option &option) {
  Json names = Json::array();
  for (const std::string &name : option.get_snames())
    names.push_back("-" + name);
  for (const std::string &name : option.get_lnames())
    names.push_back("--" + name);
  const std::string type = option.get_type_name();
  const std::size_t colon = std::min(type.find(':'), type.size());
  const bool positional = option.get_positional();
  return {{"names", names},
          {"positional", positional},
          {"type", positional ? option.get_name(true, false) : type.substr(0, colon)},
          {"limits", colon < type.size() ? type.substr(colon + 1) : ""},
          {"default", option.get_default_str()},
          {"required", option.get_required()},
          {"many", option.get_expected_max() >= CLI::detail::expected_max_vector_size},
          {"description", option.get_description()}};
}

/// A verb, or an option group, which CLI11 takes for a verb without a name.
Json describe_verb(const CLI::App &verb) {
  Json described = {
      {"name", verb.get_name()},     {"description", verb.get_description()},
      {"footer", verb.get_footer()}, {"options_required", verb.get_require_option_min()},
      {"options", Json::array()},    {"groups", Json::array()},
      {"verbs", Json::array()}};
  for (const CLI::Option *option : verb.get_options())
    if (!is_help(*option))
      described["options"].push_back(describe_option(*option));
  for (const CLI::App *part : verb.get_subcommands([](const CLI::App *) { return true; }))
    if (part->get_name().empty())
      described["groups"].push_back(describe_verb(*part));
    else if (!part->get_group().empty())
      described["verbs"].push_back(describe_verb(*part));
  return described;
}

} // namespace

void add_definitions(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("definitions", "the verbs and their options, as JSON");
  verb->group("");
  verb->callback([&app, &action] {
    action = [&app] {
      print("{}\n", describe_verb(app).dump(1));
      return kDone;
    };
  });
}

} // namespace cli
