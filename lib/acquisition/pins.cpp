// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/pins.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <thread>

#include "base/error.h"

namespace ada {

LineAddress parse_line(std::string_view text) {
  LineAddress address;
  const std::size_t colon = text.rfind(':');
  if (text.empty() || text.size() > 200 ||
      text.find_first_of(std::string_view("\0\n", 2)) != text.npos)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "a GPIO line needs a name or chip:offset");
  if (colon == std::string_view::npos) {
    address.name = text;
    return address;
  }
  const std::string_view digits = text.substr(colon + 1);
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), address.offset);
  if (colon == 0 || digits.empty() || error != std::errc{} || end != digits.data() + digits.size())
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                "\"" + std::string(text) + "\" is neither a line name nor chip:offset");
  address.chip = text.substr(0, colon);
  return address;
}

std::vector<std::string> gpio_chip_paths() {
  constexpr std::string_view kPrefix = "gpiochip";
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto &entry : std::filesystem::directory_iterator("/dev", error))
    if (entry.path().filename().string().starts_with(kPrefix))
      paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end(), [](const std::string &a, const std::string &b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

Error line_error(const LineAddress &address, int error, const char *action,
                 const std::string &holder) {
  const std::string line = "GPIO line " + address.text();
  if (error == EBUSY)
    return Error(ADA4571_ERROR_BUSY, line + " is in use" +
                                         (holder.empty() ? "" : " by \"" + holder + "\"") +
                                         "; end that first");
  if (error == EACCES || error == EPERM)
    return Error(ADA4571_ERROR_PERMISSION,
                 line + ": no permission for its chip; install the project's udev rules and join "
                        "the group they name, or run as root");
  return Error(ADA4571_ERROR_IO,
               line + ": cannot " + action + ": " + std::generic_category().message(error));
}

Error line_not_found(const LineAddress &address, bool some_chip_refused) {
  if (some_chip_refused)
    return line_error(address, EACCES, "open");
  if (address.chip.empty())
    return Error(ADA4571_ERROR_NOT_FOUND,
                 "no GPIO chip has a line named \"" + address.name +
                     "\"; see gpio-line-names in the device tree, or give chip:offset");
  return Error(ADA4571_ERROR_NOT_FOUND, "there is no GPIO line " + address.text());
}

Pins::Pins(std::unique_ptr<GpioChips> chips, const PinsConfig &config) : chips_(std::move(chips)) {
  lines_[0].address = parse_line(config.gc.value_or(kDefaultGc));
  lines_[0].active_low = config.gc_active_low;
  lines_[1].address = parse_line(config.pd.value_or(kDefaultPd));
  lines_[1].active_low = config.pd_active_low;
}

Pins::Line &Pins::find(Pin pin) {
  Line &line = lines_[pin == Pin::gc ? 0 : 1];
  if (!line.line)
    line.line = chips_->find(line.address, line.active_low);
  return line;
}

void Pins::set(Pin pin, bool on) {
  Line &line = find(pin);
  line.line->drive(on);
  line.driven = on;
  if (pin == Pin::pd && !on)
    std::this_thread::sleep_for(kPowerUp);
}

bool Pins::get(Pin pin) {
  Line &line = find(pin);
  return line.driven ? *line.driven : line.line->read();
}

} // namespace ada
