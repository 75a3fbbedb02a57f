// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One diagnosis, step by step.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <vector>

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/naming/nested_models.h"
#include "diagnosis/noise/random_causes.h"
#include "diagnosis/noise/spikes.h"
#include "diagnosis/residual/repetition.h"
#include "diagnosis/residual/structure.h"
#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// The parts of a diagnosis that work on one pair of training and held-out data.
class Work {
public:
  /// `guess`: a supply that is not recorded may be read off the radius first. `apart_from_motion`:
  /// only the radius is judged, at the angle that the pair gives with this model.
  Work(const Capture &capture, const DiagnosisOptions &options, bool guess,
       const Model *apart_from_motion = nullptr);

  Diagnosis run();

  /// Whether the shaft was taken for a reference and something is left over that may be its motion.
  bool may_blame_the_sensor_for_the_motion() const;
  /// Whether a ripple of the shaft is named that the knots of the smooth motion follow: what was
  /// fitted beside them is what they left to it.
  bool names_what_the_motion_follows() const;
  /// What the extended model leaves along the radius of held-out data, V rms.
  RadiusLeft radius_left() const { return ada::radius_left(split_.heldout, out_.extended); }

  /// Whether a supply was read off the radius that the search then did not confirm.
  bool guessed_in_vain() const;

private:
  void weigh(Direction disturbed, double weight_along);

  /// Names what the search found against what has no name, and fits and judges the whole.
  void settle();

  /// What the readings of two ranges that do not join show together is no cause's: a fit of any
  /// would mend the joint. The ellipse, and what repeats with the angle, are carried all the same.
  void name_nothing();

  /// The model as it stands now, beside what has no name.
  void judge_model();

  bool zeros_moved();

  /// What a given model carries without a name is no cause: it is looked for anew, so that a model
  /// is judged alike whether it was just found or is given.
  static std::optional<Model> named_part(const Model *model, double supply_v);

  const Model *baseline() const { return named_before_ ? &*named_before_ : nullptr; }

  /// `model` with what the given model carries without a name; nothing: it carries nothing.
  std::optional<Model> with_given_remainder(Model model) const;

  /// Without a reference the motion is read off the pair as the given model corrects it, as it is
  /// off what was found; where that leaves nothing to judge, off the pair as it is.
  Scene scene_of(const Capture &capture, bool needs_split) const;

  /// Where the supply counts from, V: one level for all captures, that of the given model if it has
  /// one. Nothing: the supply is not recorded.
  std::optional<double> vdd_level_v() const;

  const Capture &worked_on() const { return freed_ ? *freed_ : given_; }

  /// With a reference the search itself sees a supply that is not recorded; where VTEMP follows it
  /// every temperature effect would. Whether VTEMP was freed of it, and the search begins anew.
  /// Reads a scene by the radius alone, each reading at the angle that the model gives it.
  void read_by_radius(Scene &scene, const Model &model) const;
  bool free_vtemp();

  const Scene &judge() const { return options_.heldout ? *judge_ : scene_; }
  double floor() const { return std::max(noise_, scene_.white_noise_v); }

  void choose_parts();

  Search search(const Model &start);
  void search_causes();
  /// Goes on from what search_causes() found.
  void search_further();
  void search_thoroughly();

  /// Whether the second capture has other offsets than what was found accounts for. They would hide
  /// everything that the two captures have in common.
  bool offsets_moved() const;

  /// What no cause within one capture can explain.
  void report_moved_offsets();

  bool usable();

  /// A channel that died leaves little to judge; that it died is known all the same.
  void name_dead_channel();

  bool given(const Effect *effect) const;
  /// Whether the capture is worked on with a supply that was read off the radius.
  bool guesses_supply() const;

  /// What the first look found, before any fit.
  std::vector<Finding> screened_findings();

  /// A cause that the extended model names and no conversion corrects.
  Finding recorded(Finding finding);

  /// What the search began with: the model without its findings.
  Model found_baseline() const;

  /// Adds what every pair has where only the length shows it, beside a reference that errs by more.
  bool name_what_the_length_shows();

  /// No finding makes held-out data worse: where all together do, the one that harms most goes. One
  /// that does so where it is added, but not among all, is named after what it has to stand on.
  bool drop_what_harms();
  /// Whether held-out data are less likely after a step than before it.
  bool makes_worse(const Quality &before, const Quality &after) const;
  /// Whether a finding leaves more of held-out data by itself than before by no more than it moves.
  bool leaves_its_own(const Finding &finding) const;
  /// Whether held-out data are likelier under all findings than without this one, by 8 nats.
  bool needed_by_all(std::size_t place) const;

  /// A cause that the last fit, with all of the data and what has no name, leaves outside of what
  /// it can be (a delay below zero) stands for something else.
  bool drop_what_is_impossible();

  /// Causes that cancel each other in the last fit, and leave more than noise, are the shape of
  /// something else.
  bool drop_what_is_cancelled();

  /// A cause whose own standard error, beside what has no name, does not exclude that it is absent
  /// is no finding, whatever the held-out data gained by it: something else is there that it stands
  /// for. Unless it takes most of what is left without it, and is likelier there than not: what has
  /// no name could do that as well, with many columns in its place.
  bool drop_what_is_unclear();

  /// The rounding of a reference that counts in steps stays the same for as long as a slow shaft
  /// stays in one of them: what moves the angle by less than a step may be that.
  bool drop_slips_within_a_step();

  /// What comes in evenly over a good part of the turns beside is no step, however well one fits.
  bool drop_what_comes_in_slowly();

  /// Without a reference what lies across the vector is the motion's as well. What changes the
  /// figure that the pair draws is seen in the length of held-out data.
  bool drop_what_the_length_denies();

  /// Where a cause that may lie anywhere on the axis of the time or of the angle lies, in periods
  /// over the whole record: a whole one is what the record tells apart.
  struct Line {
    enum { of_time, of_angle } axis;
    double periods; ///< over the record
    bool whole;     ///< an order that comes with every turn
  };
  std::optional<Line> line_of(const EffectInstance &e) const;

  /// Lines that lie closer together than a record of this length tells apart are one, which changes
  /// as it goes on. Only where the strongest is nearly all of it that is a steady line, which has a
  /// name; otherwise it is none of the catalogue's.
  bool drop_lines_that_stand_together();

  /// What only turns the vector leaves its length. Where the length changes with the same order,
  /// and that is none of the turn's own, both are one thing, which has another cause.
  bool drop_turns_that_lengthen();
  bool drop_ripples_by_chance();
  /// Amplitude of an order of the turn in what a model leaves along the vector, V.
  double lengthens(const Model &model, double order) const;

  /// A step that is no larger than what a process of its pattern goes on with, once its course is
  /// taken out, or than coloured noise, is a part of that.
  bool drop_steps_of_processes(const std::vector<RandomCause> &noise = {});

  /// The budget, the best model that names nothing, and what is carried without a name.
  void compare_with_anonymous();

  /// What repeats with the angle and has no name, where held-out data confirm it: what this capture
  /// shows, or what the given model brought along where that tells more.
  void carry_remainder(const DataSplit &white);
  /// Whether the reference ripples against even time by what the remainder of a model turns the
  /// vector by, and the pair does not: then it is the reference's, and no matter for the angle.
  bool is_of_the_reference(const Model &with) const;
  /// Whether held-out data are likelier than with the last model, and their angle is no farther
  /// off: where the length wanders an offset or a remainder may follow it, and turn the angle.
  bool likelier_and_no_farther(const SplitQuality &other) const;
  /// Offsets and zero angle are fitted beside what has no name. Of that no file carries what goes
  /// with the time, the speed or the temperature; its mean over the capture goes with the offsets
  /// where held-out data bear it out. `judged`: the extended model by the training part alone.
  void carry_mean_of_unnamed(const DataSplit &white, const Model &judged);

  /// All usable samples: the numbers of a remainder that held-out data have confirmed are taken
  /// from them, too.
  Observations everything() const;

  /// Isolated spikes stand out of the noise that there is, whatever was stated. False: none.
  bool spikes();

  void take(NestedModels nested);

  /// Takes samples out of everything that is judged from here on.
  void leave_out(const std::vector<char> &hit);

  static bool has(const Model &model, bool (*is)(const EffectInfo &));

  /// Slow processes, read off what everything else leaves over; their courses are taken out of the
  /// data. Whether they moved the pair by more than its noise, and so may have hidden something.
  bool take_out_processes();
  /// What is named now, with all that was worked out for it.
  struct Named {
    SearchResult found;
    NestedModels nested;
    Diagnosis out;
    Anonymous unnamed;
    DataSplit split;
    SplitQuality first, last, named;
    double noise_v;
    std::vector<std::pair<const Effect *, const Effect *>> shapes;
  };
  Named named_now() const;
  void take_again(const Named &named);
  /// Samples of the whole record, few enough to look at what goes slowly.
  Observations over_the_record() const;
  /// A cause that explains no more of what wanders than any slow shape would: its place in the
  /// order of what was found.
  std::optional<std::size_t> shape_of(const RandomCause &process, int waves) const;
  /// Takes it back: it is one of the shapes that the process may have.
  void take_for(const RandomCause &process, std::size_t shape);

  /// Whether a process has a name already, and this is more of it.
  bool goes_on(const RandomCause &c) const;

  /// Whether the outputs are as they were read.
  bool nothing_taken_out() const { return processes_.empty() && !reversal_; }

  /// What the first half waves leave of a course is seen where nothing else is left beside it.
  void take_out_rest_of_courses();

  double periods_in_all() const { return scene_.rounds(1.0 / scene_.periods); }

  std::vector<RandomCause> read_noise() const;

  /// Names slow processes and the shape of the noise.
  void name_random_causes();
  /// A cause that goes as slowly as a named process has what it may have of that as an error.
  void widen_beside_processes();
  /// What other causes may have taken of a process, as a part of its size, is an error of its own.
  void widen_process(const Effect &process, double taken);
  void widen(EffectInstance &cause, const std::vector<double> &errors, const Effect &process);

  /// Whether the speed or the temperature, with fewer functions, explains as well what a slow
  /// process would, up to what chance lets them follow. `whole_v2`: what there is without either.
  bool goes_with_a_condition(const Anonymous &slow, double whole_v2, const DataSplit &white,
                             const Model &named) const;

  /// Whether a spectrum over time means anything: an even clock, and a motion that is known.
  bool even_clock() const;

  void name_process(const RandomCause &c);

  /// A slow process that has a name is taken out of what is looked at from now on: its course is
  /// known. Offsets are subtracted; a gain divides what turns, so that what goes in proportion to
  /// it is constant again. False, and nothing is taken out, where less than half of what goes on
  /// slowly goes with it: then that was something else, which the course went along with.
  bool take_out_courses(Anonymous slow, const std::vector<RandomCause> &processes);

  /// What a course or a gain is taken out of: what was left out of the fits has it as well.
  std::array<Observations *, 6> all_data() {
    return {&scene_.all,    &split_.train, &split_.heldout,
            &scene_.spiked, &scene_.rough, &scene_.bursts};
  }

  /// The outputs before something is taken out of them that may not be there.
  struct Outputs {
    std::array<std::array<std::vector<float>, 2>, 6> pairs;
    explicit Outputs(Work &of) {
      for (std::size_t k = 0; k < pairs.size(); ++k)
        pairs[k] = {of.all_data()[k]->vsin, of.all_data()[k]->vcos};
    }
    void put_back(Work &to) const {
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        to.all_data()[k]->vsin = pairs[k][0];
        to.all_data()[k]->vcos = pairs[k][1];
      }
    }
  };

  /// What has no name beside the model, and what the model is worth, with a course taken out.
  void look_anew();

  /// Several records may each have a pair of its own length: between them a magnet, an air gap or a
  /// gain was changed. That goes with the time and with the speed of each, and no half waves follow
  /// it. Taken out where that takes most of what goes with either.
  bool take_out_record_gains();

  /// The pair of a bench that was turned forth and back may have another centre and length on the
  /// way back: it has warmed up, or a supply or a wire was touched. One turning back does not tell
  /// the time from the direction, and no cause has such a step; beside it nothing smaller than the
  /// step would be named. Taken out where it takes more of held-out data than noise does.
  bool take_out_step_at_the_reversal();
  struct StepAtReversal {
    double time_s, gain, sin_v, cos_v, moved_v;
  };

  /// What the courses of processes and the causes beside them account for of each axis.
  void name_in_budget();

  void look_at_leftovers();

  /// Where nothing is seen to be left over, and the best model that names nothing still leaves
  /// clearly less of held-out data, the named model does not explain the capture.
  void note_what_the_anonymous_model_does_better();

  double channel_rms_v() const;

  /// How much a process moves a channel, V rms.
  double process_v(const EffectInfo &info, const std::vector<double> &values) const;
  /// What it goes on with above the half waves that its course was taken out by, V^2.
  double beyond_course_v2(const EffectInfo &info, const std::vector<double> &values) const;

  /// V rms of a channel that the random processes with a name and the steps of a reference or of a
  /// coarse converter leave over: what is smaller is of their kind. A slow process goes on above
  /// the half waves that its course was taken out by, and comes with what does not go on in time
  /// the less, the more periods lie in each of them.
  /// `turning`: of what turns the vector alone, as no gain does.
  double random_v(bool in_time = true, bool turning = false) const;

  /// Mean square of a channel, V^2, that the rounding of a reference which counts in steps leaves
  /// over; and of it what does not come again at the same place, as at a steady speed much of it
  /// does and at others little: of the pair's own angle, rounded to the same steps. Only what comes
  /// again can pass for structure along the angle.
  double rounding_v2() const;
  double rounding_that_does_not_come_again_v2() const;

  static bool is_white(const EffectInfo &info);
  static bool is_coloured_noise(const EffectInfo &info);
  static bool is_white_noise(const EffectInstance &e) { return is_white(e.effect->info()); }
  /// V rms of a channel above the expected noise, where a white noise has a name.
  double white_v() const;

  /// V rms of a channel that a motion without a reference leaves over: it was found as a smooth
  /// curve through the pair's own angles, and what it misses lies across the vector only.
  double motion_v() const;

  /// Takes out what the named random causes account for. White noise is what has no structure:
  /// where much of it has, it is no cause of its own.
  void drop_what_is_random();
  /// Beside a gain that wanders what is left across the vector, above noise that is white.
  std::optional<Structure> what_turns_the_vector() const;

  /// A process that accounts for less than what goes on in time beside it, its own half waves
  /// aside, is no cause: what switches between two states, say, has a slow part, too.
  void drop_processes_that_leave_more();

  /// Step of the reference, rad; 0: none was seen.
  double reference_step_rad() const;
  /// Steps of the reference that the first look did not tell, once everything else is modelled.
  void look_for_reference_steps();

  /// What the named model leaves of the axes, where held-out data confirm it and it is worth a
  /// word.
  void note_unnamed();
  /// What the named causes leave of some samples, in runs over the whole record; along the radius
  /// alone where nothing else is judged.
  struct NotNamed {
    Observations data;
    ResidualColumns rest;
    ResidualColumns of_the_angle; ///< and what goes with no other axis
  };
  NotNamed not_named() const;
  /// How much of a residual comes again at the places of the highest order that was found.
  std::optional<Repeated> repeats(const Observations &data, const ResidualColumns &rest) const;
  /// Of what was found to go with the angle, V rms of a channel: whether it is there in the
  /// residual each time that the shaft passes a place.
  Recurrence recurrence(const NotNamed &left, double rms_v) const;
  /// Whether some of what goes on may come again, though not all of it does.
  bool comes_again_in_part(const NotNamed &left, double rms_v) const;

  /// Causes of which what is left is a size that may as well be none, and none of the known ones
  /// in its place: what they take is there, and is no explanation.
  void note_what_is_not_sure();

  void note_what_stands_out();

  bool supply_is_inferred() const;

  void note_invisible(const Effect &effect);

  /// Puts the parts together.
  void conclude();

  /// The model of all that has a name against the best that names nothing. Structure is what of
  /// that the named model leaves over, and what a last look still sees. What a given model names
  /// counts as what was just found does.
  Verdict verdict() const;

  /// Whether the given model's causes are at work here: one that changes what is random or recorded
  /// was seen, or those of the signal make held-out data likelier than a sensor without them.
  bool given_explains() const;

  const Capture &given_;
  std::optional<Capture> freed_; ///< of a supply that was not recorded
  const DiagnosisOptions &options_;
  std::optional<Model> named_before_; ///< the given model, as far as it has names
  Scene scene_;
  std::optional<Scene> judge_;
  Diagnosis out_;
  DataSplit split_;
  SearchResult found_;
  NestedModels nested_;
  Anonymous unnamed_; ///< what the named model leaves over
  SplitQuality named_; ///< of the model of all that has a name
  std::optional<Finding> spikes_;
  decltype(Spikes::no_spikes) no_spikes_;
  decltype(Spikes::few) few_spikes_;
  std::vector<RandomCause> processes_; ///< whose courses are out of the data
  std::vector<Finding> random_;
  std::vector<EffectInstance>
      seen_random_; ///< the causes of these, and those that the given model names
  SplitQuality first_; ///< of the baseline, spikes and all
  SplitQuality last_;  ///< of the extended model, with what noise causes take out
  std::vector<EffectInstance>
      recorded_;                      ///< causes that the extended model names but never corrects
  std::vector<Structure> angle_left_; ///< what the last look kept of the angle
  double noise_ = 0.0, explained_noise_ = 0.0;
  bool noise_stated_ = false, free_lag_ = false;
  std::set<const Effect *> named_last_; ///< moved there once: no order of two may go round
  mutable std::optional<double> rounding_that_does_not_come_again_v2_;
  /// Processes, each with a cause that was taken back as one of the shapes that it may have.
  std::vector<std::pair<const Effect *, const Effect *>> shapes_;
  std::optional<StepAtReversal> reversal_;
  int slow_waves_ = 0; ///< half waves by which the course of a slow process was taken out
  std::vector<double> lengthening_; ///< orders at which the length changes as the angle does
  bool remainder_of_reference_ = false; ///< see is_of_the_reference
  bool remainder_in_part_ = false;  ///< it helps in a part of the record, or at some of the speeds
  bool in_bursts_ = false;          ///< samples in a row are left over
  bool given_seen_ = false;         ///< a cause that the given model names was seen before any fit
};

} // namespace ada
