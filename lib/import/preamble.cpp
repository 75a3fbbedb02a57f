// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/preamble.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "import/table.h"
#include "import/units.h"

namespace ada {

namespace {

/// Siglent and Tektronix; LabVIEW; Rigol, as a column and as "tInc = 1e-7"; Keysight.
constexpr std::string_view kIntervals[] = {"sample interval", "delta_x", "increment", "tinc",
                                           "xincrement", "x increment", "xinc"};
constexpr std::string_view kRates[] = {"sample rate", "sampling rate", "samplerate",
                                       "sampling frequency", "sample frequency"};

template <std::size_t N>
bool is_one_of(const std::string_view (&keys)[N], std::string_view text) {
  const auto end = text.find_first_of(":=(");
  const std::string key = folded(text.substr(0, end));
  return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
}

/// "Analog:0.000002", "= 1e-7", "2.0e-6": the number after the last sign that introduces one.
std::optional<double> value_in(std::string_view text, char decimal) {
  const auto sign = text.find_last_of(":=");
  return parse_decimal(folded(sign == text.npos ? text : text.substr(sign + 1)), decimal);
}

class Search {
public:
  Search(char separator, char decimal) : separator_(separator), decimal_(decimal) {}

  void line(std::string_view text) {
    split_cells(text, separator_, cells_);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const bool interval = is_one_of(kIntervals, cells_[i].text);
      if (interval || is_one_of(kRates, cells_[i].text))
        take(i, interval);
    }
    below_.clear();
    for (const TextCell &cell : cells_)
      below_.push_back(is_one_of(kIntervals, cell.text));
  }

  /// A line of numbers under a line of names, as Rigol writes start and increment.
  void numbers(std::string_view text) {
    split_cells(text, separator_, cells_);
    for (std::size_t i = 0; i < std::min(cells_.size(), below_.size()); ++i)
      if (const auto value = parse_decimal(cells_[i].text, decimal_); value && below_[i])
        add(*value, true);
  }

  std::optional<double> rate() const { return agreed_ ? rate_ : std::nullopt; }

private:
  void take(std::size_t i, bool interval) {
    if (const auto inside = value_in(cells_[i].text, decimal_))
      return add(*inside, interval);
    for (std::size_t k = i + 1; k < cells_.size(); ++k)
      if (const auto value = value_in(cells_[k].text, decimal_))
        return add(*value, interval);
  }

  void add(double value, bool interval) {
    if (!(value > 0.0) || !std::isfinite(value))
      return;
    const double rate = interval ? 1.0 / value : value;
    // 1 / 4e-7 is 2500000 but for the last digits.
    const double whole = std::round(rate);
    const double nice = whole > 0.0 && std::fabs(rate - whole) < 1e-9 * rate ? whole : rate;
    agreed_ = agreed_ && (!rate_ || std::fabs(*rate_ - nice) < 1e-9 * nice);
    rate_ = nice;
  }

  char separator_, decimal_;
  std::vector<TextCell> cells_;
  std::vector<bool> below_;
  std::optional<double> rate_;
  bool agreed_ = true;
};

} // namespace

std::optional<double> preamble_rate(const std::vector<std::string> &lines, std::size_t first_row,
                                    char separator, char decimal) {
  Search search(separator, decimal);
  for (std::size_t i = 0; i < first_row; ++i) {
    search.numbers(lines[i]);
    search.line(lines[i]);
  }
  return search.rate();
}

} // namespace ada
