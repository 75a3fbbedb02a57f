// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "parsers.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "import/importer.h"
#include "model/effect_text.h"
#include "model/model_file.h"
#include "recording/columns.h"
#include "recording/identity.h"
#include "recording/sigmf_recording.h"
#include "recording/text_reader.h"

namespace ada::test {

void promise(bool kept, const char *what) {
  if (kept)
    return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

namespace {

void check(const Error &e) {
  promise(e.status() == ADA4571_ERROR_FORMAT || e.status() == ADA4571_ERROR_INVALID_ARGUMENT,
          "a refusal has the status of bad input");
  const std::string_view message = e.what();
  promise(!message.empty() && message.find('\n') == message.npos, "a refusal is one line");
}

void check(const Capture &capture) {
  promise(capture.size() > 0, "a capture has samples");
  for (const Column &column : kColumns) {
    const auto &values = capture.*column.values;
    promise(values.size() == capture.size() || (values.empty() && !column.required),
            "columns are of one length");
    for (const double value : values)
      promise(std::fabs(value) <= column.limit, "values are numbers in their range");
  }
  for (std::size_t i = 1; i < capture.size(); ++i)
    promise(capture.time_s[i] >= capture.time_s[i - 1], "time does not go back");
  for (std::size_t i = 0; i < capture.gaps.size(); ++i)
    promise(capture.gaps[i] > (i ? capture.gaps[i - 1] : 0) && capture.gaps[i] < capture.size(),
            "gaps are in order and inside");
  promise(capture.identity == capture_identity(capture), "the identity is that of the content");
}

Descriptor file_of(std::string_view input) {
  Descriptor file(::memfd_create("fuzz", MFD_CLOEXEC));
  promise(::write(file.get(), input.data(), input.size()) == static_cast<ssize_t>(input.size()) &&
              ::lseek(file.get(), 0, SEEK_SET) == 0,
          "the input can be put into a file");
  return file;
}

/// All frames, which are no more than the input has bytes: each needs one at least.
void check(Importer &import, std::size_t bytes) {
  std::array<Frame, 64> frames;
  std::size_t all = 0;
  double last_s = -HUGE_VAL;
  while (const std::size_t n = import.read(frames)) {
    promise(n <= frames.size() && (all += n) <= bytes, "frames come out of bytes");
    for (const Frame &frame : std::span(frames).first(n)) {
      promise(std::isfinite(frame.vsin_v) && std::isfinite(frame.vcos_v), "volts are numbers");
      promise(frame.time_s >= last_s, "time does not go back");
      last_s = frame.time_s;
    }
  }
}

template <class Body> Outcome run(Body body) {
  try {
    body();
    return Outcome::accepted;
  } catch (const Error &e) {
    check(e);
    return Outcome::refused;
  }
}

} // namespace

Capture capture_of_text(std::string_view input) {
  const Descriptor file = file_of(input);
  return read_text_capture(file.get(), "input");
}

Outcome parse_text_capture(std::string_view input) {
  return run([&] { check(capture_of_text(input)); });
}

Outcome parse_sigmf_meta(std::string_view input) {
  // Data for whatever frame the meta file describes: every byte value, and a whole number of
  // frames of all the small sizes.
  static const std::vector<std::byte> data = [] {
    std::vector<std::byte> bytes(5040);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::byte>(i * 37);
    return bytes;
  }();
  return run([&] {
    const SigmfMeta meta = ada::parse_sigmf_meta(input, "input");
    check(*sigmf_recording(meta, FileBytes(data, "data"), "data")->whole());
  });
}

Outcome parse_model_file(std::string_view input) {
  return run([&] {
    const std::string text = model_to_toml(model_from_toml(input, "input"));
    promise(model_to_toml(model_from_toml(text, "again")) == text,
            "what was read can be written and read again");
  });
}

Outcome parse_foreign_file(std::string_view input) {
  const Descriptor file = file_of(input);
  const std::string path = "/proc/self/fd/" + std::to_string(file.get());
  ImportOptions told;
  told.columns[1].column = "2";
  told.columns[2].column = "3";
  told.columns[2].scale = -1e-3;
  told.sample_rate_hz = 1e3;
  Outcome outcome = Outcome::refused;
  for (const ImportOptions &options : {ImportOptions(), told}) {
    const Outcome now = run([&] { check(*open_import(path, options), input.size()); });
    outcome = now == Outcome::accepted ? now : outcome;
  }
  return outcome;
}

Outcome parse_effect_text(std::string_view input) {
  return run([&] {
    const EffectInstance instance = parse_effect(input);
    const auto parameters = instance.effect->info().parameters;
    promise(instance.values.size() == parameters.size(), "every parameter has a value");
    for (std::size_t i = 0; i < parameters.size(); ++i)
      promise(instance.values[i] == parameters[i].fallback ||
                  check_parameter(parameters[i], instance.values[i]).empty(),
              "values are in their range");
  });
}

} // namespace ada::test
