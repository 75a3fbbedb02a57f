#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# names.sh SOURCE: what the engine must know of an effect is data on the effect, so no code of the
# library asks for one by its name. Allowed are only those that make or read one certain calibration:
# the ellipse, its two temperatures, the driver's, those that a study compares, and the simulated sensor
# with its figures.
set -euo pipefail
cd "$1"
ALLOWED='^lib/(conversion/ellipse|calibration/(single|dual|tracker)|capi/driver_calibration'
ALLOWED+='|simulation/(simulation|generator|figures)|study/sufficient|health/channels)\.cpp:' # a check is called clipping, too

# The identifiers, from the effects themselves.
names=$(sed -n 's/.*\.id = "\([a-z-]*\)".*/\1/p' lib/model/effects/*.cpp)
[[ $(wc -w <<<"$names") -ge 30 ]] || { echo "too few effects found in lib/model/effects"; exit 1; }
pattern=$(paste -sd'|' <<<"$names")
if found=$(grep -rnE --include='*.cpp' --include='*.h' "\"($pattern)\"" lib |
  grep -vE "^lib/(model/effects|include)/|$ALLOWED|^[^:]*:[0-9]+: *//"); then
  printf 'effects named outside their files:\n%s\n' "$found"
  exit 1
fi
