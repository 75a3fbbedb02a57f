// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/numpy_file.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

constexpr std::size_t kLongestHeader = kNumpyHead - 12, kMostFields = 256;

/// The dictionary as numpy writes it: {'descr': ..., 'fortran_order': ..., 'shape': (...), }.
class Header {
public:
  Header(std::string_view text, std::size_t begin, const std::string &shown)
      : text_(text), begin_(begin), shown_(shown) {}

  NumpyArray parse() {
    expect('{');
    while (!accept('}')) {
      const std::string key = quoted();
      expect(':');
      if (key == "descr")
        descr();
      else if (key == "fortran_order")
        out_.fortran_order = truth();
      else if (key == "shape")
        shape();
      else
        fail("the key " + excerpt(key) + " is not known");
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (out_.fields.empty() || !shape_seen_)
      fail("the header lacks descr or shape");
    return std::move(out_);
  }

private:
  [[noreturn]] void fail(const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT,
                shown_ + ": byte " + std::to_string(begin_ + at_) + ": " + what);
  }

  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t'))
      ++at_;
  }
  bool accept(char c) {
    skip_blanks();
    if (at_ == text_.size() || text_[at_] != c)
      return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c))
      fail(std::string("expected '") + c + "' in the header");
  }

  std::string quoted() {
    skip_blanks();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    const auto end = text_.find(quote, at_ + 1);
    if ((quote != '\'' && quote != '"') || end == text_.npos)
      fail("expected a string in the header");
    const std::string out(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return out;
  }

  bool truth() {
    skip_blanks();
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return word == "True";
      }
    fail("expected True or False in the header");
  }

  std::size_t number() {
    skip_blanks();
    std::size_t value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc())
      fail("expected a number in the header");
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  void shape() {
    shape_seen_ = true;
    expect('(');
    while (!accept(')')) {
      out_.shape.push_back(number());
      if (out_.shape.size() > 2)
        fail("an array of more than two dimensions cannot be imported");
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
  }

  void descr() {
    skip_blanks();
    if (at_ < text_.size() && text_[at_] != '[')
      return add_field({});
    expect('[');
    while (!accept(']')) {
      expect('(');
      const std::string name = quoted();
      expect(',');
      add_field(name);
      expect(')');
      if (!accept(',')) {
        expect(']');
        break;
      }
    }
  }

  void add_field(const std::string &name) {
    const std::size_t place = at_;
    const std::string text = quoted();
    NumpyType type;
    const bool known = text.size() == 3 && std::string_view("<>|=").find(text[0]) != std::string_view::npos &&
                       std::string_view("fiu").find(text[1]) != std::string_view::npos;
    type.kind = known ? text[1] : '\0';
    type.bytes = known ? static_cast<std::size_t>(text[2] - '0') : 0;
    type.big_endian = known && (text[0] == '>' || (text[0] == '=' && std::endian::native == std::endian::big));
    const bool fits = type.kind == 'f' ? type.bytes == 4 || type.bytes == 8
                                       : type.bytes == 1 || type.bytes == 2 || type.bytes == 4 ||
                                             type.bytes == 8;
    if (!known || !fits || out_.fields.size() >= kMostFields) {
      at_ = place;
      fail("numbers of the type " + excerpt(text) +
           " cannot be imported: integers, and floating point of 4 or 8 bytes, can");
    }
    out_.fields.push_back({name, type, out_.record_bytes});
    out_.record_bytes += type.bytes;
  }

  std::string_view text_;
  std::size_t begin_;
  const std::string &shown_;
  std::size_t at_ = 0;
  bool shape_seen_ = false;
  NumpyArray out_;
};

template <class Word> double as_double(char kind, Word word) {
  if (kind == 'i')
    return static_cast<double>(static_cast<std::make_signed_t<Word>>(word));
  return static_cast<double>(word);
}

} // namespace

NumpyArray parse_numpy(std::span<const std::byte> head, std::size_t file_bytes,
                       const std::string &shown) {
  const std::string_view text(reinterpret_cast<const char *>(head.data()), head.size());
  const auto fail = [&](const std::string &what) {
    throw Error(ADA4571_ERROR_FORMAT, shown + ": " + what);
  };
  if (!text.starts_with(kNumpyMagic) || text.size() < 12)
    fail("this is no .npy file");
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(text[i])}; };
  const std::size_t version = byte(6), wide = version > 1;
  if (version < 1 || version > 3)
    fail("version " + std::to_string(version) + " of the .npy format is not known");
  std::size_t length = byte(8) | byte(9) << 8;
  if (wide)
    length |= byte(10) << 16 | byte(11) << 24;
  const std::size_t begin = wide ? 12 : 10;
  if (length > kLongestHeader || length > text.size() - begin)
    fail("the header is cut short, or longer than " + std::to_string(kLongestHeader) + " bytes");
  NumpyArray array = Header(text.substr(begin, length), begin, shown).parse();
  array.data_begin = begin + length;
  std::size_t left = (file_bytes - array.data_begin) / array.record_bytes;
  for (const std::size_t n : array.shape)
    left = n == 0 ? left : left / n;
  if (left == 0)
    fail("the data end before the array does");
  return array;
}

double numpy_number(const NumpyType &type, const std::byte *at) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < type.bytes; ++i) {
    const std::size_t place = type.big_endian ? type.bytes - 1 - i : i;
    word |= std::uint64_t{std::to_integer<std::uint8_t>(at[i])} << (8 * place);
  }
  if (type.kind == 'f')
    return type.bytes == 4 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(word))}
                           : std::bit_cast<double>(word);
  switch (type.bytes) {
  case 1:
    return as_double(type.kind, static_cast<std::uint8_t>(word));
  case 2:
    return as_double(type.kind, static_cast<std::uint16_t>(word));
  case 4:
    return as_double(type.kind, static_cast<std::uint32_t>(word));
  default:
    return as_double(type.kind, word);
  }
}

} // namespace ada
