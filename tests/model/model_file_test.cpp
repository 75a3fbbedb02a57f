// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "model/model_file.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "base/error.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "support/remainder.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada::test {
namespace {

template <class Call> std::string failure(Call call, ada4571_status *status = nullptr) {
  try {
    call();
  } catch (const Error &e) {
    if (status)
      *status = e.status();
    return e.what();
  }
  return {};
}

double draw(std::mt19937_64 &rng, const ParameterInfo &p) {
  if (p.unit == "channel")
    return static_cast<double>(rng() % 2);
  const double low = std::max(p.minimum, -1e6), high = std::min(p.maximum, 1e6);
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/// Every effect of the catalogue, with any numbers that its ranges allow.
Model full_model(std::mt19937_64 &rng) {
  std::uniform_real_distribution<double> unit(0, 1);
  Model m;
  m.periods_per_turn = 1 + static_cast<int>(rng() % 4);
  m.supply_v = 2.7 + 3 * unit(rng);
  m.baseline = {unit(rng), unit(rng) - 0.5, unit(rng) - 0.5, 360 * unit(rng)};
  m.baseline_std_error = {unit(rng), 0, unit(rng) * 1e-9, unit(rng)};
  m.vtemp_reference_v = unit(rng);
  m.noise_rms_v = unit(rng) * 1e-3;
  for (const Effect *effect : catalogue()) {
    EffectInstance instance{effect, {}, {}};
    do {
      instance.values.clear();
      for (const ParameterInfo &p : effect->info().parameters)
        instance.values.push_back(may_be_absent(p) && rng() % 2 ? std::nan("") : draw(rng, p));
    } while (!effect->contradiction(instance.values).empty());
    for (std::size_t i = 0; i < instance.values.size(); ++i)
      instance.std_errors.push_back(rng() % 3 ? unit(rng) : std::nan(""));
    if (rng() % 2)
      instance.std_errors.clear();
    m.effects.push_back(instance);
  }
  if (rng() % 4)
    m.remainder = drawn_remainder(rng, 1 + below(rng, PeriodicRemainder::kHighestOrder), unit(rng),
                                  rng() % 2 == 0);
  m.provenance.serial = "S \"1\" \\ \xC3\xA9 \t\x01";
  m.provenance.date = "2024-02-29T12:00:00Z";
  m.provenance.method = "single fit";
  m.provenance.capture_identity = "crc32:1a2b3c4d/70000x6";
  m.provenance.generator = "libada4571 1.0.0";
  m.provenance.vtemp_min_v = -unit(rng);
  m.provenance.vtemp_max_v = unit(rng);
  m.provenance.gain_control = rng() % 2 == 0;
  m.provenance.fit_residual_rms_v = unit(rng);
  return m;
}

bool same(const std::vector<double> &a, const std::vector<double> &b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

void expect_same(const Baseline &a, const Baseline &b) {
  EXPECT_EQ(a.amplitude_v, b.amplitude_v);
  EXPECT_EQ(a.offset_sin_v, b.offset_sin_v);
  EXPECT_EQ(a.offset_cos_v, b.offset_cos_v);
  EXPECT_EQ(a.angle_zero_deg, b.angle_zero_deg);
}

void expect_same(const Model &a, const Model &b) {
  EXPECT_EQ(a.periods_per_turn, b.periods_per_turn);
  EXPECT_EQ(a.supply_v, b.supply_v);
  expect_same(a.baseline, b.baseline);
  expect_same(a.baseline_std_error, b.baseline_std_error);
  EXPECT_EQ(a.vtemp_reference_v, b.vtemp_reference_v);
  EXPECT_EQ(a.noise_rms_v, b.noise_rms_v);
  ASSERT_EQ(a.effects.size(), b.effects.size());
  for (std::size_t i = 0; i < a.effects.size(); ++i) {
    EXPECT_EQ(a.effects[i].effect, b.effects[i].effect);
    EXPECT_TRUE(same(a.effects[i].values, b.effects[i].values)) << i;
    const auto none = [](double e) { return std::isnan(e); };
    const auto &errors = b.effects[i].std_errors;
    if (std::all_of(errors.begin(), errors.end(), none)) // nothing known is the same as no table
      EXPECT_TRUE(
          std::all_of(a.effects[i].std_errors.begin(), a.effects[i].std_errors.end(), none));
    else
      EXPECT_TRUE(same(a.effects[i].std_errors, errors)) << i;
  }
  ASSERT_EQ(a.remainder.has_value(), b.remainder.has_value());
  if (a.remainder) {
    EXPECT_EQ(a.remainder->electrical, b.remainder->electrical);
    EXPECT_EQ(a.remainder->sin_cos, b.remainder->sin_cos);
    EXPECT_EQ(a.remainder->sin_sin, b.remainder->sin_sin);
    EXPECT_EQ(a.remainder->cos_cos, b.remainder->cos_cos);
    EXPECT_EQ(a.remainder->cos_sin, b.remainder->cos_sin);
  }
  EXPECT_EQ(a.provenance.serial, b.provenance.serial);
  EXPECT_EQ(a.provenance.date, b.provenance.date);
  EXPECT_EQ(a.provenance.method, b.provenance.method);
  EXPECT_EQ(a.provenance.capture_identity, b.provenance.capture_identity);
  EXPECT_EQ(a.provenance.generator, b.provenance.generator);
  EXPECT_EQ(a.provenance.vtemp_min_v, b.provenance.vtemp_min_v);
  EXPECT_EQ(a.provenance.vtemp_max_v, b.provenance.vtemp_max_v);
  EXPECT_EQ(a.provenance.gain_control, b.provenance.gain_control);
  EXPECT_EQ(a.provenance.fit_residual_rms_v, b.provenance.fit_residual_rms_v);
  EXPECT_EQ(a.provenance.heldout_residual_rms_v, b.provenance.heldout_residual_rms_v);
}

TEST(ModelFile, KeepsEveryNumberOfEveryEffect) {
  std::mt19937_64 rng(fresh_seed());
  const TempFolder folder;
  for (int i = 0; i < 20; ++i) {
    const Model before = full_model(rng);
    write_model(before, folder / "m.toml");
    expect_same(read_model(folder / "m.toml"), before);
    EXPECT_EQ(folder.names().size(), 1u);
  }
}

TEST(ModelFile, ReadsWhatAPersonWrites) {
  const Model m =
      model_from_toml("schema = \"ada4571-model/1\"\n"
                      "periods_per_turn = 2\n"
                      "supply_v = 3\n"
                      "baseline = {amplitude_v = 1, offset_sin_v = 0, offset_cos_v = 0}\n"
                      "[[effect]]\nname = \"channel-swap\"\n"
                      "[[effect]]\nname = \"harmonic-distortion\"\n"
                      "parameters = {order = 3, channel = \"vcos\", amplitude = 0.01, "
                      "phase_deg = 0}\n",
                      "m");
  EXPECT_EQ(m.supply_v, 3.0);
  ASSERT_EQ(m.effects.size(), 2u);
  EXPECT_EQ(m.effects[1].values, (std::vector<double>{3, 1, 0.01, 0}));
}

TEST(ModelFile, CallsTheRemainderUnnamed) {
  Model m;
  EXPECT_EQ(model_to_toml(m).find("nnamed"), std::string::npos);
  m.remainder = {false, {0.01}, {0}, {-0.5}, {1}};
  EXPECT_NE(
      model_to_toml(m).find("\n# Unnamed: what repeats with the angle and no effect explains, "
                            "relative to amplitude_v.\n"
                            "[remainder]\n"
                            "angle = \"mechanical\"\n"
                            "orders = 1\n"
                            "sin_cos = [0.01]\n"
                            "sin_sin = [0]\n"
                            "cos_cos = [-0.5]\n"
                            "cos_sin = [1]\n"),
      std::string::npos);
}

TEST(ModelFile, ReadsLettersOfAllLanguages) {
  Model m;
  m.provenance.serial = "\xC3\xA9 \xD1\x9D \xE2\x82\xAC \xF0\x9F\xA7\xB2";
  const std::string text = "\xEF\xBB\xBF# \xC3\xA9\n" + model_to_toml(m);
  std::string unchecked = text;
  const auto begin = text.find("\nchecksum") + 1;
  unchecked.erase(begin, text.find('\n', begin) + 1 - begin);
  EXPECT_EQ(model_from_toml(unchecked, "m").provenance.serial, m.provenance.serial);
}

TEST(ModelFile, ChecksumSeesEveryChangedByte) {
  Model m;
  m.provenance.serial = "S1";
  add_effect(m, parse_effect("stray-field"));
  m.remainder = {
      true, {0.01, 0, 0, 0, -0.0003}, {0, 0, 0, 0, 1e-7}, {0, 0.002, 0, 0, 0}, {0, 0, 0, 0, 0}};
  const std::string text = model_to_toml(m);
  ASSERT_EQ(failure([&] { model_from_toml(text, "m"); }), "");
  for (std::size_t i = 0; i < text.size(); ++i)
    for (int change = 1; change < 128; ++change) {
      std::string changed = text;
      changed[i] = static_cast<char>(changed[i] ^ change);
      if (text[i] == ' ' && changed[i] == '\t') // space is space in the checksum's own line
        continue;
      EXPECT_NE(failure([&] { model_from_toml(changed, "m"); }), "") << "byte " << i << "\n"
                                                                     << changed;
    }
}

TEST(ModelFile, AChecksumThatIsACommentIsNone) {
  std::string text = model_to_toml(Model());
  text[text.find("\nchecksum")] = '#'; // one byte, and the line is a comment
  EXPECT_NE(failure([&] { model_from_toml(text, "m"); }), "");
}

TEST(ModelFile, ChecksumAllowsOtherLineEnds) {
  std::string text = model_to_toml(Model()), dos;
  for (const char c : text)
    dos += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(failure([&] { model_from_toml(dos, "m"); }), "");
}

TEST(ModelFile, ChecksumIsThatOfTheOtherLines) {
  // crc32 of "123456789" is the check value of the polynomial.
  EXPECT_EQ(model_checksum("1234\nx\n56789", 2), model_checksum("1234\n56789", 0));
  EXPECT_EQ(model_checksum("123456789", 0), "crc32:cbf43926");
}

TEST(ModelFile, MayLackTheChecksumButNotHaveAWrongOne) {
  std::string text = model_to_toml(Model());
  const auto begin = text.find("\nchecksum") + 1, end = text.find('\n', begin) + 1;
  std::string without = text;
  without.erase(begin, end - begin);
  EXPECT_EQ(failure([&] { model_from_toml(without, "m"); }), "");
  text.replace(text.find("amplitude_v = 1.45"), 18, "amplitude_v = 1.46");
  EXPECT_EQ(
      failure([&] { model_from_toml(text, "m"); }).rfind("m:3:12: the checksum does not fit", 0),
      0u);
}

struct Malformed {
  const char *name, *from, *to, *message; ///< a change of kModel and what it leads to
};

const std::string kModel = "schema = \"ada4571-model/1\"\n"
                           "periods_per_turn = 2\n"
                           "supply_v = 5\n"
                           "[provenance]\n"
                           "serial = \"S1\"\n"
                           "[baseline]\n"
                           "amplitude_v = 1.45\n"
                           "offset_sin_v = 0.01\n"
                           "offset_cos_v = 0\n"
                           "[[effect]]\n"
                           "name = \"stray-field\"\n"
                           "[effect.parameters]\n"
                           "b = 0.01\n"
                           "direction_deg = 30\n";

const std::string kRemainder = "direction_deg = 30\n" // as at the end of kModel
                               "[remainder]\n"        // line 15
                               "angle = \"electrical\"\n"
                               "orders = 2\n"
                               "sin_cos = [0, 0.01]\n"
                               "sin_sin = [0, 0.01]\n"
                               "cos_cos = [0, 0.01]\n"
                               "cos_sin = [0, 0.01]\n";

class ModelFileRefuses : public testing::TestWithParam<Malformed> {};

TEST_P(ModelFileRefuses, WithThePlace) {
  std::string text = kModel;
  const std::string from = GetParam().from;
  const auto at = text.find(from);
  ASSERT_NE(at, text.npos);
  text.replace(at, from.size(), GetParam().to);
  ada4571_status status = ADA4571_OK;
  const std::string message = failure([&] { model_from_toml(text, "m.toml"); }, &status);
  const std::string wanted = std::string("m.toml:") + GetParam().message;
  EXPECT_EQ(message.substr(0, wanted.size()), wanted); // lists of names may follow
  EXPECT_EQ(status, ADA4571_ERROR_FORMAT);
}

class ModelFileRefusesRemainder : public testing::TestWithParam<Malformed> {};

TEST_P(ModelFileRefusesRemainder, WithThePlace) {
  std::string text = kModel;
  text.replace(text.find("direction_deg"), text.npos, kRemainder);
  ASSERT_EQ(failure([&] { model_from_toml(text, "m.toml"); }), "");
  const std::string from = GetParam().from;
  text.replace(text.find(from), from.size(), GetParam().to);
  EXPECT_EQ(failure([&] { model_from_toml(text, "m.toml"); }),
            std::string("m.toml:") + GetParam().message);
}

const Malformed kMalformedRemainder[] = {
    {"NoTable", "[remainder]", "[[remainder]]", "15:1: remainder must be a table"},
    {"NoAngle", "angle = \"electrical\"\n", "", "15:1: angle is missing in [remainder]"},
    {"Angle", "electrical", "electric", "16:9: angle must be \"mechanical\" or \"electrical\""},
    {"AngleNoText", "\"electrical\"", "2", "16:9: angle must be text in quotes"},
    {"NoOrders", "orders = 2\n", "", "15:1: orders is missing in [remainder]"},
    {"NoOrder", "orders = 2", "orders = 0", "17:10: orders must be from 1 to 256, not 0"},
    {"TooManyOrders", "orders = 2", "orders = 257", "17:10: orders must be from 1 to 256, not 257"},
    {"PartOfAnOrder", "orders = 2", "orders = 1.5", "17:10: orders must be a whole number"},
    {"MoreOrders", "orders = 2", "orders = 3",
     "18:11: sin_cos must be an array of 3 numbers, one an order"},
    {"MissingSeries", "cos_cos = [0, 0.01]\n", "", "15:1: cos_cos is missing in [remainder]"},
    {"ShortSeries", "cos_sin = [0, 0.01]", "cos_sin = [0]",
     "21:11: cos_sin must be an array of 2 numbers, one an order"},
    {"NoSeries", "sin_sin = [0, 0.01]", "sin_sin = 0.01",
     "19:11: sin_sin must be an array of 2 numbers, one an order"},
    {"TextInSeries", "sin_cos = [0, 0.01]", "sin_cos = [0, \"1\"]",
     "18:15: sin_cos must be a finite number"},
    {"InfiniteInSeries", "sin_cos = [0, 0.01]", "sin_cos = [0, -inf]",
     "18:15: sin_cos must be a finite number"},
    {"LargeInSeries", "sin_cos = [0, 0.01]", "sin_cos = [-2, 0.01]",
     "18:12: sin_cos must be from -1 to 1, not -2"},
    {"UnknownKey", "orders = 2", "orders = 2\nname = \"x\"",
     "18:1: the key 'name' is not known in [remainder]; there are angle, cos_cos, cos_sin, orders, "
     "sin_cos, sin_sin"},
};

INSTANTIATE_TEST_SUITE_P(Malformed, ModelFileRefusesRemainder,
                         testing::ValuesIn(kMalformedRemainder),
                         [](const auto &test) { return test.param.name; });

const Malformed kMalformed[] = {
    {"NoSchema", "schema = \"ada4571-model/1\"", "",
     "1:1: this is no model file: schema = \"ada4571-model/1\" is missing"},
    {"NewerSchema", "model/1", "model/2",
     "1:10: the schema 'ada4571-model/2' is not known here, only ada4571-model/1 is"},
    {"NoToml", "supply_v = 5", "supply_v = = 5", "3:12: Error while parsing"},
    {"LetterBeyondAscii", "supply_v = 5", "supply_v = 5\n\xD1\x9D = 1",
     "4:1: a letter beyond ASCII must stand in double quotes"},
    {"LetterBeyondAsciiAfterText", "\"S1\"", "\"\\\"\xC3\xA9\" \xC3\xA9 # \xC3\xA9",
     "5:17: a letter beyond ASCII must stand in double quotes"},
    {"NoUtf8", "\"S1\"", "\"S\xC3\"", "5:12: this is no UTF-8"},
    {"LongText", "\"S1\"", "\"\"\"S1\"\"\"", "5:10: strings of several lines are not supported"},
    {"KeyTwice", "supply_v = 5", "supply_v = 5\nsupply_v = 6", "4:"},
    {"Text", "supply_v = 5", "supply_v = \"5\"", "3:12: supply_v must be a finite number"},
    {"NotANumber", "supply_v = 5", "supply_v = nan", "3:12: supply_v must be a finite number"},
    {"Infinite", "0.01\noffset_cos", "-inf\noffset_cos",
     "8:16: offset_sin_v must be a finite number"},
    {"Supply", "supply_v = 5", "supply_v = 0", "3:12: supply_v must be from 0.1 to 100, not 0"},
    {"Periods", "turn = 2", "turn = 1.5", "2:20: periods_per_turn must be a whole number"},
    {"UnknownKey", "supply_v = 5", "supply_v = 5\nsuply_v = 4",
     "4:1: the key 'suply_v' is not known; there are "},
    {"UnknownProvenance", "serial", "seriel",
     "5:1: the key 'seriel' is not known in [provenance]; there are "},
    {"UnknownBaseline", "offset_cos_v = 0", "offset_cos_v = 0\nx = 1",
     "10:1: the key 'x' is not known in [baseline]; there are "},
    {"UnknownTable", "[provenance]", "[provenence]",
     "4:2: the key 'provenence' is not known; there are "},
    {"NoBaseline", "[baseline]\namplitude_v = 1.45\noffset_sin_v = 0.01\noffset_cos_v = 0\n", "",
     "1:1: [baseline] is missing"},
    {"NoAmplitude", "amplitude_v = 1.45\n", "", "6:1: amplitude_v is missing in [baseline]"},
    {"Amplitude", "1.45", "6", "7:15: amplitude_v must be from 0.000001 to 5, not 6"},
    {"Serial", "\"S1\"", "1", "5:10: serial must be text in quotes"},
    {"GainControl", "serial", "gain_control", "5:16: gain_control must be \"on\" or \"off\""},
    {"UnknownEffect", "stray-field", "stray", "11:8: no effect is called 'stray'; there are "},
    {"NoName", "name = \"stray-field\"\n", "", "10:1: name is missing in [effect]"},
    {"UnknownParameter", "b = 0.01", "b = 0.01\nc = 1",
     "14:1: the key 'c' is not known in [effect.parameters]; there are b, direction_deg"},
    {"MissingParameter", "b = 0.01\n", "", "12:1: b is missing in [effect.parameters]"},
    {"NoParameters", "[effect.parameters]\nb = 0.01\ndirection_deg = 30\n", "",
     "10:1: parameters is missing in [effect]"},
    {"Range", "b = 0.01", "b = 99", "13:5: b must be from "},
    {"EffectTwice", "direction_deg = 30\n",
     "direction_deg = 30\n[[effect]]\nname = \"stray-field\"\nparameters = {b = 0.5, "
     "direction_deg = 3}\n",
     "15:1: the model already has stray-field"},
    {"EffectNoArray", "[[effect]]", "[effect]",
     "10:1: the effects must be an array of tables [[effect]], at most 1000"},
    {"StdErrors", "direction_deg = 30\n", "direction_deg = 30\n[effect.std_errors]\nb = -1\n",
     "16:5: b must be from 0 to inf, not -1"},
};

INSTANTIATE_TEST_SUITE_P(Malformed, ModelFileRefuses, testing::ValuesIn(kMalformed),
                         [](const auto &test) { return test.param.name; });

TEST(ModelFile, RefusesToWriteWhatItCouldNotRead) {
  const TempFolder folder;
  Model m;
  m.baseline.amplitude_v = std::nan("");
  ada4571_status status = ADA4571_OK;
  EXPECT_EQ(failure([&] { write_model(m, folder / "m.toml"); }, &status),
            (folder / "m.toml") + " is not written: amplitude_v must be a finite number");
  EXPECT_EQ(status, ADA4571_ERROR_INVALID_ARGUMENT);
  m = {};
  m.remainder = {false, {0.1, 0.2}, {0.1}, {0.1, 0}, {0, 0}};
  EXPECT_NE(failure([&] { write_model(m, folder / "m.toml"); }), "");
  m = {};
  m.provenance.serial = "\xff"; // no UTF-8
  EXPECT_NE(failure([&] { write_model(m, folder / "m.toml"); }), "");
  EXPECT_TRUE(folder.names().empty());
}

TEST(ModelFile, RefusesAFileThatIsTooLong) {
  EXPECT_EQ(failure([] { read_model("/dev/zero"); }),
            "/dev/zero:1:1: this is no model file: it is longer than 1048576 bytes");
}

std::string times(std::size_t count, const std::string &text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i)
    all += text;
  return all;
}

/// Whatever nests, at any depth: no call of the parser may lie deeper than a small stack allows.
TEST(ModelFile, RefusesDeepNesting) {
  const std::string first = "schema = \"" + std::string(kModelSchema) + "\"\n";
  std::mt19937_64 rng(fresh_seed());
  for (const std::size_t depth : {std::size_t{20}, 20 + below(rng, 100000), std::size_t{200000}}) {
    const std::string dots = times(depth, "a.") + "a";
    for (const std::string &line :
         {"[" + dots + "]", "[[" + dots + "]]", dots + " = 1", times(depth, "'a' . ") + "a = 1",
          "x = " + times(depth, "["), "x = " + times(depth, "[\n"), "x = " + times(depth, "{a="),
          "x = " + times(depth, "[{a.b="), "x = {" + dots + " = 1}"}) {
      const std::string why = failure([&] { model_from_toml(first + line + "\n", "m.toml"); });
      EXPECT_TRUE(why.starts_with("m.toml:")) << why;
      EXPECT_NE(why.find("nested too deeply"), std::string::npos)
          << line.substr(0, 20) << " " << depth << ": " << why;
    }
  }
}

TEST(ModelFile, CountsNoBracketsAndDotsOfTextsAndComments) {
  const std::string much = times(100, ".[{") + "'";
  Model m;
  m.provenance.serial = much;
  std::string text = model_to_toml(m);
  const std::size_t line = text.find("\nchecksum = ") + 1;
  text.replace(line, text.find('\n', line) - line, "# " + much);
  EXPECT_EQ(model_from_toml(text, "m").provenance.serial, much);
  const std::string flat = "x = [" + times(100, "[1.5], ") + "]\n"; // wide is not deep
  EXPECT_NE(failure([&] { model_from_toml(flat + text, "m"); }).find("'x' is not known"),
            std::string::npos);
}

} // namespace
} // namespace ada::test
