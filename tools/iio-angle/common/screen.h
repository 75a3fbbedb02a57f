// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The terminal as a grid of characters, by ncurses. What is written to standard error meanwhile
// waits until the terminal is given back, when it is the same terminal.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace cli {

enum class Style { plain, faint, strong, good, bad, accent };

class Screen {
public:
  static constexpr int kNoKey = -1, kResized = -2;

  /// Whether standard output is a terminal that can be drawn on, as far as its name tells.
  static bool is_there();
  /// Takes the terminal over; null where it is none or cannot be drawn on.
  static std::unique_ptr<Screen> open();
  ~Screen();
  Screen(const Screen &) = delete;
  Screen &operator=(const Screen &) = delete;

  int rows() const;
  int columns() const;
  /// Whether it shows characters beyond ASCII.
  bool unicode() const { return unicode_; }

  void clear();
  /// What does not fit is cut off.
  void put(int row, int column, std::string_view text, Style style = Style::plain);
  void show();
  /// The key that was pressed, kResized, or kNoKey; does not wait.
  int key();
  /// The last line that was meant for standard error.
  std::string last_remark() const;

private:
  struct Terminal;
  explicit Screen(std::unique_ptr<Terminal> terminal);

  std::unique_ptr<Terminal> terminal_;
  bool unicode_ = false;
};

} // namespace cli
