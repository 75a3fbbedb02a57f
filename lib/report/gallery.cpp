// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/gallery.h"

#include "base/gnuplot.h"
#include "report/svg.h"

namespace ada {

// Escaped text holds no control characters, so this one marks a place beyond doubt.
constexpr char kMark = '\x01';

std::string Gallery::add(const Picture &picture) {
  pictures_.push_back(picture);
  return kMark + std::to_string(pictures_.size() - 1) + kMark;
}

std::string Gallery::place(const std::string &text) const {
  std::vector<std::string> scripts;
  for (const Picture &p : pictures_)
    scripts.push_back(p.script);
  const std::vector<std::string> drawings = draw(scripts);
  std::string out;
  std::size_t at = 0;
  for (std::size_t open = text.find(kMark); open != text.npos; open = text.find(kMark, at)) {
    const std::size_t close = text.find(kMark, open + 1);
    const std::size_t k = std::stoul(text.substr(open + 1, close - open - 1));
    out.append(text, at, open - at);
    out += inline_svg(drawings[k], pictures_[k].label);
    at = close + 1;
  }
  return out.append(text, at);
}

} // namespace ada
