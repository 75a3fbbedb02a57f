// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <array>
#include <vector>

#include "model/model.h"
#include "model/residual.h"

namespace ada {

/// A residual as it is before the wires of the record: what a model holds of exchanged and inverted
/// channels undone, so that what acts ahead of them is guessed from the channels that it acted on.
class BeforeWires {
public:
  BeforeWires(const Model &model, const Residual &recorded);
  BeforeWires(const BeforeWires &) = delete;
  BeforeWires &operator=(const BeforeWires &) = delete;
  /// Lives as long as this and what the recorded one lives of.
  const Residual &view() const { return view_; }

private:
  std::array<std::vector<double>, 4> columns_; ///< residual and model of both channels
  std::array<std::vector<float>, 2> read_;
  Residual view_;
};

} // namespace ada
