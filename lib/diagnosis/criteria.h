// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every threshold of the diagnosis that decides, with its unit and where it comes from.
#pragma once

#include <cstddef>

#include "base/angle.h"

namespace ada::criteria {

// --- what can be judged at all

/// Samples, of both channels: four numbers of the baseline, two of the ellipse and as much again to
/// judge them by.
inline constexpr std::size_t kFewestSamples = 12;
/// Share of the electrical circle that must be seen: below a third an ellipse's centre and its axes
/// are one in the data (Kanatani, Statistical Optimization, 1996, on short arcs).
inline constexpr double kLeastCoverage = 0.33;
/// The same beside a reference: with the angle known, centre and axes are a linear regression. Of
/// 60 degrees its worst direction has 1/600 of the weight of a whole turn: 10,000 samples know it
/// as 17 do there. A shaft that passes once is held out in arcs, of which those at the ends lie
/// outside all others.
inline constexpr double kLeastOfOnePass = 1.0 / 6.0;
/// The same where it goes there and back at least twice: the regression says itself how well centre
/// and axes are known. On less than 20 degrees a vector turns by less than what
/// bends it may be: the worst of its directions has 1e-5 of the weight of a whole turn.
inline constexpr double kLeastCoverageByReference = 1.0 / 18.0;
/// Standard error of the centre, in amplitudes, up to which it is known at all: that of the angle
/// is a degree by then.
inline constexpr double kCentreKnown = 0.02;
/// Of the samples may lie in episodes that are not the sensor's. An estimate: with more of them it
/// is no longer plain which of the two states is the sensor's own.
inline constexpr double kMostOfEpisodes = 0.1;

/// Both outputs stand at an end of the record: rows there, and the part of the record, that both
/// stand for at least; what they scatter by, of the larger range of the two, and how many times
/// their spread still is there (one reading of noise in 1e15); and how far off their curve, in
/// radii, that is: more than any drift or tilt takes a pair which still turns.
inline constexpr std::size_t kFewestStanding = 12, kPartStanding = 50;
inline constexpr double kStandsStill = 0.01, kStandsWithin = 8.0, kFarOffCurve = 0.3;
/// Electrical degrees of the curve that must be seen for that.
inline constexpr double kSeenOfCurve = 270.0;

/// Readings that are held for several rows each: so many of them, rows a reading in the mean, share
/// of them that stands for one or two numbers of rows (starts, gaps and readings that happen to be
/// alike aside), and share in which both channels change, as they do unless the converter is
/// coarse.
inline constexpr std::size_t kFewestHeld = 30;
inline constexpr double kRowsHeld = 1.5, kHeldEvenly = 0.9, kBothDiffer = 0.8;
/// Rows that repeat the one before here and there: so many of them, and so many times what chance
/// gives, whose estimate from nine rows is right to a factor of two.
inline constexpr std::size_t kFewestStale = 5;
inline constexpr double kStaleByChance = 4.0;
/// Steps of a held reference: all but this part of the smallest and of the largest differ by this
/// much where the speed does; those of one line by no more than two to one.
inline constexpr double kFewSteps = 0.1, kStepsDiffer = 2.0;
/// Step of the pair from row to row while the reference is held, over that where it changes: one of
/// a shaft that turns, next to nothing of one that stands while it is read.
inline constexpr double kGoesOn = 0.5;

/// Of what a channel that lives moves at least, at its peak while the other passes its middle:
/// there it moves by all of it, a stuck one by none.
inline constexpr double kStuckMoves = 0.25;

/// So much more than while its peaks are cut off the other channel moves while one is stuck: from
/// peak to peak those last equally long in the angle, but for noise at their edges.
inline constexpr double kLongerThanCut = 1.5;

/// Samples about reversals and changes of speed are left out only while at least this part stays.
inline constexpr double kMostLeftOut = 0.8;

/// Standard error of the sample clock, relative: of quartz that is good to 50 ppm, spread evenly.
inline constexpr double kClock = 29e-6;

/// Jumps of the angle that a search begins with, at most: a model holds ten causes, of which every
/// pair has two.
inline constexpr std::size_t kMostJumpsAside = 6;

/// Samples that a search fits and judges on, and those of the last fits: more only narrow errors
/// that are far below anything physical.
inline constexpr std::size_t kSearchTrain = 30000, kSearchHeldout = 15000;
inline constexpr std::size_t kFitTrain = 160000, kFitHeldout = 80000;
/// A residual this far above the noise is worth another look from the beginning.
inline constexpr double kAboveNoise = 1.25;
/// Below a tenth of its length a vector tells no angle.
inline constexpr double kLeastGain = 0.1;

// --- the hold-out

/// Turns from which on whole turns are held out: two of six judge, and each of them sees all
/// angles.
inline constexpr double kFewestUnits = 6.0;
/// Runs of samples where parts of a turn are held out: an order up to a sixth of it still has
/// training samples on both sides within half its period.
inline constexpr std::size_t kArcs = 240;
/// A stop: neighbours further apart than this many times the noise at rest, and than this, rad,
/// have moved. Eight standard deviations come by chance once in 1e15.
inline constexpr double kStopMovesNoise = 8.0, kStopMovesRad = 0.1 * kRadPerDeg;
/// Play of the way that an angle goes, in standard deviations of its noise: one sample in 16,000
/// lies outside.
inline constexpr double kPlayNoise = 4.0;
/// Records of one sensor from which on every third judges as a whole: two conditions of six. Of
/// fewer each may be the only one at its temperature or its speed, which the others must not have
/// to guess.
inline constexpr std::size_t kFewestRecords = 6;
/// Stops from which on every third one judges, and readings a stop.
inline constexpr std::size_t kFewestStops = 6;
inline constexpr double kFewestReadings = 3.0;
/// Of all readings, those at rest. The others were taken on the way to a stop.
inline constexpr double kLeastAtRest = 0.75;

// --- peaks that are cut off

/// Noise of a level on either side, in standard deviations: one reading in 16,000 is beyond.
inline constexpr double kLevelNoise = 4.0;
/// So many times as many readings on a level as in the next band below: of an even motion 2.4 at
/// the top of a parabola, 5.3 of a fourth power. The band of a level, of half the channel's range,
/// at the widest: noise beyond hides what is cut off.
inline constexpr double kOnLevel = 8.0, kWidestLevel = 0.1;
/// Whatever the motion is, the readings on a level do not go with what an ellipse would have them
/// be: the slope, 1 on one, is none in so many of its errors, which are this small; one that is
/// smaller yet is a level that a filter rounds.
inline constexpr double kFlatErrors = 3.0, kFlatKnown = 0.02, kFlat = 0.005;
/// Where a level takes off more than this part of the noise it acts; readings there that tell its
/// roundness with an error of three degrees of freedom or more; what lies so many spreads from the
/// middle of them is a spike.
inline constexpr double kActsOnLevel = 0.5, kFewestActedOn = 6.0, kWildOnLevel = 6.0;
/// Readings beyond a level, of all: spikes, which come on top of what is cut off. With more of them
/// they are no rare ones.
inline constexpr double kSpikesAboveLevel = 0.02;
/// Of a channel that goes beyond the level of the other one more readings than this do: it is not
/// its level.
inline constexpr double kBeyondOthersLevel = 0.002;
/// Readings on a level, peaks that are cut off at any of the four ends, and readings in each.
inline constexpr double kFewestOnLevel = 12.0;
inline constexpr std::size_t kFewestCutPeaks = 2, kFewestInPeak = 3;
/// While a channel is on a level the other one goes on, by as much as would have it fall by so many
/// bands on an ellipse: of a peak that is not cut it is one, however long the shaft stays there.
/// The readings before and after are lower by less than this part of half its range: it does not
/// jump. Of three readings the other channel's larger step is half of its way, or somewhat more.
inline constexpr double kCutBands = 6.0, kJoins = 0.5, kLargestStep = 0.7;

// --- an alternation from row to row

/// Rows to either side over which it goes as a parabola, and rows of a record in which there are
/// some ten such windows.
inline constexpr std::size_t kAlternationReach = 8, kFewestAlternating = 100;
/// Of the radius: from here on it turns the pair by 12 degrees, more than any error of a sensor,
/// and moves it as far off its circle. A smaller one is a line of the spectrum like another.
inline constexpr double kLargeAlternation = 0.2;
/// Times what of it is not steady: white noise of 1 has 0.74 (off its neighbours 0.61 in all, of
/// which a parabola through 17 rows keeps 0.36).
inline constexpr double kSteadyAlternation = 2.0;
/// Correlation of the two channels on one line, and the part of the whole below which a channel has
/// none to speak of.
inline constexpr double kOnOneLine = 0.9, kOfOneChannel = 0.2;
/// Rows from one change of its sense to the next: three reaches, over which a parabola follows half
/// a sine to a hundredth. From as many changes on its mean square is that of a sine.
inline constexpr std::size_t kRowsOfAlternation = 3 * kAlternationReach, kComesAndGoes = 4;
/// Of a shaft that turns by more than 45 electrical degrees from row to row the mean of two rows is
/// no place of the pair.
inline constexpr double kSlowBesideAlternation = kTwoPi / 8.0;

// --- the anonymous model

/// Samples that it is fitted to and judged on: enough for 0.5 % of the noise in each of 100
/// columns.
inline constexpr std::size_t kAnonymousTrain = 8000, kAnonymousHeldout = 4000;
inline constexpr std::size_t kRemainderSamples = 30000;
/// From one end of the motion to the other: the first and the last of 20 readings of a turn have as
/// much between them.
inline constexpr double kNearlyATurn = 0.95;
/// Orders of the turn that are looked at: a map of the error has no finer detail that is worth its
/// place. The same in electrical periods, where the turn holds many: causes reach to four of them.
inline constexpr int kMostOrders = 96, kMostPeriods = 5;
/// Rms across the vector to that along it, below which a remainder that fails with both alike is
/// fitted with each as large as it is. A choice: above a half the length keeps a quarter of its
/// weight or more, and the second fit would hardly be another one.
inline constexpr double kMuchLessAcross = 0.5;
/// Turns that show what repeats in each: every angle is seen twice. Rings of more poles
/// than this would need more orders than a capture tells.
inline constexpr double kFewestTurnsToRepeat = 2.0;
inline constexpr int kMostPeriodsInTurns = 32;
/// Orders of the turn that a ring of more poles than that is asked for, beside those of its period.
/// A choice: bores, bearings and glued ends err by the lowest few.
inline constexpr int kLowOrders = 12;
/// Samples that an order takes: four numbers from two values each.
inline constexpr double kSamplesPerOrder = 6.0;
/// The same where a second capture judges, at the same places or at others: what the places say may
/// be followed to the last of them, four numbers from two values each.
inline constexpr double kPlacesPerOrder = 2.0;
/// Rows from which on the means of bins and of bands are looked at. A choice: of 72 places in the
/// turn each then has five or six rows.
inline constexpr std::size_t kFewestForMeans = 400;
/// Samples from which on lines of the spectrum are looked for.
inline constexpr std::size_t kFewestForLines = 1000;
/// Rows in the middle of a record that its spectrum is taken of, so that a long one takes no copy
/// of itself: below a corner from a thousandth of the sample rate on lie a hundred lines and more.
inline constexpr std::size_t kFlickerRows = 131072;
/// Rows that tell the white noise of a long record.
inline constexpr std::size_t kNoiseRows = 131072;

/// Electrical periods from one end of the motion to the other below which what changes an offset, a
/// gain and the angle is hardly told apart: cosines of the vector and of nothing are alike to 0.8.
inline constexpr double kPairOfArc = 0.4;

/// Functions slow in time: at most so many half waves over the record, each of which lasts this
/// many electrical periods, so that none follows the shaft, and no more than two to a round of what
/// repeats with the angle, as those are the angle's.
inline constexpr double kMostTrends = 32.0, kPeriodsPerTrend = 1.5, kTrendsPerRound = 2.0;
/// Periods over the rows that a line of few of them has at the least: what comes round less often
/// is slow in time. And how often white noise may have one as strong: in one capture of ten
/// thousand.
inline constexpr double kFewestPeriodsOfRows = 0.5 * kMostTrends, kChanceOfLine = 1e-4;
/// Steps in time: stretches that are compared (three on either side of a place, and enough places
/// to know what is usual), samples in each, and steps at most. A jump counts from this many of its
/// usual sizes on, as a spike does, and where the speed changes by less than this part of the
/// fastest.
inline constexpr double kMostStretches = 256.0;
inline constexpr std::size_t kSamplesOfStretch = 24, kFewestForSteps = 24, kMostSteps = 4;
inline constexpr double kJump = 8.0, kSameSpeed = 0.1;
/// A gap between two ranges of the readings of a channel: passed at least so often, and the next
/// widest is at most this part of it, as is what the jumps differ by.
inline constexpr std::size_t kFewestCrossings = 4;
inline constexpr double kNextGap = 0.25;
/// A pair that comes near the centre of its curve: within this part of its usual distance more
/// often than in this share of the samples, a third of the least that follows. A disc that is
/// filled evenly has 0.02 of them there (0.2 squared, the usual distance being 0.7 of its radius),
/// two tones 0.01; a sound sensor has none.
inline constexpr double kDeadCentre = 0.2, kMostNearCentre = 1.0 / 300.0;
/// Readings stand in one place where all but this part of them do; elsewhere is what lies so many
/// medians of the distance from the middle, of which noise reaches four (the median is 1.18 sigma
/// of a channel, and one of 5000 readings lies 4.1 sigma away). Those are on no circle that leave
/// it by this part of its radius, rms, as a harmonic of 14 % would have it.
inline constexpr double kMostElsewhere = 0.25, kElsewhere = 8.0, kOffCircle = 0.1;
/// Electrical degrees that a pair which goes round shows at the least: all but two steps of the
/// fewest samples. A cloud about one place of a curve shows less, for the centre lies outside it.
inline constexpr double kAllRound = 360.0 - 2.0 * 360.0 / kFewestSamples;
/// Samples that this is seen in: a share of one in 300 to a tenth of it.
inline constexpr std::size_t kForCircle = 30000;
/// A reference of another scale goes away from the pair in a straight line, and one that is bowed
/// in a plain curve. A line through a walk takes the first part of its mean square in one of two
/// thousand, and a polynomial of the third degree the second; of a single step they take three
/// quarters and less than nine tenths. By more than the last part the wheel is another one, and the
/// periods a turn are wrong. Rows that this is seen in: a tenth of a percent of a turn beside noise
/// of half a degree, at ten errors.
inline constexpr double kStraight = 0.97, kPlainCurve = 0.985, kMostOfScale = 0.1;
inline constexpr std::size_t kForScale = 2000;
/// Held-out nats by which an axis must gain to be admitted: by chance once in e^6 = 400 axes. Each
/// further step in its order must gain this many.
inline constexpr double kAdmittedNats = 6.0, kNatsPerOrder = 1.0;
/// Columns at most, as a part of the training values.
inline constexpr double kMostColumns = 0.4;
/// Orders among which causes are named: the highest of the catalogue is a clipping's, two of them.
inline constexpr int kNamedOrders = 16;
/// The same in electrical periods: a third harmonic turns back and lies four of them off.
inline constexpr int kNamedPeriods = 4;
/// Across a supply that is not recorded nothing but noise may be left, by its power. An estimate:
/// the noise is known to a tenth, and uneven between the channels.
inline constexpr double kClean = 1.6;
/// Rows below which a table is so short that one wrong row of it matters, and does not show by how
/// all differ from their neighbours: five times as many as one that stands out is rare in.
inline constexpr double kShortTable = 300.0;
/// Structure is worth a word from this part of the noise on: it then adds 0.7 % to the whole.
inline constexpr double kWorthAWord = 0.12;
/// Relative ridge of the normal equations: of double precision's 1e-16 after squaring.
inline constexpr double kRidge = 1e-9;
/// Mean square below which nothing is resolved, V^2: a nanovolt.
inline constexpr double kLeastMeanSquare = 1e-18;
/// Weights of the next orders and of those beyond them in the variance of an order.
inline constexpr double kNeighbourWeight[2] = {1.0, 0.5};
/// The variance of a coefficient that nothing is seen of, as a part of what the data resolve.
inline constexpr double kLeastOfResolution = 0.01;

/// Angle error of a model with more in it over that with less: a held-out part of a thousand
/// samples tells it to 2 %.
inline constexpr double kNoWorse = 1.02;
/// The radius that one fit leaves over that of another: a held-out part of a hundred samples tells
/// it to 7 %.
inline constexpr double kRadiusWorse = 1.1;

/// A cause that helps in one part of the record and harms in another: the harm may be this part of
/// the help. The stretches that tell are each worth so many nats, of which chance makes none
/// negative (their standard deviation is the root of twice as many), and hold so many turns.
/// Where their standard errors are measured, harm counts beyond so many of them.
inline constexpr double kMostHarm = 0.25, kNatsOfStretch = 20.0, kTurnsOfStretch = 1.0;
inline constexpr double kHarmByChance = 2.0;
inline constexpr double kMostStretchesOfGain = 20.0;
inline constexpr std::size_t kFewestStretchesOfGain = 4;
/// A cause must be this part of what nobody knows of the residual: of an unknown structure the
/// likeliest of some fifty shapes takes a tenth of the power, or a third of the rms.
inline constexpr double kOfUnknown = 0.3;
/// Of so many shapes the likeliest takes ln 60 times the mean power of what it is a shape of.
inline constexpr double kLikeliestOfShapes = 4.0;

/// A rival takes a cause's place where it leaves less than this part of the mean square without a
/// name: the likeliest of some fifty shapes takes a tenth of an unknown structure, and no more than
/// half by chance.
inline constexpr double kOfRival = 0.5;
/// Of what has no name and does not repeat with the angle, but goes with the shaft, the part of the
/// power that may lie on a cause's own axis: of one that had more there, more would be left there.
inline constexpr double kOfOtherAxes = 0.5;
/// Of the mean square that is left without a cause next to nothing is left with it: a tenth, which
/// is what chance would take, and not what it would leave.
inline constexpr double kNextToNothing = 0.1;

/// Of what a cause explains, the most that a rival may leave for not being known to second order: a
/// series whose second term were larger would not be known to first order either.
inline constexpr double kMostBlurred = 0.3;
/// Second-order terms over the product of two sizes, each rms of a channel over the amplitude: two
/// causes act in either order, each on a vector whose channels' rms is 0.7 of it.
inline constexpr double kSecondOrder = 4.0;

/// A cause may move the signal by this much of what there is to explain. What is larger stands only
/// because others cancel it: two true causes of one size leave two thirds of it unless three
/// quarters of their shapes are the same and of opposite sign.
inline constexpr double kMostOfDiscrepancy = 1.5;
/// For the same reason two to four causes together must move it by half of what the largest of them
/// does alone.
inline constexpr double kLeastOfGroup = 0.5;
/// Mean square of a cause of one order, chosen among many, over that of the orders without a name
/// (their power-weighted mean): of orders drawn alike from a structure with many of them one in
/// e^3, 5 %, has as much.
inline constexpr double kAboveComb = 3.0;
/// Mean square of the least of several orders over that of the largest that is left. A series that
/// falls to no less than half its amplitude from each order to the next, as that of a bump does,
/// has no such gap.
inline constexpr double kAboveNext = 4.0;
/// Square of the standard errors, a mean over its coordinates, by which a finding must differ from
/// none: three of them, which chance makes once in 400.
inline constexpr double kClear = 9.0;
/// The same where a finding takes most of what is left: two of them, chance once in twenty. With
/// less its own size, and its sign, are not known.
inline constexpr double kUnclear = 4.0;
/// Part of the held-out power that a cause takes which may lie at any place, where the best of all
/// places is no matter of chance: that takes 2 ln M of n independent values, three quarters of
/// sixteen of them for M of 400 places.
inline constexpr double kMoreThanChanceTakes = 0.75;

/// Lines of a spectrum, in periods over the whole record: closer than the first they are one and
/// the same; closer than the second, they are one whose size changes once over the record, of which
/// the sides lie two periods apart, each known to half of one.
inline constexpr double kOneLine = 0.05, kTwoLines = 3.0;
/// Part of its own frequency that a tone may wander by and still be one: the mains of an island
/// stay within 2 % of theirs (EN 50160, for 95 % of a week).
inline constexpr double kSameTone = 0.02;
/// Part of the power of lines that stand together which the strongest has where it is steady: a
/// line whose size goes up and down as a sine, by a factor of 2.8 (m of 0.47), has as much: 1 / (1
/// + m^2/2).
inline constexpr double kMostlySteady = 0.9;

/// A ripple of the shaft over what the motion does at its order in a turn by itself, divided by the
/// square root of the turns: the mean of so many independent turns is that large with a probability
/// of e^-9, one of 8000.
inline constexpr double kChanceRipple = 3.0;
/// Part of the power of a ripple that the knots of the smooth motion cannot follow: of less than a
/// half the larger part of any ripple is theirs.
inline constexpr double kBeyondKnots = 0.5;

// --- naming causes

/// Samples of the search: for looking around, and for a first fit.
inline constexpr std::size_t kQuick = 8000, kCoarse = 4000;
/// What is left of a fit, times the noise, from which on the noise adds no more than a sixteenth to
/// its variance: the first fits are enough then.
inline constexpr double kFarAboveNoise = 4.0;
/// What a law leaves of the scatter of the lengths that records have of their own. A corner and an
/// amplitude take two of them; each further one comes as near by chance in about one of ten.
inline constexpr double kLawLeaves = 0.1;
/// Candidates that get a joint fit, of each axis beyond the angle at least, and effects of a model
/// at most.
inline constexpr std::size_t kShortlist = 5, kShortlistOfAxis = 2;
inline constexpr int kMostEffects = 10;
/// Amplitude along the vector over that across it, from where on both have one cause: a sum with
/// another field has as much of either, an error of an angle has none.
inline constexpr double kAsMuchAlong = 0.5;
/// A cause must be worth this many nats on held-out data, and more for each coordinate: the
/// likeliest of some fifty shapes gains e^-12 of them by chance, and a coordinate that is fitted to
/// nothing one nat on the average.
inline constexpr double kLeastNats = 12.0, kNatsPerCoordinate = 3.0;
/// What every pair has need only be likelier than not by this, beyond what each coordinate costs.
inline constexpr double kExpectedNats = 0.0;
/// A moment that was looked for among all samples costs about the logarithm of their number.
inline constexpr double kNatsPerMoment = 11.0;
/// Part of the noise that a cause must explain: below it the noise of the whole grows by 0.2 %, and
/// nobody would care.
inline constexpr double kLeastOfNoise = 0.06;
/// Residual, in units of the noise, above which what was found is called into question.
inline constexpr double kExchangeAbove = 1.25;
inline constexpr std::size_t kMostExchanged =
    6; ///< effects; beyond so many the work grows too long
/// Of a converter's coarse step, what a cause must explain at least: its error is no noise, and
/// looks like a little of many effects.
inline constexpr double kOfStep = 0.1;
/// Of a step of the reference, the least amplitude of an error of the angle that is told, whoever
/// makes it: the readings agree with a motion to within a twentieth of a step beyond the half of
/// one, and a ripple of the shaft of that size is in the pair and not in the motion.
inline constexpr double kOfReferenceStep = 0.1;
/// Two causes this correlated are one and the same in the data: both together would cancel each
/// other at sizes that mean nothing. Unless far more is gained than by chance: two speeds just tell
/// two lags apart. Or they do not cancel, and each is clear of its error.
inline constexpr double kOneShape = 0.995, kNearlyOne = 0.999, kFarMoreNats = 1000.0;
/// Part of the best worth from which on another candidate does about as well.
inline constexpr double kAsWell = 0.98;
/// A candidate whose gain, before its numbers are fitted, is less than this part of one that was
/// accepted does not go first: fitted it would have to gain five times as much. Its turn comes with
/// what the first one leaves.
inline constexpr double kFarLess = 0.2;

/// A shape without a physical cause that gains so many times as much as any cause: two causes that
/// share its work would each gain half of it.
inline constexpr double kSaysMuchMore = 2.5;

/// Part of the highest gain from which on a first look, which is linear, does not tell which of two
/// does better: what is clipped far, or bent far, looks that much smaller or larger than it is.
inline constexpr double kComparable = 0.8;
/// What scatters by less than this above noise may be noise. An estimate: 0.44 of the power of
/// noise may lie hidden in it, which the held-out angle is asked about as well.
inline constexpr double kMoreThanNoise = 1.2;
/// What is left across the vector over what is left along it, below which the direction alone tells
/// the figure: fitted alike, what the length does would have a hundred times its weight.
inline constexpr double kFarLessAcross = 0.1;
/// Mean square of what causes turn the vector by, each for itself, to that of what it is turned by
/// without them, from which on they cancel each other: of causes that are independent it is 1.
inline constexpr double kTurnsBack = 2.0;
/// The same where nothing else speaks against them: two of one shape and size, of phases that have
/// nothing to do with each other, leave a tenth of their power in one case of seven, more of them
/// in fewer. On every bench that has been looked at it was 4 or less.
inline constexpr double kCancels = 10.0;
/// The same where one of them is what every pair has: two of one size leave a hundredth in one case
/// of twenty-two.
inline constexpr double kCancelsWhatIsThere = 100.0;
/// A rival that comes this close, in nats, cannot be rejected: odds of e^8 are 3000 to one.
inline constexpr double kRivalNats = 8.0;
/// What a cause leaves over of the one that yields to it: as a part of what either explains, and as
/// a part of the noise, where what stands clear of it tells the two apart.
inline constexpr double kSlight = 0.02, kHidden = 0.5;
/// Prior cost of a motion whose own ripple happens to look like an error of the reference, nats.
inline constexpr double kCoincidence = 20.0;

// --- random causes

/// What one cause may leave over of what several explain, as a part of the mean square.
inline constexpr double kLittle = 0.1;
/// Of what goes on slowly, as a part of the mean square, that must go with the course of a process:
/// all of it, but for what the course's half waves do not follow and for what else there is.
inline constexpr double kOfCourse = 0.5;
/// What the few functions of the speed may leave of what many slow ones explain, as a part of the
/// mean square. A process that wanders follows them to nine tenths by chance in one record of six,
/// and to this part in none of a thousand; where the speed is the cause only their own roughness is
/// left.
inline constexpr double kNearlyAll = 0.01;
/// Nats by which a cause of the noise must raise the likelihood: one in e^12 by chance.
inline constexpr double kNatsOfNoise = 12.0;
/// Ratio of two variances from which on they are told apart by more than a detail: 5 % of the rms.
inline constexpr double kMoreVariance = 1.1;
/// The same beside what goes on slowly and has no name: what of that is fast is no more than the
/// noise.
inline constexpr double kTwiceAsMuch = 2.0;
/// Mean step of an even clock over its median one, with a third of the turns held out.
inline constexpr double kUneven = 1.2;
/// Highest corner of flicker noise that is tried, over half the sample rate: the density there
/// falls as 1/f to within an eighth, as without any white noise.
inline constexpr double kHighestCorner = 8.0;
/// Power of a noise at low frequencies over that of the errors of what was taken out there by a
/// fit: what has no more than they may be they.
inline constexpr double kOfFit = 4.0;
/// Structure of up to this part of what random causes leave over is of their kind; more of it says
/// that they are no noise.
inline constexpr double kOfRandom = 0.5, kOfProcess = 1.2;
/// Mean square of the steps of a reference over that of an even spread, which it may reach where
/// the shaft dwells.
inline constexpr double kOfSteps = 1.5;
/// Mean square of white noise over what its differences from sample to sample give: with 8000
/// samples that is one to 3 %, and a tenth is worth a word.
inline constexpr double kAlmostWhite = 1.1;
/// Samples over which noise may remember itself: converters average up to so many, and structure
/// that turns once in the square of it is the same over twice as many. A memory counts from this
/// many of its standard errors on: chance gives it once in ten thousand.
inline constexpr std::size_t kMemory = 8;
inline constexpr double kClearErrors = 4.0;
/// Lines of an octave that tell its power to a quarter, and the factor by which it may be off; by
/// less where that is so many of its standard errors.
inline constexpr double kFewestOfOctave = 16.0, kOctaveOff = 2.0;
inline constexpr double kOctaveClearlyOff = 1.5, kErrorsOfOctave = 5.0;
/// What a line that is another one's image has of what an image has not, as a part of itself or in
/// radians: several errors of a line of ten times the noise's own power.
inline constexpr double kNoImage = 0.2;
/// Samples that tell the shape of the noise: a variance to 14 %.
inline constexpr double kFewestForNoise = 100.0;
/// Correlation of two courses that may be one and the same wave.
inline constexpr double kSameWave = 0.9;

// --- standard errors

/// Correlation with a cause that was not found from which on the error is worked out with it as
/// well: it then grows by 2 % or more.
inline constexpr double kWorthAFit = 0.2;
/// Powers of ten over which a size is as likely at one as at the other: a conversion takes from a
/// thousandth of a frame to all of it, and no converter remembers less than that of another value.
inline constexpr double kDecadesOfSize = 3.0;
/// Share of what a value may be that lies within two of its standard errors.
inline constexpr double kWithinTwo = 0.95;

/// Stretches of the record between which the score is compared: with forty its variance is known to
/// a quarter. Fewer than eight say nothing; each holds this many samples.
inline constexpr std::size_t kStretches = 40, kFewestStretches = 8, kFewestOfStretch = 10;

/// What a reference ripples by against even time, projected on what a remainder would turn the
/// vector by the other way, is as much of that at least, and that as much of it, for the remainder
/// to be the reference's: half way from a shaft that ripples by half of it is 0.75.
inline constexpr double kMostOfRemainder = 0.75;

/// Electrical periods from which on what is left along the radius is that of the period in the
/// middle: a median of fewer knows no better than their mean what is usual.
inline constexpr std::size_t kFewestPeriodsInTheMiddle = 8;

} // namespace ada::criteria
