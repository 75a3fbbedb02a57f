// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Clients that send what no client would, a server that says what no server would, and a process
// that has run out of something.

#include <algorithm>
#include <atomic>
#include <cstring>
#include <random>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "acquisition/iio_source.h"
#include "acquisition/network_buffer.h"
#include "acquisition/server_watch.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "raw_client.h"
#include "served.h"
#include "simulation/iiod_buffer.h"
#include "support/seed.h"

using namespace ada;
using namespace ada::test;

namespace {

const ScanFormat kU16 = [] {
  ScanFormat f;
  f.bits = f.storage = 16;
  return f;
}();

/// A command with some of its words replaced, left out or made long, or bytes of no meaning.
std::string hostile_line(std::mt19937_64 &rng) {
  static const char *const words[] = {"OPEN",
                                      "READBUF",
                                      "READ",
                                      "WRITE",
                                      "CLOSE",
                                      "iio:device0",
                                      "INPUT",
                                      "voltage0",
                                      "scale",
                                      "00000003",
                                      "33554432",
                                      "-1",
                                      "TIMEOUT",
                                      "PRINT",
                                      "VERSION",
                                      "SETTRIG",
                                      "GETTRIG",
                                      "",
                                      "SET",
                                      "BUFFERS_COUNT",
                                      "18446744073709551615",
                                      "ffffffff",
                                      "4",
                                      "DEBUG"};
  std::string line;
  if (rng() % 4 == 0) {
    line.resize(below(rng, 6000));
    for (char &c : line)
      c = static_cast<char>(rng());
    return line;
  }
  for (std::size_t n = below(rng, 6) + 1; n > 0; --n)
    line += std::string(words[below(rng, std::size(words))]) + (rng() % 8 ? " " : "");
  return line + (rng() % 8 ? "\r\n" : "\n\n");
}

TEST(HostileClient, leaves_the_server_to_the_others) {
  std::mt19937_64 rng(fresh_seed());
  Served server(served_pair(kU16, kU16, 0.0));
  for (int client = 0; client < 100; ++client) {
    const Descriptor fd = connect_to(server.port());
    for (std::size_t n = below(rng, 20); n > 0; --n)
      say(fd, hostile_line(rng));
    if (rng() % 2)
      shutdown(fd.get(), SHUT_WR);
  }
  EXPECT_EQ(list_iio_devices(server.uri()).size(), 1u);
}

TEST(HostileClient, cannot_make_the_process_hold_more_than_it_says) {
  Served server(served_pair(kU16, kU16, 0.0, false));
  const Descriptor fd = connect_to(server.port());
  say(fd, "OPEN iio:device0 134217728 00000003\r\n"); // 512 MiB
  EXPECT_EQ(answer_line(fd), "-12");
  say(fd, "OPEN iio:device0 1024 00000003\r\n");
  EXPECT_EQ(answer_line(fd), "0");
}

TEST(BufferMemory, is_one_for_all_buffers) {
  BufferMemory first;
  ASSERT_TRUE(first.take(kMostBufferBytes / 2));
  {
    BufferMemory second, third;
    EXPECT_FALSE(second.take(kMostBufferBytes / 2 + 1));
    EXPECT_TRUE(third.take(kMostBufferBytes / 2));
  }
  BufferMemory fourth;
  EXPECT_TRUE(fourth.take(kMostBufferBytes / 2));
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

TEST(HostileClient, waits_when_descriptors_run_out_and_the_server_does_not_spin) {
  Served server(served_pair(kU16, kU16, 0.0));
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  Descriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  rlimit none = before;
  none.rlim_cur = static_cast<rlim_t>(dup(fd.get())); // the first number that is free
  close(static_cast<int>(none.rlim_cur));
  setrlimit(RLIMIT_NOFILE, &none);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(fd.get(), reinterpret_cast<sockaddr *>(&address), sizeof address), 0);
  say(fd, "VERSION\r\n");
  const double began = cpu_seconds();
  usleep(500000);
  const double used = cpu_seconds() - began;
  char c = 0;
  EXPECT_EQ(recv(fd.get(), &c, 1, MSG_DONTWAIT), -1); // nobody could take the call
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_LT(used, 0.1) << "seconds of work in half a second of waiting";
  EXPECT_EQ(answer_line(fd).substr(0, 5), "0.24.");
}

TEST(HostileServer, has_no_power_over_the_terminal) {
  auto context = served_pair(kU16, kU16, 1000.0);
  for (ServedAttribute &a : context->devices[0].channels[1].attributes)
    if (a.name == "label")
      a.value = "\033[2Jvcos\r\nnext";
  Served server(context);
  const auto list = list_iio_devices(server.uri());
  ASSERT_EQ(list.size(), 1u);
  EXPECT_NE(list[0].channels.find("\\x1b[2Jvcos\\x0d\\nnext"), std::string::npos)
      << list[0].channels;
}

TEST(HostileServer, that_sends_more_than_was_asked_for_is_refused) {
  for (const char *length : {"100000000", "4194304", "4294967297", "99999999999999999999", "12x"}) {
    Served server(served_pair(kU16, kU16, 1000.0), [&](std::string_view line) -> IiodFault {
      if (!line.starts_with("READBUF"))
        return {};
      return {IiodFault::Kind::raw_answer, 0,
              std::string(length) + "\n00000003\n" + std::string(1 << 20, 'x')};
    });
    IioSourceOptions options;
    options.uri = server.uri();
    const auto source = open_iio_source(options);
    source->start();
    Frame frames[16];
    EXPECT_THROW(for (int i = 0; i < 50; ++i) source->read(frames, std::chrono::milliseconds(200)),
                 Error)
        << length;
  }
}

/// Every server of a network is read with checked lengths, however it is named: found by libiio,
/// too.
TEST(HostileServer, is_met_at_the_port_that_libiio_calls) {
  EXPECT_EQ(server_port("ip:"), "30431");
  EXPECT_EQ(server_port("ip:192.168.1.20"), "30431");
  EXPECT_EQ(server_port("ip:bench.local:1234"), "1234");
  EXPECT_EQ(server_port("ip::1234"), "1234");
  EXPECT_EQ(server_port("ip:fe80::1%eth0"), "30431");
  EXPECT_EQ(server_port("ip:::1"), "30431");
  EXPECT_EQ(server_port("ip:[::1]:1234"), "1234");
  for (const char *uri : {"", "local:", "usb:1.2.3", "serial:/dev/ttyUSB0,115200", "ip"})
    EXPECT_EQ(server_port(uri), "") << uri;
}

/// Answers `text` to the commands that begin so.
IiodServer::FaultHook answer_to(std::string command, std::string text) {
  return [=](std::string_view line) -> IiodFault {
    if (!line.starts_with(command))
      return {};
    return {IiodFault::Kind::raw_answer, 0, text};
  };
}

/// Sentence of an open, start and read that fail; empty where they do not.
std::string failure_at(const std::string &uri) {
  try {
    IioSourceOptions options;
    options.uri = uri;
    const auto source = open_iio_source(options);
    source->start();
    Frame frames[16];
    for (int i = 0; i < 50; ++i)
      source->read(frames, std::chrono::milliseconds(200));
  } catch (const Error &e) {
    return e.what();
  }
  return {};
}

/// Before a sample is taken for another.
TEST(HostileServer, whose_samples_cannot_be_read_is_refused_at_the_start) {
  std::mt19937_64 rng(fresh_seed());
  const auto context = served_pair(kU16, kU16, 1000.0);
  const auto described = [&](const std::string &from, const std::string &to) {
    std::string xml = context_xml(*context);
    for (std::size_t at = 0; (at = xml.find(from, at)) != xml.npos; at += to.size())
      xml.replace(at, from.size(), to);
    return answer_to("PRINT", std::to_string(xml.size()) + "\n" + xml + "\n");
  };
  const struct {
    IiodServer::FaultHook hook;
    const char *said;
  } cases[] = {
      {described("le:u16/16", "le:f32/32"), "'le:f32/32>>0', which is no whole number"},
      {described("le:u16/16", "be:f16/16"), "no whole number"},
      {described("le:s64/64", "le:s32/32"), "a timestamp has 64 bits"},
      {answer_to("READBUF",
                 "16\n" + std::string(9 + below(rng, 4000), 'f') + "\n" + std::string(100, 'x')),
       "do not trust it"},
      {answer_to("READ iio:device0 sampling_frequency", std::string("6\n1e308\0\n", 9)),
       "no converter samples at"},
      {answer_to("READ iio:device0 sampling_frequency", std::string("7\n1e-320\0\n", 10)),
       "no converter samples at"},
  };
  for (const auto &[hook, said] : cases) {
    Served server(context, hook);
    const std::string sentence = failure_at(server.uri());
    EXPECT_NE(sentence.find(said), std::string::npos) << said << ": " << sentence;
    EXPECT_NO_THROW(list_iio_devices(server.uri())); // its other devices may be fine
  }
}

/// It cannot make a recording of a second end before a second is over.
TEST(HostileServer, that_leaps_in_time_is_not_believed) {
  std::mt19937_64 rng(fresh_seed());
  for (int trial = 0; trial < 3; ++trial) {
    const auto leap = static_cast<std::int64_t>(2'500'000'000 + rng() % 56'000'000'000);
    const std::size_t at = 1 + below(rng, 300);
    std::atomic<std::size_t> frames = 0;
    Served server(served_pair(kU16, kU16, 1000.0), [&](std::string_view line) -> IiodFault {
      if (!line.starts_with("READBUF"))
        return {};
      const std::size_t bytes = std::stoul(std::string(line.substr(line.rfind(' '))));
      std::string answer = std::to_string(bytes) + "\n00000007\n";
      for (std::size_t done = 0; done < bytes; done += 16, ++frames) {
        const std::int64_t stamp =
            static_cast<std::int64_t>(frames) * 1'000'000 + (frames < at ? 0 : leap);
        answer.append(8, '\0');
        answer.append(reinterpret_cast<const char *>(&stamp), sizeof stamp);
      }
      usleep(static_cast<useconds_t>(bytes / 16 * 1000)); // as long as it takes at 1 kHz
      return {IiodFault::Kind::raw_answer, 0, answer};
    });
    IioSourceOptions options;
    options.uri = server.uri();
    const auto source = open_iio_source(options);
    source->start();
    std::vector<Frame> read(64);
    std::size_t count = 0;
    double last_s = 0;
    while (count < 400) {
      const ReadResult result = source->read(read, std::chrono::milliseconds(1000));
      ASSERT_GT(result.count, 0u);
      count += result.count;
      last_s = read[result.count - 1].time_s;
    }
    EXPECT_NEAR(last_s, static_cast<double>(count - 1) * 1e-3, 1e-5) << leap << " at " << at;
    EXPECT_EQ(source->statistics().bad_times, 1u);
  }
}

TEST(HostileServer, that_sends_empty_lines_for_ever_is_given_up) {
  for (const char *command : {"PRINT", "OPEN", "READBUF"}) {
    Served server(served_pair(kU16, kU16, 1000.0), answer_to(command, std::string(1 << 20, '\n')));
    EXPECT_NE(failure_at(server.uri()), "") << command;
  }
}

TEST(HostileServer, with_an_odd_description_is_refused_before_anybody_prints_it) {
  const struct {
    const char *answer, *said;
  } cases[] = {{"2147483646\n", "do not trust it"},
               {"99999999999999999999\n", "does not come to an end"},
               {"rubbish\n", "does not come to an end"},
               {"12\n<a>\x1b[2J</a>\n", "control characters"},
               {"8\n<a>\xc2\x9b</a>\n", "control characters"},
               {"10\n<<<<<<<<<<\n", "cannot be understood"},
               {"0\n\n", "cannot be understood"}};
  for (const auto &[answer, said] : cases) {
    auto whole = [&, text = std::string(answer)](std::string_view line) -> IiodFault {
      if (!line.starts_with("PRINT") && !line.starts_with("ZPRINT"))
        return {};
      return {IiodFault::Kind::raw_answer, 0, text};
    };
    Served server(served_pair(kU16, kU16, 1000.0), whole);
    testing::internal::CaptureStderr();
    const std::string sentence = failure_at(server.uri());
    const std::string printed = testing::internal::GetCapturedStderr();
    EXPECT_NE(sentence.find(said), std::string::npos) << answer << ": " << sentence;
    EXPECT_EQ(printed.find('\x1b'), std::string::npos) << printed;
  }
}

/// A socket that listens at a port of this machine.
struct Listener {
  Descriptor fd{socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  int port = 0;
  Listener() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(fd.get(), reinterpret_cast<sockaddr *>(&address), size), 0);
    EXPECT_EQ(listen(fd.get(), 4), 0);
    EXPECT_EQ(getsockname(fd.get(), reinterpret_cast<sockaddr *>(&address), &size), 0);
    port = ntohs(address.sin_port);
  }
};

TEST(HostileServer, has_the_time_of_one_dialogue_for_each_of_many) {
  const Listener listener;
  const Descriptor ours = connect_to(listener.port);
  const Descriptor theirs(accept(listener.fd.get(), nullptr, nullptr));
  const std::string text = std::to_string(listener.port);
  constexpr std::chrono::milliseconds kLimit(400);
  DialogueWatch watch(text, sockets_to(text), kLimit);
  char c = 0;
  for (int k = 0; k < 8; ++k) { // together longer than one may take
    const DialogueWatch::Dialogue dialogue(watch);
    std::this_thread::sleep_for(kLimit / 4);
    EXPECT_EQ(recv(ours.get(), &c, 1, MSG_DONTWAIT), -1) << k;
    EXPECT_EQ(errno, EAGAIN);
  }
  std::this_thread::sleep_for(2 * kLimit); // between two nobody waits for anything
  EXPECT_EQ(recv(ours.get(), &c, 1, MSG_DONTWAIT), -1);
  const auto begun = std::chrono::steady_clock::now();
  const DialogueWatch::Dialogue dialogue(watch);
  EXPECT_EQ(recv(ours.get(), &c, 1, 0), 0) << "it was not cut off";
  EXPECT_GE(std::chrono::steady_clock::now() - begun, kLimit);
}

/// What is read byte by byte, each in time, and never ends.
TEST(HostileServer, that_goes_on_sending_is_cut_off_when_the_time_is_over) {
  const Listener listener;
  const int port = listener.port;
  const std::string text = std::to_string(port);
  using Which = ServerWatch::Which;
  for (const Which which : {Which::these, Which::all_but}) {
    const Descriptor other = connect_to(port); // of somebody else, before
    const Descriptor other_end(accept(listener.fd.get(), nullptr, nullptr));
    const auto before = sockets_to(text);
    ASSERT_EQ(before.size(), 1u);
    std::vector<OpenSocket> watched = before;
    Descriptor ours;
    if (which == Which::these) {
      ours = connect_to(port);
      watched = sockets_to(text);
      std::erase(watched, before[0]);
      ASSERT_EQ(watched.size(), 1u);
    }
    ServerWatch watch(text, watched, which, std::chrono::milliseconds(300));
    if (which == Which::all_but)
      ours = connect_to(port);
    const Descriptor theirs(accept(listener.fd.get(), nullptr, nullptr));
    std::thread sender([&] {
      while (send(theirs.get(), "\n", 1, MSG_NOSIGNAL) == 1)
        usleep(1000);
    });
    char c = 0;
    while (recv(ours.get(), &c, 1, 0) == 1) {
    }
    shutdown(theirs.get(), SHUT_RDWR);
    sender.join();
    EXPECT_TRUE(watch.over());
    EXPECT_EQ(recv(other.get(), &c, 1, MSG_DONTWAIT), -1) << "another's connection was cut";
    EXPECT_EQ(errno, EAGAIN);
  }
}

/// What it was not asked any more is not absent: an offset, say, without which the volts are
/// others.
TEST(HostileServer, that_goes_away_while_it_is_asked_is_a_loss) {
  auto context = served_pair(kU16, kU16, 1000.0);
  for (ServedChannel &channel : context->devices[0].channels)
    channel.attributes.push_back({"offset", "-100", {}, {}});
  int losses = 0;
  for (bool open = false; !open; ++losses) {
    ASSERT_LT(losses, 100);
    std::atomic<int> asked = 0;
    Served server(context, [&asked, losses](std::string_view line) -> IiodFault {
      const bool last = line.starts_with("READ ") && asked++ == losses;
      return {last ? IiodFault::Kind::drop : IiodFault::Kind::none, 0, {}};
    });
    IioSourceOptions options;
    options.uri = server.uri();
    try {
      const auto source = open_iio_source(options);
      EXPECT_GE(losses, 7) << "labels, scales, offsets, and the rate of a pair";
      open = asked <= losses;
      EXPECT_TRUE(open) << "opened although it went away at question " << losses;
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_DISCONNECTED) << losses << ": " << e.what();
    }
  }
}

TEST(HostileServer, gets_a_sentence_for_every_nonsense) {
  std::mt19937_64 rng(fresh_seed());
  for (int draw = 0; draw < 40; ++draw) {
    const std::uint64_t seed = rng();
    Served server(served_pair(kU16, kU16, 1000.0), [seed](std::string_view line) -> IiodFault {
      std::mt19937_64 own(seed ^ std::hash<std::string_view>()(line));
      if (own() % 3)
        return {};
      std::string text = std::to_string(static_cast<int>(own() % 300) - 150) + "\n";
      for (std::size_t n = below(own, 200); n > 0; --n)
        text += static_cast<char>(own());
      return {IiodFault::Kind::raw_answer, 0, text};
    });
    try {
      IioSourceOptions options;
      options.uri = server.uri();
      const auto source = open_iio_source(options);
      source->start();
      Frame frames[16];
      source->read(frames, std::chrono::milliseconds(20));
    } catch (const Error &e) {
      EXPECT_STRNE(e.what(), "");
    }
  }
}

} // namespace
