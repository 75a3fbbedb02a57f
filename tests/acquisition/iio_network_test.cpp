// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The network backend of the real libiio against a server in this process, with every fault that a
// network or a server can have.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <thread>

#include "acquisition/iio_source.h"
#include "base/error.h"
#include "run_program.h"
#include "served.h"

using namespace ada;
using namespace ada::test;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds kPatience = 60s; ///< waited out only by what fails

const ScanFormat kU16{16, 16, 0, 1, false, false};
const ScanFormat kU32{32, 32, 0, 1, false, false};

std::unique_ptr<IioSource> open_at(const std::string &uri, std::size_t buffer_frames = 0) {
  IioSourceOptions o;
  o.uri = uri;
  o.buffer_frames = buffer_frames;
  return open_iio_source(o);
}

ada4571_status status_of(const std::function<void()> &action, std::string *text = nullptr) {
  try {
    action();
  } catch (const Error &e) {
    if (text)
      *text = e.what();
    return e.status();
  }
  return ADA4571_OK;
}

/// Answers faults one after the other to the commands that begin with `verb`.
class Faults {
public:
  Faults(std::string verb, std::vector<IiodFault> faults)
      : state_(std::make_shared<State>()), verb_(std::move(verb)) {
    state_->faults = std::move(faults);
  }
  IiodFault operator()(std::string_view line) const {
    if (!line.starts_with(verb_))
      return {};
    const std::size_t i = state_->next++;
    return i < state_->faults.size() ? state_->faults[i] : IiodFault{};
  }
  std::size_t commands() const { return state_->next; }

private:
  struct State {
    std::vector<IiodFault> faults;
    std::atomic<std::size_t> next{0};
  };
  std::shared_ptr<State> state_;
  std::string verb_;
};

/// Expects frames n, n + 1, ... of served_pair().
void expect_counting(const std::vector<Frame> &frames, double first) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].vsin_v, (first + 1 + double(i)) * 1e-3) << i;
    ASSERT_EQ(frames[i].vcos_v, 3 * (first + double(i)) * 1e-3) << i;
  }
}

std::vector<Frame> read_frames(Source &source, std::size_t count,
                               std::chrono::milliseconds timeout) {
  std::vector<Frame> frames(count);
  std::size_t got = 0;
  while (got < count) {
    const ReadResult r = source.read(std::span(frames).subspan(got), timeout);
    if (r.outcome != ReadOutcome::frames)
      break;
    got += r.count;
  }
  frames.resize(got);
  return frames;
}

TEST(IioNetwork, StreamsFramesInVolts) {
  Served server(served_pair(kU16, kU16, 10000.0));
  const auto source = open_at(server.uri());
  EXPECT_EQ(source->info().description, server.uri() + " served-adc (iio:device0)");
  source->start();
  const auto frames = read_frames(*source, 3000, kPatience);
  ASSERT_EQ(frames.size(), 3000u);
  expect_counting(frames, 0);
  EXPECT_EQ(source->statistics().lost, 0u);
}

TEST(IioNetwork, AScanThatClientAndServerMeasureWronglyIsReadRight) {
  Served server(served_pair(kU32, kU16, 10000.0, false));
  const auto source = open_at(server.uri());
  source->start();
  const auto frames = read_frames(*source, 3000, kPatience);
  ASSERT_EQ(frames.size(), 3000u);
  expect_counting(frames, 0);
}

TEST(IioNetwork, ShortTimeoutsAreOrdinaryThoughTheLibraryBlocks) {
  std::promise<void> gate;
  Served server(served_pair(kU16, kU16, 10000.0),
                [opened = gate.get_future().share()](std::string_view line) {
                  if (line.starts_with("READBUF"))
                    opened.wait();
                  return IiodFault{};
                });
  const auto source = open_at(server.uri(), 20);
  source->start();
  Frame frame;
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(source->read({&frame, 1}, 50ms).outcome, ReadOutcome::timeout);
  gate.set_value();
  const auto frames = read_frames(*source, 40, kPatience);
  EXPECT_EQ(frames.size(), 40u);
  expect_counting(frames, 0);
}

TEST(IioNetwork, CancelReturnsAtOnceWhileTheServerIsSilent) {
  constexpr std::size_t kTries = 5;
  const Faults faults("READBUF", {kTries, {IiodFault::Kind::stall, 0}});
  Served server(served_pair(kU16, kU16, 10000.0), faults);
  const auto source = open_at(server.uri());
  // The blocked refill is woken, or stop() would take the 5 s that it has. A busy machine makes
  // that longer, but not every time.
  auto shortest = Clock::duration::max();
  for (std::size_t i = 1; i <= kTries; ++i) {
    source->start();
    std::thread other([&] {
      while (faults.commands() < i)
        std::this_thread::sleep_for(1ms);
      source->cancel();
    });
    Frame frame;
    EXPECT_EQ(source->read({&frame, 1}, -1ms).outcome, ReadOutcome::cancelled);
    other.join();
    const auto before = Clock::now();
    source->stop();
    shortest = std::min(shortest, Clock::now() - before);
  }
  EXPECT_LT(shortest, 3s);

  source->start(); // the READBUFs from here on are sound
  EXPECT_EQ(read_frames(*source, 100, kPatience).size(), 100u);
}

/// A server that hangs (a cable that was pulled) answers nothing, wherever it is asked.
TEST(IioNetwork, CancelEndsAStartThatWaitsForAServer) {
  for (const char *asked : {"PRINT", "TIMEOUT", "SET", "OPEN"}) {
    std::atomic<bool> hangs = false;
    std::atomic<std::size_t> waiting = 0;
    Served server(served_pair(kU16, kU16, 10000.0), [&](std::string_view line) {
      if (hangs && line.starts_with("READBUF"))
        return IiodFault{IiodFault::Kind::drop};
      const bool stalls = hangs && line.starts_with(asked);
      waiting += stalls;
      return IiodFault{stalls ? IiodFault::Kind::stall : IiodFault::Kind::none};
    });
    const auto source = open_at(server.uri());
    source->start();
    hangs = true;
    std::vector<Frame> block(64);
    EXPECT_EQ(status_of([&] {
                while (source->read(block, kPatience).outcome == ReadOutcome::frames) {
                }
              }),
              ADA4571_ERROR_DISCONNECTED);
    // As above: of several starts one at least is not delayed by a busy machine.
    auto shortest = Clock::duration::max();
    for (std::size_t i = 1; i <= 3; ++i) {
      std::atomic<Clock::rep> began = 0;
      std::thread other([&] {
        while (waiting < i)
          std::this_thread::sleep_for(1ms);
        began = Clock::now().time_since_epoch().count();
        source->cancel();
      });
      EXPECT_NE(status_of([&] { source->start(); }), ADA4571_OK) << asked;
      const auto ended = Clock::now();
      other.join();
      shortest = std::min(shortest, ended.time_since_epoch() - Clock::duration(began.load()));
    }
    EXPECT_LT(shortest, 3s) << asked; // the time-out is 5 s
    hangs = false;
    source->start();
    EXPECT_EQ(read_frames(*source, 100, kPatience).size(), 100u) << asked;
  }
}

TEST(IioNetwork, AfterATimeoutOfTheServerTheBufferIsMadeAnew) {
  // libiio 0.24: after one time-out every refill is -EBADF for ever.
  const Faults faults("READBUF", {{IiodFault::Kind::none},
                                  {IiodFault::Kind::error, ETIMEDOUT},
                                  {IiodFault::Kind::none},
                                  {IiodFault::Kind::error, EBADF}});
  Served server(served_pair(kU16, kU16, 10000.0), faults);
  const auto source = open_at(server.uri(), 400);
  source->start();
  const auto frames = read_frames(*source, 2000, kPatience);
  ASSERT_EQ(frames.size(), 2000u);
  expect_counting({frames.begin(), frames.begin() + 400}, 0);
  expect_counting({frames.begin() + 400, frames.begin() + 600}, 0); // a new buffer begins anew
  EXPECT_GT(faults.commands(), 4u);
}

TEST(IioNetwork, ABlockTooSlowForTheServersTimeoutShrinksUntilItFits) {
  // 64 frames at 16 S/s need 4 s, the server's patience ends after 0.2 s: 64, 32, ... 2 frames.
  auto context = served_pair(kU16, kU16, 0.0);
  context->devices[0].attributes.clear(); // so that our side does not know the rate
  context->devices[0].rate_hz = 16.0;
  std::atomic<unsigned> smallest{~0u};
  Served server(context, [&](std::string_view line) {
    if (line.starts_with("OPEN"))
      smallest = std::min(smallest.load(),
                          static_cast<unsigned>(std::stoul(std::string(line.substr(17)))));
    if (line.starts_with("READBUF") && smallest > 2)
      return IiodFault{IiodFault::Kind::error, ETIMEDOUT};
    return IiodFault{};
  });
  const auto source = open_at(server.uri());
  source->start();
  Frame frames[4];
  const ReadResult r = source->read(frames, kPatience);
  ASSERT_EQ(r.outcome, ReadOutcome::frames);
  EXPECT_EQ(smallest, 2u);
  EXPECT_EQ(frames[0].vsin_v, 1e-3);
}

TEST(IioNetwork, ServerDeathIsReportedAndStartOpensAgain) {
  auto server = std::make_unique<Served>(served_pair(kU16, kU16, 10000.0));
  const int port = server->port();
  const auto source = open_at(server->uri());
  source->start();
  ASSERT_EQ(read_frames(*source, 100, kPatience).size(), 100u);
  server->die();
  std::string text;
  EXPECT_EQ(status_of(
                [&] {
                  std::vector<Frame> block(64);
                  while (source->read(block, kPatience).outcome == ReadOutcome::frames) {
                  }
                },
                &text),
            ADA4571_ERROR_DISCONNECTED);
  EXPECT_NE(text.find("the server of ip:127.0.0.1"), std::string::npos) << text;

  EXPECT_EQ(status_of([&] { source->start(); }, &text), ADA4571_ERROR_DISCONNECTED) << text;
  EXPECT_NE(text.find("no IIO server answers"), std::string::npos) << text;

  Served again(served_pair(kU16, kU16, 10000.0), {}, port);
  source->start();
  EXPECT_EQ(read_frames(*source, 100, kPatience).size(), 100u);
}

TEST(IioNetwork, FaultsInTheMiddleOfAStreamEndItWithAClearError) {
  for (const IiodFault &fault :
       {IiodFault{IiodFault::Kind::drop}, IiodFault{IiodFault::Kind::short_answer},
        IiodFault{IiodFault::Kind::error, EIO}, IiodFault{IiodFault::Kind::error, ENODEV},
        IiodFault{IiodFault::Kind::raw_answer, 0, "rubbish\n"},
        IiodFault{IiodFault::Kind::raw_answer, 0, "99999999999999999999\n"}}) {
    Served server(served_pair(kU16, kU16, 10000.0), Faults("READBUF", {{}, fault}));
    const auto source = open_at(server.uri(), 200);
    source->start();
    std::vector<Frame> got;
    std::string text;
    EXPECT_EQ(status_of([&] { got = read_frames(*source, 200, kPatience); }, &text), ADA4571_OK)
        << text;
    expect_counting(got, 0);
    EXPECT_EQ(status_of([&] { read_frames(*source, 1, kPatience); }, &text),
              ADA4571_ERROR_DISCONNECTED)
        << static_cast<int>(fault.kind) << text;
    EXPECT_NE(text.find("served-adc"), std::string::npos) << text;
    source->start(); // and the next capture is sound
    EXPECT_EQ(read_frames(*source, 200, kPatience).size(), 200u);
  }
}

TEST(IioNetwork, ARefusedBufferIsReportedWithTheReason) {
  for (const auto &[error, status] :
       {std::pair(EBUSY, ADA4571_ERROR_BUSY), std::pair(EACCES, ADA4571_ERROR_PERMISSION),
        std::pair(ENOMEM, ADA4571_ERROR_NO_MEMORY), std::pair(EINVAL, ADA4571_ERROR_IO)}) {
    Served server(served_pair(kU16, kU16, 10000.0),
                  Faults("OPEN", {{IiodFault::Kind::error, error}}));
    const auto source = open_at(server.uri());
    std::string text;
    EXPECT_EQ(status_of([&] { source->start(); }, &text), status) << text;
    EXPECT_NE(text.find("iio:device0"), std::string::npos) << text;
    source->start();
  }
}

TEST(IioNetwork, AttributesThatCannotBeReadAreReported) {
  Served server(served_pair(kU16, kU16, 10000.0), [](std::string_view line) {
    if (line.find("scale") != line.npos)
      return IiodFault{IiodFault::Kind::error, EIO};
    return IiodFault{};
  });
  std::string text;
  EXPECT_EQ(status_of([&] { open_at(server.uri()); }, &text), ADA4571_ERROR_UNSUPPORTED) << text;
  EXPECT_NE(text.find("attribute scale"), std::string::npos) << text;
}

TEST(IioNetwork, AWrongContextIsAnErrorAndNoCrash) {
  for (const char *answer : {"-22\n", "10\nrubbish<<<\n", "0\n", "999999\n<context", "\n\n\n\n"}) {
    Served server(served_pair(kU16, kU16, 10000.0), [answer](std::string_view line) {
      if (line.starts_with("PRINT") || line.starts_with("ZPRINT"))
        return IiodFault{IiodFault::Kind::raw_answer, 0, answer};
      return IiodFault{};
    });
    std::string text;
    std::thread end([&] { // a server that promises more than it sends
      std::this_thread::sleep_for(500ms);
      server.die();
    });
    EXPECT_NE(status_of([&] { open_at(server.uri()); }, &text), ADA4571_OK) << answer;
    EXPECT_NE(text.find(server.uri()), std::string::npos) << text;
    end.join();
  }
}

TEST(IioNetwork, UrisThatLeadNowhereSaySo) {
  std::string text;
  EXPECT_EQ(status_of([&] { open_at("nonsense"); }, &text), ADA4571_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(text.find("ip:HOST:PORT"), std::string::npos) << text;
  int port = 0;
  {
    const Served server(served_pair(kU16, kU16, 1.0)); // a port that was free a moment ago
    port = server.port();
  }
  EXPECT_EQ(status_of([&] { open_at("ip:127.0.0.1:" + std::to_string(port)); }, &text),
            ADA4571_ERROR_DISCONNECTED);
  EXPECT_NE(text.find("is iiod running"), std::string::npos) << text;
}

TEST(IioNetwork, AnotherClientsFramesDoNotDisturbOurs) {
  Served server(served_pair(kU16, kU16, 10000.0));
  const auto source = open_at(server.uri(), 250);
  source->start();
  const ProgramResult other = run_program("iio_readdev -u " + server.uri() +
                                          " -b 250 -s 1000 served-adc voltage1 2>/dev/null");
  EXPECT_EQ(other.output.size(), 2000u);
  const auto frames = read_frames(*source, 2000, kPatience);
  ASSERT_EQ(frames.size(), 2000u);
  expect_counting(frames, 0);
}

TEST(IioNetwork, AReaderThatIsLateLosesNothingThatTheServerHolds) {
  Served server(served_pair(kU16, kU16, 20000.0));
  const auto source = open_at(server.uri());
  source->start();
  std::this_thread::sleep_for(700ms);
  const auto frames = read_frames(*source, 10000, kPatience);
  ASSERT_EQ(frames.size(), 10000u);
  expect_counting(frames, 0);
}

TEST(IioNetwork, RandomCommandsNeverHurtTheServer) {
  Served server(served_pair(kU16, kU16, 10000.0));
  for (const char *line : {"\r\n\r\n",
                           "OPEN\r\n",
                           "OPEN iio:device0\r\n",
                           "OPEN iio:device0 0 00000003\r\n",
                           "OPEN iio:device0 99999999999999 00000003\r\n",
                           "OPEN iio:device0 10 ffffffff\r\n",
                           "OPEN iio:device0 10 0000000g\r\n",
                           "OPEN iio:device0 10 3\r\n",
                           "OPEN x 10 00000003\r\n",
                           "READBUF iio:device0 100\r\n",
                           "CLOSE iio:device0\r\n",
                           "READ\r\n",
                           "READ iio:device0\r\n",
                           "READ iio:device0 INPUT\r\n",
                           "READ iio:device0 INPUT voltage0\r\n",
                           "READ iio:device0 INPUT voltage9 raw\r\n",
                           "WRITE\r\n",
                           "WRITE iio:device0 x\r\n",
                           "WRITE iio:device0 x 99999999\r\n",
                           "SETTRIG\r\n",
                           "SETTRIG iio:device0 trigger9\r\n",
                           "GETTRIG y\r\n",
                           "TIMEOUT\r\n",
                           "TIMEOUT -1\r\n",
                           "SET\r\n",
                           "   \r\n",
                           "READ iio:device0 DEBUG \r\n",
                           "READ iio:device0 BUFFER watermark\r\n"}) {
    const std::string command =
        "printf '" + std::string(line) + "' | timeout 60 bash -c 'exec 3<>/dev/tcp/127.0.0.1/" +
        std::to_string(server.port()) + "; cat >&3; printf \"EXIT\\r\\n\" >&3; cat <&3 || true'";
    const ProgramResult r = run_program(command);
    EXPECT_EQ(r.status, 0) << line; // the server closed, or reset: it is alive and not stuck
    if (std::string_view(line).find_first_not_of("\r\n") != std::string_view::npos) {
      EXPECT_FALSE(r.output.empty()) << line;
    }
  }
  // A line without end is given up, not stored for ever.
  const ProgramResult endless =
      run_program("head -c 10000000 /dev/zero | tr '\\0' 'x' | timeout 60 bash -c 'exec "
                  "3<>/dev/tcp/127.0.0.1/" +
                  std::to_string(server.port()) + "; cat >&3' 2>/dev/null");
  EXPECT_NE(endless.status, 124);
  EXPECT_EQ(run_program("iio_info -u " + server.uri() + " >/dev/null").status, 0);
}

} // namespace
