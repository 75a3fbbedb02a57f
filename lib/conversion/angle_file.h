// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Angles as a file: text, or SigMF with angle_deg, radius and status as 32-bit floats. Blocks are
// brought into the form of the file by any thread, and written in order.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "conversion/block_converter.h"
#include "conversion/raw_converter.h"

namespace ada {

class AngleFile {
public:
  /// The bytes of one block, and their checksum where the file has one.
  struct Bytes {
    std::vector<char> bytes, floats; ///< floats: on their way into bytes
    std::uint32_t crc32 = 0;
  };

  virtual ~AngleFile() = default;
  virtual bool holds_times() const = 0;
  /// Any thread, several at once.
  virtual void encode(const AngleBlock &angles, Bytes &out) const = 0;
  /// Takes the bytes of a block that follows the last one; leaves others in their place, for their
  /// memory.
  virtual void write(Bytes &bytes) = 0;
  /// The file appears, whole.
  virtual void finish() = 0;
};

/// time_s,angle_deg,radius,status; `range_deg` is 360/p. "-" is standard output.
std::unique_ptr<AngleFile> open_angle_text(const std::string &path, double range_deg);

/// Regular times are told by the sample rate and the segments, others by a channel of doubles
/// beside the floats. The metadata is that of the recording, which must outlive the file.
std::unique_ptr<AngleFile> open_angle_sigmf(const std::string &path, const Recording &recording);

/// Text or SigMF; by_name: SigMF where the path says so.
enum class AngleForm { by_name, text, sigmf };

/// Called with the part that is done; ends the work by throwing.
using AngleProgress = std::function<void(double)>;

/// Writes the angles of a recording by a model; the file appears only when it is whole.
void save_angles(const Model &model, const Recording &recording, const std::string &path,
                 AngleForm form, const AngleProgress &progress);

/// The same of a converter that must see all frames in their order.
using FrameConversion = std::function<void(std::span<const Frame>, std::span<ada4571_angle>)>;
void save_angles(const FrameConversion &convert, double range_deg, const Recording &recording,
                 const std::string &path, AngleForm form, const AngleProgress &progress);

} // namespace ada
