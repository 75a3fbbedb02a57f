// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/wiring.h"

#include <type_traits>

#include "model/wires.h"

namespace ada {

BeforeWires::BeforeWires(const Model &model, const Residual &recorded) : view_(recorded) {
  const double mid_v = 0.5 * recorded.supply_v;
  const Wires w = wires_of(model);
  if (w.plain())
    return;
  // They exchange and invert: the inverse is the transpose.
  const auto undo = [&w](auto sin, auto cos, double about, auto &to_sin, auto &to_cos) {
    using Value = std::remove_cvref_t<decltype(to_sin[0])>;
    for (std::size_t i = 0; i < sin.size(); ++i) {
      const double s = sin[i] - about, c = cos[i] - about;
      to_sin.push_back(static_cast<Value>(about + w.sin_of_sin * s + w.cos_of_sin * c));
      to_cos.push_back(static_cast<Value>(about + w.sin_of_cos * s + w.cos_of_cos * c));
    }
  };
  undo(recorded.sin_v, recorded.cos_v, 0.0, columns_[0], columns_[1]);
  undo(recorded.model_sin_v, recorded.model_cos_v, mid_v, columns_[2], columns_[3]);
  undo(recorded.read_sin_v, recorded.read_cos_v, mid_v, read_[0], read_[1]);
  const std::array centre_sin{recorded.centre_sin_v}, centre_cos{recorded.centre_cos_v};
  std::vector<double> sin, cos;
  undo(centre_sin, centre_cos, mid_v, sin, cos);
  view_.centre_sin_v = sin[0];
  view_.centre_cos_v = cos[0];
  view_.sin_v = columns_[0];
  view_.cos_v = columns_[1];
  view_.model_sin_v = columns_[2];
  view_.model_cos_v = columns_[3];
  view_.read_sin_v = read_[0];
  view_.read_cos_v = read_[1];
}

} // namespace ada
