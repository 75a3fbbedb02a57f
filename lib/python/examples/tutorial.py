#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""From volts to a diagnosed bench, on the simulated sensor; run it, or paste it cell by cell into a
notebook. What it writes goes into the working directory."""

# %% A sensor that is not ideal: its amplitudes differ by 1 %, and a field of 0.8 % disturbs it.
import numpy as np

import ada4571

bench = ada4571.Simulation(
    effects={"amplitude-mismatch": {"k": 0.01}, "stray-field": {"b": 0.008, "direction_deg": 30}},
    motion="steps:rpm=60/600/-600", seed=4571)
capture = bench.record(7.0)
capture.save("capture.csv")
print(capture)  # in a notebook, `capture` alone shows the figure of the two signals

# %% The columns are numpy arrays, in volts and seconds.
radius = np.hypot(capture.vsin_v - capture.supply_v / 2, capture.vcos_v - capture.supply_v / 2)
print(f"radius from {radius.min():.3f} V to {radius.max():.3f} V")

# %% Is the sensor healthy?
print(ada4571.check(capture))

# %% Calibrate it, and read its angle.
calibration = ada4571.calibrate(capture)
calibration.save("sensor.toml")
angles = ada4571.Converter(calibration)(capture)


def error_rms_deg(angles, capture):
    """Against the reference, with the constant between their zeros taken away."""
    turn = 360 / capture.periods_per_turn
    error = angles["angle_deg"] - capture.reference_deg
    phase = np.exp(2j * np.pi * error / turn)
    error = np.angle(phase / phase.mean()) * turn / (2 * np.pi)
    return np.sqrt(np.mean(error**2))


before = error_rms_deg(angles, capture)
print(f"calibrated: {before:.3f} degrees rms beside the reference")

# %% What does the plain model get wrong, why, and what is gained by modelling it?
diagnosis = ada4571.diagnose(capture, progress=lambda fraction, what: None)
print(diagnosis.verdict)
for finding in diagnosis.findings:
    numbers = ", ".join(f"{name} = {p.value:.5g} {p.unit}" for name, p in finding.parameters.items())
    print(f"{finding.cause}: {numbers}")
diagnosis.report("report.html")  # in a notebook, `diagnosis` alone shows it

# %% The extended model is a calibration like any other.
diagnosis.extended.save("extended.toml")
after = error_rms_deg(ada4571.Converter(diagnosis.extended)(capture), capture)
print(f"extended: {after:.3f} degrees rms beside the reference")

# %% Live: the same sensor behind a network IIO device, block by block.
with bench.emulate() as uri, ada4571.open_device(uri) as source:
    convert = ada4571.Converter(calibration)
    for number, block in zip(range(3), source.blocks(0.1)):
        print(f"block {number}: {block.size} frames, first at {convert(block)['angle_deg'][0]:.2f} degrees")
