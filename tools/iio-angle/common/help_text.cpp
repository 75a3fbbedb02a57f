// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/help_text.h"

#include <algorithm>

namespace cli {

std::string HelpText::make_option_opts(const CLI::Option *option) const {
  if (option->get_type_size() == 0)
    return {};
  const std::string type = option->get_positional() ? "" : option->get_type_name();
  std::string text = type.substr(0, type.find(':'));
  if (text.empty() && type.find('{') != type.npos) { // ":{text,csv,json}"
    text = type.substr(type.find('{') + 1, type.find('}') - type.find('{') - 1);
    std::replace(text.begin(), text.end(), ',', '|');
  }
  const bool many = option->get_expected_max() == CLI::detail::expected_max_vector_size;
  if (many && !text.ends_with("..."))
    text += text.empty() ? "..." : " ...";
  return text.empty() ? text : " " + text;
}

std::string HelpText::make_option_desc(const CLI::Option *option) const {
  std::string words;
  const auto add = [&words](const std::string &more) {
    words += (words.empty() ? "" : "; ") + more;
  };
  if (option->get_required() && !option->get_positional())
    add("required");
  for (const CLI::Option *needed : option->get_needs())
    add("with " + needed->get_name());
  if (!option->get_default_str().empty())
    add("default " + option->get_default_str());
  return option->get_description() + (words.empty() ? "" : " (" + words + ")");
}

} // namespace cli
