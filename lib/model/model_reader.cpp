// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The reading half of model_file.h, and the only file of the model that knows toml++.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <toml++/toml.h>

#include "base/angle.h"
#include "base/error.h"
#include "base/text.h"
#include "base/toml_text.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "model/model_file.h"

namespace ada {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kMaxEffects = 1000;

/// A bound of a number in the file, inclusive.
struct Range {
  double least, most;
};

[[noreturn]] void fail(const std::string &shown, const toml::source_position &at,
                       const std::string &what) {
  throw Error(ADA4571_ERROR_FORMAT, shown + ":" + std::to_string(std::max(at.line, 1u)) + ":" +
                                        std::to_string(std::max(at.column, 1u)) + ": " + what);
}

/// A table of which every key must be asked for: finish() refuses the rest.
class StrictTable {
public:
  StrictTable(const toml::table &table, std::string name, const std::string &shown)
      : table_(table), name_(std::move(name)), shown_(shown) {}

  std::optional<double> number(std::string_view key, Range range) {
    const toml::node *node = take(key);
    if (node == nullptr)
      return std::nullopt;
    return finite(*node, key, range);
  }

  /// The number in `node`, which stands at `key` or in an array there.
  double finite(const toml::node &node, std::string_view key, Range range) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail_at(node, std::string(key) + " must be a finite number");
    if (*value < range.least || *value > range.most)
      fail_at(node, std::string(key) + " must be from " + shortest(range.least) + " to " +
                        shortest(range.most) + ", not " + shortest(*value));
    return *value;
  }

  double required_number(std::string_view key, Range range) {
    const auto value = number(key, range);
    if (!value)
      fail_missing(key);
    return *value;
  }

  double required_whole_number(std::string_view key, Range range) {
    const double value = required_number(key, range);
    if (value != std::floor(value))
      fail_at(*take(key), std::string(key) + " must be a whole number");
    return value;
  }

  std::optional<std::string> words(std::string_view key) {
    const toml::node *node = take(key);
    if (node == nullptr)
      return std::nullopt;
    if (!node->is_string())
      fail_at(*node, std::string(key) + " must be text in quotes");
    return **node->as_string();
  }

  std::optional<StrictTable> table(std::string_view key) {
    const toml::node *node = take(key);
    if (node == nullptr)
      return std::nullopt;
    if (!node->is_table())
      fail_at(*node, std::string(key) + " must be a table");
    return StrictTable(*node->as_table(),
                       name_.empty() ? std::string(key) : name_ + "." + std::string(key), shown_);
  }

  const toml::node *take(std::string_view key) {
    asked_.emplace(key);
    return table_.get(key);
  }

  void finish() const {
    std::string known;
    for (const std::string &key : asked_)
      known += (known.empty() ? "" : ", ") + key;
    for (auto &&[key, node] : table_)
      if (asked_.find(key.str()) == asked_.end())
        fail(shown_, key.source().begin,
             "the key " + excerpt(key.str()) + " is not known" + place() +
                 (known.empty() ? std::string() : "; there are " + known));
  }

  [[noreturn]] void fail_at(const toml::node &node, const std::string &what) const {
    fail(shown_, node.source().begin, what);
  }
  [[noreturn]] void fail_missing(std::string_view key) const {
    fail(shown_, table_.source().begin, std::string(key) + " is missing" + place());
  }
  const toml::table &raw() const { return table_; }
  const std::string &shown() const { return shown_; }

private:
  std::string place() const { return name_.empty() ? "" : " in [" + name_ + "]"; }

  const toml::table &table_;
  std::string name_;
  const std::string &shown_;
  std::set<std::string, std::less<>> asked_;
};

toml::table parse(std::string_view text, const std::string &shown) {
  const std::string ascii = ascii_toml(text, shown);
  try {
    return toml::parse(ascii);
  } catch (const toml::parse_error &e) {
    std::string why(e.description());
    for (char &c : why)
      if (c < 0x20 || c > 0x7e)
        c = '?';
    fail(shown, e.source().begin, why);
  }
}

void check_schema(StrictTable &root) {
  const auto schema = root.words("schema");
  if (!schema)
    fail(root.shown(), {1, 1},
         "this is no model file: schema = \"" + std::string(kModelSchema) + "\" is missing");
  if (*schema != kModelSchema)
    root.fail_at(*root.take("schema"), "the schema " + excerpt(*schema) +
                                           " is not known here, only " + std::string(kModelSchema) +
                                           " is");
}

void check_checksum(StrictTable &root, std::string_view text) {
  const auto given = root.words("checksum");
  if (!given) {
    // Written by hand, unless the line is there and something has made it unreadable.
    const std::size_t at = text.find("hecksum = \"crc32:"); // its first letter may be the #
    if (at == std::string_view::npos)
      return;
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    fail(root.shown(), {static_cast<toml::source_index>(line), 1},
         "the checksum is no longer read; delete this line if the file was changed by hand");
  }
  const toml::node &node = *root.take("checksum");
  const std::string right = model_checksum(text, node.source().begin.line);
  if (*given != right)
    root.fail_at(node, "the checksum does not fit, the file was changed after it was written "
                       "(its content has " +
                           right + "); delete this line if the change is wanted");
}

std::optional<bool> read_switch(StrictTable &table, std::string_view key) {
  const auto word = table.words(key);
  if (!word)
    return std::nullopt;
  if (*word != "on" && *word != "off")
    table.fail_at(*table.take(key), std::string(key) + " must be \"on\" or \"off\"");
  return *word == "on";
}

Provenance read_provenance(StrictTable table) {
  constexpr Range kVolts{-100, 100}, kRms{0, 100};
  Provenance p;
  p.serial = table.words("serial").value_or("");
  p.date = table.words("date").value_or("");
  p.method = table.words("method").value_or("");
  p.capture_identity = table.words("capture").value_or("");
  p.generator = table.words("generator").value_or("");
  p.vtemp_min_v = table.number("vtemp_min_v", kVolts);
  p.vtemp_max_v = table.number("vtemp_max_v", kVolts);
  p.gain_control = read_switch(table, "gain_control");
  p.fit_residual_rms_v = table.number("fit_residual_rms_v", kRms);
  p.heldout_residual_rms_v = table.number("heldout_residual_rms_v", kRms);
  table.finish();
  return p;
}

/// Angles are stored as they were fitted; anything within some turns is accepted.
constexpr Range kAngle{-3600, 3600};

void read_baseline(StrictTable table, Model &model) {
  const double supply = model.supply_v;
  model.baseline.amplitude_v = table.required_number("amplitude_v", {1e-6, supply});
  model.baseline.offset_sin_v = table.required_number("offset_sin_v", {-supply, supply});
  model.baseline.offset_cos_v = table.required_number("offset_cos_v", {-supply, supply});
  model.baseline.angle_zero_deg = table.number("angle_zero_deg", kAngle).value_or(0.0);
  if (auto errors = table.table("std_errors")) {
    constexpr Range kError{0, 1e6};
    Baseline &e = model.baseline_std_error;
    e.amplitude_v = errors->number("amplitude_v", kError).value_or(0.0);
    e.offset_sin_v = errors->number("offset_sin_v", kError).value_or(0.0);
    e.offset_cos_v = errors->number("offset_cos_v", kError).value_or(0.0);
    e.angle_zero_deg = errors->number("angle_zero_deg", kError).value_or(0.0);
    errors->finish();
  }
  table.finish();
}

double read_parameter(StrictTable &table, const ParameterInfo &parameter) {
  if (parameter.unit == "channel") {
    const auto channel = table.words(parameter.name);
    if (!channel && may_be_absent(parameter))
      return std::nan("");
    if (!channel)
      table.fail_missing(parameter.name);
    if (*channel != "vsin" && *channel != "vcos")
      table.fail_at(*table.take(parameter.name),
                    std::string(parameter.name) + " must be \"vsin\" or \"vcos\"");
    return *channel == "vcos";
  }
  const auto value = table.number(parameter.name, {parameter.minimum, parameter.maximum});
  if (!value && !may_be_absent(parameter))
    table.fail_missing(parameter.name);
  return value.value_or(std::nan(""));
}

EffectInstance read_effect(StrictTable table) {
  const auto name = table.words("name");
  if (!name)
    table.fail_missing("name");
  EffectInstance instance;
  instance.effect = find_effect(*name);
  if (instance.effect == nullptr)
    table.fail_at(*table.take("name"),
                  "no effect is called " + excerpt(*name) + "; there are " + known_effects());
  const auto info = instance.effect->info().parameters;
  if (auto parameters = table.table("parameters")) {
    for (const ParameterInfo &parameter : info)
      instance.values.push_back(read_parameter(*parameters, parameter));
    parameters->finish();
  } else if (!info.empty()) {
    table.fail_missing("parameters");
  }
  if (auto errors = table.table("std_errors")) {
    for (const ParameterInfo &parameter : info)
      instance.std_errors.push_back(
          errors->number(parameter.name, {0, kInfinity}).value_or(std::nan("")));
    errors->finish();
  }
  table.finish();
  return instance;
}

void read_effects(StrictTable &root, Model &model) {
  const toml::node *node = root.take("effect");
  if (node == nullptr)
    return;
  const toml::array *array = node->as_array();
  if (array == nullptr || array->size() > kMaxEffects)
    root.fail_at(*node, "the effects must be an array of tables [[effect]], at most " +
                            std::to_string(kMaxEffects));
  for (const toml::node &item : *array) {
    if (!item.is_table())
      root.fail_at(item, "an effect must be a table [[effect]]");
    EffectInstance instance = read_effect({*item.as_table(), "effect", root.shown()});
    try {
      add_effect(model, std::move(instance));
    } catch (const Error &e) {
      root.fail_at(item, e.what());
    }
  }
}

std::vector<double> read_series(StrictTable &table, std::string_view key, std::size_t orders) {
  const toml::node *node = table.take(key);
  if (node == nullptr)
    table.fail_missing(key);
  const toml::array *array = node->as_array();
  if (array == nullptr || array->size() != orders)
    table.fail_at(*node, std::string(key) + " must be an array of " + std::to_string(orders) +
                             " numbers, one an order");
  std::vector<double> values;
  for (const toml::node &item : *array)
    values.push_back(table.finite(item, key, {-1, 1}));
  return values;
}

PeriodicRemainder read_remainder(StrictTable table) {
  PeriodicRemainder remainder;
  const auto angle = table.words("angle");
  if (!angle)
    table.fail_missing("angle");
  if (*angle != kMechanical && *angle != kElectrical)
    table.fail_at(*table.take("angle"), "angle must be \"mechanical\" or \"electrical\"");
  remainder.electrical = *angle == kElectrical;
  const double orders =
      table.required_whole_number("orders", {1, PeriodicRemainder::kHighestOrder});
  for (const RemainderSeries &series : kRemainderSeries)
    remainder.*series.values = read_series(table, series.key, static_cast<std::size_t>(orders));
  table.finish();
  return remainder;
}

} // namespace

Model model_from_toml(std::string_view text, const std::string &shown) {
  const toml::table document = parse(text, shown);
  StrictTable root(document, "", shown);
  check_schema(root);
  check_checksum(root, text);
  Model model;
  model.periods_per_turn =
      static_cast<int>(root.required_whole_number("periods_per_turn", {1, kMostPeriodsATurn}));
  model.supply_v = root.required_number("supply_v", {0.1, 100});
  model.vtemp_reference_v = root.number("vtemp_reference_v", {-100, 100}).value_or(0.0);
  model.vdd_reference_v = root.number("vdd_reference_v", {0.1, 100});
  model.noise_rms_v = root.number("noise_rms_v", {0, 100});
  if (auto provenance = root.table("provenance"))
    model.provenance = read_provenance(std::move(*provenance));
  auto baseline = root.table("baseline");
  if (!baseline)
    root.fail_missing("[baseline]");
  read_baseline(std::move(*baseline), model);
  read_effects(root, model);
  if (auto remainder = root.table("remainder"))
    model.remainder = read_remainder(std::move(*remainder));
  root.finish();
  return model;
}

} // namespace ada
