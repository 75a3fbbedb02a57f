# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The catalogue's pages: an effect each, from what the effect objects say (facts.json), the table of
definitions (effects.md), the smallest sizes that were found (diagnosis.md), the physics (physics.md),
and pictures that the simulation draws."""
import json
import re
import subprocess

import numpy as np

# What only acts on something else: both captures of its picture have that.
COMPANIONS = {"temperature-lag": "offset-temperature-drift"}
MODEL = """schema = "ada4571-model/1"
periods_per_turn = 2
supply_v = 5
vtemp_reference_v = {reference}
[baseline]
amplitude_v = 1.45
offset_sin_v = 0
offset_cos_v = 0
"""
VTEMP_REFERENCE = 1.58
PICTURE = """set terminal svg size 900,640 dynamic font 'sans,12'
set output '{target}'
set multiplot layout 2,2
set grid
unset key
set size square
set title 'VSIN against VCOS (deviation enlarged {scale:g} times)'
set xlabel 'VCOS (V)'
set ylabel 'VSIN (V)'
plot '{table}' using 4:5 every 2 with dots lc rgb '#bbbbbb', \\
     '' using 6:7 every 2 with points pt 7 ps 0.2 lc rgb '#0060a0'
set size nosquare
set ylabel 'angle error (degrees)'
set yrange [*<-0.001:0.001<*]
set title 'against the angle'
set xlabel 'angle (degrees)'
plot '{table}' using 1:8 with points pt 7 ps 0.2 lc rgb '#0060a0'
set title 'against time'
set xlabel 'time ({unit})'
set y2tics
set ytics nomirror
set y2label 'radius change (%)'
set y2range [*<-0.01:0.01<*]
plot '{course}' using 1:3 axes x1y2 with {style} lc rgb '#c04000', \\
     '' using 1:2 with {style} lc rgb '#0060a0'
set title 'against speed'
set xlabel 'speed (rpm)'
plot '{table}' using 3:8 every 2 with points pt 7 ps 0.3 lc rgb '#0060a0', \\
     '' using 3:9 every 2 axes x1y2 with points pt 6 ps 0.3 lc rgb '#c04000'
unset multiplot
"""


# Against angle and speed: 26 turns. Against time: less than three, so that the course of each can be seen.
TURNS = "steps:rpm=60/300/600/-600"
COURSE = "steps:rpm=15/30/60/-60"
COURSE_SAMPLES = 4000
CYCLE_SAMPLES = 16  # at least, of what repeats in a course
CYCLES = 24  # at most, in a picture 400 points wide
ROUNDING = 2e-4  # of what the captures say: degrees, or percent of the radius


class Simulation:
    """Captures of an otherwise ideal sensor without noise, each made once, as tables by column."""

    def __init__(self, program, folder):
        self.program, self.folder, self.done = program, folder, {}
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "ideal.toml").write_text(MODEL.format(reference=VTEMP_REFERENCE))

    def __call__(self, effects, motion=TURNS, rate=1000, duration=4.0):
        key = (*effects, motion, rate, duration)
        if key not in self.done:
            path = self.folder / "capture.csv"
            options = [part for effect in effects for part in ("--effect", effect)]
            subprocess.run([self.program, "simulate", "--model", self.folder / "ideal.toml", "--seed",
                            "1", "--noise", "0", "--bits", "0", "--rate", str(rate), "--duration",
                            str(duration), "--motion", motion, "--temperature", "ramp:from=0,to=80",
                            *options, "-o", path], check=True)
            self.done[key] = np.genfromtxt((line for line in open(path, encoding="utf-8")
                                            if line[0] != "#"), delimiter=",", names=True)
        return self.done[key]


def angle_and_radius(capture):
    """By the plain conversion: mechanical radians less the reference, and the radius."""
    z = (capture["vcos_v"] - 2.5 + 1j * (capture["vsin_v"] - 2.5)) / 1.45
    error = np.angle(z * np.exp(-2j * np.radians(capture["reference_deg"]))) / 2
    return error, np.abs(z)


def departures(base, capture):
    """Degrees by which the angle departs from that of the other capture, and percent of the radius."""
    (error, radius), (error0, radius0) = angle_and_radius(capture), angle_and_radius(base)
    return np.degrees((error - error0 + np.pi / 2) % np.pi - np.pi / 2), 100 * (radius - radius0)


def reversals(values):
    """Places from which the values turn back by more than a tenth of their range."""
    margin = max(0.1 * np.ptp(values), ROUNDING)
    places, extreme, rising = [], 0, None
    for i, value in enumerate(values):
        back = values[extreme] - value
        if rising is None and abs(back) > margin or rising is not None \
                and (back if rising else -back) > margin:
            places.append(extreme)
            extreme, rising = i, back < 0
        elif rising is not None and (back < 0) == rising:
            extreme = i
    return np.array(places[1:], dtype=int)  # the first is where the values set out


def undersampled(values):
    """Whether something repeats in fewer samples than show it, in the busiest quarter."""
    quarter = max(1, values.size // 4)
    most = max(np.histogram(reversals(values), bins=np.arange(0, values.size + quarter, quarter))[0])
    return most > 2 * quarter / CYCLE_SAMPLES


def first_cycles(values):
    """How many of the values to show, so that the eye can tell one cycle from the next."""
    places = reversals(values)
    return values.size if places.size <= 2 * CYCLES else int(places[2 * CYCLES])


def pair(simulation, drift, base_effects, effects, *conditions):
    """The capture without an effect and the one with it, row by row. Drift that a model knows is taken
    out by VTEMP. What lost rows lost those of the reference as well, but the shaft ran on."""
    base, capture = (simulation(which, *conditions).copy() for which in (base_effects, effects))
    for table in (base, capture) if base_effects else ():
        for channel in ("sin", "cos"):
            table[f"v{channel}_v"] -= drift[f"tc_{channel}"] * (table["vtemp_v"] - VTEMP_REFERENCE)
    if capture.size < base.size:
        base = base[:capture.size]
        capture["reference_deg"] = base["reference_deg"]
    return base, capture


def course(simulation, drift, base_effects, effects, noise):
    """Time, angle error and radius change over a few turns, from nearer where they are too fast to be
    seen."""
    for rate in (1000, 10_000, 100_000):
        base, capture = pair(simulation, drift, base_effects, effects, COURSE, rate,
                             COURSE_SAMPLES / rate)
        both = departures(base, capture)
        if noise or not any(undersampled(values) for values in both):
            shown = base.size if noise else min(first_cycles(values) for values in both)
            return np.stack([base["time_s"], *both], axis=1)[:shown:2 if noise else 1]
    raise ValueError(f"{effects}: too fast for a picture against time")


def signature(base, capture):
    """Columns of the picture's table."""
    turned = np.unwrap(np.radians(base["reference_deg"]), period=2 * np.pi)
    rpm = np.gradient(turned, base["time_s"]) * 60 / (2 * np.pi)
    change = np.stack([capture["vcos_v"] - base["vcos_v"], capture["vsin_v"] - base["vsin_v"]])
    largest = np.abs(change).max()
    scale = max(1.0, float(f"{0.3 / largest:.0e}")) if largest > 0 else 1.0
    table = np.stack([base["reference_deg"] % 360, base["time_s"], rpm, base["vcos_v"], base["vsin_v"],
                      base["vcos_v"] + scale * change[0], base["vsin_v"] + scale * change[1],
                      *departures(base, capture)], axis=1)
    # A turn has 100, 200 or 1000 samples: of each turn other ones. And what is rare.
    shown = np.union1d(np.arange(0, base.size, 3), np.argsort(np.abs(change).max(axis=0))[-16:])
    return table[shown], scale


def draw(simulation, drift, fact, target):
    name = fact["id"]
    without = [COMPANIONS[name]] if name in COMPANIONS else []
    table, scale = signature(*pair(simulation, drift, without, [*without, name]))
    folder = simulation.folder
    np.savetxt(folder / f"{name}.dat", table, fmt="%.8g")
    noise = fact["evidence"] == "noise"
    shown = course(simulation, drift, without, [*without, name], noise)
    milli = shown[-1, 0] < 0.1
    np.savetxt(folder / f"{name}.course", shown * [1000 if milli else 1, 1, 1], fmt="%.8g")
    # A picture names its tables, so not by a path of the machine that drew it.
    script = PICTURE.format(target=target, table=f"{name}.dat", scale=scale, course=f"{name}.course",
                            unit="ms" if milli else "s",
                            style="points pt 7 ps 0.2" if noise else "lines")
    subprocess.run(["gnuplot", "-"], input=script, text=True, check=True, cwd=folder,
                   stderr=subprocess.DEVNULL)


def rows_of(text, heading, columns):
    """{first cell: cells} of the tables with so many columns below a heading that begins so."""
    part = text[text.index(heading):]
    rows = [[cell.strip() for cell in line.strip("|\n").split("|")]
            for line in part.split("\n") if line.startswith("| `")]
    return {row[0].strip("`"): row for row in rows if len(row) == columns}


def section(text, name):
    """The physics of an effect, which names its source or says that it is derived in place."""
    found = re.search(rf"^## {re.escape(name)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    if not found:
        raise KeyError(f"physics.md has no section on {name}")
    if not re.search(r"\([^()]*\*[^*]+\*[^*]*\)|[Dd]erived here", found[1]):
        raise KeyError(f"physics.md names no source of {name}")
    return found[1].strip()


def link(name, known):
    return f"[{name}]({name}.md)" if name in known else f"`{name}`"


def rivals_of(fact, facts):
    """{rival: experiment}, also where only the rival says so."""
    rivals = {s["rival"]: s["experiment"] for s in fact["separations"]}
    for other in facts:
        for s in other["separations"]:
            if s["rival"] == fact["id"]:
                rivals.setdefault(other["id"], s["experiment"])
    return rivals


def size_of(smallest, sizeless):
    """What is known of the smallest size, as lines; either row may be missing."""
    how = "[how small is too small](../diagnosis.md#how-small-is-too-small)"
    if sizeless:
        return [sizeless[1], ""]
    bound = f" The bound of the joint fit there: {smallest[3]}." if smallest[3] else ""
    reach = "up to" if smallest[1] == "`corner_hz`" else "from"  # the lower a corner the more it does
    return [f"Found in 95 % of captures {reach} {smallest[1]} = {smallest[2]} (60,000 to 75,000 samples, "
            f"0.35 to 0.7 mV of noise).{bound} How it was measured: {how}.", ""]


def page(fact, known, definition, size, rivals, physics):
    name = fact["id"]
    lines = [f"# {name}", "", fact["cause"], "", f"![Its signature: VSIN against VCOS, and the angle "
             f"error against angle, time and speed]({name}.svg)", "",
             "An otherwise ideal sensor without noise, two periods a turn, at 60, 300, 600 and -600 rpm, "
             "from 0 to 80 degrees Celsius, with this effect at the size that "
             f"`iio-angle simulate --effect {name}` takes. Against time it turns slowly, at 15, 30, 60 and "
             "-60 rpm and for less than three turns; of what is faster the beginning is shown. The angle "
             "error is blue, the change of the radius red.", ""]
    if name in COMPANIONS:
        lines += [f"Both captures have {link(COMPANIONS[name], known)} as well, and what VTEMP says of it "
                  "is taken out.", ""]
    if definition:
        lines += ["## Definition", "", definition, ""]
    if fact["parameters"]:
        lines += ["| parameter | unit | in the picture | from | to |", "|---|---|---|---|---|"]
        lines += [f"| `{p['name']}` | {p['unit']} | {p['fallback']} | {p['minimum']} | {p['maximum']} |"
                  for p in fact["parameters"]] + [""]
    lines += [f"It acts at the stage *{fact['stage']}*, and " +
              ("is corrected in the angle." if fact["correctable"] else
               "is found and modelled, but never corrected in the angle: it is not the sensor's."), ""]
    lines += ["## Physics", "", physics, ""]
    lines += ["## What it is mistaken for", ""]
    if rivals:
        lines += ["| for | what tells them apart |", "|---|---|"]
        lines += [f"| {link(rival, known)} | {experiment} |" for rival, experiment in rivals.items()]
    else:
        lines += ["No other effect of the catalogue."]
    lines += ["", "## How small one can see", "", *size]
    return "\n".join(lines)


def build(tree, target, scratch):
    facts = json.loads(subprocess.run([tree.facts], check=True, capture_output=True, text=True).stdout)
    known = {fact["id"] for fact in facts}
    texts = {name: (tree.source / path).read_text(encoding="utf-8") for name, path in
             {"effects": "lib/docs/effects.md", "diagnosis": "lib/docs/diagnosis.md",
              "physics": "lib/docs/physics.md"}.items()}
    definitions = rows_of(texts["effects"], "# ", 6)
    smallest = rows_of(texts["diagnosis"], "## How small is too small", 5)
    sizeless = rows_of(texts["diagnosis"], "## How small is too small", 2)
    target.mkdir(parents=True, exist_ok=True)
    drift = {p["name"]: p["fallback"] for fact in facts if fact["id"] == "offset-temperature-drift"
             for p in fact["parameters"]}
    simulation = Simulation(tree.program, scratch)
    index = ["# The catalogue of effects", "", "What a real sensor, its field, its electronics and its "
             "recording do that the application note's model does not.", "",
             "| effect | what happens |", "|---|---|"]
    for fact in facts:
        name = fact["id"]
        draw(simulation, drift, fact, target / f"{name}.svg")
        if (name in smallest) == (name in sizeless):
            raise KeyError(f"diagnosis.md must say once how small {name} may be, or why it has no size")
        text = page(fact, known, definitions.get(name, [""] * 3)[2],
                    size_of(smallest.get(name), sizeless.get(name)), rivals_of(fact, facts),
                    section(texts["physics"], name))
        (target / f"{name}.md").write_text(text + "\n", encoding="utf-8")
        index.append(f"| [{name}]({name}.md) | {fact['cause']} |")
    (target / "index.md").write_text("\n".join(index) + "\n", encoding="utf-8")
    return sorted(known)
