// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include "acquisition/channel_choice.h"
#include "base/error.h"

using namespace ada;

namespace {

IioChannel voltage(const std::string &id, const std::string &label, long index) {
  return {id, "", label, true, false, false, index, {}};
}

IioDevice labelled() {
  return {"iio:device0",
          "adc",
          "",
          {voltage("voltage0", "vcos", 0),
           voltage("voltage1", "vsin", 1),
           voltage("voltage2", "vdd", 2),
           voltage("voltage3", "", -1),
           {"timestamp", "", "", false, true, false, 3, {}}}};
}

TEST(ChannelChoice, LabelsDecideWithoutOptions) {
  const ChannelChoice c = choose_channels(labelled(), {});
  EXPECT_EQ(c.sin, 1u);
  EXPECT_EQ(c.cos, 0u);
  EXPECT_FALSE(c.temp);
  EXPECT_EQ(c.vdd, 2u);
  EXPECT_EQ(c.timestamp, 4u);
}

TEST(ChannelChoice, AnOptionWinsOverALabel) {
  IioDevice device = labelled();
  device.channels[2].label = "spare";
  const ChannelChoice c = choose_channels(device, {"voltage2", "vsin", "vcos", ""});
  EXPECT_EQ(c.sin, 2u);
  EXPECT_EQ(c.cos, 1u);
  EXPECT_EQ(c.temp, 0u);
}

TEST(ChannelChoice, AnOutputOfTheSameIdIsNeverMeant) {
  IioDevice device = labelled();
  IioChannel dac = voltage("voltage1", "vsin", 0);
  dac.is_output = true;
  device.channels.insert(device.channels.begin(), dac);
  EXPECT_EQ(choose_channels(device, {}).sin, 2u);
  EXPECT_EQ(choose_channels(device, {"voltage1", "voltage0", "", ""}).sin, 2u);
}

TEST(ChannelChoice, AChannelOutsideTheBufferCannotBeChosen) {
  try {
    choose_channels(labelled(), {"voltage3", "", "", ""});
    FAIL();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNSUPPORTED);
    EXPECT_NE(std::string(e.what()).find("cannot be captured"), std::string::npos);
  }
}

TEST(ChannelChoice, ADeviceIsFoundByIdLabelOrName) {
  IioDevice a = labelled(), b = labelled();
  b.id = "iio:device1";
  b.name = "other";
  b.label = "shaft";
  const std::vector<IioDevice> devices{a, b};
  EXPECT_EQ(choose_device(devices, "iio:device1", {}).id, "iio:device1");
  EXPECT_EQ(choose_device(devices, "shaft", {}).id, "iio:device1");
  EXPECT_EQ(choose_device(devices, "adc", {}).id, "iio:device0");
  EXPECT_THROW(choose_device(devices, "", {}), Error); // both would do
}

std::string refusal_of(const std::vector<IioDevice> &devices, const ChannelSelection &selection) {
  try {
    choose_channels(choose_device(devices, "", selection), selection);
  } catch (const Error &e) {
    return e.what();
  }
  return "";
}

TEST(ChannelChoice, ARefusalSaysWhatIsMissingAndWhatThereIs) {
  const std::string known = "voltage0 (vcos), voltage1 (vsin), voltage2 (vdd)";
  const std::string of_one = "adc (iio:device0) has no input channel \"foo\"; it has " + known;
  EXPECT_EQ(refusal_of({labelled()}, {"foo", "", "", ""}), of_one);
  EXPECT_EQ(refusal_of({labelled()}, {"", "foo", "", ""}), of_one);
  EXPECT_EQ(refusal_of({labelled()}, {"", "", "foo", ""}), of_one);
  EXPECT_EQ(refusal_of({labelled()}, {"timestamp", "", "", ""}),
            "channel timestamp of adc (iio:device0) is not a voltage");
  IioDevice plain{
      "iio:device1", "plain", "", {voltage("voltage0", "", 0), voltage("voltage7", "", 1)}};
  const std::string both =
      ": name device and channels by option; there is adc (iio:device0): " + known +
      "; plain (iio:device1): voltage0, voltage7";
  EXPECT_EQ(refusal_of({labelled(), plain}, {"foo", "", "", ""}),
            "no IIO device has a voltage channel \"foo\" to capture" + both);
  EXPECT_EQ(refusal_of({labelled(), plain}, {"voltage7", "", "", ""}),
            "no IIO device has a voltage channel \"voltage7\" to capture and a channel labelled "
            "vcos" +
                both);
  EXPECT_EQ(refusal_of({plain, plain}, {}),
            "no IIO device has a channel labelled vsin or a channel labelled vcos: name device and "
            "channels by option; there is plain (iio:device1): voltage0, voltage7; plain "
            "(iio:device1): voltage0, voltage7");
}

TEST(ChannelChoice, TheOnlyFittingDeviceNeedsNoName) {
  IioDevice plain{
      "iio:device1", "plain", "", {voltage("voltage0", "", 0), voltage("voltage7", "", 1)}};
  const std::vector<IioDevice> devices{plain, labelled()};
  EXPECT_EQ(choose_device(devices, "", {}).id, "iio:device0");
  EXPECT_EQ(choose_device(devices, "", {"voltage0", "voltage7", "", ""}).id, "iio:device1");
  EXPECT_TRUE(has_usable_pair(plain));
  EXPECT_FALSE(labels_name_pair(plain));
}

} // namespace
