# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Angles from analog sine/cosine angle sensors (ADA4571 and its kind).

Units are in the names: _s seconds, _v volts, _deg mechanical degrees, _hz hertz. Long calls let
other threads run; reading and diagnosing also let Ctrl-C through. Failures are exceptions derived
from Error, with the library's sentence.
"""
from . import _core
from ._core import angle_dtype, frame_dtype
from ._diagnosis import Diagnosis, Health, check, diagnose
from ._errors import (BusyError, DeniedError, DisconnectedError, Error, FormatError,
                      InputOutputError, InvalidArgumentError, LostSamplesWarning, NoMemoryError,
                      NotFoundError, StateError, UnsupportedError, UnusableDataError)
from ._files import Import, Recording, Writer
from ._models import Converter, Effect, Model, Parameter, Tracker, calibrate, catalogue
from ._simulation import Simulation
from ._sources import Pins, Source, devices, open, open_device, stored
from ._study import Study

__version__ = _core.version()
__all__ = [
    "BusyError", "Converter", "DeniedError", "Diagnosis", "DisconnectedError", "Effect", "Error",
    "FormatError", "Health", "Import", "InputOutputError", "InvalidArgumentError", "LostSamplesWarning",
    "Model", "NoMemoryError", "NotFoundError", "Parameter", "Pins", "Recording", "Simulation",
    "Source", "StateError", "Study", "Tracker", "UnsupportedError", "UnusableDataError", "Writer",
    "angle_dtype", "calibrate", "catalogue", "check", "devices", "diagnose", "frame_dtype", "open",
    "open_device", "set_jobs", "stored", "vector_target",
]


def set_jobs(jobs):
    """Threads that one call may use for a long recording; 0: as many as the process may run on.
    Results do not depend on it."""
    _core.set_jobs(jobs)


def vector_target():
    """Instruction set that the library uses on this processor: "AVX2", "NEON", ..., "scalar"."""
    return _core.vector_target()
