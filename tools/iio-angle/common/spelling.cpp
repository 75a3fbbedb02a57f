// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/spelling.h"

#include <algorithm>
#include <utility>

namespace cli {

namespace {

constexpr std::size_t kMost = 3;
constexpr std::size_t kShortestPart = 4; ///< shorter ones are a part of too many words

/// How far `word` is from `known`, 0 best; anything above `limit` is no suggestion.
std::size_t distance(std::string_view word, std::string_view known, std::size_t limit) {
  if (word.size() > 1 && known.starts_with(word))
    return 0;
  const std::size_t edits = edit_distance(word, known);
  const bool part = word.size() >= kShortestPart && known.find(word) != known.npos;
  return part ? std::min(edits, limit) : edits;
}

} // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the table: a swap looks back two.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] != b[j - 1]);
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

std::vector<std::string> nearest(std::string_view word, const std::vector<std::string> &known) {
  constexpr std::size_t kLongest = 100; // a longer one is no slip of the hand
  const std::size_t letters = word.size() - std::min(word.find_first_not_of('-'), word.size());
  if (word.size() > kLongest || letters < 2)
    return {};
  const std::size_t limit = std::clamp<std::size_t>(word.size() / 3, 1, 3);
  std::vector<std::pair<std::size_t, std::string>> found;
  for (const std::string &candidate : known)
    if (const std::size_t d = distance(word, candidate, limit); d <= limit)
      found.emplace_back(d, candidate);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto &a, const auto &b) { return a.first < b.first; });
  std::vector<std::string> best;
  for (const auto &[d, candidate] : found)
    if (d == found.front().first && best.size() < kMost)
      best.push_back(candidate);
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string> &known,
                         const std::string &help) {
  const std::vector<std::string> best = nearest(word, known);
  std::string text;
  for (std::size_t i = 0; i < best.size(); ++i)
    text += (i == 0 ? "; did you mean '" : i + 1 == best.size() ? " or '" : ", '") + best[i] + "'";
  if (text.empty())
    return help.empty() ? "" : "; see `" + help + "`";
  return text + "?";
}

} // namespace cli
