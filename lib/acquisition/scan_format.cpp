// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/scan_format.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <type_traits>

#include "base/columns_of_numbers.h"
#include "base/error.h"

namespace ada {

namespace {

[[noreturn]] void refuse_text(std::string_view text, const char *why) {
  throw Error(ADA4571_ERROR_FORMAT, "scan format \"" + std::string(text.substr(0, 64)) +
                                        "\": " + why + "; expected for example \"le:s12/16>>4\"");
}

/// Takes a decimal number off the front of `rest`.
unsigned take_number(std::string_view &rest, std::string_view text, const char *why) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc{} || value > 4096)
    refuse_text(text, why);
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return value;
}

bool take(std::string_view &rest, std::string_view prefix) {
  if (!rest.starts_with(prefix))
    return false;
  rest.remove_prefix(prefix.size());
  return true;
}

template <class Word> Word load(const std::byte *p) {
  Word word;
  std::memcpy(&word, p, sizeof word);
  return word;
}

template <class Word> Word swap_bytes(Word word) {
  if constexpr (sizeof(Word) == 8)
    return __builtin_bswap64(word);
  else if constexpr (sizeof(Word) == 4)
    return __builtin_bswap32(word);
  else if constexpr (sizeof(Word) == 2)
    return __builtin_bswap16(word);
  else
    return word;
}

} // namespace

ScanFormat parse_scan_format(std::string_view text) {
  ScanFormat format;
  std::string_view rest = text;
  while (!rest.empty() && (rest.back() == '\n' || rest.back() == '\0' || rest.back() == ' '))
    rest.remove_suffix(1);

  if (take(rest, "be:"))
    format.big_endian = true;
  else if (!take(rest, "le:"))
    refuse_text(text, "it does not begin with \"le:\" or \"be:\"");

  if (take(rest, "s") || take(rest, "S"))
    format.is_signed = true;
  else if (!take(rest, "u") && !take(rest, "U"))
    refuse_text(text, "no sign \"s\" or \"u\"");

  format.bits = take_number(rest, text, "no number of bits");
  if (!take(rest, "/"))
    refuse_text(text, "no \"/\" after the bits");
  format.storage = take_number(rest, text, "no number of storage bits");
  if (take(rest, "X"))
    format.repeat = take_number(rest, text, "no number after \"X\"");
  if (take(rest, ">>"))
    format.shift = take_number(rest, text, "no number after \">>\"");
  if (!rest.empty())
    refuse_text(text, "unexpected text at the end");
  return format;
}

std::string to_string(const ScanFormat &format) {
  std::string text = format.big_endian ? "be:" : "le:";
  text += format.is_signed ? 's' : 'u';
  text += std::to_string(format.bits) + "/" + std::to_string(format.storage);
  if (format.repeat > 1)
    text += "X" + std::to_string(format.repeat);
  return text + ">>" + std::to_string(format.shift);
}

void validate(const ScanFormat &format, std::string_view channel) {
  const auto refuse = [&](const char *why) {
    throw Error(ADA4571_ERROR_UNSUPPORTED, "channel " + std::string(channel) + ": scan format " +
                                               to_string(format) + " has " + why);
  };
  const unsigned storage = format.storage;
  if (storage != 8 && storage != 16 && storage != 32 && storage != 64)
    refuse("a storage that is not 8, 16, 32 or 64 bits");
  if (format.bits < 1 || format.bits > storage || format.shift > storage - format.bits)
    refuse("bits that do not fit into their storage");
  if (format.repeat < 1 || format.repeat > 64 || !std::has_single_bit(format.repeat))
    refuse("a repetition that is not a power of two up to 64");
}

FrameLayout compute_layout(std::span<const ScanFormat> elements) {
  FrameLayout layout;
  layout.offsets.reserve(elements.size());
  std::size_t position = 0, largest = 1;
  const auto align = [](std::size_t value, std::size_t to) { return (value + to - 1) / to * to; };
  for (const ScanFormat &element : elements) {
    const std::size_t bytes = std::max(1u, element.element_bytes());
    position = align(position, bytes);
    layout.offsets.push_back(position);
    position += bytes;
    largest = std::max(largest, bytes);
  }
  layout.frame_bytes = align(position, largest);
  return layout;
}

/// One instance a combination of word size, byte order and sign.
template <class Word, bool Swap, bool Signed> struct ElementDecoder::Kernel {
  using SignedWord = std::make_signed_t<Word>;

  /// Shift the unwanted high bits out to the left, then back: the right shift of a signed word
  /// extends the sign, that of an unsigned one fills with zeros.
  static auto value(const std::byte *p, unsigned left, unsigned right) {
    Word word = load<Word>(p);
    if constexpr (Swap)
      word = swap_bytes(word);
    word = static_cast<Word>(word << left);
    if constexpr (Signed)
      return static_cast<SignedWord>(static_cast<SignedWord>(word) >> right);
    else
      return static_cast<Word>(word >> right);
  }

  static unsigned left(const ScanFormat &f) { return f.storage - f.bits - f.shift; }
  static unsigned right(const ScanFormat &f) { return f.storage - f.bits; }

  static std::int64_t raw(const ElementDecoder &d, const std::byte *p) {
    return static_cast<std::int64_t>(value(p, left(d.format_), right(d.format_)));
  }

  static void run(const ElementDecoder &d, const std::byte *p, std::size_t stride,
                  std::size_t count, double *out, std::size_t out_stride) {
    const unsigned l = left(d.format_), r = right(d.format_);
    const double offset = d.scale_.offset, scale = d.scale_.scale_v;
    const unsigned repeat = d.format_.repeat;
    if constexpr (sizeof(Word) == 2 && !Swap)
      if (repeat == 1 && out_stride == 1 && has_vectors_for(stride)) {
        scaled_words16(p, stride, count, {Signed, l, r}, offset, scale, out);
        return;
      }
    if (repeat == 1) {
      for (std::size_t i = 0; i < count; ++i, p += stride, out += out_stride)
        *out = (static_cast<double>(value(p, l, r)) + offset) * scale;
      return;
    }
    for (std::size_t i = 0; i < count; ++i, p += stride, out += out_stride) {
      double sum = 0.0;
      for (unsigned k = 0; k < repeat; ++k)
        sum += static_cast<double>(value(p + k * sizeof(Word), l, r));
      *out = (sum / repeat + offset) * scale;
    }
  }
};

template <class Word> void ElementDecoder::choose() {
  const bool swap = format_.big_endian != (std::endian::native == std::endian::big);
  const auto set = [this](auto kernel) {
    run_ = &decltype(kernel)::run;
    raw_ = &decltype(kernel)::raw;
  };
  if (format_.is_signed && swap)
    set(Kernel<Word, true, true>{});
  else if (format_.is_signed)
    set(Kernel<Word, false, true>{});
  else if (swap)
    set(Kernel<Word, true, false>{});
  else
    set(Kernel<Word, false, false>{});
}

ElementDecoder::ElementDecoder(const ScanFormat &format, const LinearScale &scale,
                               std::string_view channel)
    : format_(format), scale_(scale) {
  validate(format, channel);
  switch (format.storage) {
  case 8:
    choose<std::uint8_t>();
    break;
  case 16:
    choose<std::uint16_t>();
    break;
  case 32:
    choose<std::uint32_t>();
    break;
  default:
    choose<std::uint64_t>();
    break;
  }
}

} // namespace ada
