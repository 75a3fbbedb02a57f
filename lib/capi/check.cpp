// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <string>

#include "capi/guard.h"
#include "capi/handles.h"
#include "capi/to_fit.h"
#include "health/health.h"

struct ada4571_health {
  bool sound;
  std::string text, json;
};

extern "C" {

ada4571_status ada4571_check(const ada4571_recording *recording, const ada4571_model *model,
                             ada4571_health **health) {
  return ada::capi::guard([&] {
    ada::capi::require(recording, "recording");
    ada::capi::require(health, "health");
    const ada::Health result =
        ada::check_health(ada::capi::to_fit(*recording), model != nullptr ? &model->impl : nullptr);
    *health =
        new ada4571_health{result.sound(), ada::health_text(result), ada::health_json(result)};
  });
}

int ada4571_health_sound(const ada4571_health *health) {
  return health != nullptr && health->sound;
}

const char *ada4571_health_text(const ada4571_health *health) {
  return health != nullptr ? health->text.c_str() : "";
}

const char *ada4571_health_json(const ada4571_health *health) {
  return health != nullptr ? health->json.c_str() : "";
}

void ada4571_health_free(ada4571_health *health) {
  delete health;
}

} // extern "C"
