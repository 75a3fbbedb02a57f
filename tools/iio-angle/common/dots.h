// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Drawings of dots in characters: two by four dots each, in Braille, or in ASCII by halves.
#pragma once

#include <string>
#include <vector>

namespace cli {

class Dots {
public:
  static constexpr int kAcross = 2, kDown = 4; ///< dots of a character

  Dots(int rows, int columns, bool unicode)
      : rows_(rows), columns_(columns), unicode_(unicode),
        cells_(static_cast<std::size_t>(rows * columns), 0) {}

  int width() const { return columns_ * kAcross; }
  int height() const { return rows_ * kDown; }
  /// From the upper left; what lies outside is left out.
  void set(int x, int y);
  void line(double x0, double y0, double x1, double y1);
  /// The character at a place, empty where it has no dot.
  std::string at(int row, int column) const;

private:
  int rows_, columns_;
  bool unicode_;
  std::vector<unsigned char> cells_; ///< bits as in Braille
};

} // namespace cli
