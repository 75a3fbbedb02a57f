#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""`record` against `iio_readdev` at 1 MS/s and four channels: processor time, and nothing lost.

  tests/bench/record.py IIO-ANGLE [--samples N] [--rate HZ] [--repeat N]

Needs Debian's libiio-utils. Both read the simulated sensor that IIO-ANGLE serves, the same channels
with their timestamps, in turns, into a file; the cheapest run of each counts, as it is and without
what it costs to start. The server's own time counts for neither.
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
    commands = {
        "iio_readdev": lambda n: ["iio_readdev", "-u", uri, "-b", frames, "-s", str(n), "iio:device0",
                                  "voltage0", "voltage1", "voltage2", "voltage3", "timestamp"],
        "record": lambda n: [args.program, "record", "-u", uri, "--samples", str(n), "-o",
                             f"{folder}/a.sigmf-meta"]}
    # Whatever starts and opens the device costs the same for a short record.
    few = args.rate // 20
    least = {(name, n): float("inf") for name in commands for n in (args.samples, few)}
    lost = 0
    for _ in range(args.repeat):
        for name, n in least:
            for old in os.listdir(folder):  # to free what was written before is no work of either
                os.remove(f"{folder}/{old}")
            seconds, words = cost(commands[name](n), folder)
            least[name, n] = min(least[name, n], seconds)
            found = re.search(r"^(\d+) samples were lost", words, re.MULTILINE)
            lost += int(found.group(1)) if found else 0
    record, readdev = least["record", args.samples], least["iio_readdev", args.samples]
    starts = least["record", few], least["iio_readdev", few]
    print(f"{args.samples} samples of 4 channels at {args.rate} Hz: record {record:.3f} s, iio_readdev "
          f"{readdev:.3f} s of processor time, {record / readdev:.2f} times; of it to start "
          f"{starts[0]:.3f} and {starts[1]:.3f} s, {(record - starts[0]) / (readdev - starts[1]):.2f} "
          f"times while it runs; {lost} samples lost")


if __name__ == "__main__":
    main()
