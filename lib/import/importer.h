// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Measurements of other programs as frames. What a file says of itself is taken from it; what it
// does not say and nobody else says is refused.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/frame.h"
#include "recording/capture.h"
#include "recording/columns.h"

namespace ada {

struct ImportColumn {
  std::optional<std::string> column; ///< name, number from 1, or "#" and number; "": none
  std::optional<double> scale;       ///< nullopt: by the unit in the file
  double offset = 0.0;
};

struct ImportOptions {
  std::optional<char> separator, decimal;
  std::optional<std::size_t> header_lines;
  std::array<ImportColumn, kColumns.size()> columns; ///< in the order of kColumns
  double sample_rate_hz = 0.0;                       ///< 0: by the file
  double supply_v = 5.0;
  int periods_per_turn = 2;
};

class Importer {
public:
  virtual ~Importer() = default;
  const CaptureMetadata &meta() const { return meta_; }
  const ChannelSet &channels() const { return channels_; }
  /// How the file was understood, a line a channel.
  const std::string &text() const { return text_; }
  /// The next frames; 0 at the end. Throws FORMAT with the place.
  virtual std::size_t read(std::span<Frame> out) = 0;

protected:
  CaptureMetadata meta_;
  ChannelSet channels_;
  std::string text_;
};

/// By content: numpy's .npy where it begins as one, else text. "-" is standard input (text only).
std::unique_ptr<Importer> open_import(const std::string &path, const ImportOptions &options);

} // namespace ada
