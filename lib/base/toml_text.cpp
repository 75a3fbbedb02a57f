// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/toml_text.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/error.h"
#include "base/utf8.h"

namespace ada {

namespace {

bool is_ascii(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

/// Of brackets within one another, and of dots in one key. This project's files need two; toml++
/// calls itself for each, and what the stack of a caller's thread holds is not known here.
constexpr std::size_t kDeepest = 16;

class LineConverter {
public:
  /// `open` brackets are those of the lines before.
  LineConverter(std::string_view line, std::size_t open) : line_(line), open_(open) {}

  std::string convert() {
    while (at_ < line_.size() && problem == nullptr)
      step();
    return std::move(out_);
  }

  const char *problem = nullptr;
  std::size_t column() const { return at_ + 1; }
  std::size_t open() const { return open_; }

private:
  /// From a place outside of strings and comments.
  void step() {
    const char c = line_[at_];
    if (!is_ascii(c)) {
      problem = "a letter beyond ASCII must stand in double quotes";
    } else if (c == '#') {
      for (; at_ < line_.size(); ++at_)
        out_ += is_ascii(line_[at_]) ? line_[at_] : '?';
    } else if (c != '"' && c != '\'') {
      count(c);
      if (problem == nullptr)
        take();
    } else if (line_.substr(at_, 3) == std::string(3, c)) {
      problem = "strings of several lines are not supported";
    } else {
      string(c);
    }
  }

  void count(char c) {
    if (c == '.')
      ++dots_;
    else if (std::string_view("=,[]{}").find(c) != std::string_view::npos)
      dots_ = 0; // another key, or a number
    if (c == '[' || c == '{')
      ++open_;
    else if ((c == ']' || c == '}') && open_ > 0)
      --open_;
    if (open_ > kDeepest || dots_ > kDeepest)
      problem = "brackets or dotted keys are nested too deeply for any file of this kind";
  }

  void string(char quote) {
    take();
    while (at_ < line_.size() && line_[at_] != quote && problem == nullptr) {
      if (!is_ascii(line_[at_])) {
        escape(quote);
        continue;
      }
      const bool escaped = quote == '"' && line_[at_] == '\\';
      take();
      if (escaped && at_ < line_.size() && is_ascii(line_[at_]))
        take();
    }
    if (problem == nullptr && at_ < line_.size())
      take();
  }

  void escape(char quote) {
    const Utf8Character character = utf8_at(line_, at_);
    if (character.bytes == 0 || quote == '\'') {
      problem = character.bytes == 0 ? "this is no UTF-8"
                                     : "a letter beyond ASCII must stand in double quotes";
      return;
    }
    std::array<char, 16> text;
    std::snprintf(text.data(), text.size(), "\\U%08x", static_cast<unsigned>(character.code));
    out_ += text.data();
    at_ += character.bytes;
  }

  void take() { out_ += line_[at_++]; }

  std::string_view line_;
  std::size_t at_ = 0;
  std::size_t open_, dots_ = 0;
  std::string out_;
};

} // namespace

std::string ascii_toml(std::string_view text, const std::string &shown) {
  if (constexpr std::string_view kMark = "\xEF\xBB\xBF"; text.substr(0, kMark.size()) == kMark)
    text.remove_prefix(kMark.size());
  std::string out;
  std::size_t open = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
    text.remove_prefix(line.size());
    LineConverter converter(line, open);
    out += converter.convert();
    open = converter.open();
    if (converter.problem)
      throw Error(ADA4571_ERROR_FORMAT, shown + ":" + std::to_string(number) + ":" +
                                            std::to_string(converter.column()) + ": " +
                                            converter.problem);
  }
  return out;
}

} // namespace ada
