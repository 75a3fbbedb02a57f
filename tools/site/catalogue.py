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
vtemp_reference_v = 1.58
[baseline]
amplitude_v = 1.45
offset_sin_v = 0
offset_cos_v = 0
"""
PICTURE = """set terminal svg size 900,640 dynamic font 'sans,12'
set output '{target}'
set multiplot layout 2,2
set grid
unset key
set size square
set title 'VSIN against VCOS (deviation enlarged {scale:g} times)'
set xlabel 'VCOS (V)'
set ylabel 'VSIN (V)'
plot '{table}' using 5:6 with dots lc rgb '#bbbbbb', '' using 7:8 with points pt 7 ps 0.2 lc rgb '#0060a0'
set size nosquare
set ylabel 'angle error (degrees)'
set title 'against the angle'
set xlabel 'angle (degrees)'
plot '{table}' using 1:9 with points pt 7 ps 0.2 lc rgb '#0060a0'
set title 'against time'
set xlabel 'time (s)'
plot '{table}' using 2:9 with points pt 7 ps 0.2 lc rgb '#0060a0'
set title 'against speed'
set xlabel 'speed (rpm)'
set y2tics
set ytics nomirror
set y2label 'radius change (%)'
plot '{table}' using 3:9 with points pt 7 ps 0.3 lc rgb '#0060a0', \\
     '' using 3:10 axes x1y2 with points pt 6 ps 0.3 lc rgb '#c04000'
unset multiplot
"""


def simulate(program, folder, name, effects):
    """A capture of an otherwise ideal sensor without noise, as a table by column."""
    path = folder / f"{name}.csv"
    options = [part for effect in effects for part in ("--effect", effect)]
    subprocess.run([program, "simulate", "--model", folder / "ideal.toml", "--seed", "1", "--noise", "0",
                    "--bits", "0", "--rate", "1000", "--duration", "4", "--motion",
                    "steps:rpm=60/300/600/-600", "--temperature", "ramp:from=0,to=80", *options,
                    "-o", path], check=True)
    return np.genfromtxt((line for line in open(path, encoding="utf-8") if line[0] != "#"),
                         delimiter=",", names=True)


def angle_and_radius(capture):
    """By the plain conversion: mechanical radians less the reference, and the radius."""
    z = (capture["vcos_v"] - 2.5 + 1j * (capture["vsin_v"] - 2.5)) / 1.45
    error = np.angle(z * np.exp(-2j * np.radians(capture["reference_deg"]))) / 2
    return error, np.abs(z)


def signature(base, capture):
    """Columns of the picture's table."""
    rows = min(base.size, capture.size)
    base, capture = base[:rows], capture[:rows]
    error, radius = angle_and_radius(capture)
    error0, radius0 = angle_and_radius(base)
    turned = np.unwrap(np.radians(base["reference_deg"]), period=2 * np.pi)
    rpm = np.gradient(turned, base["time_s"]) * 60 / (2 * np.pi)
    change = np.stack([capture["vcos_v"] - base["vcos_v"], capture["vsin_v"] - base["vsin_v"]])
    largest = np.abs(change).max()
    scale = max(1.0, float(f"{0.3 / largest:.0e}")) if largest > 0 else 1.0
    apart = np.degrees((error - error0 + np.pi / 2) % np.pi - np.pi / 2)
    table = np.stack([base["reference_deg"] % 360, base["time_s"], rpm, error, base["vcos_v"],
                      base["vsin_v"], base["vcos_v"] + scale * change[0],
                      base["vsin_v"] + scale * change[1], apart, 100 * (radius - radius0)], axis=1)
    return table[::10], scale


def draw(program, folder, effect, base, target):
    companion = COMPANIONS.get(effect)
    effects = ([companion] if companion else []) + [effect]
    capture = simulate(program, folder, effect, effects)
    base = simulate(program, folder, "companion", [companion]) if companion else base
    table, scale = signature(base, capture)
    np.savetxt(folder / f"{effect}.dat", table, fmt="%.8g")
    # A picture names its table, so not by a path of the machine that drew it.
    script = PICTURE.format(target=target, table=f"{effect}.dat", scale=scale)
    subprocess.run(["gnuplot", "-"], input=script, text=True, check=True, cwd=folder,
                   stderr=subprocess.DEVNULL)


def rows_of(text, heading):
    """{first cell: cells} of the tables below a heading that begins so."""
    part = text[text.index(heading):]
    rows = [[cell.strip() for cell in line.strip("|\n").split("|")]
            for line in part.split("\n") if line.startswith("| `")]
    return {row[0].strip("`"): row for row in rows}


def section(text, name):
    found = re.search(rf"^## {re.escape(name)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    if not found:
        raise KeyError(f"physics.md has no section on {name}")
    return found[1].strip()


def link(name, known):
    return f"[{name}]({name}.md)" if name in known else f"`{name}`"


def page(fact, known, definition, smallest, physics):
    name = fact["id"]
    lines = [f"# {name}", "", fact["cause"], "", f"![Its signature: VSIN against VCOS, and the angle "
             f"error against angle, time and speed]({name}.svg)", "",
             "An otherwise ideal sensor without noise, two periods a turn, at 60, 300, 600 and -600 rpm, "
             "from 0 to 80 degrees Celsius, with this effect at the size that "
             f"`iio-angle simulate --effect {name}` takes.", ""]
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
    if fact["separations"]:
        lines += ["## What it is mistaken for", "", "| for | what tells them apart |", "|---|---|"]
        lines += [f"| {link(s['rival'], known)} | {s['experiment']} |" for s in fact["separations"]]
        lines += [""]
    how = "[how small is too small](../diagnosis.md#how-small-is-too-small)"
    lines += ["## How small one can see", ""]
    if smallest:
        bound = f" The bound of the joint fit there: {smallest[3]}." if smallest[3] else ""
        lines += [f"Found in 95 % of captures from {smallest[1]} = {smallest[2]} on (60,000 to 75,000 "
                  f"samples, 0.35 to 0.7 mV of noise).{bound} How it was measured: {how}.", ""]
    else:
        lines += [f"No limit is stated for it; which effects were measured, and how: {how}.", ""]
    return "\n".join(lines)


def build(tree, target, scratch):
    facts = json.loads(subprocess.run([tree.facts], check=True, capture_output=True, text=True).stdout)
    known = {fact["id"] for fact in facts}
    texts = {name: (tree.source / path).read_text(encoding="utf-8") for name, path in
             {"effects": "lib/docs/effects.md", "diagnosis": "lib/docs/diagnosis.md",
              "physics": "lib/docs/physics.md"}.items()}
    definitions = rows_of(texts["effects"], "# ")
    smallest = rows_of(texts["diagnosis"], "## How small is too small")
    for folder in (target, scratch):
        folder.mkdir(parents=True, exist_ok=True)
    (scratch / "ideal.toml").write_text(MODEL)
    base = simulate(tree.program, scratch, "base", [])
    index = ["# The catalogue of effects", "", "What a real sensor, its field, its electronics and its "
             "recording do that the application note's model does not.", "",
             "| effect | what happens |", "|---|---|"]
    for fact in facts:
        name = fact["id"]
        draw(tree.program, scratch, name, base, target / f"{name}.svg")
        text = page(fact, known, definitions.get(name, [""] * 3)[2], smallest.get(name),
                    section(texts["physics"], name))
        (target / f"{name}.md").write_text(text + "\n", encoding="utf-8")
        index.append(f"| [{name}]({name}.md) | {fact['cause']} |")
    (target / "index.md").write_text("\n".join(index) + "\n", encoding="utf-8")
    return sorted(known)
