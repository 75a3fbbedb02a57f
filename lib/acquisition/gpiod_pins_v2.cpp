// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// GPIO lines by libgpiod 2.x; gpiod_pins_v1.cpp is the same for 1.6. No other file includes
// libgpiod.

#include <cerrno>
#include <memory>

#include <gpiod.h>

#include "acquisition/pins.h"
#include "base/error.h"

namespace ada {

namespace {

template <auto Free> struct Deleter {
  template <class T> void operator()(T *object) const { Free(object); }
};
using ChipPointer = std::unique_ptr<gpiod_chip, Deleter<gpiod_chip_close>>;
using ChipInfoPointer = std::unique_ptr<gpiod_chip_info, Deleter<gpiod_chip_info_free>>;
using LineInfoPointer = std::unique_ptr<gpiod_line_info, Deleter<gpiod_line_info_free>>;
using SettingsPointer = std::unique_ptr<gpiod_line_settings, Deleter<gpiod_line_settings_free>>;
using LineConfigPointer = std::unique_ptr<gpiod_line_config, Deleter<gpiod_line_config_free>>;
using RequestConfigPointer =
    std::unique_ptr<gpiod_request_config, Deleter<gpiod_request_config_free>>;
using RequestPointer = std::unique_ptr<gpiod_line_request, Deleter<gpiod_line_request_release>>;

gpiod_line_value value_of(bool active) {
  return active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

class LineV2 final : public GpioLine {
public:
  LineV2(ChipPointer chip, unsigned offset, LineAddress address, bool active_low)
      : chip_(std::move(chip)), offset_(offset), address_(std::move(address)),
        active_low_(active_low) {}

  void drive(bool active) override {
    if (!held_)
      held_ = request(GPIOD_LINE_DIRECTION_OUTPUT, active);
    else if (gpiod_line_request_set_value(held_.get(), offset_, value_of(active)) != 0)
      throw line_error(address_, errno, "drive");
  }

  bool read() override {
    RequestPointer for_now;
    if (!held_)
      for_now = request(GPIOD_LINE_DIRECTION_AS_IS, false);
    const gpiod_line_value value =
        gpiod_line_request_get_value(held_ ? held_.get() : for_now.get(), offset_);
    if (value == GPIOD_LINE_VALUE_ERROR)
      throw line_error(address_, errno, "read");
    return value == GPIOD_LINE_VALUE_ACTIVE;
  }

private:
  RequestPointer request(gpiod_line_direction direction, bool active) {
    const SettingsPointer settings(gpiod_line_settings_new());
    const LineConfigPointer lines(gpiod_line_config_new());
    const RequestConfigPointer config(gpiod_request_config_new());
    if (!settings || !lines || !config)
      throw line_error(address_, ENOMEM, "request");
    gpiod_line_settings_set_direction(settings.get(), direction);
    gpiod_line_settings_set_active_low(settings.get(), active_low_);
    if (direction == GPIOD_LINE_DIRECTION_OUTPUT)
      gpiod_line_settings_set_output_value(settings.get(), value_of(active));
    gpiod_request_config_set_consumer(config.get(), "libada4571");
    if (gpiod_line_config_add_line_settings(lines.get(), &offset_, 1, settings.get()) != 0)
      throw line_error(address_, errno, "request");
    RequestPointer request(gpiod_chip_request_lines(chip_.get(), config.get(), lines.get()));
    if (!request) {
      const int error = errno;
      throw line_error(address_, error, "request", holder());
    }
    return request;
  }

  std::string holder() const {
    const LineInfoPointer info(gpiod_chip_get_line_info(chip_.get(), offset_));
    const char *consumer = info ? gpiod_line_info_get_consumer(info.get()) : nullptr;
    return consumer ? consumer : "";
  }

  ChipPointer chip_;
  unsigned offset_;
  LineAddress address_;
  bool active_low_;
  RequestPointer held_;
};

class ChipsV2 final : public GpioChips {
public:
  std::unique_ptr<GpioLine> find(const LineAddress &address, bool active_low) override {
    bool refused = false;
    for (const std::string &path : gpio_chip_paths()) {
      ChipPointer chip(gpiod_chip_open(path.c_str()));
      if (!chip) {
        refused = refused || errno == EACCES || errno == EPERM;
        continue;
      }
      const int offset = offset_on(chip.get(), path, address);
      if (offset >= 0)
        return std::make_unique<LineV2>(std::move(chip), static_cast<unsigned>(offset), address,
                                        active_low);
    }
    throw line_not_found(address, refused);
  }

private:
  /// Negative where the line is not on this chip.
  static int offset_on(gpiod_chip *chip, const std::string &path, const LineAddress &address) {
    if (address.chip.empty())
      return gpiod_chip_get_line_offset_from_name(chip, address.name.c_str());
    const ChipInfoPointer info(gpiod_chip_get_info(chip));
    if (!info || address.offset >= gpiod_chip_info_get_num_lines(info.get()))
      return -1;
    const std::string name = gpiod_chip_info_get_name(info.get());
    const bool called = address.chip == path || address.chip == name ||
                        address.chip == gpiod_chip_info_get_label(info.get()) ||
                        "gpiochip" + address.chip == name;
    return called ? static_cast<int>(address.offset) : -1;
  }
};

} // namespace

std::unique_ptr<GpioChips> make_gpio_chips() {
  return std::make_unique<ChipsV2>();
}

} // namespace ada
