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

    def play(self):
        """The capture as a Source, as fast as it is read."""
        from ._sources import Source
        return Source(_core.Source.recording(self._handle))

    def __repr__(self):
        extra = [name for name in _COLUMNS if self._info[f"has_{name}"]]
        return (f"<ada4571.Recording: {len(self)} samples, {self.duration_s:g} s, "
                f"with {', '.join(extra) or 'the two signals alone'}>")

    def _repr_html_(self):
        return _pictures.recording(self)


class Writer:
    """Writes a capture block by block; the file appears under its name only when the `with` block
    ends well.

    Keywords: supply_v (V), periods_per_turn, gain_control (True, False, None: unknown), noise_rms_v
    (V), sample_rate_hz (Hz), adc_bits, adc_reference_v (V), serial, origin. `vtemp`, `vdd` and
    `reference` say which columns there are.
    """

    def __init__(self, path, *, vtemp=True, vdd=True, reference=False, gain_control=None, **info):
        known = {"supply_v", "periods_per_turn", "noise_rms_v", "sample_rate_hz", "adc_bits",
                 "adc_reference_v", "serial", "origin"}
        if unknown := set(info) - known:
            raise TypeError(f"Writer does not know {', '.join(sorted(unknown))}")
        info["gain_control"] = -1 if gain_control is None else int(gain_control)
        info.update(has_vtemp=int(vtemp), has_vdd=int(vdd), has_reference=int(reference))
        self._handle = _core.Writer(os.fspath(path), info)

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
