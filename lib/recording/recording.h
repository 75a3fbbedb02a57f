// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A recording that is read block by block, wherever it is: in memory, in a SigMF data file, or in a
// text file, of which blocks are parsed in place. What it holds beside its blocks does not grow
// with its length.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ada4571.h"
#include "base/file_bytes.h"
#include "recording/block.h"
#include "recording/capture.h"
#include "recording/columns.h"

namespace ada {

/// Neighbouring 16-bit numbers of VSIN and VCOS, in the machine's order and of one scale.
struct RawPairs {
  BytesRead frames; ///< of four bytes
  ada4571_layout layout;
  bool cos_first;

  const std::byte *data() const { return std::span<const std::byte>(frames).data(); }
  const std::byte *sin() const { return data() + (cos_first ? 2 : 0); }
  const std::byte *cos() const { return data() + (cos_first ? 0 : 2); }
};

/// Immutable once made; every function may be called by several threads at once.
class Recording {
public:
  virtual ~Recording() = default;
  Recording(const Recording &) = delete;
  Recording &operator=(const Recording &) = delete;

  /// Metadata and notes; the columns are empty.
  const Capture &facts() const { return facts_; }
  const CaptureMetadata &meta() const { return facts_.meta; }
  const ChannelSet &channels() const { return channels_; }
  std::size_t size() const { return size_; }
  double first_time_s() const { return first_time_s_; }
  double last_time_s() const { return last_time_s_; }
  /// Whether time is that of the sample rate everywhere but at the gaps.
  bool regular() const { return regular_; }

  /// Blocks are fixed by the recording: the same whatever reads them.
  virtual std::size_t blocks() const = 0;
  /// First sample of a block; the size for blocks().
  virtual std::size_t block_begin(std::size_t block) const = 0;
  /// `count` samples from `offset` on of a block, as far as it has them.
  virtual void read(std::size_t block, std::size_t offset, std::size_t count, ColumnMask wanted,
                    Block &out) const = 0;
  void read(std::size_t block, ColumnMask wanted, Block &out) const {
    read(block, 0, size_, wanted, out);
  }

  /// The pairs of a block as the converter gave them; nothing where they are kept in another form.
  virtual std::optional<RawPairs> raw_pairs(std::size_t) const { return std::nullopt; }

  /// The block that holds a sample.
  std::size_t block_of(std::size_t sample) const;
  /// Time of one sample.
  double time_s(std::size_t sample) const;
  /// Samples before which others are missing by their times alone (GapDetector), beside
  /// facts().gaps.
  virtual const std::vector<std::size_t> &jumps() const;
  /// Checksum of the content; worked out when it is first asked for.
  const std::string &identity() const;
  /// All of it in memory, made when it is first asked for.
  virtual std::shared_ptr<const Capture> whole() const;

protected:
  Recording() = default;
  /// Without the cache of whole().
  Capture materialise() const;

  Capture facts_;
  ChannelSet channels_;
  std::size_t size_ = 0;
  double first_time_s_ = 0, last_time_s_ = 0;
  bool regular_ = false;

private:
  mutable std::once_flag once_jumps_, once_identity_, once_whole_;
  mutable std::vector<std::size_t> jumps_;
  mutable std::string identity_;
  mutable std::shared_ptr<const Capture> whole_;
};

/// A capture in memory as one block.
std::shared_ptr<const Recording> recording_of(std::shared_ptr<const Capture> capture);
/// The same of a capture that outlives it.
std::shared_ptr<const Recording> recording_of(const Capture &capture);

/// Opens and validates a file of either form, as read_capture does, without holding it in memory;
/// "-" and whatever else is no regular file is read into memory.
std::shared_ptr<const Recording> open_recording(const std::string &path);

} // namespace ada
