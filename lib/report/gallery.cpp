// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/gallery.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

#include "base/error.h"
#include "base/gnuplot.h"
#include "report/svg.h"

namespace ada {

namespace {

// Escaped text holds no control characters, so these mark a place beyond doubt.
constexpr char kMark = '\x01', kNotice = '\x02';
constexpr std::string_view kMarks = "\x01\x02";

/// For one picture, and for all of them where they are drawn one by one: some take 20 ms.
constexpr int kOneMs = 20000, kAllMs = 60000;

std::string notice_of(std::size_t failed, std::size_t all, const std::string &why) {
  if (failed == 0)
    return {};
  const std::string what = failed == all ? "This page has no plots: " + why + "."
                                         : fmt::format("{} of {} plots could not be drawn; the "
                                                       "reason stands in their place.",
                                                       failed, all);
  return "<p class=\"notice\" id=\"plots-missing\">" + html_escape(what) +
         " Everything else is complete.</p>\n";
}

} // namespace

std::string Gallery::add(const Picture &picture) {
  pictures_.push_back(picture);
  return kMark + std::to_string(pictures_.size() - 1) + kMark;
}

std::string Gallery::notice() {
  return std::string(1, kNotice);
}

std::vector<Gallery::Drawing> Gallery::drawn() const {
  std::vector<std::string> scripts;
  for (const Picture &p : pictures_)
    scripts.push_back(p.script);
  std::vector<Drawing> out(scripts.size());
  try {
    const std::vector<std::string> drawings = draw(scripts);
    for (std::size_t k = 0; k < out.size(); ++k)
      out[k].svg = inline_svg(drawings[k], pictures_[k].label);
    return out;
  } catch (const Error &e) {
    out.assign(scripts.size(), {{}, e.what()});
    if (e.status() == ADA4571_ERROR_NOT_FOUND)
      return out;
  }
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::milliseconds(kAllMs);
  for (std::size_t k = 0; k < out.size() && Clock::now() < end; ++k)
    try {
      out[k] = {inline_svg(draw({scripts[k]}, kOneMs).front(), pictures_[k].label), {}};
    } catch (const Error &e) {
      out[k].why_not = e.what();
    }
  return out;
}

std::string Gallery::place(const std::string &text) const {
  const std::vector<Drawing> drawings = drawn();
  const auto is_missing = [](const Drawing &d) { return d.svg.empty(); };
  const auto failed =
      static_cast<std::size_t>(std::count_if(drawings.begin(), drawings.end(), is_missing));
  // One reason for all stands at the top of the page.
  const bool one_reason = failed == drawings.size() &&
                          std::all_of(drawings.begin(), drawings.end(), [&](const auto &d) {
                            return d.why_not == drawings.front().why_not;
                          });
  std::string out;
  std::size_t at = 0;
  for (std::size_t open = text.find_first_of(kMarks); open != text.npos;
       open = text.find_first_of(kMarks, at)) {
    out.append(text, at, open - at);
    if (text[open] == kNotice) {
      out += notice_of(failed, drawings.size(), failed > 0 ? drawings.front().why_not : "");
      at = open + 1;
      continue;
    }
    const std::size_t close = text.find(kMark, open + 1);
    const std::size_t k = std::stoul(text.substr(open + 1, close - open - 1));
    at = close + 1;
    if (!is_missing(drawings[k]))
      out += drawings[k].svg;
    else
      out += "<p class=\"undrawn\"><b>Not drawn" +
             (one_reason ? ".</b>" : ":</b> " + html_escape(drawings[k].why_not) + ".") +
             " It would show: " + html_escape(pictures_[k].label) + ".</p>";
  }
  return out.append(text, at);
}

} // namespace ada
