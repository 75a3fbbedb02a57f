// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every limit of the health checks: unit, and where it comes from.
#pragma once

#include <cstddef>

namespace ada::health {

/// Samples below which nothing is judged: three wild ones of twenty are less than the sixth on
/// either side that the robust figures bear, and the ellipse has three samples a parameter and some
/// to spare.
inline constexpr std::size_t kFewestSamples = 20;

/// Isolated faulty samples are spikes, which the conversion marks one by one. More than one in a
/// thousand, or a row of them, is a fault of the sensor. Three never are, however short the
/// capture.
inline constexpr double kMaxFaultyFraction = 1e-3;
inline constexpr std::size_t kFewFaulty = 3;
inline constexpr std::size_t kMaxFaultyRow = 4; ///< samples

/// Of the radius: no error of a sound sensor takes a sample so far off the ellipse. A degree of
/// angle, the data sheet's accuracy at two periods a turn, is 0.017; three of them leave room for a
/// distortion that the ellipse does not follow at an angle where the magnet seldom is.
inline constexpr double kFarOff = 0.05;
/// Electrical degrees off quadrature at which either channel holds half of what the other one is (the
/// sine of it): what two bridges at the wrong angle give, or one signal twice with a delay.
inline constexpr double kMostQuadratureDeg = 30;

/// Samples on either side of a turn in the sense of rotation, by which its speed is measured; and
/// how many steps of that speed the angle jumps there at least, where no shaft turned back.
inline constexpr std::size_t kSenseSamples = 8;
inline constexpr double kSenseJump = 3, kSameSpeed = 0.1;
/// Or without a jump, rad/s^2 of the shaft: coreless servo motors without a load reach a fifth.
inline constexpr double kMostAcceleration = 1e6;

/// Samples to either side whose median a sample must be as far from, at an end as many in all on
/// the one side: so many in a row may be wild at once, and what is slower than that (a heater,
/// another supply) is none of it.
inline constexpr std::size_t kFarReach = 63;

/// Electrical degrees: so far from where it was, sensor against reference, no reading of a reference
/// is off for less than kFarReach samples, unless it is wild. The worst that an eccentric or coarse
/// one does in so short a time is a tenth of it, or shows in the scatter of all.
inline constexpr double kFarReferenceDeg = 5;

/// Spikes expected in a capture of normal noise alone. As a normal deviate exceeds z sigmas with a
/// chance below exp(-z^2/2), the threshold for n samples is sqrt(2 ln(n/this)) sigmas: 6.0 for 70
/// 000.
inline constexpr double kFalseSpikes = 1e-3;
inline constexpr std::size_t kTimesInText = 5;  ///< spikes that the sentence names
inline constexpr std::size_t kMostTimes = 1000; ///< that the result holds

/// Mechanical degrees that an ADA4571 may err by (its data sheet's headline accuracy): smaller
/// spikes are told, but are no fault however many.
inline constexpr double kAccuracyDeg = 0.5;

/// Of the supply: less travel than this is standstill. It is 2 electrical degrees of an amplitude
/// of 0.29 VDD, and above any noise with which an angle could be read.
inline constexpr double kStillFraction = 0.01;

/// Travel of VSIN - VCOS over that of the channels, below which they are one signal: on a circle it
/// is 1.4, and two converters of 1 % each leave 0.02 of a signal common to both.
inline constexpr double kShortedRatio = 0.05;

/// Measured over stated noise. A scale by the median of n deviations is known to 1.17/sqrt(n): of
/// the fewest samples to 12 %, so that half as much again stands four standard errors off.
inline constexpr double kNoiseFactor = 1.5;
inline constexpr std::size_t kMinNoiseSamples = 100;

/// The supply may differ by this from what is stated: the tolerance of a 5 V supply, 4.5 to 5.5 V.
/// Where VDD is not recorded, the middle of the figure measures it: outputs are about VDD/2, and
/// the offsets of an ADA4571 (3.75 % of VDD at most, each) can feign 7.5 %.
inline constexpr double kSupplyTolerance = 0.1;

/// An output cannot leave its supply, a reading cannot leave its converter's range; of either, this
/// part is left for the error of the converter's scale.
inline constexpr double kRangeMargin = 0.01;

/// Amplitude of a bare AMR bridge, without amplifier, at the least: 8 mV per volt of supply (span
/// of the KMT32B: 16 mV/V). A sensor that gives less is not connected, or the scale is wrong.
inline constexpr double kLeastAmplitude = 0.008;

/// Times are recorded to the nanosecond: a shorter usual step, s, is no sampling.
inline constexpr double kShortestStep = 1e-9;

/// Equal values in a row that noise cannot leave: with noise of half a converter's step the chance
/// of a repetition is 0.52 at most, so that 200 in a row do not happen.
inline constexpr std::size_t kFrozenSamples = 200;
inline constexpr double kFrozenNoiseSteps = 0.5;

/// Scatter of angles, the mean of 1 - cos about their direction, from which on they count as turning:
/// that of angles spread evenly over 28 electrical degrees.
inline constexpr double kTurnedScatter = 0.01;
/// Part of the sensor's turning that the reference may leave. Of one that stands still for a part of
/// the record it is that part, of one that has nothing to do with the sensor 1; errors of 10
/// electrical degrees leave 0.02.
inline constexpr double kReferenceScatter = 0.5;
/// A reference is held (health/wrong_stretches.h): how far from a value, of its noise from row to
/// row, it is still that value, rows of one value at least, values that tell what is usual, which
/// quantile of the ways of the pair at one value, and of its rows, that is, how many times as far
/// as it, or as the noise of the angle, the pair goes on, and as many rows, while the reference is
/// held, and the part of the record above which the reference is not held but stands. Of a way as
/// many robust deviations from a straight course do not count: hum has a range of two.
inline constexpr double kStaysWithin = 8.5; // two values differ by sqrt(2) of it: six of that
inline constexpr std::size_t kFewestHeldByReference = 4;
inline constexpr std::size_t kFewestValues = 20;
inline constexpr double kNearlyAllValues = 0.95;
inline constexpr double kHeldLonger = 4.0;
inline constexpr double kMostHeld = 0.5;
inline constexpr double kOfItsScatter = 2.0;
/// Rows of a block that was delivered twice at least, those from which on a repeat counts as a
/// short one, which chance makes as well, how many times its usual step, their scatter and a count
/// of each converter the pair is off its course at an end of the block, and the part of what was
/// found that chance may have made.
inline constexpr std::size_t kFewestRepeated = 8, kShortRepeat = 3;
inline constexpr double kBreaksMotion = 4.0, kByChance = 0.05;
/// Part of what the pair does, in variance (health/reference_share.h), that a reference of its
/// shaft tells at least: half. An ellipse it tells wholly, beside harmonics of a third nine tenths;
/// another shaft, one that stands still or one of other periods tells some hundredths. Other
/// periods or another unit, to be told instead, are to tell more than what is certain.
inline constexpr double kOfThisShaft = 0.5, kCertainlyOfThisShaft = 0.7;
/// Once round, degrees that hardly change tell 0.8 of the pair, as a parabola does. A reference
/// that tells no more than nine tenths may be such a one: it is where other periods or another unit
/// leave less than a tenth of what it leaves.
inline constexpr double kMostlyOfThisShaft = 0.9, kTenth = 0.1;
/// Of each stretch the pair goes twice round: with half or with twice the periods nothing is then
/// left of it. Three unknowns of 16 rows at least; 512 rows of 64 stretches are enough to tell a
/// half.
inline constexpr double kRoundsOfShare = 2.0;
inline constexpr std::size_t kFewestOfShare = 16, kRowsOfShare = 512, kStretchesOfShare = 64;
/// A move of the pair that counts as one, of its radius: some thirty of them go round, and noise of
/// a twentieth of the radius makes one in seventy rows.
inline constexpr double kMoveOfShare = 0.2;
/// Periods a turn that are looked for. Half a degree of scatter takes a quarter of what a sound
/// reference tells of so many, exp(-(64 * 0.5 degrees)^2), and half of what it tells of 95.
inline constexpr int kMostPeriodsTried = 64;

/// Degrees Celsius. VTEMP's white noise: what one reading is off by may not be a degree, or it is
/// no temperature. And a jump, which is one from the median of seven samples to that of the next
/// seven where the chip would have to warm faster than by 100 degrees a second; noise and usual
/// motion of the column stand below a tenth of it.
inline constexpr double kVtempNoiseDeg = 1, kVtempJumpDeg = 5, kVtempJumpDegPerS = 100;
inline constexpr double kVtempJumpOverUsual = 10;
/// Volts: VTEMP has noise of this at least, so that a converter whose step is no wider than twice
/// that (kFrozenNoiseSteps) does not give the same value kFrozenSamples times.
inline constexpr double kVtempLeastNoise = 1e-4;

/// Different values that a converter of n bits gives are 2^n; of one whose range has a sign some
/// programs count the bits without it.
inline constexpr double kCodesOverBits = 2;

/// Time stamps against an even clock, in its steps: from what scatter on they are uneven, of how
/// many last digits of the number, how near the clock the middle of some of them comes again and
/// again where no row is missing, the part of their scatter that they have from each to the next at
/// least, where white ones have all of it, and how many times as near the way between its
/// neighbours the rows lie by their number than by the stamps. A stamp rounded to a microsecond
/// scatters by 0.003 steps of 10 kHz.
inline constexpr double kUnevenStamps = 0.02, kUnevenDigits = 8.0, kSameClock = 0.5,
                        kStampsApart = 0.5, kRowsTellBetter = 2.0;
/// Rows from which an even clock is known.
inline constexpr std::size_t kFewestOfClock = 12;

/// Electrical degrees of an arc from which on its middle is known: on less, the smallest distortion
/// moves it by more than the arc is long, so that no calibration is made of it either.
inline constexpr double kLeastArcDeg = 90;

/// Electrical degrees by which the ellipse of a capture may be uncertain that its own samples are
/// held against: 1.7 % of the radius, a third of the band that they are to keep.
inline constexpr double kYardstickErrorDeg = 1.0;

/// Electrical degrees within which every peak was seen.
inline constexpr double kWholeTurnDeg = 300;

} // namespace ada::health
