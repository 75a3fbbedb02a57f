// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The scan element of Linux IIO: how one channel lies in a frame of raw bytes, and how it becomes
// volts. Pure functions; nothing here knows libiio.
//
// The kernel writes a format as "[be|le]:[s|u]BITS/STORAGE[Xrepeat][>>SHIFT]": the value is the
// STORAGE-bit word, shifted right by SHIFT, of which the lowest BITS count (Documentation/ABI/
// testing/sysfs-bus-iio, scan_elements/<type>_type). Capital S and U say that the bits above are
// already sign or zero extended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

struct ScanFormat {
  unsigned bits = 16;    ///< significant bits, 1 to 64
  unsigned storage = 16; ///< bits of the word in memory: 8, 16, 32 or 64
  unsigned shift = 0;    ///< right shift before the significant bits
  unsigned repeat = 1;   ///< words of this channel in one frame; a power of two
  bool is_signed = false;
  bool big_endian = false;

  unsigned word_bytes() const { return storage / 8; }
  unsigned element_bytes() const { return word_bytes() * repeat; }

  bool operator==(const ScanFormat &) const = default;
};

/// Reads "le:s12/16>>4" and its kind. Throws ADA4571_ERROR_FORMAT naming `text`.
ScanFormat parse_scan_format(std::string_view text);

/// The same text as the kernel would write it.
std::string to_string(const ScanFormat &format);

/// Throws ADA4571_ERROR_UNSUPPORTED, naming `channel`, for a format that no driver can mean.
void validate(const ScanFormat &format, std::string_view channel);

/// volts = (raw + offset) * scale_v. IIO states the scale of a voltage in millivolts a count, so
/// scale_v is a thousandth of the sysfs value.
struct LinearScale {
  double offset = 0.0;
  double scale_v = 1.0;

  bool operator==(const LinearScale &) const = default;
};

/// Byte offsets of the elements of one frame and the bytes of the frame. The kernel aligns each
/// element to its own size (all repetitions together) and the frame to the largest of them
/// (iio_compute_scan_bytes). Computed here and not asked from libiio, because the sample size of
/// libiio up to 0.24 leaves out the second step.
struct FrameLayout {
  std::vector<std::size_t> offsets; ///< one an element, in the order given
  std::size_t frame_bytes = 0;
};

/// `elements` in the order of their scan index.
FrameLayout compute_layout(std::span<const ScanFormat> elements);

/// Decodes one channel of a block of frames, chosen once by format: no branch on the format and no
/// allocation a sample.
class ElementDecoder {
public:
  ElementDecoder() = default;
  /// Throws as validate() does.
  ElementDecoder(const ScanFormat &format, const LinearScale &scale, std::string_view channel);

  /// Volts of `count` elements, the first at `first`, each `stride` bytes after the last. Results
  /// go to out, out + out_stride, ... in doubles. A repeated element gives the mean of its words.
  void volts(const std::byte *first, std::size_t stride, std::size_t count, double *out,
             std::size_t out_stride) const {
    run_(*this, first, stride, count, out, out_stride);
  }

  /// The raw integer of word 0, as signed 64-bit; unsigned 64-bit words keep their bit pattern.
  std::int64_t raw(const std::byte *element) const { return raw_(*this, element); }

  const ScanFormat &format() const { return format_; }
  const LinearScale &scale() const { return scale_; }

private:
  template <class Word, bool Swap, bool Signed> struct Kernel;
  using Run = void (*)(const ElementDecoder &, const std::byte *, std::size_t, std::size_t,
                       double *, std::size_t);
  using Raw = std::int64_t (*)(const ElementDecoder &, const std::byte *);

  template <class Word> void choose();

  ScanFormat format_;
  LinearScale scale_;
  Run run_ = nullptr;
  Raw raw_ = nullptr;
};

} // namespace ada
