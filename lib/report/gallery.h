// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Collects the pictures of a page while it is written, and draws them all in one run of gnuplot;
// one run a picture where that fails, so that a picture that cannot be drawn costs only itself.
#pragma once

#include <string>
#include <vector>

#include "report/pictures.h"

namespace ada {

class Gallery {
public:
  /// What stands for the picture in the text until place().
  std::string add(const Picture &picture);
  /// What stands for the sentence about pictures that could not be drawn; once in a page.
  static std::string notice();
  /// The text with every drawing in its place, or with the reason why it is missing. Throws nothing
  /// for gnuplot's sake.
  std::string place(const std::string &text) const;

private:
  struct Drawing {
    std::string svg, why_not; ///< one of them
  };
  std::vector<Drawing> drawn() const;

  std::vector<Picture> pictures_;
};

} // namespace ada
