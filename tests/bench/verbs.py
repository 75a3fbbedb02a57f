#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The verbs on a long recording against numpy and pandas: processor time and peak memory.

  tests/bench/verbs.py IIO-ANGLE [--pairs N] [--write lib/docs/performance.md]

Needs Debian's python3-numpy and python3-pandas. Everything runs in one go on the same files, each
command several times, of which the cheapest counts; the ratios are what carries over to another
machine. User and system time are added up, so other work on the machine matters little.
"""

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time

READ = """
import sys, numpy as np
raw = np.fromfile(sys.argv[1], dtype='<u2').reshape(-1, 2)
s, c = raw[:, 0] * (5 / 65536), raw[:, 1] * (5 / 65536)
"""

# An ellipse by least squares, and all angles: what a user would write in ten lines.
ELLIPSE = READ + """
x, y = s - s.mean(), c - c.mean()
D = np.stack([x * x, x * y, y * y, x, y], axis=1)
p = np.linalg.solve(D.T @ D, D.T @ np.ones(len(x)))
angle = np.arctan2(x, y) / 2
"""
ARCTAN2 = READ + "angle = np.arctan2(s - 2.5, c - 2.5)\n"
SAVETXT = READ + """
n = len(s) // 10  # a tenth: it takes long
x, y = s[:n] - 2.5, c[:n] - 2.5
rows = np.stack([np.arange(n) / 1e6, np.degrees(np.arctan2(x, y)) / 2, np.hypot(x, y), 0 * x], axis=1)
np.savetxt('/dev/null', rows, fmt='%.9f,%.6f,%.6f,%d')
"""
READ_CSV = """
import sys, pandas
pandas.read_csv(sys.argv[1], comment='#')
"""


def cost(command, repeat=3):
    """Processor seconds and peak memory in MB of the cheapest run."""
    best = None
    for _ in range(repeat):
        pid = os.fork()
        if pid == 0:
            null = os.open(os.devnull, os.O_RDWR)
            for fd in (0, 1, 2):
                os.dup2(null, fd)
            os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
            try:
                os.execvp(command[0], command)
            except OSError:
                os._exit(127)
        _, status, usage = os.wait4(pid, 0)
        if status != 0:
            sys.exit(f"{' '.join(command)[:80]}: ended with status {status}")
        run = (usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)
        best = run if best is None else min(best, run)
    return best


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--pairs", type=int, default=10_000_000)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--diagnose", action="store_true", help="too; it takes minutes")
    parser.add_argument("--write", metavar="FILE")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
        rows = measure(args, folder)
    text = table(rows, args)
    print(text)
    if args.write:
        write(args.write, text)


def measure(args, folder):
    angle = os.path.abspath(args.program)

    def simulate(pairs, path):
        subprocess.run([angle, "simulate", "--rate", "1000000", "--duration", str(pairs / 1e6),
                        "--motion", "constant:rpm=6000", "--effect", "amplitude-mismatch:k=0.01",
                        "--no-vtemp", "--no-vdd", "--no-reference", "-o", path],
                       check=True, stderr=subprocess.DEVNULL)

    sigmf, text = f"{folder}/long.sigmf-meta", f"{folder}/long.csv"
    data, model = f"{folder}/long.sigmf-data", f"{folder}/sensor.toml"
    simulate(args.pairs, sigmf)
    simulate(args.pairs, text)

    def python(script, path):
        return cost(["/usr/bin/python3", "-c", script, path], args.repeat)

    def run(*words, repeat=args.repeat):
        return cost([angle, *words], repeat)

    ellipse, arctan2 = python(ELLIPSE, data), python(ARCTAN2, data)
    read_csv = python(READ_CSV, text)
    tenth, empty = python(SAVETXT, data), python(READ, data)
    savetxt = (10 * (tenth[0] - empty[0]), tenth[1])
    calibrate = run("calibrate", "single", sigmf, "-o", model)
    convert = ["convert", "--calibration", model, sigmf, "-o"]
    rows = [
        ("`calibrate single`, SigMF", calibrate, "numpy: ellipse and angles", ellipse, 1.0),
        ("`check`, SigMF", run("check", sigmf), "the same", ellipse, 2.0),
        ("`convert`, SigMF to SigMF", run(*convert, f"{folder}/angles.sigmf-meta"),
         "numpy: `arctan2` of the file", arctan2, 0.5),
        ("`convert`, SigMF to CSV", run(*convert, "/dev/null"), "`numpy.savetxt`", savetxt, 0.1),
        ("`calibrate single`, CSV", run("calibrate", "single", text, "-o", model),
         "`pandas.read_csv`", read_csv, 1.0),
    ]
    if args.diagnose:
        short = f"{folder}/short.sigmf-meta"
        simulate(args.pairs // 10, short)
        rows.append(("`diagnose`, against a tenth of it (one run)", run("diagnose", sigmf, repeat=1),
                     "`diagnose` of the tenth", run("diagnose", short, repeat=1), 2.0))
    return rows


def table(rows, args):
    lines = [
        f"{args.pairs / 1e6:g} million pairs of 16 bits at 1 MS/s; {processor()}, "
        f"{os.cpu_count()} processors, {platform.freedesktop_os_release()['PRETTY_NAME']}, "
        f"{time.strftime('%Y-%m-%d', time.gmtime())}. Processor seconds, user and system; the least "
        f"of {args.repeat} runs.",
        "",
        "| work | s | against | s | ratio | aim | MB |",
        "|---|---|---|---|---|---|---|",
    ]
    for work, (seconds, memory), other, (their_seconds, _), aim in rows:
        lines.append(f"| {work} | {seconds:.2f} | {other} | {their_seconds:.2f} | "
                     f"{seconds / their_seconds:.2f} | {aim:g} | {memory:.0f} |")
    return "\n".join(lines)


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def write(path, text):
    """Between the two marks of the page."""
    begin, end = "<!-- measured -->\n", "<!-- /measured -->"
    with open(path, encoding="utf-8") as file:
        page = file.read()
    head, rest = page.split(begin, 1)
    tail = rest.split(end, 1)[1]
    with open(path, "w", encoding="utf-8") as file:
        file.write(head + begin + text + "\n" + end + tail)


if __name__ == "__main__":
    main()
