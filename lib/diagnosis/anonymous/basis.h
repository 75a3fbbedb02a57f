// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Generic shapes of what a simulation gets wrong, without any cause: the residual as one complex
// signal e = r_cos + j r_sin is a sum of terms  c g e^(j m x), with g a function of time,
// temperature, supply or speed, and x the angle of the magnet. Fourier's theorem makes the set
// complete in the angle; an effect of the catalogue is a pattern in these coefficients.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/axis.h"
#include "diagnosis/conditions/observations.h"

namespace ada {

/// A function of the conditions that a term is multiplied by.
struct Modulation {
  enum Kind {
    none,
    angle_cos, ///< cosine of `order` times the angle of the turn
    angle_sin,
    sense,       ///< sense of rotation, -1 or +1
    velocity,    ///< signed speed over the fastest
    speed,       ///< its absolute value
    square,      ///< its square
    temperature, ///< Legendre polynomial `order` of VTEMP over its range
    supply,      ///< VDD as a wave of rms 1
    step,        ///< -1/2 before `at`, s, and +1/2 from then on
    trend,       ///< cosine of `order` half waves over the record
    line_cos,    ///< of the frequency `at`, Hz
    line_sin,
  } kind = none;
  int order = 0;
  double at = 0.0;

  bool of_angle() const { return kind == angle_cos || kind == angle_sin; }
  bool operator==(const Modulation &) const = default;
};

/// Order of the groups of the baseline's own numbers: they are fitted along with whatever else
/// takes part, and count as none of it.
inline constexpr int kOfBaseline = 0;

/// Coefficients that stand or fall together: real and imaginary part of one complex coefficient, or
/// of those of one function family.
struct Group {
  Axis axis;
  int order;         ///< of the angle error that it makes, |m - p|; of the function otherwise
  std::size_t first; ///< column
  std::size_t count = 2;
  bool of_step = false; ///< on the axis of time, where a step comes before what is slow
};

class Basis {
public:
  Basis() = default;
  /// `zero_rad`: from the angle of the observations to the magnet's.
  Basis(int periods, double zero_rad) : periods_(periods), zero_rad_(zero_rad) {}

  /// Adds the two columns of one complex coefficient.
  void add(Axis axis, int order, int exponent, Modulation modulation = {});

  /// Of its terms those that have one of these columns, in their order.
  Basis part(const std::vector<Eigen::Index> &columns) const;

  /// What all exponents and orders of the angle are multiples of: where turns cannot be compared
  /// the periods of a turn, which are thousands on a sine encoder.
  int unit() const;

  std::size_t columns() const { return 2 * terms_.size(); }
  const std::vector<Group> &groups() const { return groups_; }
  int periods() const { return periods_; }
  double zero_rad() const { return zero_rad_; }
  /// Of each column the inverse of the variance that its coefficient may have before any data,
  /// relative: what is slow in time wanders, with a power that falls as the square of the
  /// frequency; about the others nothing is known.
  Eigen::VectorXd stiffness() const;

  /// Ranges that the functions are scaled to, and the means that those of the speed are centred on;
  /// the same for training and held-out data. What has no name is what departs from the mean: with
  /// a function whose zero lies outside of the data, the baseline would be the pair at a standstill
  /// that nobody has seen, far from it where a parabola is drawn through three speeds (the
  /// constraint of Hastie and Tibshirani, Generalized Additive Models, 1990, section 5.2).
  void scale_to(const Observations &data);
  bool scaled_as(const Basis &other) const;

  /// Angle of the magnet that the terms turn with, rad, and a modulation that is no function of it.
  double angle(const Observations &data, std::size_t i) const { return data.alpha[i] + zero_rad_; }
  double function(const Modulation &g, const Observations &data, std::size_t i) const;

  /// Values of all columns for samples [first, first + n): rows are columns of the basis, column 2i
  /// is VSIN and 2i + 1 VCOS of sample i.
  void evaluate(const Observations &data, std::size_t first, std::size_t n,
                Eigen::Ref<Eigen::MatrixXd> out) const;

  /// Complex coefficient of e^(j m x) without modulation among `values`, by m; for a remainder.
  struct Term {
    int exponent;
    Modulation modulation;
  };
  const std::vector<Term> &terms() const { return terms_; }

private:
  int periods_ = 2;
  double zero_rad_ = 0.0;
  double top_speed_ = 1.0, mean_sense_ = 0.0, mean_velocity_ = 0.0, mean_speed_ = 0.0,
         mean_square_ = 0.0, temp_middle_ = 0.0, temp_half_ = 1.0, time_from_ = 0.0,
         time_span_ = 1.0;
  std::vector<Term> terms_;
  std::vector<Group> groups_;

  double of_top(double omega) const; ///< speed over the fastest
};

/// A line of the spectrum: of the channels as they are (an added tone), or of what turns with the
/// vector (its gain and angle are modulated).
struct SpectralLine {
  double frequency_hz;
  bool turns;
};

/// Which axes are asked.
struct Asked {
  bool over_time = true; ///< false: another capture judges, which knows nothing of this one's time
  bool speed = true;
  bool others = true; ///< temperature and supply
  bool operator==(const Asked &) const = default;
};

/// Whether what repeats with the angle is told in orders of the turn: with a reference, and without
/// one where whole turns follow one another, though nobody knows where the turn begins. A ring of
/// many poles has no two alike, and a scale of many lines is told by the line.
bool in_turns(const Scene &scene);

/// Whether an order of the turn is looked at: of a ring of many poles the low ones, by which its
/// bore and its bearing err, and those of the electrical period.
bool has_order(const Scene &scene, int n);

/// What the capture lets each axis show. `orders`: highest order of the turn on the angle axis;
/// `lines`: of the spectrum; `steps_s`: moments, s.
Basis generic_basis(const Scene &scene, const Observations &data, double zero_rad, int orders,
                    const std::vector<SpectralLine> &lines, const std::vector<double> &steps_s,
                    Asked asked);

} // namespace ada
