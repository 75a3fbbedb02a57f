// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Good input of every parser with a few things broken. The parsers must refuse or accept, and
// never crash; parsers.cpp checks the promises.

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "parsers.h"
#include "support/seed.h"

namespace ada::test {
namespace {

const std::string kText = "# ada4571-capture/1\r\n# supply_v = 5.0\n# sample_rate_hz = 10\n"
                          "# adc_bits = 16\n# adc_reference_v = 5\n# bench = 3\n"
                          "time_s,vsin_v,vcos_v,vtemp_v,note,vdd_v,reference_deg\n"
                          "0.000000,3.617706,1.552887,1.580811,a,5.00012,212.4879\n"
                          "0.100000,3.6e0,-1.5,1.58,b,5,0\n"
                          "0.400000,3.6,1.5,1.58,,5,359.9999\n";

const std::string kSigmf =
    R"({"global":{"core:datatype":"ru8","core:num_channels":16,"core:sample_rate":1000,
"core:version":"1.2.0","core:extensions":[{"name":"ada4571","version":"1.0.0","optional":false}],
"ada4571:frame_bytes":16,"ada4571:supply_v":3.3,"ada4571:gain_control":"off",
"ada4571:metadata":{"bench":"3"},"ada4571:channels":[
{"name":"vsin_v","type":"be:u12/16>>4","scale":0.8,"unit":"mV"},
{"name":"vcos_v","type":"le:s12/16>>4","scale":0.001,"offset":2048,"byte":2},
{"name":"x","type":"le:u8/8X2>>0"}]},
"captures":[{"core:sample_start":0,"ada4571:time_s":0.5},
{"core:sample_start":5,"core:global_index":9}],"annotations":[]})";

const std::string kModel = R"(schema = "ada4571-model/1"
periods_per_turn = 2
supply_v = 5
noise_rms_v = 0.0005
[provenance]
serial = "S1"
gain_control = "on"
[baseline]
amplitude_v = 1.45
offset_sin_v = 0.01
offset_cos_v = -1e-3
std_errors = {amplitude_v = 0.001}
[[effect]]
name = "harmonic-distortion"
parameters = {order = 3, channel = "vcos", amplitude = 0.01, phase_deg = 10}
[[effect]]
name = "clipping"
[effect.parameters]
high_v = 3.9
[remainder]
angle = "electrical"
orders = 2
sin_cos = [0.01, 0]
sin_sin = [0, -1e-3]
cos_cos = [0, 0]
cos_sin = [0.002, 0]
)";

const std::string kEffect = "harmonic-distortion:order=3,channel=vcos,amplitude=0.01";

/// Pieces that are trouble for one parser or another.
const std::vector<std::string> kTrouble = {"nan",
                                           "inf",
                                           "-",
                                           "1e999",
                                           "1e-999",
                                           "99999999999999999999",
                                           "-9223372036854775809",
                                           "\"",
                                           "\\",
                                           "\n",
                                           "\r",
                                           ",",
                                           "=",
                                           "#",
                                           "[[",
                                           "{",
                                           "}",
                                           "]",
                                           ":",
                                           std::string(1, '\0'),
                                           "\xff\xfe",
                                           "0x10",
                                           "\\u0000",
                                           "null",
                                           "true",
                                           "le:s64/64>>63"};

std::string mutate(std::string text, std::mt19937_64 &rng) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(rng() % (n ? n : 1)); };
  for (std::size_t changes = 1 + below(3); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size()),
                      count = below(std::min<std::size_t>(20, text.size() - at));
    switch (rng() % 7) {
    case 0: // another byte
      text[at] = static_cast<char>(rng());
      break;
    case 1: // a bit
      text[at] = static_cast<char>(text[at] ^ (1 << rng() % 8));
      break;
    case 2: // something missing
      text.erase(at, count);
      break;
    case 3: // something twice
      text.insert(below(text.size()), text.substr(at, count));
      break;
    case 4: // something foreign
      text.insert(at, kTrouble[below(kTrouble.size())]);
      break;
    case 5: // a cut end
      if (below(4) == 0)
        text.resize(at);
      break;
    default: // another digit, so that numbers move while the form stays
      if (const auto digit = text.find_first_of("0123456789", at); digit != text.npos)
        text[digit] = static_cast<char>('0' + rng() % 10);
    }
  }
  return text;
}

struct Parser {
  const char *name;
  Outcome (*parse)(std::string_view);
  const std::string *good;
};

class Mutation : public testing::TestWithParam<Parser> {};

TEST_P(Mutation, RefusesOrAcceptsButNeverBreaks) {
  const auto &[name, parse, good] = GetParam();
  ASSERT_EQ(parse(*good), Outcome::accepted);
  std::mt19937_64 rng(fresh_seed());
  int refused = 0, accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string input = mutate(*good, rng);
    SCOPED_TRACE(input);
    (parse(input) == Outcome::refused ? refused : accepted) += 1;
  }
  // Both ways must be taken, or the mutations test nothing.
  EXPECT_GT(refused, 100);
  EXPECT_GT(accepted, 100);
}

INSTANTIATE_TEST_SUITE_P(Parsers, Mutation,
                         testing::Values(Parser{"TextCapture", parse_text_capture, &kText},
                                         Parser{"SigmfMeta", parse_sigmf_meta, &kSigmf},
                                         Parser{"ModelFile", parse_model_file, &kModel},
                                         Parser{"EffectText", parse_effect_text, &kEffect}),
                         [](const auto &test) { return test.param.name; });

} // namespace
} // namespace ada::test
