// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The writing half and the file itself; model_reader.cpp parses.

#include "model/model_file.h"

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/text.h"
#include "model/effect.h"

namespace ada {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr std::string_view kComment =
    "# Model of one sensor, volts at supply_v. After a change by hand delete the checksum line.\n";
constexpr std::string_view kRemainderComment =
    "\n# Unnamed: what repeats with the angle and no effect explains, relative to amplitude_v.\n";

std::string basic_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      std::array<char, 8> escape;
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(byte));
      out += escape.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// TOML reads "-0" as the integer 0, so a negative zero is written as what it will be.
std::string plain_number(double value) {
  return shortest(value == 0 ? 0.0 : value);
}

class Writer {
public:
  std::string text;

  void line(std::string_view key, const std::string &value, std::string_view comment = {}) {
    text += std::string(key) + " = " + value;
    text += comment.empty() ? "\n" : "  # " + std::string(comment) + "\n";
  }
  void number(std::string_view key, double value) { line(key, plain_number(value)); }
  void number(std::string_view key, const std::optional<double> &value) {
    if (value)
      number(key, *value);
  }
  void words(std::string_view key, const std::string &value) {
    if (!value.empty())
      line(key, basic_string(value));
  }
};

void write_provenance(Writer &out, const Provenance &p) {
  const std::size_t empty = out.text.size();
  out.text += "\n[provenance]\n";
  const std::size_t head = out.text.size();
  out.words("serial", p.serial);
  out.words("date", p.date);
  out.words("method", p.method);
  out.words("capture", p.capture_identity);
  out.words("generator", p.generator);
  out.number("vtemp_min_v", p.vtemp_min_v);
  out.number("vtemp_max_v", p.vtemp_max_v);
  if (p.gain_control)
    out.words("gain_control", *p.gain_control ? "on" : "off");
  out.number("fit_residual_rms_v", p.fit_residual_rms_v);
  out.number("heldout_residual_rms_v", p.heldout_residual_rms_v);
  if (out.text.size() == head)
    out.text.resize(empty);
}

void write_baseline(Writer &out, const Model &model) {
  const Baseline &value = model.baseline, &error = model.baseline_std_error;
  out.text += "\n[baseline]\n";
  out.number("amplitude_v", value.amplitude_v);
  out.number("offset_sin_v", value.offset_sin_v);
  out.number("offset_cos_v", value.offset_cos_v);
  out.number("angle_zero_deg", value.angle_zero_deg);
  if (error.amplitude_v == 0 && error.offset_sin_v == 0 && error.offset_cos_v == 0 &&
      error.angle_zero_deg == 0)
    return;
  out.text += "\n[baseline.std_errors]\n";
  for (const auto &[key, number] :
       {std::pair("amplitude_v", error.amplitude_v), std::pair("offset_sin_v", error.offset_sin_v),
        std::pair("offset_cos_v", error.offset_cos_v),
        std::pair("angle_zero_deg", error.angle_zero_deg)})
    if (number != 0)
      out.number(key, number);
}

std::string value_text(const ParameterInfo &parameter, double value) {
  if (parameter.unit == "channel")
    return value < 0.5 ? "\"vsin\"" : "\"vcos\"";
  return plain_number(value);
}

void write_effect(Writer &out, const EffectInstance &instance) {
  const EffectInfo &info = instance.effect->info();
  out.text += "\n[[effect]]\n";
  out.words("name", std::string(info.id));
  if (info.parameters.empty())
    return;
  out.text += "[effect.parameters]\n";
  for (std::size_t i = 0; i < info.parameters.size(); ++i)
    if (std::isfinite(instance.values[i])) // others are not present
      out.line(info.parameters[i].name, value_text(info.parameters[i], instance.values[i]),
               info.parameters[i].unit);
  std::string head = "[effect.std_errors]\n";
  for (std::size_t i = 0; i < instance.std_errors.size(); ++i)
    if (std::isfinite(instance.std_errors[i])) {
      out.text += std::exchange(head, "");
      out.number(info.parameters[i].name, instance.std_errors[i]);
    }
}

std::string numbers_text(const std::vector<double> &values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i)
    text += (i == 0 ? "" : i % 4 == 0 ? ",\n  " : ", ") + plain_number(values[i]);
  return text + "]";
}

void write_remainder(Writer &out, const PeriodicRemainder &remainder) {
  out.text += kRemainderComment;
  out.text += "[remainder]\n";
  out.words("angle", std::string(remainder.electrical ? kElectrical : kMechanical));
  out.line("orders", std::to_string(remainder.orders()));
  for (const RemainderSeries &series : kRemainderSeries)
    out.line(series.key, numbers_text(remainder.*series.values));
}

std::string read_all(int fd, const std::string &shown) {
  std::string text;
  std::array<char, 1 << 14> block;
  while (true) {
    const ssize_t count = ::read(fd, block.data(), block.size());
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0)
      throw system_error(errno, shown, "cannot read");
    if (count == 0)
      return text;
    text.append(block.data(), static_cast<std::size_t>(count));
    if (text.size() > kMaxBytes)
      throw Error(ADA4571_ERROR_FORMAT, shown + ":1:1: this is no model file: it is longer than " +
                                            std::to_string(kMaxBytes) + " bytes");
  }
}

} // namespace

std::string model_checksum(std::string_view text, std::size_t line) {
  std::uint32_t crc = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    auto part = text.substr(0, end == text.npos ? end : end + 1);
    text.remove_prefix(part.size());
    if (number == line)
      continue;
    for (const char &c : part)
      if (c != '\r')
        crc = crc32_of(std::as_bytes(std::span(&c, 1)), crc);
  }
  std::array<char, 24> out;
  std::snprintf(out.data(), out.size(), "crc32:%08x", crc);
  return out.data();
}

std::string model_to_toml(const Model &model) {
  Writer head, body;
  head.text = kComment;
  head.words("schema", std::string(kModelSchema));
  body.text = "\n";
  body.line("periods_per_turn", std::to_string(model.periods_per_turn));
  body.number("supply_v", model.supply_v);
  body.number("vtemp_reference_v", model.vtemp_reference_v);
  body.number("vdd_reference_v", model.vdd_reference_v);
  body.number("noise_rms_v", model.noise_rms_v);
  write_provenance(body, model.provenance);
  write_baseline(body, model);
  for (const EffectInstance &instance : model.effects)
    write_effect(body, instance);
  if (model.remainder)
    write_remainder(body, *model.remainder);
  const std::string checksum = model_checksum(head.text + body.text, 0);
  head.words("checksum", checksum);
  return head.text + body.text;
}

Model read_model(const std::string &path) {
  if (path == "-")
    return model_from_toml(read_all(STDIN_FILENO, "standard input"), "standard input");
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  return model_from_toml(read_all(fd.get(), path), path);
}

void check_model(const Model &model) {
  try {
    model_from_toml(model_to_toml(model), "model"); // what is written must be readable
  } catch (const Error &e) {
    const std::string_view message = e.what(); // "model:line:column: why"
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, std::string(message.substr(message.find(' ') + 1)));
  }
}

void write_model(const Model &model, const std::string &path) {
  try {
    check_model(model);
  } catch (const Error &e) {
    throw Error(e.status(), path + " is not written: " + e.what());
  }
  AtomicFile file(path);
  file.write(model_to_toml(model));
  file.commit();
}

} // namespace ada
