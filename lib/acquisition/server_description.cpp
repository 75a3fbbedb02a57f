// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/server_description.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <vector>

#include "acquisition/iio_library.h"
#include "acquisition/network_buffer.h"
#include "acquisition/scan_format.h"
#include "acquisition/server_connection.h"
#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTimeout{5000};
/// That of a board with many converters has some hundred kilobytes.
constexpr long kMostBytes = 16L << 20;
constexpr std::chrono::seconds kMostTime{60};

/// Of "ip:HOST", "ip:HOST:PORT" and "ip:[HOST]:PORT"; empty where libiio has to find it.
std::string server_host(const std::string &uri, const std::string &port) {
  std::string host = uri.substr(3);
  if (host.ends_with(":" + port))
    host.resize(host.size() - port.size() - 1);
  if (host.starts_with('[') && host.ends_with(']'))
    host = host.substr(1, host.size() - 2);
  return host;
}

bool has_control_characters(std::string_view text) {
  std::string lines(text);
  std::erase_if(lines, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  return printable(lines) != lines;
}

/// Value of an attribute of a tag; empty where it has none.
std::string value_of(std::string_view tag, const std::string &name) {
  const std::string begins = " " + name + "=\"";
  const std::size_t at = tag.find(begins);
  if (at == tag.npos)
    return {};
  const std::string_view rest = tag.substr(at + begins.size());
  std::string value(rest.substr(0, rest.find('"')));
  constexpr std::string_view kMore = "&gt;"; // the one that a format has
  for (std::size_t i = 0; (i = value.find(kMore, i)) != value.npos; ++i)
    value.replace(i, kMore.size(), ">");
  return value;
}

/// libiio reads the text as XML, and has taken what cannot be read so for something else by then.
std::vector<OddFormat> odd_formats(std::string_view text) {
  std::vector<OddFormat> odd;
  std::string device, channel;
  for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) {
    const std::size_t end = std::min(text.find('>', at), text.size());
    const std::string_view tag = text.substr(at, end - at);
    at = end;
    if (tag.starts_with("<device "))
      device = value_of(tag, "id");
    else if (tag.starts_with("<channel "))
      channel = value_of(tag, "id");
    else if (const std::string format = value_of(tag, "format"); !format.empty()) {
      try {
        parse_scan_format(format);
      } catch (const Error &) {
        odd.push_back({device, channel, format});
      }
    }
  }
  return odd;
}

} // namespace

std::vector<OddFormat> check_server_description(const std::string &uri,
                                                const Cancellation *cancellation) {
  const std::string port = server_port(uri);
  const std::string host = port.empty() ? "" : server_host(uri, port);
  if (host.empty())
    return {};
  const auto refuse = [&](ada4571_status status, const std::string &why) {
    throw Error(status, "IIO context \"" + uri + "\": " + why);
  };
  bool answered = false;
  try {
    ServerConnection connection(host, port, kTimeout, cancellation);
    connection.send("PRINT\r\n");
    const long length = connection.number();
    answered = true;
    if (length < 0)
      return {}; // libiio asks in another way, too
    if (length > kMostBytes)
      refuse(ADA4571_ERROR_IO, "the server announces a description of its devices of " +
                                   std::to_string(length) + " bytes: do not trust it");
    std::vector<std::byte> text(static_cast<std::size_t>(length));
    const auto deadline = Clock::now() + kMostTime;
    connection.receive(text.data(), text.size(), deadline);
    const std::string_view description(reinterpret_cast<const char *>(text.data()), text.size());
    if (has_control_characters(description))
      refuse(ADA4571_ERROR_IO, "the server's description of its devices holds control characters: "
                               "do not trust it");
    return odd_formats(description);
  } catch (const ServerFailed &failed) {
    if (!answered && (failed.error == ETIMEDOUT || failed.error == EBADF))
      refuse(ADA4571_ERROR_DISCONNECTED, "the server does not answer");
    if (answered || failed.error == EBADMSG)
      refuse(failed.error == EBADMSG ? ADA4571_ERROR_IO : ADA4571_ERROR_DISCONNECTED,
             "the server does not come to an end with the description of its devices: " +
                 errno_text(failed.error));
  }
  return {};
}

} // namespace ada
