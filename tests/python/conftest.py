# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Captures that the tests share. Each run draws its seed and says it."""
import os
import random

import pytest

import ada4571

SEED = int(os.environ.get("ADA4571_TEST_SEED") or random.SystemRandom().randrange(1, 2**31))


def pytest_report_header():
    return f"ADA4571_TEST_SEED={SEED}"


@pytest.fixture(scope="session")
def seed():
    return SEED


@pytest.fixture(scope="session")
def capture(seed):
    """A second of a sound sensor."""
    return ada4571.Simulation(seed=seed).record(1.0)


@pytest.fixture(scope="session")
def mismatched(seed):
    """Both directions, and an amplitude mismatch of 1 %."""
    return ada4571.Simulation({"amplitude-mismatch": {"k": 0.01}}, motion="steps:rpm=600/-600",
                              seed=seed).record(4.0)
