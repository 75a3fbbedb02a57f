#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""study_tables.py STUDY.db: what a study found, as pandas tables. The database is plain SQLite; the
package ada4571 is not needed."""
import sqlite3
import sys

import pandas as pd

study = sqlite3.connect(f"file:{sys.argv[1]}?mode=ro", uri=True)

# %% A row a capture, with the keys of its header as columns.
captures = pd.read_sql("SELECT id, capture, serial, state, verdict, sound, reason FROM captures", study)
factors = pd.read_sql("SELECT * FROM factors", study).pivot(
    index="capture_id", columns="key", values="value")
captures = captures.join(factors, on="id")
print(captures["state"].value_counts())

# %% A row a number; place 0 is what every capture has, 1 and up are the findings of the diagnosis.
numbers = pd.read_sql("SELECT capture_id, place, cause, parameter, value FROM parameters", study)
everyone = numbers[numbers["place"] == 0]
print(everyone.groupby(["cause", "parameter"])["value"].describe()[["count", "mean", "std"]])

# %% How often each cause was found, and what it costs in angle.
findings = pd.read_sql("SELECT capture_id, cause, angle_rms_deg FROM findings", study)
print(findings.groupby("cause")["angle_rms_deg"].agg(["count", "median"]))

# %% One number beside the sensor that it is of, ready for a plot or a test of one's own.
mismatch = everyone[everyone["cause"] == "amplitude-mismatch"].merge(
    captures, left_on="capture_id", right_on="id")
print(mismatch[["serial", "value"]].sort_values("value").tail())
