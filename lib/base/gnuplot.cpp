// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/gnuplot.h"

#include <fmt/format.h>

#include "base/child_process.h"
#include "base/error.h"

namespace ada {

namespace {

ChildResult run(const std::string &script, int timeout_ms) {
  try {
    // -d: not the user's own start-up files.
    return run_child("gnuplot", {"-d"}, script, {.timeout_ms = timeout_ms});
  } catch (const Error &e) {
    if (e.status() != ADA4571_ERROR_NOT_FOUND)
      throw;
    throw Error(ADA4571_ERROR_NOT_FOUND,
                "plots need the program gnuplot, which is not in PATH (Debian: gnuplot-nox)");
  }
}

/// What gnuplot complains of, on one line.
std::string complaint(const std::string &err) {
  std::string out;
  for (char c : err) {
    const bool blank = c == '\n' || c == '\t' || c == ' ';
    if (!blank || (!out.empty() && out.back() != ' '))
      out += blank ? ' ' : (c >= 0x20 && c < 0x7f ? c : '?');
  }
  if (out.empty())
    return "it says nothing";
  return out.size() > 300 ? out.substr(0, 300) + "..." : out;
}

} // namespace

std::string gnuplot_quoted(std::string_view text) {
  std::string out = "'";
  for (char c : text) {
    if (c == '\'')
      out += "''";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return out + "'";
}

std::vector<std::string> draw(const std::vector<std::string> &scripts, int timeout_ms) {
  if (scripts.empty())
    return {};
  std::string all;
  for (const std::string &script : scripts)
    all += "reset\n" + script + "\nset output\n"; // closes the document on standard output
  const ChildResult result = run(all, timeout_ms);

  std::vector<std::string> drawn;
  const std::string_view out = result.out;
  for (std::size_t at = out.find("<svg"); at != out.npos; at = out.find("<svg", at)) {
    const std::size_t end = out.find("</svg>", at);
    if (end == out.npos)
      break;
    drawn.emplace_back(out.substr(at, end + 6 - at));
    at = end;
  }
  if (drawn.size() != scripts.size() || result.exit_status > 0)
    throw Error(ADA4571_ERROR_IO, fmt::format("gnuplot drew {} of {} plots: {}", drawn.size(),
                                              scripts.size(), complaint(result.err)));
  return drawn;
}

} // namespace ada
