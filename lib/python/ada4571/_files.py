# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Captures in files."""
import os

import numpy as np

from . import _core, _pictures

_COLUMNS = ("vtemp", "vdd", "reference")


class Recording:
    """A capture: text (.csv) or SigMF (.sigmf-meta with .sigmf-data).

    The columns are numpy arrays, views into `frames`, and cannot be written: time_s (s), vsin_v,
    vcos_v, vtemp_v, vdd_v (V, absolute), reference_deg (mechanical degrees). A channel that was not
    recorded is NaN throughout.
    """

    def __init__(self, path):
        self._open(_core.Recording(os.fspath(path)))

    @classmethod
    def _of(cls, handle):
        recording = cls.__new__(cls)
        recording._open(handle)
        return recording

    def _open(self, handle):
        self._handle = handle
        self._info = handle.info()
        self._frames = None

    @property
    def frames(self):
        """All samples as one structured array of `frame_dtype`."""
        if self._frames is None:
            self._frames = self._handle.frames()
        return self._frames

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name in _core.frame_dtype.names:
            return self.frames[name]
        if name in self._info:
            return self._info[name]
        raise AttributeError(f"a Recording has no '{name}'")

    def __dir__(self):
        return [*super().__dir__(), *_core.frame_dtype.names, *self._info]

    def __len__(self):
        return self._info["samples"]

    def metadata(self, key):
        """Value of a `# key = value` line, None where it is absent."""
        return self._handle.metadata(key)

    def save(self, path):
        """Writes the capture to another file, in the form that the extension names."""
        self._handle.save(os.fspath(path))

    def play(self, speed=None):
        """The capture as a Source: as fast as it is read, or by its own times, `speed` times as fast
        as it was recorded. Its frames keep the times that were recorded."""
        from ._sources import Source
        if speed is None:
            return Source(_core.Source.recording(self._handle))
        return Source(_core.Source.replay(self._handle, speed))

    def emulate(self, port=0, *, speed=1.0):
        """Serves the capture as a network IIO device, `speed` times as fast as it was recorded; in
        the `with` block the value is its URI. Port 0: a free one."""
        from ._simulation import Emulator
        return Emulator(_core.Emulator(self._handle, speed, port))

    def __repr__(self):
        extra = [name for name in _COLUMNS if self._info[f"has_{name}"]]
        return (f"<ada4571.Recording: {len(self)} samples, {self.duration_s:g} s, "
                f"with {', '.join(extra) or 'the two signals alone'}>")

    def _repr_html_(self):
        return _pictures.recording(self)


class Import:
    """A measurement of another program: the CSV of an oscilloscope or of an acquisition program, or
    numpy's .npy. Its frames can be read once, by read(), blocks() or save().

    What the file says of itself is taken from it, the rest from the keywords; what cannot be told is
    refused rather than guessed. time, vsin, vcos, vtemp, vdd, reference: the column, by its name or
    by its number from 1, or (column, scale) or (column, scale, offset) with value = scale * number +
    offset in the units of a frame; None: looked for by its name; False: there is none.
    separator, decimal, header_lines: of a text, None: detected. sample_rate_hz (Hz) takes the place
    of the times. supply_v (V), periods_per_turn: of the sensor.
    """

    def __init__(self, path, *, separator=None, decimal=None, header_lines=None, time=None,
                 vsin=None, vcos=None, vtemp=None, vdd=None, reference=None, sample_rate_hz=0.0,
                 supply_v=5.0, periods_per_turn=2):
        columns = dict(time=time, vsin=vsin, vcos=vcos, vtemp=vtemp, vdd=vdd, reference=reference)
        self._handle = _core.Import(os.fspath(path), dict(
            {name: _column(name, given) for name, given in columns.items()}, separator=separator,
            decimal=decimal, header_lines=-1 if header_lines is None else header_lines,
            sample_rate_hz=sample_rate_hz, supply_v=supply_v, periods_per_turn=periods_per_turn))

    @property
    def text(self):
        """How the file was understood, for a person: a line a channel."""
        return self._handle.text()

    @property
    def info(self):
        """What is known before the rows are read: supply_v, sample_rate_hz, has_vtemp, ..."""
        return {key: value for key, value in self._handle.info().items()
                if key not in ("samples", "duration_s")}

    def read(self, count):
        """The next frames, up to `count`; none at the end."""
        frames = np.empty(count, _core.frame_dtype)
        return frames[:self._handle.read(frames)]

    def blocks(self, count=65536):
        """All frames that are left, `count` at a time."""
        while (frames := self.read(count)).size:
            yield frames

    def save(self, path):
        """Writes a capture, in the form that the extension names, and gives it as a Recording."""
        info = self.info
        columns = {name: info.pop(f"has_{name}") for name in _COLUMNS}
        known = {key: value for key, value in info.items()
                 if key not in ("gain_control", "serial", "origin") or value not in ("", -1)}
        with Writer(path, **columns, **known) as writer:
            for frames in self.blocks():
                writer.write(frames)
        return Recording(path)

    def __repr__(self):
        return f"<ada4571.Import:\n{self.text.rstrip()}>"


def _column(name, given):
    """(column, scale, offset) as the C API has them: no scale is NaN."""
    if given is None or given is False:
        return (None if given is None else "", np.nan, 0.0)
    column, *factors = given if isinstance(given, tuple) else (given,)
    if isinstance(column, bool) or not isinstance(column, (str, int)) or len(factors) > 2:
        raise TypeError(f"{name} is a column, (column, scale) or (column, scale, offset)")
    return (str(column), *factors, *(np.nan, 0.0)[len(factors):])


class Writer:
    """Writes a capture block by block; the file appears under its name only when the `with` block
    ends well. With `growing` it is SigMF that is there from the first frame on and survives a crash;
    with `resume` as well it goes on in the file that is there already.

    Keywords: supply_v (V), periods_per_turn, gain_control (True, False, None: unknown), noise_rms_v
    (V), sample_rate_hz (Hz), adc_bits, adc_reference_v (V), serial, origin. `vtemp`, `vdd` and
    `reference` say which columns there are.
    """

    def __init__(self, path, *, vtemp=True, vdd=True, reference=False, gain_control=None,
                 growing=False, resume=False, **info):
        known = {"supply_v", "periods_per_turn", "noise_rms_v", "sample_rate_hz", "adc_bits",
                 "adc_reference_v", "serial", "origin"}
        if resume and not growing:
            raise TypeError("only a growing file can be resumed")
        if unknown := set(info) - known:
            raise TypeError(f"Writer does not know {', '.join(sorted(unknown))}")
        info["gain_control"] = -1 if gain_control is None else int(gain_control)
        info.update(has_vtemp=int(vtemp), has_vdd=int(vdd), has_reference=int(reference))
        self._handle = _core.Writer(os.fspath(path), info, growing, resume)
        self._path = os.fspath(path)

    def __repr__(self):
        return f"<ada4571.Writer {self._path}>"

    def metadata(self, key, value):
        """A further `# key = value` line; before the first frames."""
        self._handle.metadata(key, str(value))

    def write(self, frames):
        """Frames of `frame_dtype`, as blocks() and Recording.frames give them."""
        self._handle.write(np.ascontiguousarray(frames, dtype=_core.frame_dtype))

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        try:
            if kind is None:
                self._handle.finish()
        finally:
            self._handle.close()
