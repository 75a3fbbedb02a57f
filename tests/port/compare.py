#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The numbers of the verbs on another processor beside those of this one.

    compare.py NATIVE FOREIGN       two iio-angle, FOREIGN may need binfmt_misc

Both work on the captures that NATIVE made, and both make one of their own from the same seed. Bounds:
what is estimated agrees within a thousandth of its standard error; angles agree within 1e-6 degrees,
the last digit that is printed."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

SAMPLES = 20000
LAST_DIGIT = 1e-6  # of what convert prints
SHARE = 1e-3  # of a standard error

CAPTURES = {
    "plain": ["--effect", "amplitude-mismatch:k=0.012", "--effect", "quadrature-error:delta_deg=0.4"],
    "field": ["--effect", "stray-field:b=0.01,direction_deg=40", "--effect", "channel-skew:dt_s=4e-6"],
}


def run(program, *arguments, wanted=0):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != wanted:
        sys.exit(f"{program} {' '.join(arguments)} ended with {done.returncode}: {done.stderr}")
    return done.stdout


class Comparison:
    """Differences in units of what is allowed."""

    def __init__(self):
        self.failed, self.compared, self.worst = [], 0, (0.0, "")

    def same(self, what, native, foreign, allowed):
        self.compared += 1
        if isinstance(native, float) and math.isnan(native) and math.isnan(foreign):
            return
        ratio = abs(native - foreign) / allowed if native != foreign else 0.0
        self.worst = max(self.worst, (ratio, what))
        if not ratio <= 1.0:
            self.failed.append(f"{what}: {native!r} here, {foreign!r} there, {allowed:.1g} allowed")

    def equal(self, what, native, foreign):
        self.compared += 1
        if native != foreign:
            self.failed.append(f"{what}: {native!r} here, {foreign!r} there")


def rows(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return lines[0].split(","), [[float(x) for x in line.split(",")] for line in lines[1:]]


def numbers_of(path):
    """name -> (value, standard error) of a calibration."""
    model = tomllib.loads(path.read_text())
    baseline = model["baseline"]
    errors = baseline.pop("std_errors", {})
    out = {name: (value, errors.get(name)) for name, value in baseline.items()}
    for effect in model.get("effect", []):
        for name, value in effect["parameters"].items():
            out[f"{effect['name']} {name}"] = (value, effect.get("std_errors", {}).get(name))
    return out


def compare_simulated(c, programs, folder, name, effects):
    paths = []
    for which, program in zip(("here", "there"), programs):
        path = folder / f"{name}-{which}.csv"
        run(program, "simulate", *effects, "--seed", "4571", "--motion", "constant:rpm=600",
            "--rate", "10000", "--duration", str(SAMPLES / 10000), "-o", str(path))
        paths.append(path)
    header, here = rows(paths[0])
    header_there, there = rows(paths[1])
    c.equal(f"{name}: columns", header, header_there)
    c.equal(f"{name}: rows", len(here), len(there))
    # A sine that differs in its last place may fall on the other side of a code's or a digit's edge:
    # rare, and by one. The sums over the capture do not notice.
    for column, title in enumerate(header):
        pairs = [(a[column], b[column]) for a, b in zip(here, there) if a[column] != b[column]]
        c.same(f"{name}: {title}, rows that differ", 0.0, float(len(pairs)), SAMPLES / 1000)
    return paths[0]


def compare_calibration(c, programs, folder, capture):
    found = []
    for which, program in zip(("here", "there"), programs):
        path = folder / f"{capture.stem}-{which}.toml"
        run(program, "calibrate", "single", str(capture), "-o", str(path))
        found.append(path)
    here, there = (numbers_of(path) for path in found)
    c.equal(f"{capture.stem}: entries of the calibration", sorted(here), sorted(there))
    for name, (value, error) in here.items():
        if error:
            c.same(f"{capture.stem}: {name}", value, there[name][0], SHARE * error)
        else:
            c.equal(f"{capture.stem}: {name}", value, there[name][0])
    return found[0]


def compare_angles(c, programs, folder, capture, calibration):
    tables = []
    for which, program in zip(("here", "there"), programs):
        path = folder / f"angles-{which}.csv"
        run(program, "convert", "--calibration", str(calibration), str(capture), "-o", str(path))
        tables.append(rows(path))
    (header, here), (_, there) = tables
    for column, title in enumerate(header):
        worst = max(abs(a[column] - b[column]) for a, b in zip(here, there))
        exact = title in ("time_s", "status")
        c.same(f"{capture.stem}: {title}", 0.0, worst, 1e-12 if exact else 1.001 * LAST_DIGIT)


def compare_diagnosis(c, programs, capture):
    here, there = (json.loads(run(program, "diagnose", "--json", str(capture)))
                   for program in programs)
    c.equal(f"{capture.stem}: verdict", here["verdict"], there["verdict"])
    causes = [[f["cause"] for f in d["findings"]] for d in (here, there)]
    c.equal(f"{capture.stem}: causes", *causes)
    if causes[0] != causes[1]:
        return
    for a, b in zip(here["findings"], there["findings"]):
        for name, one in a["parameters"].items():
            error = one.get("std_error")
            if error:
                c.same(f"{capture.stem}: {a['cause']} {name}", one["value"],
                       b["parameters"][name]["value"], SHARE * error)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: compare.py NATIVE FOREIGN")
    programs = sys.argv[1:]
    c = Comparison()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for kind, effects in CAPTURES.items():
            capture = compare_simulated(c, programs, folder, kind, effects)
            calibration = compare_calibration(c, programs, folder, capture)
            compare_angles(c, programs, folder, capture, calibration)
            compare_diagnosis(c, programs, capture)
    for line in c.failed:
        print(f"differs: {line}")
    print(f"{c.compared} numbers compared, {len(c.failed)} differ; the largest difference is "
          f"{c.worst[0]:.2g} of what is allowed ({c.worst[1]})")
    return 1 if c.failed else 0


if __name__ == "__main__":
    sys.exit(main())
