// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/assignment.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "import/units.h"

namespace ada {

namespace {

/// A channel in the words of those who measure.
struct Channel {
  Quantity quantity;
  std::string_view words, wholes, option, unit; ///< one of the words in the name, or all of it
};

constexpr std::array<Channel, kColumns.size()> kChannels = {{
    {Quantity::time, " time zeit timestamp elapsed ", " t x x_value x-axis ", "time", "s"},
    {Quantity::volts, " sin vsin sine sinus usin ", "", "sin", "V"},
    {Quantity::volts, " cos vcos cosine cosinus kosinus ucos ", "", "cos", "V"},
    {Quantity::volts, " temp vtemp temperature temperatur ", "", "temp", "V"},
    {Quantity::volts, " vdd vcc supply versorgung ", "", "vdd", "V"},
    {Quantity::degrees, " reference ref referenz encoder angle winkel ", "", "reference",
     "deg"},
}};

/// Whether one of the words of a name is one of the channel's.
bool speaks_of(const Channel &channel, const std::string &name) {
  const std::string text = folded(name);
  if (!text.empty() && channel.wholes.find(" " + text + " ") != channel.wholes.npos)
    return true;
  for (std::size_t begin = 0; begin < text.size();) {
    auto end = text.find_first_of(" _-+./:", begin);
    end = end == text.npos ? text.size() : end;
    std::string word = text.substr(begin, end - begin);
    while (!word.empty() && word.back() >= '0' && word.back() <= '9')
      word.pop_back();
    if (!word.empty() && channel.words.find(" " + word + " ") != channel.words.npos)
      return true;
    begin = end + 1;
  }
  return false;
}

constexpr std::size_t kMostShown = 12; ///< columns in a sentence

class Assigner {
public:
  Assigner(const std::vector<FileColumn> &columns, const ImportOptions &options,
           const std::string &place, bool rate_known)
      : columns_(columns), options_(options), place_(place), rate_known_(rate_known) {}

  Assignment run() {
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      if (const auto index = column_of(c))
        assign(c, *index);
    refuse_shared();
    mention_the_rest();
    return std::move(out_);
  }

private:
  [[noreturn]] void refuse(const std::string &what) const {
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, place_ + ": " + what);
  }

  std::string shown(std::size_t i) const {
    return "column " + std::to_string(i + 1) +
           (columns_[i].name.empty() ? "" : " " + excerpt(columns_[i].name));
  }

  std::string all_columns() const {
    std::string text;
    for (std::size_t i = 0; i < std::min(columns_.size(), kMostShown); ++i)
      text += (i ? ", " : "") + std::to_string(i + 1) +
              (columns_[i].name.empty() ? "" : " " + excerpt(columns_[i].name));
    return text + (columns_.size() > kMostShown ? ", ..." : "");
  }

  std::optional<std::size_t> column_of(std::size_t c) const {
    const auto &wanted = options_.columns[c].column;
    if (c == 0 && wanted && wanted->empty() && !rate_known_)
      refuse("without a column of times give the sample rate by --rate: the file names none");
    if (wanted)
      return wanted->empty() ? std::nullopt : std::optional(named(c, *wanted));
    if (c == 0 && options_.sample_rate_hz > 0.0)
      return std::nullopt;
    const auto found = looked_for(c);
    if (!found && c == 0 && !rate_known_)
      refuse("no column is known to be the time, and the file names no sample rate: give --time or "
             "--rate; there are " +
             all_columns());
    if (!found && kColumns[c].required && c > 0)
      refuse("no column is known to be " + std::string(c == 1 ? "VSIN" : "VCOS") + ": give " +
             option(c) + "; there are " + all_columns());
    return found;
  }

  static std::string option(std::size_t c) { return "--" + std::string(kChannels[c].option); }

  /// Its name, or all that the file says: "CH1" or "CH1 [V]".
  static bool is_called(const FileColumn &column, const std::string &wanted) {
    const NameAndUnit parts = split_unit(wanted);
    return folded(column.name) == folded(wanted) ||
           (!parts.unit.empty() && folded(column.name) == folded(parts.name) &&
            folded(unit_word(column.unit)) == folded(parts.unit));
  }

  /// Its number from 1, or its name with or without the unit. `c` is the channel that wants it.
  std::size_t named(std::size_t c, const std::string &wanted) const {
    const bool marked = wanted.front() == '#';
    const char *const first = wanted.data() + (marked ? 1 : 0), *const last = wanted.data() + wanted.size();
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(first, last, number);
    const bool is_number = error == std::errc() && end == last && number > 0;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < columns_.size() && !marked; ++i)
      if (is_called(columns_[i], wanted))
        found.push_back(i);
    if (is_number && number <= columns_.size() && (found.empty() || (found.size() == 1 && found[0] == number - 1)))
      return number - 1;
    if (is_number && !found.empty())
      refuse(excerpt(wanted) + " is a column's number and another one's name: give " + option(c) +
             " #" + std::to_string(number) + " or #" + std::to_string(found[0] + 1));
    if (found.empty())
      refuse("there is no column " + excerpt(wanted) + " for " + option(c) + "; there are " +
             all_columns());
    if (found.size() > 1)
      refuse(excerpt(wanted) + " is the name of more than one column: give " + option(c) +
             " its number; there are " + all_columns());
    return found[0];
  }

  std::optional<std::size_t> looked_for(std::size_t c) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (fits(c, columns_[i]) && !asked_for(i))
        found.push_back(i);
    if (found.size() > 1)
      refuse(shown(found[0]) + " and " + shown(found[1]) + " could both be the " +
             std::string(kChannels[c].option) + " column: give " + option(c));
    return found.empty() ? std::nullopt : std::optional(found[0]);
  }

  /// Whether the options give the column to a channel.
  bool asked_for(std::size_t i) const {
    for (std::size_t c = 0; c < options_.columns.size(); ++c)
      if (const auto &wanted = options_.columns[c].column;
          wanted && !wanted->empty() && named(c, *wanted) == i)
        return true;
    return false;
  }

  bool fits(std::size_t c, const FileColumn &column) const {
    const Quantity quantity = kChannels[c].quantity;
    if (is_sample_count(column.unit) || is_sample_count(column.name))
      return false;
    const bool unit_fits = unit_factor(quantity, column.unit).has_value();
    if (c == 0 && unit_fits)
      return true;
    return speaks_of(kChannels[c], column.name) &&
           (unit_fits || column.unit.empty() || options_.columns[c].scale);
  }

  void assign(std::size_t c, std::size_t index) {
    const Channel &channel = kChannels[c];
    const ImportColumn &wanted = options_.columns[c];
    const FileColumn &column = columns_[index];
    Assigned out{index, 1.0, wanted.offset};
    std::string how = "in " + std::string(channel.unit) + " (assumed: the file gives no unit)";
    if (wanted.scale) {
      out.scale = *wanted.scale;
      how = "times " + shortest(out.scale);
    } else if (const auto factor = unit_factor(channel.quantity, column.unit)) {
      out.scale = *factor;
      how = "in " + printable(column.unit);
    } else if (!column.unit.empty()) {
      refuse(shown(index) + " is in " + excerpt(column.unit) + ", which is no unit of " +
             std::string(kColumns[c].name) + ": give --scale " + std::string(channel.option) +
             "=FACTOR");
    } else if (channel.quantity == Quantity::degrees) {
      refuse(shown(index) + " does not say whether it is in degrees or radians: give "
                            "--reference-unit");
    }
    if (out.offset != 0.0)
      how += ", plus " + shortest(out.offset);
    out_.channels[c] = out;
    out_.text += std::string(kColumns[c].name) + ": " + shown(index) + ", " + how + "\n";
  }

  void refuse_shared() const {
    for (std::size_t a = 0; a < kColumns.size(); ++a)
      for (std::size_t b = a + 1; b < kColumns.size(); ++b)
        if (out_.channels[a] && out_.channels[b] &&
            out_.channels[a]->index == out_.channels[b]->index)
          refuse(shown(out_.channels[a]->index) + " cannot be both " +
                 std::string(kColumns[a].name) + " and " + std::string(kColumns[b].name) +
                 ": give " + option(a) + " and " + option(b));
  }

  void mention_the_rest() {
    std::string rest;
    for (std::size_t i = 0; i < std::min(columns_.size(), kMostShown); ++i)
      if (std::none_of(out_.channels.begin(), out_.channels.end(),
                       [i](const auto &channel) { return channel && channel->index == i; }))
        rest += (rest.empty() ? "left out: " : ", ") + shown(i);
    if (!rest.empty())
      out_.text += rest + "\n";
  }

  const std::vector<FileColumn> &columns_;
  const ImportOptions &options_;
  const std::string &place_;
  bool rate_known_;
  Assignment out_;
};

/// The number with the fewest digits within a share of `value`.
double rounded(double value, double share) {
  for (int digits = 1; digits < 16; ++digits) {
    std::array<char, 40> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::scientific, digits - 1).ptr;
    double near = value;
    std::from_chars(text.data(), end, near);
    if (std::fabs(near - value) <= share * value)
      return near;
  }
  return value;
}

} // namespace

Assignment assign_columns(const std::vector<FileColumn> &columns, const ImportOptions &options,
                          const std::string &place, bool rate_known) {
  return Assigner(columns, options, place, rate_known).run();
}

std::optional<double> regular_rate(const std::vector<double> &times) {
  if (times.size() < 3)
    return std::nullopt;
  const double span = times.back() - times.front();
  const double step = span / static_cast<double>(times.size() - 1);
  if (!(step > 0.0))
    return std::nullopt;
  double worst = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i)
    worst = std::max(worst, std::fabs(times[i] - times.front() - static_cast<double>(i) * step));
  // Half a step: rounding of the printed times, and no gap.
  if (worst > 0.5 * step)
    return std::nullopt;
  return rounded(1.0 / step, std::max(1e-9, 2.0 * worst / span));
}

std::string value_problem(const Column &column, double value) {
  if (std::fabs(value) <= column.limit)
    return {};
  return shortest(value) + " is out of range for " + std::string(column.name);
}

} // namespace ada
