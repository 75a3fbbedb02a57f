// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include <cerrno>
#include <functional>
#include <map>

#include "acquisition/pins.h"

using namespace ada;
using namespace std::chrono_literals;

namespace {

/// A board in memory: lines with a level, a holder and an error to give.
struct Board {
  struct Line {
    bool level = false; ///< physical
    bool output = false, held = false;
    int error = 0;
    std::string holder;
  };
  std::map<std::string, Line> lines;
  int requests = 0;
};

class FakeLine final : public GpioLine {
public:
  FakeLine(Board &board, LineAddress address, bool active_low)
      : board_(board), address_(std::move(address)), line_(board.lines.at(address_.text())),
        active_low_(active_low) {}
  ~FakeLine() override {
    if (held_)
      line_.held = false;
  }
  void drive(bool active) override {
    request();
    held_ = line_.held = line_.output = true;
    line_.level = active != active_low_;
  }
  bool read() override {
    request();
    return line_.level != active_low_;
  }

private:
  void request() {
    if (held_)
      return;
    ++board_.requests;
    if (line_.error)
      throw line_error(address_, line_.error, "request", line_.holder);
  }
  Board &board_;
  LineAddress address_;
  Board::Line &line_;
  bool active_low_, held_ = false;
};

class FakeChips final : public GpioChips {
public:
  explicit FakeChips(Board &board) : board_(board) {}
  std::unique_ptr<GpioLine> find(const LineAddress &address, bool active_low) override {
    if (!board_.lines.count(address.text()))
      throw line_not_found(address, false);
    return std::make_unique<FakeLine>(board_, address, active_low);
  }

private:
  Board &board_;
};

Pins make(Board &board, const PinsConfig &config = {}) {
  return Pins(std::make_unique<FakeChips>(board), config);
}

ada4571_status status_of(const std::function<void()> &action, std::string &text) {
  try {
    action();
  } catch (const Error &e) {
    text = e.what();
    return e.status();
  }
  return ADA4571_OK;
}

TEST(PinsTest, LinesAreNamedOrNumbered) {
  EXPECT_EQ(parse_line("ada4571-gc").name, "ada4571-gc");
  EXPECT_EQ(parse_line("ada4571-gc").chip, "");
  EXPECT_EQ(parse_line("gpiochip0:17").chip, "gpiochip0");
  EXPECT_EQ(parse_line("gpiochip0:17").offset, 17u);
  EXPECT_EQ(parse_line("/dev/gpiochip12:0").chip, "/dev/gpiochip12");
  EXPECT_EQ(parse_line("3:4").text(), "3:4");
  for (const char *text : {"", ":3", "a:", "a:b", "a:-1", "a:1x", "a:99999999999"}) {
    try {
      parse_line(text);
      FAIL() << text;
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_INVALID_ARGUMENT);
    }
  }
}

TEST(PinsTest, TheDefaultLinesAreFoundByName) {
  Board board;
  board.lines["ada4571-gc"];
  board.lines["ada4571-pd"];
  Pins pins = make(board);
  pins.set(Pins::Pin::gc, true);
  EXPECT_TRUE(board.lines["ada4571-gc"].level);
  EXPECT_TRUE(board.lines["ada4571-gc"].output);
  EXPECT_FALSE(board.lines["ada4571-pd"].held); // not touched
  pins.set(Pins::Pin::gc, false);
  EXPECT_FALSE(board.lines["ada4571-gc"].level);
}

TEST(PinsTest, PolarityTurnsTheLevelRound) {
  Board board;
  board.lines["gpiochip0:4"].level = true;
  PinsConfig config;
  config.gc = "gpiochip0:4";
  config.gc_active_low = true;
  Pins pins = make(board, config);
  EXPECT_FALSE(pins.get(Pins::Pin::gc));
  pins.set(Pins::Pin::gc, true);
  EXPECT_FALSE(board.lines["gpiochip0:4"].level);
  EXPECT_TRUE(pins.get(Pins::Pin::gc));
}

TEST(PinsTest, ALineIsHeldAsLongAsTheHandleLives) {
  Board board;
  board.lines["ada4571-gc"];
  {
    Pins pins = make(board);
    pins.set(Pins::Pin::gc, true);
    pins.set(Pins::Pin::gc, false);
    EXPECT_TRUE(board.lines["ada4571-gc"].held);
    EXPECT_EQ(board.requests, 1);
  }
  EXPECT_FALSE(board.lines["ada4571-gc"].held);
}

TEST(PinsTest, GetGivesWhatWasSetElseWhatTheLineReads) {
  Board board;
  board.lines["ada4571-gc"].level = true;
  Pins pins = make(board);
  EXPECT_TRUE(pins.get(Pins::Pin::gc));
  EXPECT_FALSE(board.lines["ada4571-gc"].held); // reading holds nothing and drives nothing
  EXPECT_FALSE(board.lines["ada4571-gc"].output);
  pins.set(Pins::Pin::gc, true);
  board.lines["ada4571-gc"].level = false; // something pulls the pin: what was set counts
  EXPECT_TRUE(pins.get(Pins::Pin::gc));
}

TEST(PinsTest, OnlyPowerUpWaits) {
  Board board;
  board.lines["ada4571-gc"];
  board.lines["ada4571-pd"];
  Pins pins = make(board);
  const auto time = [&](Pins::Pin pin, bool on) {
    const auto began = std::chrono::steady_clock::now();
    pins.set(pin, on);
    return std::chrono::steady_clock::now() - began;
  };
  EXPECT_GE(time(Pins::Pin::pd, false), Pins::kPowerUp);
  // On a busy machine one of the others may take long, but not all of many.
  auto shortest = std::chrono::steady_clock::duration::max();
  for (int i = 0; i < 20; ++i)
    shortest = std::min({shortest, time(Pins::Pin::pd, true), time(Pins::Pin::gc, i % 2)});
  EXPECT_LT(shortest, Pins::kPowerUp / 2);
}

TEST(PinsTest, BusyMissingAndForbiddenLinesSaySoInOneSentence) {
  Board board;
  board.lines["ada4571-gc"].error = EBUSY;
  board.lines["ada4571-gc"].holder = "gpioset";
  board.lines["ada4571-pd"].error = EACCES;
  Pins pins = make(board);
  std::string text;
  EXPECT_EQ(status_of([&] { pins.set(Pins::Pin::gc, true); }, text), ADA4571_ERROR_BUSY);
  EXPECT_EQ(text, "GPIO line ada4571-gc is in use by \"gpioset\"; end that first");
  EXPECT_EQ(status_of([&] { pins.set(Pins::Pin::pd, true); }, text), ADA4571_ERROR_PERMISSION);
  EXPECT_NE(text.find("udev rules"), std::string::npos);
  board.lines.clear();
  Pins none = make(board);
  EXPECT_EQ(status_of([&] { none.get(Pins::Pin::gc); }, text), ADA4571_ERROR_NOT_FOUND);
  EXPECT_NE(text.find("no GPIO chip has a line named \"ada4571-gc\""), std::string::npos) << text;
}

TEST(PinsTest, TheMachinesOwnChipsHaveNoLineOfAnUnlikelyName) {
  // The real libgpiod, on whatever this machine has.
  PinsConfig config;
  config.gc = "ada4571-no-such-line";
  config.pd = "gpiochip9999:3";
  Pins pins(make_gpio_chips(), config);
  std::string text;
  for (const Pins::Pin pin : {Pins::Pin::gc, Pins::Pin::pd}) {
    const ada4571_status status = status_of([&] { pins.get(pin); }, text);
    EXPECT_TRUE(status == ADA4571_ERROR_NOT_FOUND || status == ADA4571_ERROR_PERMISSION) << text;
    EXPECT_FALSE(text.empty());
  }
}

} // namespace
