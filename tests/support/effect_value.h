// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "model/effect.h"
#include "model/model.h"

namespace ada::test {

/// Value of a parameter of the effect with this id; nothing when the model does not hold it.
inline std::optional<double> effect_value(const Model &model, std::string_view id,
                                          std::string_view parameter) {
  for (const EffectInstance &e : model.effects) {
    const EffectInfo &info = effect_info(*e.effect);
    for (std::size_t i = 0; info.id == id && i < info.parameters.size(); ++i)
      if (info.parameters[i].name == parameter)
        return e.values[i];
  }
  return std::nullopt;
}

} // namespace ada::test
