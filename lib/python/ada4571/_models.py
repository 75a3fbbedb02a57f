# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Models of a sensor, calibrations among them, and what they make of volts."""
import os
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from . import _core
from ._files import Recording


@dataclass(frozen=True)
class Parameter:
    """A number with its standard error (None where unknown) and unit; of the catalogue also the least
    and the largest value that it may have (infinite where there is no limit)."""

    value: "float | str | None"
    std_error: "float | None" = None
    unit: str = "1"
    minimum: "float | None" = None
    maximum: "float | None" = None


@dataclass(frozen=True)
class Effect:
    """An effect of the catalogue or of a model."""

    id: str
    cause: str
    stage: str
    correctable: bool
    parameters: dict = field(default_factory=dict)

    @classmethod
    def _of(cls, entry, ranges=None):
        rows = entry.pop("parameters")
        numbers = {name: Parameter(None if np.isnan(value) else value,
                                   None if np.isnan(error) else error, unit,
                                   *(ranges(place) if ranges else ()))
                   for place, (name, value, error, unit) in enumerate(rows)}
        return cls(**entry, parameters=numbers)


def catalogue():
    """Every effect that a model can hold, with what its parameters are by default and may be."""
    return [Effect._of(entry, partial(_core.catalogue_range, number))
            for number, entry in enumerate(_core.catalogue())]


def effect_text(name, parameters=None):
    """An effect as the C API and `--effect` write it: "stray-field:b=0.01"."""
    if not parameters:
        return name
    return name + ":" + ",".join(f"{key}={value}" for key, value in parameters.items())


class Model:
    """A model of one sensor; a calibration is such a model.

    Model() is an ideal sensor; keywords: amplitude_v, offset_sin_v, offset_cos_v, supply_v,
    vtemp_reference_v (V), angle_zero_deg (mechanical degrees), periods_per_turn. The same names are
    its attributes.
    """

    def __init__(self, **baseline):
        known = _core.Model({}).baseline()
        if unknown := set(baseline) - set(known):
            raise TypeError(f"Model does not know {', '.join(sorted(unknown))}")
        self._handle = _core.Model(baseline)

    @classmethod
    def _of(cls, handle):
        model = cls.__new__(cls)
        model._handle = handle
        return model

    @classmethod
    def load(cls, path):
        """A model or calibration file (.toml)."""
        return cls._of(_core.Model.load(os.fspath(path)))

    def save(self, path):
        """Writes the file whole or not at all."""
        self._handle.save(os.fspath(path))

    def add(self, name, **parameters):
        """Adds an effect of the catalogue; what is not given takes the catalogue's value."""
        self._handle.add_effect(effect_text(name, parameters))

    @property
    def effects(self):
        """The effects that it holds, a list of Effect."""
        return [Effect._of(entry) for entry in self._handle.effects()]

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._handle.baseline()[name]
        except KeyError:
            raise AttributeError(f"a Model has no '{name}'") from None

    def __dir__(self):
        return [*super().__dir__(), *self._handle.baseline()]

    def __repr__(self):
        held = ", ".join(effect.id for effect in self.effects)
        return (f"<ada4571.Model: A {self.amplitude_v:.4f} V, offsets {1e3 * self.offset_sin_v:.3f} "
                f"and {1e3 * self.offset_cos_v:.3f} mV{', ' + held if held else ''}>")


_METHODS = {"fit": 0, "mean": 1, "extrema": 2}


def calibrate(recording, hot=None, *, method="fit"):
    """Offsets, amplitudes and phase from a recording, or over VTEMP from a cold and a hot one.

    method: "fit" (best, needs no whole turn), "mean" (whole turns), "extrema". Data that cannot
    carry it raises UnusableDataError with the reason.
    """
    if method not in _METHODS:
        raise ValueError(f"there is no method '{method}': {', '.join(_METHODS)}")
    number = _METHODS[method]
    if hot is None:
        return Model._of(_core.calibrate_single(recording._handle, number))
    return Model._of(_core.calibrate_dual(recording._handle, hot._handle, number))


class Converter:
    """Volts in, angles out: converter(frames) and converter(recording) give arrays of
    `angle_dtype`: time_s (s), angle_deg (mechanical degrees), radius (1 for a sound sample), status
    (0 when sound). Blocks of a stream are given one after the other."""

    def __init__(self, model):
        self._handle = _core.Converter(model._handle)
        self._of = repr(model)

    def __repr__(self):
        return f"<ada4571.Converter of {self._of}>"

    def __call__(self, frames):
        if isinstance(frames, Recording):
            return self._handle.recording(frames._handle)
        return self._handle.frames(frames)

    def save(self, recording, path, *, progress=None):
        """The angles of a Recording into a file, whole or not at all: SigMF where it ends in
        .sigmf-meta, else text. Block by block, so that the length of the recording does not matter.
        progress(fraction, what) is called on the way."""
        self._handle.save(recording._handle, os.fspath(path), progress)

    def raw(self, sin, cos, *, scale_v, offset=0.0, shift=0, bits=0):
        """Raw samples as they lie in memory, volts = (raw + offset) * scale_v: mechanical angle in
        radians, and the radius. Neither is copied first: slices of an interleaved block will do."""
        return self._handle.raw(sin, cos, scale_v, offset, shift, bits)


class Tracker:
    """A Converter whose calibration follows what drifts while the magnet turns; `model` is the one
    in force. max_offset_rate_v_per_s: the drift that is believed, V/s."""

    def __init__(self, model, *, amplitude=False, phase=False, max_offset_rate_v_per_s=0.02):
        self._handle = _core.Tracker(model._handle, amplitude, phase, max_offset_rate_v_per_s)
        self._follows = ", ".join(["offsets"] + ["amplitude"] * amplitude + ["phase"] * phase)

    def __repr__(self):
        return f"<ada4571.Tracker of {self._follows}, now {self.model!r}>"

    def __call__(self, frames):
        return self._handle.frames(frames)

    def save(self, recording, path, *, progress=None):
        """The angles of a Recording into a file, as Converter.save."""
        self._handle.save(recording._handle, os.fspath(path), progress)

    @property
    def model(self):
        """The calibration in force now, a Model of its own."""
        return Model._of(self._handle.model())
