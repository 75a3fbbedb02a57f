#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""`record` against `iio_readdev` at 1 MS/s and four channels: processor time, and nothing lost.

  tests/bench/record.py IIO-ANGLE [--samples N] [--rate HZ] [--repeat N]

Needs Debian's libiio-utils. Both read the simulated sensor that IIO-ANGLE serves, the same channels
with their timestamps, in turns, into a file; the cheapest run of each counts. The server's own time
counts for neither.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile


def cost(command, folder):
    """Processor seconds, and what was said on standard error."""
    with open(f"{folder}/out", "wb") as out, open(f"{folder}/said", "wb") as said:
        process = subprocess.Popen(command, stdout=out, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
    with open(f"{folder}/said", encoding="utf-8") as said:
        words = said.read()
    if status != 0:
        sys.exit(f"{command[0]}: ended with status {status}: {words}")
    return usage.ru_utime + usage.ru_stime, words


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--samples", type=int, default=5_000_000)
    parser.add_argument("--rate", type=int, default=1_000_000)
    parser.add_argument("--repeat", type=int, default=3)
    args = parser.parse_args()
    server = subprocess.Popen([args.program, "emulate", "--rate", str(args.rate),
                               "--temperature", "constant:deg_c=25"],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        uri = server.stdout.readline().strip()
        with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
            compare(args, uri, folder)
    finally:
        server.kill()


def compare(args, uri, folder):
    frames = str(args.rate // 20)  # what `record` takes by itself
    theirs = ["iio_readdev", "-u", uri, "-b", frames, "-s", str(args.samples), "iio:device0",
              "voltage0", "voltage1", "voltage2", "voltage3", "timestamp"]
    mine = [args.program, "record", "-u", uri, "--samples", str(args.samples), "-o",
            f"{folder}/a.sigmf-meta"]
    runs = {"iio_readdev": [], "record": []}
    lost = 0
    for _ in range(args.repeat):
        runs["iio_readdev"].append(cost(theirs, folder)[0])
        seconds, words = cost(mine, folder)
        runs["record"].append(seconds)
        found = re.search(r"^(\d+) samples were lost", words, re.MULTILINE)
        lost += int(found.group(1)) if found else 0
    record, readdev = min(runs["record"]), min(runs["iio_readdev"])
    print(f"{args.samples} samples of 4 channels at {args.rate} Hz: record {record:.2f} s, iio_readdev "
          f"{readdev:.2f} s of processor time, {record / readdev:.2f} times; {lost} samples lost")


if __name__ == "__main__":
    main()
