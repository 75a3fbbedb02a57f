#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Hides effects, lets `iio-angle diagnose --json` look for them, and counts.

  score.py --iio-angle build/tools/iio-angle --truth-capture build/tests/truth/truth-capture \\
           --category single --runs 200

One line is printed for each failure, with the command that makes the same capture again; a
table for each effect closes the run. Exit status: 0 when every rate that the category demands
was reached, 1 when not, 2 for wrong usage.

What counts
  found     the finding's cause is the hidden one, or one that the truth accepts in its place
            and the hidden one is among its alternatives; where the data cannot decide, all the
            names of the set must be there
  numbers   each parameter within its tolerance (10 % or the stated floor), angles compared
            modulo their symmetry; a missing parameter is wrong
  invented  a finding that belongs to no hidden effect and is not tolerated
  corrected (with --second) the extended model, used on another capture of the same sensor, leaves
            an angle error within 1.3 times what the noise makes
  quiet     nothing hidden, or nothing to be seen: no finding, nothing unexplained
"""

import argparse
import collections
import concurrent.futures
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time

DEMANDED = {"found": 0.95, "numbers": 0.95, "invented": 0.02, "quiet": 1.0, "unexplained": 0.90,
            "corrected": 0.95}
CORRECTED_WITHIN = 1.3  # times the noise floor
QUIET_CATEGORIES = ("null", "tiny", "short")
WITH_EFFECTS = ("single", "bench", "ambiguous", "unknown", "outside")


def names_of(finding):
    return {finding.get("cause")} | set(finding.get("alternatives") or [])


def match(effect, findings, used):
    """The finding for a hidden effect: by its own name before any other."""
    for i, finding in enumerate(findings):
        if i not in used and finding.get("cause") == effect["cause"]:
            return i
    for i, finding in enumerate(findings):
        if (i not in used and finding.get("cause") in effect["accept"]
                and effect["cause"] in names_of(finding)):
            return i
    return None


def difference(value, wanted, period):
    delta = value - wanted
    return abs(math.remainder(delta, period)) if period else abs(delta)


def check_parameter(name, wanted, got):
    """None when right, else what is wrong. The second value tells that the other frame fitted."""
    if got is None:
        return f"{name} missing", False
    value = got.get("value") if isinstance(got, dict) else got
    if "text" in wanted:
        return (None if str(value).removesuffix("_v") == wanted["text"].removesuffix("_v")
                else f"{name}={value} not {wanted['text']}"), False
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return f"{name}={value}", False
    period = wanted.get("period")
    if difference(value, wanted["value"], period) <= wanted["tolerance"]:
        return None, False
    if "other" in wanted and difference(value, wanted["other"], period) <= wanted["tolerance"]:
        return None, True
    return f"{name}={value:.6g} not {wanted['value']:.6g}+-{wanted['tolerance']:.2g}", False


def pull(wanted, got):
    """(estimate - truth)/standard error, for the closing table."""
    if "value" not in wanted or not isinstance(got, dict) or not got.get("std_error"):
        return None
    deltas = [math.remainder(got["value"] - w, wanted["period"]) if wanted.get("period")
              else got["value"] - w
              for w in (wanted["value"], wanted.get("other", wanted["value"]))]
    return min(deltas, key=abs) / got["std_error"]


class Score:
    """One capture's result."""

    def __init__(self, truth):
        self.truth = truth
        self.effects = []  # (cause, found, wrong parameters, number of parameters, pulls)
        self.invented = []
        self.problems = []
        self.notes = []
        self.verdict = None
        self.unexplained = False
        self.report = {}
        self.seconds = None  # of the diagnosis
        self.correction = None  # angle error over noise floor, on the second capture


def judge(truth, report):
    score = Score(truth)
    score.report = report
    if report.get("schema") != "ada4571-diagnosis/1":
        score.problems.append(f"schema is {report.get('schema')!r}")
    findings = report.get("findings") or []
    used = set()
    for effect in truth["effects"]:
        index = match(effect, findings, used)
        if index is None:
            hint = [f.get("cause") for i, f in enumerate(findings)
                    if i not in used and effect["cause"] in names_of(f)]
            score.problems.append(f"missed {effect['cause']}"
                                  + (f" (an alternative of {hint[0]})" if hint else ""))
            score.effects.append((effect["cause"], False, 0, 0, []))
            continue
        used.add(index)
        finding = findings[index]
        lacking = [n for n in effect["require"] if n not in names_of(finding)]
        if lacking:
            score.problems.append(f"{finding.get('cause')} without alternative {', '.join(lacking)}")
        wrong, count, pulls = 0, 0, []
        if finding.get("cause") == effect["cause"]:
            got = finding.get("parameters") or {}
            for name, wanted in effect["parameters"].items():
                count += 1
                problem, other = check_parameter(name, wanted, got.get(name))
                if problem:
                    wrong += 1
                    score.problems.append(f"{effect['cause']}: {problem}")
                if other:
                    score.notes.append("other-frame")
                p = pull(wanted, got.get(name))
                if p is not None:
                    pulls.append(p)
        score.effects.append((effect["cause"], not lacking, wrong, count, pulls))
    for i, finding in enumerate(findings):
        if i not in used and finding.get("cause") not in truth["tolerated"]:
            score.invented.append(finding.get("cause"))
            score.problems.append(f"invented {finding.get('cause')}")
    score.verdict = report.get("verdict")
    score.unexplained = bool((report.get("unexplained") or {}).get("present"))
    instead = any(f.get("cause") in truth.get("named_instead", []) for f in findings)
    if truth["unexplained"] is not None and not instead:
        if truth["unexplained"] and not score.unexplained:
            score.problems.append(f"not called unexplained (verdict {score.verdict})")
        if not truth["unexplained"] and score.unexplained:
            score.problems.append("called unexplained")
    if truth["unexplained"] and instead:
        score.unexplained = True  # said, by its name
    if score.verdict not in truth["verdicts"]:
        score.problems.append(f"verdict {score.verdict}")
    return score


def column(path, name):
    with open(path, encoding="utf-8") as file:
        rows = (line for line in file if not line.startswith("#"))
        index = next(rows).strip().split(",").index(name)
        return [float(line.split(",")[index]) for line in rows]


def angle_error(corrected, exact, periods):
    """rms in degrees, modulo the sensor's period, without the zero angle."""
    period = 360.0 / periods
    differences = [a - b for a, b in zip(corrected, exact)]
    x = sum(math.cos(math.radians(d * periods)) for d in differences)
    y = sum(math.sin(math.radians(d * periods)) for d in differences)
    zero = math.degrees(math.atan2(y, x)) / periods
    return math.sqrt(sum(math.remainder(d - zero, period) ** 2 for d in differences)
                     / len(differences))


def correction(arguments, truth, model, second, folder):
    """Angle error of the second capture, read with the extended model, over the noise floor."""
    angles = os.path.join(folder, "angles.csv")
    converted = subprocess.run([arguments.iio_angle, "convert", "--calibration", model, second,
                                "-o", angles], capture_output=True, text=True,
                               timeout=arguments.timeout)
    if converted.returncode != 0:
        raise RuntimeError(f"convert: exit status {converted.returncode}: "
                           f"{(converted.stderr.strip().splitlines() or [''])[-1]}")
    corrected, exact = column(angles, "angle_deg"), column(second, "reference_deg")
    if len(corrected) != len(exact):
        raise RuntimeError(f"convert: {len(corrected)} angles of {len(exact)} samples")
    floor = math.degrees(truth["noise_rms_v"] / truth["amplitude_v"]) / truth["periods_per_turn"]
    return angle_error(corrected, exact, truth["periods_per_turn"]) / floor


def run_one(arguments, category, effect, seed):
    """Makes a capture, has it diagnosed and judges. Returns (truth, score) or an error text."""
    with tempfile.TemporaryDirectory(prefix="truth-", dir=arguments.scratch) as folder:
        capture = os.path.join(folder, "capture.csv")
        hidden = os.path.join(folder, "truth.json")
        second = os.path.join(folder, "second.csv")
        model = os.path.join(folder, "model.toml")
        make = [arguments.truth_capture, "--category", category, "--seed", str(seed),
                "-o", capture, "--truth", hidden]
        if effect:
            make += ["--effect", effect]
        diagnose = [arguments.iio_angle, "diagnose", "--json"]
        if arguments.second:
            make += ["--second", second, "--second-reference"]
            diagnose += ["--extend", model]
        made = subprocess.run(make, capture_output=True, text=True)
        if made.returncode != 0:
            return None, f"truth-capture: {made.stderr.strip()}"
        with open(hidden, encoding="utf-8") as file:
            truth = json.load(file)
        began = time.monotonic()
        try:
            diagnosed = subprocess.run(diagnose + [capture], capture_output=True, text=True,
                                       timeout=arguments.timeout)
        except subprocess.TimeoutExpired:
            return truth, f"no answer within {arguments.timeout} s"
        try:
            # A capture that is too poor may end with status 1 and still say why.
            report = json.loads(diagnosed.stdout)
        except json.JSONDecodeError:
            lines = diagnosed.stderr.strip().splitlines() or ["no JSON"]
            return truth, f"exit status {diagnosed.returncode}: {lines[-1]}"
        score = judge(truth, report)
        score.seconds = time.monotonic() - began
        if arguments.second:
            try:
                score.correction = correction(arguments, truth, model, second, folder)
                if score.correction > CORRECTED_WITHIN:
                    score.problems.append(f"second capture at {score.correction:.2f} times the "
                                          "noise floor")
            except (RuntimeError, OSError, ValueError, subprocess.SubprocessError) as error:
                score.problems.append(str(error))
        return truth, score


def effects_of(truth_capture, category):
    """What --effect takes in a category."""
    listing = subprocess.run([truth_capture, "--list"], capture_output=True, text=True,
                             check=True).stdout.splitlines()
    begin = next(i for i, line in enumerate(listing) if line.startswith(f"effects of {category}"))
    effects = []
    for entry in listing[begin + 1:]:
        if not entry.startswith("  "):
            break
        effects.append(entry.strip())
    return effects


class Tally:
    def __init__(self):
        self.hidden = collections.Counter()
        self.found = collections.Counter()
        self.parameters = collections.Counter()
        self.right = collections.Counter()
        self.pulls = collections.defaultdict(list)
        self.invented = collections.Counter()
        self.notes = collections.Counter()
        self.captures = self.with_invention = self.errors = self.clean = 0
        self.corrections = []
        self.verdicts = self.unexplained_wanted = self.unexplained_said = 0

    def add(self, truth, result):
        self.captures += 1
        if truth:
            self.unexplained_wanted += bool(truth["unexplained"])
        if not isinstance(result, Score):
            self.errors += 1
            for effect in (truth or {}).get("effects", []):
                self.hidden[effect["cause"]] += 1
            return
        for cause, found, wrong, count, pulls in result.effects:
            self.hidden[cause] += 1
            self.found[cause] += found
            self.parameters[cause] += count
            self.right[cause] += count - wrong
            self.pulls[cause] += pulls
        self.with_invention += bool(result.invented)
        self.invented.update(result.invented)
        self.notes.update(set(result.notes))
        self.clean += not result.problems
        if result.correction is not None:
            self.corrections.append(result.correction)
        self.verdicts += result.verdict in truth["verdicts"]
        self.unexplained_said += bool(truth["unexplained"]) and result.unexplained


def share(part, whole):
    return f"{part}/{whole} ({100 * part / whole:.1f} %)" if whole else "-"


def print_table(tally):
    if tally.hidden:
        print(f"\n{'effect':32} {'hidden':>6} {'found':>15} {'numbers right':>17} {'within 2 se':>12}")
        for cause in sorted(tally.hidden):
            pulls = tally.pulls[cause]
            inside = f"{100 * sum(abs(p) < 1.96 for p in pulls) / len(pulls):.0f} %" if pulls else "-"
            print(f"{cause:32} {tally.hidden[cause]:6} "
                  f"{share(tally.found[cause], tally.hidden[cause]):>15} "
                  f"{share(tally.right[cause], tally.parameters[cause]):>17} {inside:>12}")
    if tally.invented:
        print("\ninvented: " + ", ".join(f"{c} {n}" for c, n in tally.invented.most_common()))


def verdict_of(tally, quiet, slack=0.0):
    """Prints the totals and tells whether the demands are met, each eased by `slack`."""
    met = True

    def line(title, part, whole, demand, at_most=False):
        nonlocal met
        if not whole:
            return
        demand = min(1.0, demand + slack) if at_most else max(0.0, demand - slack)
        good = part <= demand * whole if at_most else part >= demand * whole
        met = met and good
        print(f"{title:22} {share(part, whole):>20}   "
              f"demanded {'at most' if at_most else 'at least'} {100 * demand:.0f} %"
              f"{'' if good else '   NOT MET'}")

    print()
    line("found", sum(tally.found.values()), sum(tally.hidden.values()), DEMANDED["found"])
    line("numbers right", sum(tally.right.values()), sum(tally.parameters.values()),
         DEMANDED["numbers"])
    line("captures with invented", tally.with_invention, tally.captures, DEMANDED["invented"], True)
    if quiet:
        line("quiet", tally.clean, tally.captures, DEMANDED["quiet"])
    line("called unexplained", tally.unexplained_said, tally.unexplained_wanted,
         DEMANDED["unexplained"])
    line("corrected", sum(c <= CORRECTED_WITHIN for c in tally.corrections),
         len(tally.corrections), DEMANDED["corrected"])
    print(f"{'verdict right':22} {share(tally.verdicts, tally.captures):>20}")
    print(f"{'nothing wrong at all':22} {share(tally.clean, tally.captures):>20}")
    if tally.notes:
        print("directions given in the reference's frame, or noise as a total: "
              f"{tally.notes['other-frame']} captures")
    if tally.errors:
        met = False
        print(f"{'no usable answer':22} {share(tally.errors, tally.captures):>20}")
    return met


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iio-angle", required=True)
    parser.add_argument("--truth-capture", required=True)
    parser.add_argument("--category", default="single")
    parser.add_argument("--effect", action="append", default=[],
                        help="only this one; may be given several times, taken in turn")
    parser.add_argument("--each", action="store_true",
                        help="every effect of the category in turn, --runs of each")
    parser.add_argument("--runs", type=int, default=40)
    parser.add_argument("--seed", type=int, help="of the first capture; drawn if not given")
    parser.add_argument("--slack", type=float, default=0.0,
                        help="ease every demanded rate by so much, for runs too short to tell")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=300)
    parser.add_argument("--second", action="store_true",
                        help="also correct another capture of the same sensor")
    parser.add_argument("--scratch", help="folder for captures (default: the system's)")
    parser.add_argument("--quiet", action="store_true", help="no line for each failure")
    arguments = parser.parse_args()

    first = arguments.seed if arguments.seed is not None else random.SystemRandom().randrange(10**9)
    effects = arguments.effect or [""]
    if arguments.each:
        if arguments.category not in WITH_EFFECTS:
            parser.error("--each goes with " + ", ".join(WITH_EFFECTS))
        effects = effects_of(arguments.truth_capture, arguments.category)
    total = arguments.runs * (len(effects) if arguments.each else 1)
    jobs = [(arguments.category, effects[i % len(effects)], first + i) for i in range(total)]
    print(f"category {arguments.category}, {total} captures, seeds {first}..{first + total - 1}",
          flush=True)

    tally = Tally()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(lambda job: run_one(arguments, *job), jobs)
        for (category, effect, seed), (truth, result) in zip(jobs, results):
            tally.add(truth, result)
            problems = result.problems if isinstance(result, Score) else [result]
            if problems and not arguments.quiet:
                again = f"--category {category} --seed {seed}" + (f" --effect {effect}" if effect
                                                                  else "")
                about = truth["description"] if truth else ""
                print(f"{again}: {'; '.join(problems)}  [{about}]", flush=True)
    print_table(tally)
    return 0 if verdict_of(tally, arguments.category in QUIET_CATEGORIES,
                           arguments.slack) else 1


if __name__ == "__main__":
    sys.exit(main())
