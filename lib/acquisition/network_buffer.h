// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The capture buffer behind a server, read without libiio: of the answers to READBUF, libiio 0.24 to
// 0.26 write as many bytes into their buffer as the server says, not as there is room for, so a
// server that lies writes over our heap. Everything else of the network is left to libiio.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/iio_library.h"

namespace ada {

struct NetworkBufferOptions {
  std::string host, port;           ///< host as a number
  std::string device;               ///< "iio:device0"
  std::vector<IioChannel> channels; ///< all of the device, in libiio's order
  std::vector<std::size_t> wanted;  ///< positions in `channels`
  std::size_t frames = 0;
  unsigned kernel_buffers = 4;
  std::size_t bytes = 0; ///< of a refill: what libiio on the other side makes of `frames`
  std::chrono::milliseconds timeout{};
  const Cancellation *cancellation = nullptr; ///< of the start; the buffer has a cancel of its own
};

/// The port that libiio calls for "ip:HOST", "ip:HOST:PORT" and "ip:[HOST]:PORT". A server that it has
/// to find ("ip:") is called at the usual one, whatever Avahi says of it. Empty for what is no network.
std::string server_port(const std::string &uri);

/// Starts the capture. Returns null and sets `error` (an errno) where that is refused.
std::unique_ptr<IioBuffer> open_network_buffer(const NetworkBufferOptions &options, int &error);

} // namespace ada
