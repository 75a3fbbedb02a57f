// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Collects the pictures of a page while it is written, and draws them all in one run of gnuplot.
#pragma once

#include <string>
#include <vector>

#include "report/pictures.h"

namespace ada {

class Gallery {
public:
  /// What stands for the picture in the text until place().
  std::string add(const Picture &picture);
  /// The text with every drawing in its place.
  std::string place(const std::string &text) const;

private:
  std::vector<Picture> pictures_;
};

} // namespace ada
