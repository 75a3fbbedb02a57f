#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The smallest size of each effect that `iio-angle diagnose` finds in 95 % of captures.

  smallest.py --iio-angle build/tools/iio-angle --truth-capture build/tests/truth/truth-capture

It measures what `single` captures hide, and what `bench` captures add.

First two captures at each of a ladder of sizes, the usual ones and each a half of the last, say
about where the limit lies; then the other captures lie within a factor of three of it. The share
found may only grow with the size: the isotonic regression that follows the captures best. Printed
for each effect and its first fitted parameter: the smallest size at which that share is 95 %, the
median standard error of those found within a factor of two of it, which is the Cramer-Rao bound of
the joint fit, and the captures within a factor of three of it, found and all.
"""

import argparse
import concurrent.futures
import json
import math
import os
import random
import statistics
import subprocess
import tempfile
import typing

# What has no size of its own, and what is a count.
SIZELESS = {"channel-swap", "channel-inverted", "stuck-channel", "sample-loss"}
DEPTH = 0.065  # of the usual clipping, in the middle; the captures tell only the levels
# Otherwise the first parameter.
SIZE = {"stray-field": ["b"], "sensor-off-axis": ["a_deg"], "field-direction-error": ["a_deg"],
        "rotation-nonuniformity": ["amplitude_deg"], "reference-eccentricity": ["e_deg"],
        "harmonic-distortion": ["amplitude"],
        "periodic-interference": ["amplitude_sin_v", "amplitude_cos_v"],
        "impulse-noise": ["amplitude_v"], "offset-step": ["step_sin_v", "step_cos_v"],
        "angle-slip": ["step_deg"], "offset-temperature-drift": ["tc_sin", "tc_cos"],
        "reference-harmonic": ["e_deg"], "offset-wander": ["rms_sin_v", "rms_cos_v"],
        "offset-temperature-curvature": ["c_sin", "c_cos"],
        "temperature-lag": [], "clipping": []}
LABEL = {"temperature-lag": "share of the usual drift under it", "clipping": "depth over peak"}
POWER = {"flicker-noise": 2}  # its scale is one of the noise's power, all others are of the size
LADDER = 9


class Effect(typing.NamedTuple):
    name: str
    category: str  # of the truth engine


class Look(typing.NamedTuple):
    scale: float  # of the usual size
    size: float
    error: float | None
    found: bool
    names: list  # of the parameters that make the size


def look(arguments, effect, scale, seed):
    """One capture."""
    effect, category = effect
    with tempfile.TemporaryDirectory() as folder:
        capture, truth = os.path.join(folder, "c.csv"), os.path.join(folder, "t.json")
        subprocess.run([arguments.truth_capture, "--category", category, "--effect", effect,
                        "--scale", str(scale ** POWER.get(effect, 1)), "--seed", str(seed),
                        "-o", capture, "--truth", truth], check=True, capture_output=True)
        answer = subprocess.run([arguments.iio_angle, "diagnose", "--json", capture],
                                capture_output=True, text=True)
        with open(truth) as file:
            hidden = next(e for e in json.load(file)["effects"] if e["cause"] == effect)
    findings = json.loads(answer.stdout)["findings"] if answer.returncode == 0 else []
    names = SIZE.get(effect, [next(iter(hidden["parameters"]))])
    if effect == "clipping":
        size = scale * DEPTH
    elif effect == "temperature-lag":
        size = scale
    elif effect == "low-pass-rolloff":  # the higher the corner the less there is to see
        size = 1.0 / hidden["parameters"]["corner_hz"]["value"]
    else:
        size = math.hypot(*(hidden["parameters"][n]["value"] for n in names))
    for finding in findings:
        if effect in [finding["cause"]] + finding["alternatives"]:
            errors = [finding["parameters"].get(n, {}).get("std_error") or 0.0 for n in names]
            return Look(scale, size, max(errors, default=None), True, names)
    return Look(scale, size, None, False, names)


def limit_of(looks):
    """Size from which on the isotonic share found is 95 %; None when it never is."""
    blocks = []  # [captures found, captures, smallest size]
    for l in sorted(looks, key=lambda l: l.size):
        blocks.append([int(l.found), 1, l.size])
        while len(blocks) > 1 and blocks[-2][0] * blocks[-1][1] >= blocks[-1][0] * blocks[-2][1]:
            found, count, _ = blocks.pop()
            blocks[-1][0] += found
            blocks[-1][1] += count
    return next((size for found, count, size in blocks if found >= 0.95 * count), None)


def measure(arguments, effect, pool):
    """One line of the table."""
    rng = random.Random(f"{arguments.seed} {effect.name}")
    seeds = (rng.randrange(10**9) for _ in range(10**6))
    ladder = [2.0**-k for k in range(LADDER) for _ in range(2)]
    looks = list(pool.map(lambda x: look(arguments, effect, *x), zip(ladder, seeds)))
    unit = statistics.median(l.size / l.scale for l in looks)
    about = limit_of(looks) or unit
    near = [min(2.0, about / unit * 3.0 ** rng.uniform(-1, 1))
            for _ in range(max(0, arguments.runs - len(ladder)))]
    looks += pool.map(lambda x: look(arguments, effect, *x), zip(near, seeds))
    limit = limit_of(looks)
    if limit is None:
        usual = [l for l in looks if l.scale >= 0.5]
        return (f"never in 95 %: {sum(l.found for l in usual)} of {len(usual)} at the usual sizes "
                "and half of them", "", "", "")
    errors = [l.error for l in looks if l.error and limit / 2 <= l.size <= 2 * limit]
    near = [l for l in looks if limit / 3 <= l.size <= 3 * limit]
    value = 1.0 / limit if effect.name == "low-pass-rolloff" else limit
    return (f"{value:.2g}", f"{statistics.median(errors):.2g}" if errors else "",
            f"{sum(l.found for l in near)} of {len(near)}",
            LABEL.get(effect.name) or ", ".join(f"`{n}`" for n in looks[0].names))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iio-angle", required=True)
    parser.add_argument("--truth-capture", required=True)
    parser.add_argument("--runs", type=int, default=42, help="captures an effect")
    parser.add_argument("--effect", action="append", help="only this one; may be repeated")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**9))
    arguments = parser.parse_args()
    listing = subprocess.run([arguments.truth_capture, "--list"], capture_output=True, text=True,
                             check=True).stdout.splitlines()
    effects, category = [], None
    for line in listing:
        if not line.startswith("  "):
            category = next((c for c in ("single", "bench") if line.startswith(f"effects of {c}")),
                            None)
        elif category:
            effects.append(Effect(line.strip(), category))
    print(f"seed {arguments.seed}, {arguments.runs} captures an effect")
    print("| effect | parameter | 95 % found from | Cramer-Rao bound there | found near it |")
    print("|---|---|---|---|---|")
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for effect in effects:
            if effect.name in SIZELESS or (arguments.effect
                                           and effect.name not in arguments.effect):
                continue
            limit, error, share, names = measure(arguments, effect, pool)
            print(f"| `{effect.name}` | {names} | {limit} | {error} | {share} |", flush=True)


if __name__ == "__main__":
    main()
