// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "acquisition/config.h"
#include "ada4571.h"
#include "base/error.h"
#include "support/seed.h"

using namespace ada;
namespace fs = std::filesystem;

namespace {

class Config : public ::testing::Test {
protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "ada4571-config-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("XDG_CONFIG_HOME");
    fs::remove_all(folder_);
  }
  void put(const std::string &path, const std::string &text) const {
    fs::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path) << text;
  }
  static std::string message(const std::string &text) {
    try {
      parse_config(text, "f.toml");
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_FORMAT) << text;
      return e.what();
    }
    ADD_FAILURE() << "accepted: " << text;
    return {};
  }

  fs::path folder_;
};

TEST_F(Config, EveryKeyIsRead) {
  const StoredConfig c = parse_config(R"([source]
uri = "ip:bench:30431"
device = "ad7380"
sin = "voltage0"
cos = "vcos"
temp = "voltage2"
vdd = "voltage3"
trigger = "timer0"
sample_rate_hz = 10000
supply_v = 3.3
periods_per_turn = 1
[pins]
gc = "gpiochip0:17"
pd = "board-pd"
gc_active_low = true
pd_active_low = false
[calibration]
file = "/var/lib/sensor.toml"
)",
                                      "f.toml");
  EXPECT_EQ(c.source.uri, "ip:bench:30431");
  EXPECT_EQ(c.source.device, "ad7380");
  EXPECT_EQ(c.source.channels.sin, "voltage0");
  EXPECT_EQ(c.source.channels.cos, "vcos");
  EXPECT_EQ(c.source.channels.temp, "voltage2");
  EXPECT_EQ(c.source.channels.vdd, "voltage3");
  EXPECT_EQ(c.source.trigger, "timer0");
  EXPECT_EQ(c.source.sample_rate_hz, 10000.0);
  EXPECT_EQ(c.source.supply_v, 3.3);
  EXPECT_EQ(c.source.periods_per_turn, 1);
  EXPECT_EQ(c.pins.gc, "gpiochip0:17");
  EXPECT_EQ(c.pins.pd, "board-pd");
  EXPECT_TRUE(c.pins.gc_active_low);
  EXPECT_FALSE(c.pins.pd_active_low);
  EXPECT_EQ(c.calibration_file, "/var/lib/sensor.toml");
}

TEST_F(Config, AnEmptyFileGivesTheDefaults) {
  const StoredConfig c = parse_config("", "f.toml");
  EXPECT_EQ(c.source.uri, "local:");
  EXPECT_EQ(c.source.supply_v, 5.0);
  EXPECT_EQ(c.source.periods_per_turn, 2);
  EXPECT_FALSE(c.pins.gc.has_value());
  EXPECT_TRUE(c.calibration_file.empty());
}

TEST_F(Config, WhatIsNotUnderstoodIsRefusedWithItsPlace) {
  EXPECT_EQ(message("[source]\nchannel = 1\n"), "f.toml:2:1: unknown key \"channel\" in [source]");
  EXPECT_NE(message("[sources]\n").find("f.toml:1:"), std::string::npos);
  EXPECT_NE(message("uri = \"local:\"\n").find("f.toml:1:1: unknown entry \"uri\""),
            std::string::npos);
  EXPECT_NE(message("[source]\nuri = 1\n").find("f.toml:2:7: expected a text"), std::string::npos);
  EXPECT_NE(message("[source]\nuri = \"\"\n").find("f.toml:2:7:"), std::string::npos);
  EXPECT_NE(message("[source]\nuri = \"a\\nb\"\n").find("f.toml:2:7:"), std::string::npos);
  EXPECT_NE(
      message("[source]\nsupply_v = 0\n").find("f.toml:2:12: expected a number from 0.1 to 50"),
      std::string::npos);
  EXPECT_NE(message("[source]\nsupply_v = nan\n").find("f.toml:2:12:"), std::string::npos);
  EXPECT_NE(message("[source]\nsupply_v = inf\n").find("f.toml:2:12:"), std::string::npos);
  EXPECT_NE(message("[source]\nsupply_v = \"5\"\n").find("f.toml:2:12:"), std::string::npos);
  EXPECT_NE(message("[source]\nperiods_per_turn = 2.0\n").find("f.toml:2:20:"), std::string::npos);
  EXPECT_NE(message("[source]\nperiods_per_turn = 65537\n").find("from 1 to 65536"),
            std::string::npos);
  EXPECT_NE(message("[pins]\ngc_active_low = 1\n").find("true or false"), std::string::npos);
  EXPECT_NE(message("source = 1\n").find("must be a section"), std::string::npos);
  EXPECT_NE(message("[[source]]\n").find("must be a section"), std::string::npos);
  EXPECT_NE(message("[source]\nuri = \"a\"\nuri = \"b\"\n").find("f.toml:3:"), std::string::npos);
  EXPECT_NE(message("[source\n").find("f.toml:1:"), std::string::npos);
}

TEST_F(Config, TheUsersFolderIsSearchedByName) {
  put("ada4571/bench.toml", "[source]\ndevice = \"mine\"\n");
  EXPECT_EQ(find_config("bench"), (folder_ / "ada4571/bench.toml").string());
  EXPECT_EQ(load_config("bench").source.device, "mine");
  try {
    load_config("other");
    FAIL();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_NOT_FOUND);
    const std::string text = e.what();
    EXPECT_NE(text.find((folder_ / "ada4571/other.toml").string()), std::string::npos) << text;
    EXPECT_NE(text.find("/etc/ada4571/other.toml"), std::string::npos) << text;
  }
}

TEST_F(Config, TheFoldersAreTheUsersThenTheMachines) {
  EXPECT_EQ(config_folders(),
            (std::vector<std::string>{(folder_ / "ada4571").string(), "/etc/ada4571"}));
  setenv("XDG_CONFIG_HOME", "relative", 1); // invalid by the XDG specification
  const char *home = std::getenv("HOME");
  const std::string before = home ? home : "";
  setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(config_folders().front(), "/home/somebody/.config/ada4571");
  unsetenv("HOME");
  unsetenv("XDG_CONFIG_HOME");
  EXPECT_EQ(config_folders(), (std::vector<std::string>{"/etc/ada4571"}));
  try {
    find_config("x");
    FAIL();
  } catch (const Error &e) {
    EXPECT_NE(std::string(e.what()).find(": /etc/ada4571/x.toml does not exist"), std::string::npos)
        << e.what();
  }
  setenv("HOME", "relative", 1); // no better than none
  EXPECT_EQ(config_folders(), (std::vector<std::string>{"/etc/ada4571"}));
  EXPECT_THROW(save_config("x", {}), Error);
  if (home)
    setenv("HOME", before.c_str(), 1);
}

TEST_F(Config, NamesThatAreNoFileNamesAreRefused) {
  for (const char *name : {"", ".", "..", ".hidden", "-x", "a b", "a\nb", "a:b"}) {
    try {
      find_config(name);
      FAIL() << name;
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_INVALID_ARGUMENT) << name;
    }
  }
}

TEST_F(Config, ANameWithASlashIsAPath) {
  put("x/y.conf", "[calibration]\nfile = \"sensor.toml\"\n");
  const StoredConfig c = load_config((folder_ / "x/y.conf").string());
  EXPECT_EQ(c.calibration_file, (folder_ / "x/sensor.toml").string()); // beside the configuration
}

TEST_F(Config, WhatIsSavedIsReadBack) {
  StoredConfig c;
  c.source.uri = "ip:host";
  c.source.device = "a \"quoted\" \\ name";
  c.source.channels = {"vsin", "vcos", "", "voltage3"};
  c.source.sample_rate_hz = 12345.675;
  c.source.supply_v = 3.3;
  c.pins.gc = "ada4571-gc";
  c.pins.gc_active_low = true;
  c.calibration_file = "/a/b/../c.toml";
  const std::string path = save_config("bench", c);
  EXPECT_EQ(path, (folder_ / "ada4571/bench.toml").string());
  const StoredConfig back = load_config("bench");
  EXPECT_EQ(back.source.uri, c.source.uri);
  EXPECT_EQ(back.source.device, c.source.device);
  EXPECT_EQ(back.source.channels.vdd, "voltage3");
  EXPECT_EQ(back.source.channels.temp, "");
  EXPECT_EQ(back.source.sample_rate_hz, c.source.sample_rate_hz);
  EXPECT_EQ(back.source.supply_v, 3.3);
  EXPECT_EQ(back.pins.gc, "ada4571-gc");
  EXPECT_TRUE(back.pins.gc_active_low);
  EXPECT_EQ(back.calibration_file, "/a/c.toml");
}

TEST_F(Config, WhatCouldNotBeReadBackIsNotWritten) {
  put("ada4571/bench.toml", "[source]\ndevice = \"old\"\n");
  StoredConfig c;
  c.source.device = "line\nend";
  EXPECT_THROW(save_config("bench", c), Error);
  EXPECT_EQ(load_config("bench").source.device, "old");
  std::size_t files = 0;
  for ([[maybe_unused]] const auto &entry : fs::directory_iterator(folder_ / "ada4571"))
    ++files;
  EXPECT_EQ(files, 1u); // no temporary file is left
}

TEST_F(Config, FoldersAndHugeFilesAreNoConfigurations) {
  fs::create_directories(folder_ / "ada4571/dir.toml");
  EXPECT_THROW(load_config("dir"), Error);
  put("big.toml", std::string(2 << 20, '#'));
  EXPECT_THROW(load_config((folder_ / "big.toml").string()), Error);
}

/// What a folder can hold beside configurations; each with a word of what is said of it.
TEST_F(Config, OneBadFileHindersNoOther) {
  put("ada4571/good.toml", "[source]\ndevice = \"mine\"\n");
  put("ada4571/cut.toml", "[source\n");
  std::string deep = "[a";
  for (int i = 0; i < 200000; ++i)
    deep += ".a";
  put("ada4571/deep.toml", deep + "]\n");
  put("ada4571/binary.toml", std::string("\0\xff\x80", 3));
  put("ada4571/big.toml", std::string(2 << 20, '#'));
  const fs::path stored = folder_ / "ada4571";
  fs::create_symlink("loop.toml", stored / "loop.toml");
  fs::create_symlink("nowhere", stored / "dangling.toml");
  fs::create_symlink("/dev/zero", stored / "endless.toml");
  fs::create_directories(stored / "folder.toml");
  ASSERT_EQ(mkfifo((stored / "pipe.toml").c_str(), 0600), 0);
  const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string socket_path = (stored / "socket.toml").string();
  ASSERT_LT(socket_path.size(), sizeof address.sun_path);
  socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(fd, reinterpret_cast<sockaddr *>(&address), sizeof address), 0);
  const std::pair<std::string, std::string> bad[] = {{"cut", ":1:"},
                                                     {"deep", ":1:"},
                                                     {"binary", ":1:"},
                                                     {"big", "too large"},
                                                     {"loop", "cannot open"},
                                                     {"dangling", "cannot open"},
                                                     {"endless", "no regular file"},
                                                     {"folder", "no regular file"},
                                                     {"pipe", "no regular file"},
                                                     {"socket", "no regular file"}};
  if (geteuid() != 0) {
    put("ada4571/secret.toml", "[source]\n");
    fs::permissions(stored / "secret.toml", fs::perms::none);
  }

  EXPECT_EQ(load_config("good").source.device, "mine");
  for (const auto &[name, word] : bad) {
    try {
      load_config(name);
      ADD_FAILURE() << name;
    } catch (const Error &e) {
      const std::string why = e.what();
      EXPECT_TRUE(why.starts_with((stored / (name + ".toml")).string() + ":")) << why;
      EXPECT_NE(why.find(word), std::string::npos) << why;
    }
  }

  // The list of all has each with its problem.
  ada4571_stored_list *list = nullptr;
  ASSERT_EQ(ada4571_stored_list_new(nullptr, &list), ADA4571_OK) << ada4571_last_error();
  std::map<std::string, std::string> problems;
  for (std::size_t i = 0; i < ada4571_stored_list_count(list); ++i) {
    ada4571_stored entry;
    ada4571_stored_init(&entry);
    ASSERT_EQ(ada4571_stored_list_get(list, i, &entry), ADA4571_OK);
    problems[entry.name] = entry.problem;
  }
  ada4571_stored_list_free(list);
  EXPECT_EQ(problems.at("good"), "");
  for (const auto &[name, word] : bad)
    EXPECT_NE(problems.at(name).find(word), std::string::npos) << name << problems.at(name);

  try {
    load_config("nosuch");
    ADD_FAILURE();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_NOT_FOUND);
    EXPECT_TRUE(std::string(e.what()).starts_with("no stored configuration \"nosuch\""))
        << e.what();
  }
  close(fd);
}

TEST_F(Config, RandomDamageNeverCrashesAndIsReadOrRefusedWithAPlace) {
  std::mt19937_64 random(test::fresh_seed());
  const std::string sound = "[source]\nuri = \"local:\"\nsupply_v = 5.0\nperiods_per_turn = 2\n"
                            "[pins]\ngc = \"a\"\ngc_active_low = true\n";
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = sound;
    for (std::size_t k = 1 + test::below(random, 4); k > 0; --k)
      text[test::below(random, text.size())] = static_cast<char>(random() % 256);
    try {
      parse_config(text, "f.toml");
    } catch (const Error &e) {
      ASSERT_EQ(e.status(), ADA4571_ERROR_FORMAT);
      ASSERT_TRUE(std::string(e.what()).starts_with("f.toml:")) << e.what();
    }
  }
}

} // namespace
