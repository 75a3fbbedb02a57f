// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_writer.h"

#include <array>

#include "base/atomic_file.h"
#include "base/error.h"
#include "recording/fixed_point.h"
#include "recording/frame_check.h"
#include "recording/metadata.h"

namespace ada {

namespace {

/// Microseconds where that is exact, nanoseconds otherwise.
char *print_time(char *out, double time_s) {
  const std::int64_t steps = to_steps(time_s, power_of_ten(kTimeDecimals));
  return steps % 1000 == 0 ? print_steps(out, steps / 1000, 6)
                           : print_steps(out, steps, kTimeDecimals);
}

class TextWriter final : public CaptureWriter {
public:
  TextWriter(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels)
      : check_(meta, channels), file_(path), volt_decimals_(volt_decimals(meta)),
        volt_scale_(power_of_ten(volt_decimals_)) {}

  void metadata(std::string_view key, std::string_view value) override {
    check_.add_metadata(key, value);
  }

  void write(std::span<const Frame> frames) override {
    for (const Frame &frame : frames) {
      const bool first = check_.frames() == 0;
      check_.accept(frame);
      if (first)
        write_head();
      write_row(frame);
    }
  }

  void finish() override {
    check_.require_frames();
    if (const std::string beside = file_.commit_or_beside(); !beside.empty())
      throw Error(ADA4571_ERROR_BUSY, file_.target() +
                                          ": another program has written this file "
                                          "meanwhile; the recording is in " +
                                          beside);
  }

private:
  void write_head() {
    std::string head = "# ada4571-capture/1\n";
    for (const auto &[key, value] : metadata_entries(check_.meta()))
      head += "# " + key + " = " + value + "\n";
    for (const Column &column : kColumns)
      if (check_.channels().has(column))
        head += (&column == &kColumns[0] ? "" : ",") + std::string(column.name);
    file_.write(head + "\n");
  }

  void write_row(const Frame &frame) {
    std::array<char, kColumns.size() * (kStepsBytes + 1)> row;
    char *out = print_time(row.data(), frame.time_s);
    for (const Column &column : kColumns) {
      if (column.field == &Frame::time_s || !check_.channels().has(column))
        continue;
      *out++ = ',';
      out = column.field == &Frame::reference_deg
                ? print_steps(out, to_steps(frame.reference_deg, reference_scale_),
                              kReferenceDecimals)
                : print_steps(out, to_steps(frame.*column.field, volt_scale_), volt_decimals_);
    }
    *out++ = '\n';
    file_.write(row.data(), static_cast<std::size_t>(out - row.data()));
  }

  FrameCheck check_;
  AtomicFile file_;
  int volt_decimals_;
  double volt_scale_;
  double reference_scale_ = power_of_ten(kReferenceDecimals);
};

} // namespace

std::unique_ptr<CaptureWriter>
open_text_writer(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels) {
  return std::make_unique<TextWriter>(path, meta, channels);
}

} // namespace ada
