// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/server_description.h"

#include <cerrno>
#include <chrono>
#include <vector>

#include "acquisition/iio_library.h"
#include "acquisition/network_buffer.h"
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

} // namespace

void check_server_description(const std::string &uri, const Cancellation *cancellation) {
  const std::string port = server_port(uri);
  const std::string host = port.empty() ? "" : server_host(uri, port);
  if (host.empty())
    return;
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
      return; // libiio asks in another way, too
    if (length > kMostBytes)
      refuse(ADA4571_ERROR_IO, "the server announces a description of its devices of " +
                                   std::to_string(length) + " bytes: do not trust it");
    std::vector<std::byte> text(static_cast<std::size_t>(length));
    const auto deadline = Clock::now() + kMostTime;
    connection.receive(text.data(), text.size(), deadline);
    if (has_control_characters({reinterpret_cast<const char *>(text.data()), text.size()}))
      refuse(ADA4571_ERROR_IO, "the server's description of its devices holds control characters: "
                               "do not trust it");
  } catch (const ServerFailed &failed) {
    if (!answered && (failed.error == ETIMEDOUT || failed.error == EBADF))
      refuse(ADA4571_ERROR_DISCONNECTED, "the server does not answer");
    if (answered || failed.error == EBADMSG)
      refuse(failed.error == EBADMSG ? ADA4571_ERROR_IO : ADA4571_ERROR_DISCONNECTED,
             "the server does not come to an end with the description of its devices: " +
                 errno_text(failed.error));
  }
}

} // namespace ada
