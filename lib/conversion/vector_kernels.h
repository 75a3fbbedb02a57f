// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Vector kernels: arctangents, and raw pairs to angles in one pass. Compiled once for every
// instruction set (Highway, dynamic dispatch); the best one of the processor is taken at run time.
// No Highway type stands in this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ada {

/// Greatest error of atan2_f64, radians. That of atan2_f32 is ADA4571_ATAN2_F32_MAX_ERROR_RAD.
inline constexpr double kAtan2F64MaxErrorRad = 1e-15;

/// out[i] = atan2(y[i], x[i]); special values as in C. `out` may be y or x.
void atan2_f32(const float *y, const float *x, std::size_t count, float *out);
void atan2_f64(const double *y, const double *x, std::size_t count, double *out);

/// What a pair goes through, fused: with s and c the raw numbers about their centres,
///   sin psi = sin_s s + sin_c c + sin_0,  cos psi = cos_s s + cos_c c + cos_0,
///   angle = psi / p in [0, period).
/// A zero angle costs nothing: it turns the vector, so it stands in the six numbers.
template <class T> struct PairConstants {
  T centre_sin, centre_cos; ///< raw units; whole numbers for the integer kernels
  T sin_s, sin_c, sin_0;
  T cos_s, cos_c, cos_0;
  T period; ///< 2 pi / p
};

/// Pairs of neighbouring 16-bit numbers, first sin, then cos. Any alignment. `radius` may be null.
/// A pair at the very centre has no angle: not a number, and a radius of 0.
void convert_pairs_i16(const void *pairs, std::size_t count, const PairConstants<float> &constants,
                       float *angle, float *radius);
void convert_pairs_u16(const void *pairs, std::size_t count, const PairConstants<float> &constants,
                       float *angle, float *radius);
void convert_pairs_i16(const void *pairs, std::size_t count, const PairConstants<double> &constants,
                       double *angle, double *radius);
void convert_pairs_u16(const void *pairs, std::size_t count, const PairConstants<double> &constants,
                       double *angle, double *radius);
/// Channels of their own.
void convert_planar_i16(const void *sin, const void *cos, std::size_t count,
                        const PairConstants<float> &constants, float *angle, float *radius);
void convert_planar_u16(const void *sin, const void *cos, std::size_t count,
                        const PairConstants<float> &constants, float *angle, float *radius);
void convert_planar_f32(const float *sin, const float *cos, std::size_t count,
                        const PairConstants<float> &constants, float *angle, float *radius);
void convert_planar_f64(const double *sin, const double *cos, std::size_t count,
                        const PairConstants<double> &constants, double *angle, double *radius);

/// What makes samples of angles and radii: degrees below the end of the range, and the bits of
/// ada4571_angle.status. A channel is at a rail when its volts, (number + offset) scale_v, are not
/// between `low_v` and `high_v`.
struct SampleLimits {
  double degrees_per_rad, largest_deg;
  double least_radius, largest_radius;
  double offset, scale_v, low_v, high_v;
};

/// Turns `angle` into degrees and fills `status`. False: some angle or radius is no number.
bool finish_pairs_i16(const void *pairs, std::size_t count, const SampleLimits &limits,
                      double *angle, const double *radius, std::uint32_t *status);
bool finish_pairs_u16(const void *pairs, std::size_t count, const SampleLimits &limits,
                      double *angle, const double *radius, std::uint32_t *status);
bool finish_planar_f64(const double *sin, const double *cos, std::size_t count,
                       const SampleLimits &limits, double *angle, const double *radius,
                       std::uint32_t *status);

/// Frames of angle, radius and status as three floats, of any alignment. An angle just below `turn`
/// is that turn as a float, and becomes 0.
void frames_of_floats(const double *angle, const double *radius, const std::uint32_t *status,
                      std::size_t count, float turn, void *frames);

/// Name of the instruction set in use. Lives for ever.
const char *vector_target();

/// For tests and benchmarks: the instruction sets that this processor has and the library was
/// compiled for, best first; and to use one of them from now on, "" for the best. Not safe while
/// another thread converts.
std::vector<std::string> vector_targets();
void use_vector_target(const std::string &name);

} // namespace ada
