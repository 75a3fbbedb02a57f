// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The sensor's GC (gain control) and PD (power down) pins on GPIO lines. libgpiod 1.6 and 2.x have
// different interfaces; each is behind GpioChips in one file, chosen when the build is configured.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/config.h"
#include "base/error.h"

namespace ada {

/// "ada4571-gc", or chip and offset: "gpiochip0:17", "/dev/gpiochip0:17", "LABEL:17", "0:17".
struct LineAddress {
  std::string chip; ///< empty: by name on any chip
  unsigned offset = 0;
  std::string name;

  std::string text() const { return chip.empty() ? name : chip + ":" + std::to_string(offset); }
};

/// Throws INVALID_ARGUMENT for a text that can be neither.
LineAddress parse_line(std::string_view text);

/// One line. Nothing is requested before the first use; from the first drive() on the line is held
/// until the object ends.
class GpioLine {
public:
  virtual ~GpioLine() = default;
  /// Makes it an output. Active is what the polarity says it is.
  virtual void drive(bool active) = 0;
  /// The level, without a change of direction; the line is released again unless it is held.
  virtual bool read() = 0;
};

class GpioChips {
public:
  virtual ~GpioChips() = default;
  /// Throws NOT_FOUND, PERMISSION or BUSY, each with a sentence that names the line.
  virtual std::unique_ptr<GpioLine> find(const LineAddress &address, bool active_low) = 0;
};

/// The machine's GPIO chips by libgpiod.
std::unique_ptr<GpioChips> make_gpio_chips();

/// What `ls /dev/gpiochip*` gives, in the order of their numbers.
std::vector<std::string> gpio_chip_paths();

/// The sentence for a failed `action` ("request", "read", "drive") on a line. `holder` is the
/// consumer of a busy line where it is known.
Error line_error(const LineAddress &address, int error, const char *action,
                 const std::string &holder = {});
Error line_not_found(const LineAddress &address, bool some_chip_refused);

class Pins {
public:
  enum class Pin { gc, pd };

  static constexpr const char *kDefaultGc = "ada4571-gc";
  static constexpr const char *kDefaultPd = "ada4571-pd";
  /// Waited after PD is taken off. Assumed with a wide margin, since no limit was found in a data
  /// sheet: long beside any start of an analog part, short for a person.
  static constexpr std::chrono::milliseconds kPowerUp{10};

  Pins(std::unique_ptr<GpioChips> chips, const PinsConfig &config);

  /// GC on: gain control active. PD on: powered down; off waits kPowerUp.
  void set(Pin pin, bool on);
  /// What was set here, else what the line reads.
  bool get(Pin pin);

private:
  struct Line {
    LineAddress address;
    bool active_low = false;
    std::unique_ptr<GpioLine> line;
    std::optional<bool> driven;
  };

  Line &find(Pin pin);

  std::unique_ptr<GpioChips> chips_;
  std::array<Line, 2> lines_;
};

} // namespace ada
