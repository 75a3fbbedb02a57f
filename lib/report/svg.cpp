// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/svg.h"

#include <array>
#include <sstream>

#include "base/error.h"

namespace ada {

namespace {

constexpr std::array kNames = {"ink",      "muted", "grid", "before", "after",
                               "measured", "floor", "pale", "second"};

/// Replaces every piece from `open` to the next `close`, both included, by nothing.
void cut(std::string &text, std::string_view open, std::string_view close) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const std::size_t from = text.find(open, at);
    const std::size_t to = from == text.npos ? text.npos : text.find(close, from + open.size());
    if (to == text.npos)
      break;
    out.append(text, at, from - at);
    at = to + close.size();
  }
  out.append(text, at);
  text = std::move(out);
}

void replace(std::string &text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

/// "rgb(  4,   4,   4)" and "rgb(4,4,4)" to "var(--before)".
void name_colours(std::string &text) {
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const std::string n = std::to_string(k + 1), by = std::string("var(--") + kNames[k] + ")";
    replace(text, "rgb(  " + n + ",   " + n + ",   " + n + ")", by);
    replace(text, "rgb(" + n + "," + n + "," + n + ")", by);
  }
}

/// Third number of a viewBox: the style sheet sizes text by how wide a picture was drawn.
std::string width_of(const std::string &view) {
  std::istringstream numbers(view.substr(view.find('"') + 1));
  int x = 0, y = 0, width = 0;
  if (!(numbers >> x >> y >> width))
    throw Error(ADA4571_ERROR_IO, "gnuplot's output is no picture");
  return std::to_string(width);
}

/// Groups that hold nothing: gnuplot opens one for each change of pen.
void drop_empty_groups(std::string &text) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const std::size_t close = text.find(">\n</g>\n", at);
    const std::size_t open = close == text.npos ? text.npos : text.rfind('<', close);
    if (open == text.npos)
      break;
    if (open >= at && text.compare(open, 3, "<g ") == 0) {
      out.append(text, at, open - at);
      at = close + 7;
    } else {
      out.append(text, at, close + 1 - at);
      at = close + 1;
    }
  }
  out.append(text, at);
  text = std::move(out);
}

} // namespace

std::string html_escape(std::string_view text) {
  std::string out;
  for (char c : text)
    switch (c) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '>':
      out += "&gt;";
      break;
    case '"':
      out += "&quot;";
      break;
    case '\'':
      out += "&#39;";
      break;
    default:
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    }
  return out;
}

std::string inline_svg(std::string_view drawing, std::string_view label) {
  const std::size_t head = drawing.find('>');
  const std::size_t box = drawing.find("viewBox=\"");
  if (head == drawing.npos || box == drawing.npos || drawing.find('"', box + 9) == drawing.npos)
    throw Error(ADA4571_ERROR_IO, "gnuplot's output is no picture");
  const std::string view(drawing.substr(box, drawing.find('"', box + 9) + 1 - box));
  std::string body(drawing.substr(head + 1));
  cut(body, "<defs>", "</defs>");
  cut(body, "<title>", "</title>");
  cut(body, "<desc>", "</desc>");
  cut(body, " id=\"", "\"");
  cut(body, " font-family=\"", "\"");
  cut(body, " class=\"", "\"");
  replace(body, " stroke-linecap=\"butt\" stroke-linejoin=\"miter\"", "");
  replace(body, " color=\"black\"", "");
  replace(body, " color=\"white\"", "");
  replace(body, " color=\"gray\"", "");
  replace(body, "xlink:href", "href");
  drop_empty_groups(body);
  name_colours(body);
  return "<svg class=\"w" + width_of(view) + "\" " + view + " role=\"img\" aria-label=\"" +
         html_escape(label) + "\">" + body;
}

std::string svg_marks() {
  return "<svg class=\"marks\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs>"
         "<circle id=\"gpDot\" r=\"0.5\" stroke-width=\"0.5\" stroke=\"currentColor\"/>"
         "<circle id=\"gpPt5\" r=\"1\" stroke-width=\"0.4\" stroke=\"currentColor\" fill=\"none\"/>"
         "<circle id=\"gpPt6\" r=\"1\" fill=\"currentColor\" stroke=\"none\"/>"
         "</defs></svg>\n";
}

} // namespace ada
