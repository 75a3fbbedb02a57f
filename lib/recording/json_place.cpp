// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/json_place.h"

#include <algorithm>

namespace ada {

namespace {

/// Walks well-formed JSON; on anything else it stops early rather than past the end.
class Walker {
public:
  explicit Walker(std::string_view text) : text_(text) {}

  std::size_t find(const std::vector<std::string> &path) {
    blanks();
    std::size_t found = at_;
    for (const std::string &step : path) {
      if (!enter(step))
        break;
      found = at_;
    }
    return found;
  }

private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void blanks() {
    while (at_ < text_.size() &&
           std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }

  /// The text of the string that begins here, escapes left as they are.
  std::string_view string() {
    const std::size_t begin = ++at_;
    while (at_ < text_.size() && text_[at_] != '"')
      at_ += text_[at_] == '\\' ? 2 : 1;
    at_ = std::min(at_, text_.size());
    const auto inside = text_.substr(begin, at_ - begin);
    at_ = std::min(at_ + 1, text_.size());
    return inside;
  }

  /// Past the value that begins here, whatever its depth.
  void skip() {
    int depth = 0;
    do {
      const char c = peek();
      if (c == '"') {
        string();
      } else if (c == '{' || c == '[') {
        ++depth;
        ++at_;
      } else if (c == '}' || c == ']') {
        --depth;
        ++at_;
      } else if (depth == 0) {
        at_ = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
      } else {
        ++at_;
      }
    } while (depth > 0 && at_ < text_.size());
  }

  /// From the begin of an object or array to the value named `step`; false where there is none.
  bool enter(const std::string &step) {
    const char open = peek();
    if (open != '{' && open != '[')
      return false;
    ++at_;
    for (std::size_t index = 0; at_ < text_.size(); ++index) {
      blanks();
      if (peek() == '}' || peek() == ']')
        return false;
      bool wanted = open == '[' && step == std::to_string(index);
      if (open == '{') {
        wanted = string() == step;
        blanks();
        ++at_; // the colon
        blanks();
      }
      if (wanted)
        return true;
      skip();
      blanks();
      if (peek() != ',')
        return false;
      ++at_;
    }
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

} // namespace

TextPlace place_of_offset(std::string_view text, std::size_t offset) {
  const auto before = text.substr(0, offset);
  const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
  const auto newline = before.rfind('\n');
  return {line, newline == before.npos ? before.size() + 1 : before.size() - newline};
}

TextPlace place_in_json(std::string_view json, const std::vector<std::string> &path) {
  return place_of_offset(json, Walker(json).find(path));
}

} // namespace ada
