#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The smallest size of each effect that `iio-angle diagnose` finds in 95 % of captures.

  smallest.py --iio-angle build/tools/iio-angle --truth-capture build/tests/truth/truth-capture

Sizes fall by --factor from --first times the usual ones until fewer than 95 % of the captures are
found under the right name. Printed for each effect and its first fitted parameter: the median
absolute size at the last step that was good enough, the share found there and one step further
down, and the median standard error there, which is the Cramer-Rao bound of the joint fit.
"""

import argparse
import concurrent.futures
import json
import os
import random
import statistics
import subprocess
import tempfile

# What has no size of its own, and what is a count.
SIZELESS = {"channel-swap", "channel-inverted", "stuck-channel", "sample-loss"}
SIZE = {"stray-field": "b", "sensor-off-axis": "a_deg", "field-direction-error": "a_deg",
        "rotation-nonuniformity": "amplitude_deg", "reference-eccentricity": "e_deg",
        "harmonic-distortion": "amplitude", "periodic-interference": "amplitude_sin_v",
        "impulse-noise": "amplitude_v", "offset-step": "step_sin_v", "angle-slip": "step_deg",
        "offset-temperature-drift": "tc_sin", "offset-temperature-curvature": "c_sin"}


def look(arguments, effect, scale, seed):
    """Size, standard error and whether it was found; None when nothing could be said."""
    with tempfile.TemporaryDirectory() as folder:
        capture, truth = os.path.join(folder, "c.csv"), os.path.join(folder, "t.json")
        subprocess.run([arguments.truth_capture, "--category", "single", "--effect", effect,
                        "--scale", str(scale), "--seed", str(seed), "-o", capture,
                        "--truth", truth], check=True, capture_output=True)
        answer = subprocess.run([arguments.iio_angle, "diagnose", "--json", capture],
                                capture_output=True, text=True)
        with open(truth) as file:
            hidden = next(e for e in json.load(file)["effects"] if e["cause"] == effect)
    findings = json.loads(answer.stdout)["findings"] if answer.returncode == 0 else []
    name = SIZE.get(effect) or next(iter(hidden["parameters"]))
    size = abs(hidden["parameters"][name]["value"])
    for finding in findings:
        if effect in [finding["cause"]] + finding["alternatives"]:
            got = finding["parameters"].get(name) or {}
            return name, size, got.get("std_error"), True
    return name, size, None, False


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iio-angle", required=True)
    parser.add_argument("--truth-capture", required=True)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--steps", type=int, default=7)
    parser.add_argument("--first", type=float, default=1.0)
    parser.add_argument("--factor", type=float, default=2.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**9))
    arguments = parser.parse_args()
    listing = subprocess.run([arguments.truth_capture, "--list"], capture_output=True, text=True,
                             check=True).stdout.splitlines()
    first = next(i for i, line in enumerate(listing) if line.startswith("effects of single"))
    effects = []
    for line in listing[first + 1:]:
        if not line.startswith("  "):
            break
        effects.append(line.strip())
    print(f"seeds from {arguments.seed}, {arguments.runs} captures a step, steps of "
          f"{arguments.factor:g}")
    print("| effect | parameter | smallest size found | standard error there | found | one step below |")
    print("|---|---|---|---|---|---|")
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for effect in effects:
            if effect in SIZELESS:
                continue
            best, below = None, ""
            for step in range(arguments.steps):
                results = list(pool.map(
                    lambda k: look(arguments, effect,
                                   arguments.first / arguments.factor**step,
                                   arguments.seed + k),
                    range(arguments.runs)))
                found = sum(r[3] for r in results) / len(results)
                if found < 0.95:
                    below = f"{100 * found:.0f} %"
                    break
                errors = [r[2] for r in results if r[2]]
                best = (results[0][0], statistics.median(r[1] for r in results),
                        statistics.median(errors) if errors else None, found)
            if best is None:
                print(f"| `{effect}` | | larger than the usual sizes | | | {below} |", flush=True)
                continue
            error = f"{best[2]:.2g}" if best[2] else ""
            print(f"| `{effect}` | `{best[0]}` | {best[1]:.2g} | {error} | {100 * best[3]:.0f} % "
                  f"| {below or 'not tried'} |", flush=True)


if __name__ == "__main__":
    main()
