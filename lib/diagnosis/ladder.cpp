// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/explain.h"
#include "model/effect_text.h"

namespace ada {

namespace {

/// The effect of a fitted model that this is a less fitted version of.
const EffectInstance *same_instance(const Model &model, const EffectInstance &e) {
  for (const EffectInstance &o : model.effects)
    if (repeats(o, e))
      return &o;
  return nullptr;
}

/// The model without anything that was found.
Model without_findings(const SearchResult &found) {
  Model model = found.fit.model;
  std::vector<std::size_t> drop = found.order;
  std::sort(drop.rbegin(), drop.rend());
  for (std::size_t k : drop)
    model.effects.erase(model.effects.begin() + static_cast<std::ptrdiff_t>(k));
  return model;
}

Finding supply_finding(const Parts &parts, double rms_fraction, const Rung &before,
                       const Rung &after) {
  const double error = rms_fraction / std::sqrt(2.0 * static_cast<double>(parts.train.size()));
  Finding out{
      &the_effect(follows_supply), {rms_fraction}, {error}, {}, {}, {}, before, after, false};
  put_in_words(out);
  return out;
}

} // namespace

void put_in_words(Finding &finding) {
  finding.separate_by = separation(*finding.effect, finding.alternatives);
  finding.explanation = explanation(finding);
}

namespace {

/// Wald's statistic of each effect of a fit over the number of its coordinates.
std::vector<double> clearness_of(const FitResult &fit) {
  std::vector<double> out;
  Eigen::Index first = static_cast<Eigen::Index>(coordinates_of(Model{}).size());
  for (const EffectInstance &e : fit.model.effects) {
    const std::vector<double> x = e.effect->to_coordinates(e.values);
    const auto parameters = e.effect->info().parameters;
    std::vector<Eigen::Index> sizes; // the coordinates that are 0 where it is absent
    for (std::size_t k = 0; k < x.size(); ++k)
      if (x.size() != parameters.size() || !is_place(parameters[k]))
        sizes.push_back(static_cast<Eigen::Index>(k));
    const auto all = static_cast<Eigen::Index>(x.size()), n = static_cast<Eigen::Index>(sizes.size());
    const Eigen::VectorXd value = Eigen::Map<const Eigen::VectorXd>(x.data(), all)(sizes);
    const Eigen::MatrixXd c = fit.covariance.block(first, first, all, all)(sizes, sizes);
    const double z2 = n == 0 ? std::numeric_limits<double>::infinity()
                             : value.dot(c.ldlt().solve(value)) / static_cast<double>(n);
    out.push_back(fit.determined && std::isfinite(z2) ? z2 : std::numeric_limits<double>::infinity());
    first += all;
  }
  return out;
}

std::vector<std::string> ids_of(const std::vector<Rival> &rivals) {
  std::vector<std::string> out;
  for (const Rival &r : rivals)
    out.push_back(r.id);
  return out;
}

} // namespace

Ladder build_ladder(Parts &parts, const SearchResult &found) {
  // A supply that is not recorded counts as a finding, and so from its own rung on.
  const bool supply = found.disturbed == Direction::supply;
  parts.weigh(found.disturbed, supply ? 1.0 : found.weight_along);
  Ladder out;
  Model step = out.baseline = fit(parts.train, without_findings(found), 6).model;
  out.models.push_back(step);
  out.first = out.last = parts.rung(step);
  parts.weigh(found.disturbed, found.weight_along);
  if (found.supply_rms_fraction > 0.0) {
    if (supply)
      step = fit(parts.train, step, 6).model;
    const Rung after = parts.rung(step);
    out.supply = supply_finding(parts, found.supply_rms_fraction, out.first, after);
    out.last = after;
  }
  FitResult whole = fit(parts.train, found.fit.model, 5);
  widen_by_scatter(parts.train, whole);
  attach_errors(whole);
  const std::vector<double> clear = clearness_of(whole);
  out.extended = std::move(whole.model);
  const Model &model = out.extended;
  for (std::size_t i = 0; i < found.order.size(); ++i) {
    const EffectInstance &e = model.effects[found.order[i]];
    step.effects.push_back(e);
    // Everything else starts where the whole model has it: a clipping bends the baseline far.
    step.baseline = model.baseline;
    for (EffectInstance &earlier : step.effects)
      if (const EffectInstance *last = same_instance(model, earlier))
        earlier.values = last->values;
    step = i + 1 == found.order.size() ? model : fit(parts.train, step, 5).model;
    const Rung after = parts.rung(step);
    out.models.push_back(step);
    out.findings.push_back({e.effect,
                            e.values,
                            e.std_errors,
                            ids_of(found.alternatives[i]),
                            {},
                            {},
                            out.last,
                            after,
                            e.effect->info().correctable});
    put_in_words(out.findings.back());
    out.clearness.push_back(clear[found.order[i]]);
    out.last = after;
  }
  if (out.supply && supply) {
    // What its weights are worth shows where nothing else is wrong any more.
    parts.weigh(found.disturbed, 1.0);
    const Rung plain = parts.rung(model);
    parts.weigh(found.disturbed, found.weight_along);
    for (Quality Rung::*part : {&Rung::in_sample, &Rung::heldout}) {
      (out.supply->before.*part).log_likelihood = (plain.*part).log_likelihood;
      (out.supply->after.*part).log_likelihood = (out.last.*part).log_likelihood;
    }
  }
  return out;
}

} // namespace ada
