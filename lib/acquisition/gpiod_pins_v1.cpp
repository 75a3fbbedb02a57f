// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// GPIO lines by libgpiod 1.6; gpiod_pins_v2.cpp is the same for 2.x. No other file includes
// libgpiod.

#include <cerrno>
#include <memory>

#include <gpiod.h>

#include "acquisition/pins.h"
#include "base/error.h"

namespace ada {

namespace {

struct ChipDeleter {
  void operator()(gpiod_chip *chip) const { gpiod_chip_close(chip); }
};
using ChipPointer = std::unique_ptr<gpiod_chip, ChipDeleter>;

class LineV1 final : public GpioLine {
public:
  /// The line belongs to its chip, which therefore stays open.
  LineV1(ChipPointer chip, gpiod_line *line, LineAddress address, bool active_low)
      : chip_(std::move(chip)), line_(line), address_(std::move(address)), active_low_(active_low) {
  }
  ~LineV1() override {
    if (held_)
      gpiod_line_release(line_);
  }
  LineV1(const LineV1 &) = delete;
  LineV1 &operator=(const LineV1 &) = delete;

  void drive(bool active) override {
    if (!held_) {
      request(GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, active);
      held_ = true;
    } else if (gpiod_line_set_value(line_, active) != 0) {
      throw line_error(address_, errno, "drive");
    }
  }

  bool read() override {
    if (!held_)
      request(GPIOD_LINE_REQUEST_DIRECTION_AS_IS, false);
    const int value = gpiod_line_get_value(line_);
    const int error = errno;
    if (!held_)
      gpiod_line_release(line_);
    if (value < 0)
      throw line_error(address_, error, "read");
    return value != 0;
  }

private:
  void request(int type, bool value) {
    const gpiod_line_request_config config{
        "libada4571", type, active_low_ ? int{GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW} : 0};
    if (gpiod_line_request(line_, &config, value) == 0)
      return;
    const int error = errno;
    const char *holder = gpiod_line_consumer(line_);
    throw line_error(address_, error, "request", holder ? holder : "");
  }

  ChipPointer chip_;
  gpiod_line *line_;
  LineAddress address_;
  bool active_low_, held_ = false;
};

class ChipsV1 final : public GpioChips {
public:
  std::unique_ptr<GpioLine> find(const LineAddress &address, bool active_low) override {
    bool refused = false;
    for (const std::string &path : gpio_chip_paths()) {
      ChipPointer chip(gpiod_chip_open(path.c_str()));
      if (!chip) {
        refused = refused || errno == EACCES || errno == EPERM;
        continue;
      }
      gpiod_line *line = nullptr;
      if (address.chip.empty())
        line = gpiod_chip_find_line(chip.get(), address.name.c_str());
      else if (is_called(chip.get(), path, address.chip))
        line = gpiod_chip_get_line(chip.get(), address.offset);
      if (line)
        return std::make_unique<LineV1>(std::move(chip), line, address, active_low);
    }
    throw line_not_found(address, refused);
  }

private:
  static bool is_called(gpiod_chip *chip, const std::string &path, const std::string &text) {
    return text == path || text == gpiod_chip_name(chip) || text == gpiod_chip_label(chip) ||
           "gpiochip" + text == gpiod_chip_name(chip);
  }
};

} // namespace

std::unique_ptr<GpioChips> make_gpio_chips() {
  return std::make_unique<ChipsV1>();
}

} // namespace ada
