// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The rows of a study as columns: a number and a factor for each capture. Everything that follows
// reads these and knows neither files nor tables.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "study/database.h"

namespace ada::study {

/// A number over the captures that have it.
struct Column {
  std::string cause, parameter, unit;
  std::vector<std::size_t> capture; ///< ascending
  std::vector<double> value;
  std::vector<float> std_error; ///< of each value; NaN where unknown
  /// Whether it is a number that can be more or less: not a place that a search chose (an order, a
  /// moment), and not a direction that points everywhere.
  bool measured = true;
  bool amount = false; ///< cannot be negative
};

/// Words that come again and again, each kept once, by number; 0 is the empty one.
class Words {
public:
  Words() { number_of(""); }
  Words(Words &&) = default; // by move only: the index looks into the words
  Words &operator=(Words &&) = default;
  std::uint32_t number_of(const std::string &word);
  const std::string &operator[](std::uint32_t number) const { return words_[number]; }
  std::size_t size() const { return words_.size(); }

private:
  std::deque<std::string> words_;
  std::unordered_map<std::string_view, std::uint32_t> numbers_;
};

/// A key of the headers over all captures.
struct Factor {
  std::string key;
  bool numeric = false;
  std::vector<std::uint32_t> word{}; ///< of each row, 0 where its header does not have the key
  Words words{};                     ///< texts of numbers are kept while they are few
  std::vector<double> number{};      ///< of a numeric one, NaN where missing

  const std::string &text(std::size_t row) const { return words[word[row]]; }
};

/// A finding of a capture, with the fitted parameter of its cause that is known best. Names are
/// numbers of Fleet::names.
struct MemberFinding {
  std::uint32_t cause = 0, parameter = 0, unit = 0; ///< parameter 0: there is none
  bool correctable = false;
  double angle_rms_deg = 0.0; ///< NaN where unknown
  double value = 0.0, std_error = 0.0;
};

/// What is kept of a capture beside its columns and factors. A row of the database is several times
/// as large, and there may be a million.
struct Member {
  std::string capture, serial, report;
  std::string reason; ///< of a failure
  bool done = false, sound = false;
  double extended_angle_rms_deg = 0.0; ///< NaN where unknown
  double noise_angle_deg = 0.0; ///< what the noise of a sample makes of the angle, mechanical
  std::vector<MemberFinding> findings{};
  std::vector<std::uint32_t> failed_checks{}; ///< numbers of Fleet::names
  int periods = 0;
  std::vector<float> series{}; ///< the signature's values; half the size, 1e-7 of a volt

  bool has_signature() const { return periods > 0; }
  Signature signature() const { return {periods, {series.begin(), series.end()}}; }
};

struct Fleet {
  std::vector<Member> rows{};        ///< without those that wait, by name
  std::size_t waiting = 0;           ///< captures that were not done
  std::vector<std::size_t> done{};   ///< rows that were diagnosed
  std::vector<std::size_t> sensor{}; ///< of each row: number of its sensor
  std::size_t sensors = 0;
  bool diagnosed = true;         ///< whether the study has diagnoses at all
  Words names{};                 ///< of causes, parameters, units and checks
  std::vector<Column> columns{}; ///< by cause and parameter
  std::vector<Factor> factors{}; ///< by key; "order" is the order of measurement
};

/// Row by row, so that a study need not fit into memory as a whole.
Fleet read_fleet(const Database &database);
/// The same from rows, in whichever order.
Fleet make_fleet(std::vector<Row> rows, bool diagnosed);

/// Seconds since 1970 of an ISO 8601 date or date and time; NaN where it is none.
double seconds_of(const std::string &date);

/// Whether a name comes before another where digits count as numbers: ring-9 before ring-10.
bool naturally_before(const std::string &a, const std::string &b);

} // namespace ada::study
