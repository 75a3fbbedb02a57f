// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/known_names.h"

#include "common/handles.h"

namespace cli {

namespace {

/// Names that the library gives by a number, until it gives none.
std::vector<std::string> all(const char *(*name_of)(std::size_t)) {
  std::vector<std::string> names;
  while (const char *name = name_of(names.size()))
    names.emplace_back(name);
  return names;
}

/// Calls take(parameter) for each parameter of an effect.
template <class Take> void for_each_parameter(std::string_view id, const Take &take) {
  for (std::size_t i = 0; i < ada4571_catalogue_count(); ++i) {
    auto effect = initialised(ada4571_effect_info_init);
    check(ada4571_catalogue_get(i, &effect));
    for (std::size_t k = 0; effect.id == id && k < effect.parameters; ++k) {
      auto parameter = initialised(ada4571_parameter_init);
      check(ada4571_catalogue_parameter(i, k, &parameter));
      take(parameter);
    }
  }
}

} // namespace

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ada4571_catalogue_count(); ++i) {
    auto effect = initialised(ada4571_effect_info_init);
    check(ada4571_catalogue_get(i, &effect));
    names.emplace_back(effect.id);
  }
  return names;
}

std::vector<std::string> parameter_names(std::string_view effect) {
  std::vector<std::string> names;
  for_each_parameter(effect, [&](const ada4571_parameter &p) { names.emplace_back(p.name); });
  return names;
}

std::string parameter_unit(std::string_view effect, std::string_view parameter) {
  std::string unit = "1";
  for_each_parameter(effect, [&](const ada4571_parameter &p) {
    if (p.name == parameter)
      unit = p.unit;
  });
  return unit;
}

std::vector<std::string> figure_names() {
  return all(ada4571_figure_name);
}

std::vector<std::string> motion_examples() {
  return all(ada4571_motion_example);
}

std::vector<std::string> temperature_examples() {
  return all(ada4571_temperature_example);
}

std::vector<std::string> stored_names() {
  const auto list = make<StoredList>(ada4571_stored_list_new, static_cast<const char *>(nullptr));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < ada4571_stored_list_count(list.get()); ++i) {
    auto stored = initialised(ada4571_stored_init);
    check(ada4571_stored_list_get(list.get(), i, &stored));
    names.emplace_back(stored.name);
  }
  return names;
}

std::string_view kind_of(std::string_view text) {
  return text.substr(0, text.find(':'));
}

std::vector<std::string> keys_of(const std::vector<std::string> &texts, std::string_view kind) {
  std::vector<std::string> keys;
  for (const std::string &text : texts)
    if (kind_of(text) == kind)
      for (std::size_t end = text.find('='); end != text.npos; end = text.find('=', end + 1)) {
        const std::size_t begin = text.find_last_of(":,", end) + 1;
        keys.push_back(text.substr(begin, end - begin));
      }
  return keys;
}

std::vector<std::string> kinds_of(const std::vector<std::string> &texts) {
  std::vector<std::string> kinds;
  for (const std::string &text : texts)
    kinds.emplace_back(kind_of(text));
  return kinds;
}

} // namespace cli
