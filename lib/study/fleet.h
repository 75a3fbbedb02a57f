// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The rows of a study as columns: a number and a factor for each capture. Everything that follows
// reads these and knows neither files nor tables.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "study/database.h"

namespace ada::study {

/// A number over the captures that have it.
struct Column {
  std::string cause, parameter, unit;
  std::vector<std::size_t> capture; ///< ascending
  std::vector<double> value;
  /// Whether it is a number that can be more or less: not a place that a search chose (an order, a
  /// moment), and not a direction that points everywhere.
  bool measured = true;
};

/// A key of the headers over all captures; "" where a header does not have it.
struct Factor {
  std::string key;
  bool numeric = false;
  std::vector<std::string> word;
  std::vector<double> number; ///< NaN where missing
};

struct Fleet {
  std::vector<Row> rows;           ///< without those that wait, by name
  std::size_t waiting = 0;         ///< captures that were not done
  std::vector<std::size_t> done;   ///< rows that were diagnosed
  std::vector<std::size_t> sensor; ///< of each row: number of its sensor
  std::size_t sensors = 0;
  bool diagnosed = true;       ///< whether the study has diagnoses at all
  std::vector<Column> columns; ///< by cause and parameter
  std::vector<Factor> factors; ///< by key; "order" is the order of measurement
};

Fleet read_fleet(const Database &database);
/// The same from rows, in whichever order.
Fleet make_fleet(std::vector<Row> rows, bool diagnosed);

/// Seconds since 1970 of an ISO 8601 date or date and time; NaN where it is none.
double seconds_of(const std::string &date);

/// Whether a name comes before another where digits count as numbers: ring-9 before ring-10.
bool naturally_before(const std::string &a, const std::string &b);

} // namespace ada::study
