// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Raw blocks in every layout, on every instruction set, against the scalar frame path in double.

#include "conversion/raw_converter.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"
#include "conversion/vector_kernels.h"
#include "model/forward.h"
#include "support/remainder.h"
#include "support/seed.h"

namespace ada::test {
namespace {

Model drawn_model(std::mt19937_64 &rng) {
  const auto u = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(rng);
  };
  Model m;
  m.periods_per_turn = rng() % 2 ? 1 : 2;
  m.baseline = {u(0.5, 2.0), u(-0.2, 0.2), u(-0.2, 0.2), u(-400, 400)};
  m.effects.push_back(effect_instance("amplitude-mismatch", {u(-0.1, 0.1)}, {}));
  m.effects.push_back(effect_instance("quadrature-error", {u(-5, 5)}, {}));
  if (rng() % 2)
    m.effects.push_back(effect_instance("channel-inverted", {double(rng() % 2)}, {}));
  return m;
}

/// What every sample of a block should give.
struct Expected {
  double angle_rad, radius;
};

Expected by_frame_path(const Model &model, double vsin, double vcos) {
  Frame f = empty_frame();
  f.time_s = 0;
  f.vsin_v = vsin;
  f.vcos_v = vcos;
  ada4571_angle a;
  FrameConverter(model).frames({&f, 1}, {&a, 1});
  return {a.angle_deg * kRadPerDeg, a.radius};
}

struct Case {
  ada4571_sample_type type;
  std::size_t stride, cos_at; ///< bytes; cos_at 0: planar
  unsigned shift, bits;
};

double decoded(const Case &c, std::int64_t raw) {
  const unsigned width = c.type <= ADA4571_U8 ? 8 : c.type <= ADA4571_U16 ? 16 : 32;
  const unsigned bits = c.bits ? c.bits : width - c.shift;
  raw >>= c.shift;
  raw &= (std::int64_t{1} << bits) - 1;
  const bool is_signed = c.type == ADA4571_S8 || c.type == ADA4571_S16 || c.type == ADA4571_S32;
  if (is_signed && (raw >> (bits - 1)) & 1)
    raw -= std::int64_t{1} << bits;
  return static_cast<double>(raw);
}

class RawOnTarget : public testing::TestWithParam<std::string> {
protected:
  void SetUp() override { use_vector_target(GetParam()); }
  void TearDown() override { use_vector_target(""); }
};

INSTANTIATE_TEST_SUITE_P(Every, RawOnTarget, testing::ValuesIn(vector_targets()),
                         [](const auto &i) { return i.param; });

std::size_t width_of(ada4571_sample_type t) {
  return t <= ADA4571_U8 ? 1 : t <= ADA4571_U16 ? 2 : t <= ADA4571_F32 ? 4 : 8;
}

/// Writes `raw` (or volts for floats) into the block and gives the volts that it stands for.
double put(const Case &c, const ada4571_layout &l, std::uint8_t *at, double volts,
           std::mt19937_64 &rng) {
  if (c.type == ADA4571_F32) {
    const float v = static_cast<float>(volts / l.scale_v - l.offset);
    std::memcpy(at, &v, 4);
    return (static_cast<double>(v) + l.offset) * l.scale_v;
  }
  if (c.type == ADA4571_F64) {
    const double v = volts / l.scale_v - l.offset;
    std::memcpy(at, &v, 8);
    return (v + l.offset) * l.scale_v;
  }
  const unsigned bits = c.bits ? c.bits : static_cast<unsigned>(8 * width_of(c.type)) - c.shift;
  const auto code = static_cast<std::uint64_t>(std::llround(volts / l.scale_v - l.offset));
  // Rubbish above and below the significant bits.
  std::uint64_t raw = rng();
  const std::uint64_t mask = ((std::uint64_t{1} << bits) - 1) << c.shift;
  raw = (raw & ~mask) | ((code << c.shift) & mask);
  // The low bytes of the word: on a big-endian machine they are its last ones.
  const std::size_t ahead = std::endian::native == std::endian::big ? 8 - width_of(c.type) : 0;
  const std::uint64_t low_first = raw << (8 * ahead);
  std::memcpy(at, &low_first, width_of(c.type));
  return (decoded(c, static_cast<std::int64_t>(raw & mask)) + l.offset) * l.scale_v;
}

void expect_layout_is_converted(const Case &c, std::mt19937_64 &rng) {
  const Model model = drawn_model(rng);
  const RawConverter converter(model);
  const unsigned bits = c.bits ? c.bits : static_cast<unsigned>(8 * width_of(c.type)) - c.shift;
  const bool is_signed = c.type == ADA4571_S8 || c.type == ADA4571_S16 || c.type == ADA4571_S32;
  ada4571_layout l{};
  l.struct_size = sizeof l;
  l.type = c.type;
  l.stride_bytes = c.stride;
  l.shift = c.shift;
  l.bits = c.bits;
  l.scale_v = width_of(c.type) >= 4 && bits > 24 ? 5.0 / std::exp2(bits) : 5.0 / std::exp2(bits);
  if (c.type >= ADA4571_F32)
    l.scale_v = 1.0;
  l.offset = is_signed ? std::exp2(bits - 1) : 0.25; // mid-scale at zero: 0 V is code -2^(b-1)

  const std::size_t n = 1037;
  std::vector<std::uint8_t> block(n * c.stride * (c.cos_at == 0 ? 2 : 1) + 16);
  std::uint8_t *sin = block.data() + 1, *cos = c.cos_at == 0 ? sin + n * c.stride : sin + c.cos_at;
  std::vector<Expected> expected;
  for (std::size_t i = 0; i < n; ++i) {
    const double psi = kTwoPi * static_cast<double>(rng() % 100000) / 100000;
    const double a = model.baseline.amplitude_v * 0.9;
    const double vs = put(c, l, sin + i * c.stride, 2.5 + a * std::sin(psi), rng);
    const double vc = put(c, l, cos + i * c.stride, 2.5 + a * std::cos(psi), rng);
    expected.push_back(by_frame_path(model, vs, vc));
  }
  std::vector<float> angle(n + 1, -9), radius(n + 1, -9);
  std::vector<double> angle64(n + 1, -9), radius64(n + 1, -9);
  converter.convert(l, sin, cos, n, angle.data(), radius.data());
  converter.convert(l, sin, cos, n, angle64.data(), radius64.data());
  const int p = model.periods_per_turn;
  const double period = kTwoPi / p;
  for (std::size_t i = 0; i < n; ++i) {
    const double e = wrap_centred(angle[i] - expected[i].angle_rad, period);
    ASSERT_LT(std::abs(e) * p, ADA4571_ATAN2_F32_MAX_ERROR_RAD) << "type " << c.type << " at " << i;
    ASSERT_GE(angle[i], 0.0f);
    ASSERT_LT(angle[i], static_cast<float>(period));
    ASSERT_NEAR(radius[i], expected[i].radius, 1e-6 * expected[i].radius);
    ASSERT_NEAR(wrap_centred(angle64[i] - expected[i].angle_rad, period), 0, 1e-13);
    ASSERT_NEAR(radius64[i], expected[i].radius, 1e-13);
  }
  EXPECT_EQ(angle[n], -9);
  EXPECT_EQ(radius[n], -9);
  EXPECT_EQ(angle64[n], -9);
  std::vector<float> alone(n);
  converter.convert(l, sin, cos, n, alone.data(), nullptr);
  EXPECT_EQ(std::memcmp(alone.data(), angle.data(), n * sizeof(float)), 0);
}

TEST_P(RawOnTarget, every_layout_gives_what_the_scalar_path_gives) {
  std::mt19937_64 rng(fresh_seed());
  const Case cases[] = {
      {ADA4571_S16, 4, 2, 0, 0},  {ADA4571_U16, 4, 2, 0, 16}, // interleaved pairs
      {ADA4571_S16, 2, 0, 0, 0},  {ADA4571_U16, 2, 0, 0, 0},  // packed channels
      {ADA4571_S16, 16, 2, 0, 0}, {ADA4571_U16, 6, 4, 0, 0},  // in a wider scan
      {ADA4571_U16, 4, 2, 4, 12}, {ADA4571_S16, 4, 2, 2, 14}, // shifted
      {ADA4571_S16, 4, 2, 3, 12}, {ADA4571_S8, 2, 1, 0, 0},   {ADA4571_U8, 1, 0, 0, 0},
      {ADA4571_S32, 8, 4, 8, 24}, {ADA4571_U32, 8, 4, 0, 0},  {ADA4571_S32, 4, 0, 0, 20},
      {ADA4571_F32, 4, 0, 0, 0},  {ADA4571_F32, 12, 4, 0, 0}, {ADA4571_F64, 8, 0, 0, 0},
      {ADA4571_F64, 24, 8, 0, 0},
  };
  for (const Case &c : cases)
    for (int draw = 0; draw < 3; ++draw)
      expect_layout_is_converted(c, rng);
}

TEST_P(RawOnTarget, channels_in_the_other_order_give_the_same) {
  std::mt19937_64 rng(fresh_seed());
  const Model model = drawn_model(rng);
  ada4571_layout l{sizeof l, ADA4571_S16, 4, 5.0 / 65536, 32768, 0, 0};
  std::vector<std::int16_t> one(2002), other(2002);
  for (std::size_t i = 0; i < one.size(); ++i)
    one[i] = static_cast<std::int16_t>(rng() % 40000 - 20000);
  for (std::size_t i = 0; i < one.size(); i += 2) {
    other[i] = one[i + 1];
    other[i + 1] = one[i];
  }
  std::vector<float> a(1001), b(1001);
  const RawConverter converter(model);
  converter.convert(l, one.data(), one.data() + 1, 1001, a.data(), nullptr);
  converter.convert(l, other.data() + 1, other.data(), 1001, b.data(), nullptr);
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(wrap_centred(a[i] - b[i], kTwoPi / model.periods_per_turn), 0, 1e-6);
}

TEST_P(RawOnTarget, large_blocks_give_what_small_ones_give_at_any_address) {
  std::mt19937_64 rng(fresh_seed());
  const Model model = drawn_model(rng);
  const std::size_t n = (std::size_t{5} << 20) / sizeof(float);
  ada4571_layout l{sizeof l, ADA4571_S16, 4, 5.0 / 65536, 32768, 0, 0};
  std::vector<std::int16_t> pairs(2 * n);
  for (auto &v : pairs)
    v = static_cast<std::int16_t>(rng() % 40000 - 20000);
  std::vector<float> whole(n + 5, -9), plain(n);
  const RawConverter converter(model);
  converter.convert(l, pairs.data(), pairs.data() + 1, n, whole.data() + 3, nullptr);
  for (std::size_t i = 0; i < n; i += 1000)
    converter.convert(l, pairs.data() + 2 * i, pairs.data() + 2 * i + 1,
                      std::min<std::size_t>(1000, n - i), plain.data() + i, nullptr);
  EXPECT_EQ(std::memcmp(whole.data() + 3, plain.data(), n * sizeof(float)), 0);
  EXPECT_EQ(whole[2], -9);
  EXPECT_EQ(whole[n + 3], -9);
}

TEST_P(RawOnTarget, numbers_that_are_none_give_none) {
  Model model;
  const RawConverter converter(model);
  ada4571_layout l{sizeof l, ADA4571_F32, 4, 1.0, 0, 0, 0};
  std::vector<float> sin(40, 3.0f), cos(40, 3.0f), angle(40), radius(40);
  sin[7] = NAN;
  cos[33] = NAN;
  converter.convert(l, sin.data(), cos.data(), 40, angle.data(), radius.data());
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(std::isnan(angle[i]), i == 7 || i == 33) << i;
    EXPECT_EQ(std::isnan(radius[i]), i == 7 || i == 33) << i;
  }
}

/// The pair of a model, without noise, at angles all over the turn.
struct Simulated {
  std::vector<double> alpha, sin_v, cos_v;

  Simulated(const Model &model, std::mt19937_64 &rng) {
    std::uniform_real_distribution<double> turn(0.0, kTwoPi);
    for (int i = 0; i < 3001; ++i)
      alpha.push_back(turn(rng));
    const std::vector<double> zeros(alpha.size());
    const std::vector<float> at_rest(alpha.size());
    sin_v.resize(alpha.size());
    cos_v.resize(alpha.size());
    ForwardModel(model).evaluate(
        {.n = alpha.size(), .time = zeros.data(), .alpha = alpha.data(), .omega = at_rest.data()},
        sin_v.data(), cos_v.data());
  }
};

constexpr ada4571_layout kVolts{sizeof(ada4571_layout), ADA4571_F64, 8, 1.0, 0, 0, 0};

/// Leaves only what is the same in every electrical period.
void keep_multiples(PeriodicRemainder &r, std::size_t periods) {
  for (auto *series : {&r.sin_cos, &r.sin_sin, &r.cos_cos, &r.cos_sin})
    for (std::size_t n = 1; n <= series->size(); ++n)
      if (n % periods != 0)
        (*series)[n - 1] = 0;
}

/// A model of drawn_model with a remainder that the raw path can hold.
Model drawn_with_remainder(std::mt19937_64 &rng, std::size_t orders, double first) {
  Model model = drawn_model(rng);
  model.remainder = drawn_remainder(rng, orders, first, rng() % 2 == 0);
  if (!model.remainder->electrical)
    keep_multiples(*model.remainder, static_cast<std::size_t>(model.periods_per_turn));
  return model;
}

TEST_P(RawOnTarget, a_remainder_is_taken_out_as_by_the_frame_path) {
  std::mt19937_64 rng(fresh_seed());
  for (const std::size_t orders : {std::size_t{2}, std::size_t{64}, std::size_t{256}})
    for (const double first : {0.001, 0.05}) {
      const Model model = drawn_with_remainder(rng, orders, first);
      const Simulated at(model, rng);
      const std::size_t n = at.alpha.size();
      std::vector<double> angle(n), radius(n);
      std::vector<float> angle32(n), radius32(n);
      const RawConverter converter(model);
      converter.convert(kVolts, at.sin_v.data(), at.cos_v.data(), n, angle.data(), radius.data());
      converter.convert(kVolts, at.sin_v.data(), at.cos_v.data(), n, angle32.data(),
                        radius32.data());
      const int p = model.periods_per_turn;
      const double period = kTwoPi / p;
      // The table aims at kInterpolationRad for the series itself; the angle under it is a
      // function of that function, steeper by up to 1/(1 - slope)^5 in its fourth derivative. With
      // slopes to 0.05 * sqrt(2) * (1 + 1/2 + ... + 1/256) < 0.44: 20.
      const double exact = 20 * AngleTable::kInterpolationRad;
      for (std::size_t i = 0; i < n; ++i) {
        if (i % 10 == 0) { // slow
          const Expected frame = by_frame_path(model, at.sin_v[i], at.cos_v[i]);
          ASSERT_NEAR(wrap_centred(frame.angle_rad - angle[i], period) * p, 0, exact);
        }
        ASSERT_NEAR(wrap_centred(angle[i] - at.alpha[i], period) * p, 0, exact) << orders;
        ASSERT_NEAR(wrap_centred(angle32[i] - at.alpha[i], period) * p, 0,
                    2 * ADA4571_ATAN2_F32_MAX_ERROR_RAD);
        ASSERT_NEAR(radius[i], 1, exact);
        ASSERT_NEAR(radius32[i], 1, 2e-6);
        for (const double a : {angle[i], static_cast<double>(angle32[i])}) {
          ASSERT_GE(a, 0);
          ASSERT_LT(a, static_cast<double>(static_cast<float>(period)));
        }
      }
    }
}

TEST_P(RawOnTarget, a_remainder_counts_in_every_layout) {
  std::mt19937_64 rng(fresh_seed());
  const Model model = drawn_with_remainder(rng, 16, 0.02);
  const Simulated at(model, rng);
  const std::size_t n = at.alpha.size();
  const ada4571_layout l{sizeof l, ADA4571_U16, 4, 5.0 / 65536, 0.25, 0, 0};
  std::vector<std::uint16_t> pairs;
  for (std::size_t i = 0; i < n; ++i)
    for (const double v : {at.sin_v[i], at.cos_v[i]})
      pairs.push_back(static_cast<std::uint16_t>(std::lround(v / l.scale_v - l.offset)));
  std::vector<float> angle(n + 1, -9);
  RawConverter(model).convert(l, pairs.data(), pairs.data() + 1, n, angle.data(), nullptr);
  // Half a code of each channel over the amplitude, which is at least 0.5 V * 0.95.
  const double quantum = l.scale_v / (0.5 * 0.95);
  for (std::size_t i = 0; i < n; ++i)
    ASSERT_NEAR(wrap_centred(angle[i] - at.alpha[i], kTwoPi / model.periods_per_turn), 0,
                2 * quantum);
  EXPECT_EQ(angle[n], -9);
}

TEST_P(RawOnTarget, the_very_centre_has_no_angle) {
  const std::vector<double> middle(37, 2.5);
  std::vector<double> angle(middle.size()), radius(middle.size(), -9.0);
  std::vector<float> middle_f32(middle.size(), 2.5f), angle_f32(middle.size());
  const ada4571_layout volts_f32{sizeof volts_f32, ADA4571_F32, 4, 1.0, 0.0, 0, 0};
  const RawConverter converter{Model()};
  converter.convert(kVolts, middle.data(), middle.data(), middle.size(), angle.data(),
                    radius.data());
  for (std::size_t i = 0; i < middle.size(); ++i) {
    ASSERT_TRUE(std::isnan(angle[i])) << angle[i] << " of sample " << i;
    ASSERT_EQ(radius[i], 0.0);
  }
  converter.convert(volts_f32, middle_f32.data(), middle_f32.data(), middle.size(),
                    angle_f32.data(), nullptr);
  for (float a : angle_f32)
    ASSERT_TRUE(std::isnan(a)) << a;
}

TEST(RawConverter, a_remainder_leaves_no_number_none) {
  Model model;
  model.remainder = {true, {0, 0.01}, {0, 0}, {0, 0}, {0, 0.01}};
  const double sin[3] = {NAN, 2.5, 3.0}, cos[3] = {3.0, 2.5, NAN};
  double angle[3], radius[3];
  RawConverter(model).convert(kVolts, sin, cos, 3, angle, radius);
  for (const double a : angle) // the second is at the very centre
    EXPECT_TRUE(std::isnan(a)) << a;
  EXPECT_EQ(radius[1], 0);
}

std::string why_refused(const Model &model) {
  try {
    RawConverter{model};
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNSUPPORTED);
    return e.what();
  }
  return {};
}

TEST(RawConverter, refuses_a_remainder_that_no_table_holds) {
  Model model;
  model.remainder = {false, {0, 0.01, 0}, {0, 0, 0}, {0, 0.01, 0}, {0, 0, 0}};
  EXPECT_EQ(why_refused(model), ""); // order 2 of a turn with two periods
  model.remainder->cos_sin[2] = 1e-9;
  EXPECT_EQ(why_refused(model), "the model's periodic remainder, which has no name, differs "
                                "between the parts of a turn that a pair cannot tell apart: "
                                "convert frames");
  model.remainder->electrical = true;
  EXPECT_EQ(why_refused(model), "");
  model.remainder = {true, {0, 0, 0.9}, {0, 0, 0.9}, {0, 0, 0}, {0, 0, 0}}; // 3 * 0.9 * 1.4 > 1
  EXPECT_EQ(why_refused(model), "the model's periodic remainder, which has no name, bends the "
                                "curve so far that one angle of the ellipse stands for several: "
                                "convert frames");
  model.remainder = {true, {0.01}, {0}, {0}, {0}};
  model.effects.push_back(effect_instance("weak-field", {0.02}, {}));
  EXPECT_NE(why_refused(model).find("weak-field"), std::string::npos);
}

TEST(RawConverter, refuses_what_one_ellipse_cannot_hold) {
  Model model;
  model.effects.push_back(effect_instance("offset-temperature-drift", {0.01, 0.0}, {}));
  EXPECT_THROW(RawConverter{model}, Error);
  Model further;
  further.effects.push_back(effect_instance("weak-field", {0.02}, {}));
  try {
    RawConverter{further};
    ADD_FAILURE();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNSUPPORTED);
    EXPECT_NE(std::string(e.what()).find("weak-field"), std::string::npos);
  }
}

TEST(RawConverter, refuses_layouts_that_make_no_sense) {
  const RawConverter converter{Model()};
  const std::int16_t pair[2] = {0, 0};
  float angle;
  const ada4571_layout good{sizeof good, ADA4571_S16, 4, 1e-4, 0, 0, 0};
  auto expect_refused = [&](auto change) {
    ada4571_layout l = good;
    change(l);
    EXPECT_THROW(converter.convert(l, pair, pair + 1, 1, &angle, nullptr), Error);
  };
  expect_refused([](auto &l) { l.stride_bytes = 1; });
  expect_refused([](auto &l) { l.scale_v = 0; });
  expect_refused([](auto &l) { l.scale_v = NAN; });
  expect_refused([](auto &l) { l.offset = INFINITY; });
  expect_refused([](auto &l) { l.shift = 16; });
  expect_refused([](auto &l) { l.shift = 8, l.bits = 9; });
  expect_refused([](auto &l) { l.type = ADA4571_F32, l.bits = 12; });
}

} // namespace
} // namespace ada::test
