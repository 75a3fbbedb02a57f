// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/effect_text.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "base/error.h"

namespace ada::test {
namespace {

std::string refusal(const std::string &text) {
  try {
    parse_effect(text);
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_INVALID_ARGUMENT);
    return e.what();
  }
  return {};
}

TEST(EffectText, NameAloneTakesTheFallbacksOfEveryEffect) {
  for (const Effect *effect : catalogue()) {
    const EffectInstance instance = parse_effect(effect->info().id);
    EXPECT_EQ(instance.effect, effect);
    ASSERT_EQ(instance.values.size(), effect->info().parameters.size());
    for (std::size_t i = 0; i < instance.values.size(); ++i) {
      const double fallback = effect->info().parameters[i].fallback;
      EXPECT_TRUE(instance.values[i] == fallback || std::isnan(fallback)) << effect->info().id;
      EXPECT_EQ(std::isnan(instance.values[i]), std::isnan(fallback)) << effect->info().id;
    }
  }
}

TEST(EffectText, TakesParametersInAnyOrder) {
  EXPECT_EQ(parse_effect("stray-field:direction_deg=-30,b=1e-2").values,
            (std::vector<double>{0.01, -30}));
  EXPECT_EQ(parse_effect(" stray-field : b = 0.02 ").values[0], 0.02);
}

TEST(EffectText, TakesAChannelByNameOrNumber) {
  for (const char *text : {"vcos", "1"})
    EXPECT_EQ(parse_effect(std::string("channel-inverted:channel=") + text).values[0], 1.0);
  EXPECT_EQ(parse_effect("channel-inverted:channel=vsin").values[0], 0.0);
  EXPECT_EQ(refusal("channel-inverted:channel=2"),
            "channel-inverted: channel must be vsin or vcos, not '2'");
  EXPECT_EQ(refusal("channel-inverted:channel=vtemp"),
            "channel-inverted: channel is not a number: 'vtemp'");
}

TEST(EffectText, TakesNoneForALevelThatIsNotThere) {
  const EffectInstance clipping = parse_effect("clipping:low_v=1.2,high_v=none");
  EXPECT_EQ(clipping.values[0], 1.2);
  EXPECT_TRUE(std::isnan(clipping.values[1]));
  const EffectInstance low = parse_effect("clipping:low_v=1.2,channel=vcos");
  EXPECT_TRUE(std::isnan(low.values[1])) << "a level that was not given";
  EXPECT_EQ(low.values[2], 1.0);
  EXPECT_EQ(refusal("offset-step:time_s=none"), "offset-step: time_s is not a number: 'none'");
  EXPECT_EQ(refusal("stray-field:b=none"), "stray-field: b is not a number: 'none'");
}

TEST(EffectText, RefusesLevelsThatContradictEachOther) {
  const auto refused = [](const char *text) {
    Model m;
    try {
      add_effect(m, parse_effect(text));
    } catch (const Error &e) {
      EXPECT_EQ(e.status(), ADA4571_ERROR_INVALID_ARGUMENT);
      EXPECT_STREQ(e.what(), "clipping: low_v must not be above high_v");
      EXPECT_TRUE(m.effects.empty());
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused("clipping:low_v=3,high_v=2"));
  EXPECT_TRUE(refused("clipping:low_v=-1,high_v=-2,channel=vcos"));
  for (const char *text : {"clipping:low_v=2,high_v=3", "clipping:low_v=2,high_v=2",
                           "clipping:low_v=4,high_v=none", "clipping:low_v=none,high_v=1"})
    EXPECT_FALSE(refused(text)) << text;
}

TEST(EffectText, SaysWhatThereIs) {
  const std::string unknown = refusal("stray");
  EXPECT_EQ(unknown.rfind("no effect is called 'stray'; there are ", 0), 0u);
  for (const Effect *effect : catalogue())
    EXPECT_NE(unknown.find(effect->info().id), std::string::npos);
  EXPECT_LT(unknown.size(), 1024u); // what ada4571_last_error() holds
  EXPECT_EQ(refusal("stray-field:c=1"),
            "stray-field has no parameter 'c'; there are: b, direction_deg");
  EXPECT_EQ(refusal("channel-swap:c=1"), "channel-swap has no parameter 'c'; there are: none");
}

TEST(EffectText, RefusesWhatIsNoValue) {
  EXPECT_EQ(refusal("stray-field:"), "stray-field expects parameter=value, not ''");
  EXPECT_EQ(refusal("stray-field:b"), "stray-field expects parameter=value, not 'b'");
  EXPECT_EQ(refusal("stray-field:=1"), "stray-field expects parameter=value, not '=1'");
  EXPECT_EQ(refusal("stray-field:b=0.1,"), "stray-field expects parameter=value, not ''");
  EXPECT_EQ(refusal("stray-field:b="), "stray-field: b is not a number: ''");
  EXPECT_EQ(refusal("stray-field:b=x"), "stray-field: b is not a number: 'x'");
  EXPECT_EQ(refusal("stray-field:b=nan"), "stray-field: b is not a number: 'nan'");
  EXPECT_EQ(refusal("stray-field:b=0.1,b=0.2"), "stray-field: b is given twice");
  EXPECT_EQ(refusal("amplitude-mismatch:k=9"),
            "amplitude-mismatch: k must be from -1.9 to 1.9, not '9'");
}

TEST(EffectText, AnEffectStandsOnceAtAPlace) {
  const auto add = [](Model &m, const char *text) {
    try {
      add_effect(m, parse_effect(text));
    } catch (const Error &e) {
      return std::string(e.what());
    }
    return std::string();
  };
  Model m;
  EXPECT_EQ(add(m, "amplitude-mismatch:k=0.01"), "");
  EXPECT_EQ(add(m, "amplitude-mismatch:k=0.02"), "the model already has amplitude-mismatch");
  EXPECT_EQ(add(m, "harmonic-distortion:order=3"), "");
  EXPECT_EQ(add(m, "harmonic-distortion:order=4"), "");
  EXPECT_EQ(add(m, "harmonic-distortion:order=3,channel=vcos"), "");
  EXPECT_EQ(add(m, "harmonic-distortion:order=3,amplitude=0.02"),
            "the model already has harmonic-distortion at this place");
  EXPECT_EQ(add(m, "periodic-interference:frequency_hz=50"), "");
  EXPECT_EQ(add(m, "periodic-interference:frequency_hz=100"), "");
  EXPECT_EQ(m.effects.size(), 6u);
}

} // namespace
} // namespace ada::test
