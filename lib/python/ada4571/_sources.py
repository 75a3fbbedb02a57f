# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Where frames come from: devices, recordings, the simulated sensor."""
import os
import warnings

import numpy as np

from . import _core
from ._errors import Error, LostSamplesWarning
from ._models import Model

# Frames of a block where the sample rate is not known: what is read at a time, at most.
_ROOM_FRAMES = 65536


class Source:
    """Frames in volts; used as a context manager, it is closed at the end.

    Made by open(), open_device(), Recording.play() and Simulation.open().
    """

    def __init__(self, handle):
        self._handle = handle
        self._started = False
        self._ended = False

    @property
    def info(self):
        """description, serial, sample_rate_hz (Hz, 0 where unknown), supply_v (V),
        periods_per_turn, gain_control (1, 0, -1: unknown), has_vtemp, has_vdd, has_reference."""
        return self._handle.info()

    @property
    def statistics(self):
        """frames delivered since the start, lost ones, and gaps: the places where they are lost."""
        return self._handle.statistics()

    def start(self):
        """Begins the capture; blocks() and read() do it by themselves."""
        self._handle.start()
        self._started, self._ended = True, False

    @property
    def ended(self):
        """Whether the last read told that nothing more comes: the end, or a cancel."""
        return self._ended

    def fileno(self):
        """A descriptor for select, selectors or asyncio: while it is readable, read() with timeout_s=0
        has something to tell. Read until that gives nothing; once `ended`, watch it no more. It is the
        source's own: neither read nor close it. Start the source before you wait."""
        return self._handle.fileno()

    def read(self, count, timeout_s=1.0):
        """Up to `count` frames, fewer being ordinary; none when nothing came in `timeout_s`
        (negative: wait for ever) or the source has ended. Ctrl-C ends the wait."""
        if not self._started:
            self.start()
        frames = np.empty(count, _core.frame_dtype)
        filled, self._ended = self._handle.read(frames, 0, timeout_s)
        return frames[:filled]

    def blocks(self, duration_s, timeout_s=5.0):
        """Blocks of `duration_s` seconds until the source ends: structured arrays of `frame_dtype`
        into which the library has written itself. Samples that are lost are said by a
        LostSamplesWarning before the block; nothing for `timeout_s` raises TimeoutError."""
        if not self._started:
            self.start()
        lost, ended = 0, False
        while not ended:
            frames, ended = self._block(duration_s, timeout_s)
            now_lost = self.statistics["lost"]
            if now_lost > lost:
                warnings.warn(f"{now_lost - lost} samples are lost", LostSamplesWarning,
                              stacklevel=2)
            lost = now_lost
            if frames.size:
                yield frames

    def _block(self, duration_s, timeout_s):
        rate = self.info["sample_rate_hz"]
        room = max(1, round(rate * duration_s)) if rate > 0 else _ROOM_FRAMES
        frames, filled, ended = np.empty(room, _core.frame_dtype), 0, False
        while filled < room and not ended:
            count, self._ended = self._handle.read(frames, filled, timeout_s)
            ended = self._ended
            if count == 0 and not ended:
                raise TimeoutError(f"nothing came from the source for {timeout_s:g} s")
            filled += count
            times = frames["time_s"]
            if rate <= 0 and filled and times[filled - 1] - times[0] >= duration_s:
                break
        return frames[:filled], ended

    def calibration(self):
        """The Model that the stored configuration names, or that the driver keeps."""
        return Model._of(self._handle.calibration())

    def model_for(self, model):
        """The Model at the supply of this source, as a Converter or Tracker of its frames needs it;
        UnusableDataError where the two do not go together."""
        return Model._of(self._handle.model_for(model._handle))

    def write_calibration(self, model):
        """Writes offsets and amplitudes of a Model into the driver, which then corrects by itself; a
        driver without calibbias and calibscale raises NotFoundError."""
        self._handle.write_calibration(model._handle)

    def set_buffer(self, frames):
        """Frames of a device's buffer from the next start on, 0: as it was opened."""
        self._handle.set_buffer(frames)

    def save(self, name, calibration=None):
        """Stores how this source was opened, for open(name)."""
        self._handle.save_config(os.fspath(name), None if calibration is None
                                 else os.fspath(calibration))

    def cancel(self):
        """Makes a read in another thread return at once."""
        self._handle.cancel()

    def close(self):
        """Ends the capture and lets the device go."""
        if self._handle is not None:
            self._handle.cancel()
            self._handle.close()
            self._handle = None

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    def __repr__(self):
        return f"<ada4571.Source: {self.info['description'] if self._handle else 'closed'}>"


def open(name):
    """The source that the stored configuration `name` describes, as `iio-angle list --save` makes
    it; a name with a slash is a path."""
    return Source(_core.Source.named(os.fspath(name)))


def open_device(uri=None, device=None, *, sin=None, cos=None, temp=None, vdd=None, trigger=None,
                sample_rate_hz=0.0, supply_v=5.0, periods_per_turn=2, buffer_frames=0):
    """An IIO device by libiio: `uri` "local:", "ip:host:port", "usb:..." (None: local), `device` by
    name, label or id (None: the only usable one), channels by id, name or label (None: by label).
    sample_rate_hz in Hz (0: what is set), supply_v in V."""
    return Source(_core.Source.device(dict(
        uri=uri, device=device, sin=sin, cos=cos, temp=temp, vdd=vdd, trigger=trigger,
        sample_rate_hz=sample_rate_hz, supply_v=supply_v, periods_per_turn=periods_per_turn,
        buffer_frames=buffer_frames)))


def devices(uri=None):
    """Devices of a context with a usable pair of channels, a dictionary each."""
    return _core.devices(uri)


def stored(name=None):
    """The stored configurations that open() finds, a dictionary each; `problem` is why one cannot be
    used, else empty. With a name that one alone, which must be usable."""
    return _core.stored(None if name is None else os.fspath(name))


class Pins:
    """The sensor's lines GC (gain control) and PD (power down), held as long as this lives."""

    _NUMBERS = {"gc": 0, "pd": 1}

    def __init__(self, config=None, *, gc_line=None, pd_line=None, gc_active_low=False,
                 pd_active_low=False):
        self._handle = _core.Pins(config, gc_line, pd_line, gc_active_low, pd_active_low)

    def __repr__(self):
        def state(pin):
            try:
                return f"{pin} {'on' if self[pin] else 'off'}"
            except Error:
                return f"{pin} unknown"
        return f"<ada4571.Pins {', '.join(map(state, self._NUMBERS))}>"

    def __getitem__(self, pin):
        return self._handle.get(self._NUMBERS[pin])

    def __setitem__(self, pin, on):
        self._handle.set(self._NUMBERS[pin], bool(on))

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._handle.close()
