# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The simulated sensor."""
import threading

from . import _core
from ._files import Recording
from ._models import Model, effect_text
from ._sources import Source


class Simulation:
    """A model, a motion and a temperature, seeded.

    effects: {"stray-field": {"b": 0.01}}, or texts as `--effect` takes them. model: what the
    effects are added to (None: a sound ADA4571 drawn from the seed). motion: "constant:rpm=600",
    "steps:rpm=60/600"; temperature: "constant:deg_c=25", "ramp:from=-20,to=100". Keywords:
    sample_rate_hz (Hz), noise_rms_v (V), adc_bits, adc_reference_v (V), gain_control, vtemp, vdd,
    reference (whether the column exists).
    """

    def __init__(self, effects=(), *, model=None, motion=None, temperature=None, seed=1, vtemp=True,
                 vdd=True, reference=True, gain_control=True, sample_rate_hz=10000.0,
                 noise_rms_v=0.0005, adc_bits=16, adc_reference_v=5.0):
        self._seed = seed
        self._options = dict(motion=motion, temperature=temperature, has_vtemp=int(vtemp),
                             has_vdd=int(vdd), has_reference=int(reference),
                             gain_control=int(gain_control), sample_rate_hz=sample_rate_hz,
                             noise_rms_v=noise_rms_v, adc_bits=adc_bits,
                             adc_reference_v=adc_reference_v)
        # A model of its own: the sensor that is drawn, or a copy of what is given, with the effects.
        self._model = _core.Simulation(model._handle if model else None, self._options, seed).model()
        items = effects.items() if hasattr(effects, "items") else [(e, None) for e in effects]
        for name, parameters in items:
            self._model.add_effect(effect_text(name, parameters))

    def __repr__(self):
        given = ", ".join(f"{key} {self._options[key]}" for key in ("motion", "temperature")
                          if self._options[key])
        return f"<ada4571.Simulation seed {self._seed}{', ' + given if given else ''}: {self.model!r}>"

    def _new(self, duration_s):
        return _core.Simulation(self._model, dict(self._options, duration_s=duration_s), self._seed)

    @property
    def model(self):
        """The Model in force, drawn values included."""
        return Model._of(self._new(1.0).model())

    def record(self, duration_s):
        """A Recording of `duration_s` seconds."""
        return Recording._of(self._new(duration_s).run())

    def open(self, *, realtime=False, duration_s=0.0):
        """The simulated sensor as a Source; duration_s 0: without end."""
        return Source(_core.Source.simulation(self._new(duration_s), realtime))

    def emulate(self, port=0):
        """Serves it as a network IIO device; in the `with` block the value is its URI."""
        return Emulator(_core.Emulator(self._new(0.0), port))


class Emulator:
    """A simulated sensor or a capture as a network IIO device, for any client of libiio."""

    def __init__(self, handle):
        self._handle = handle
        self._thread = threading.Thread(target=self._handle.run, daemon=True)

    def __repr__(self):
        return f"<ada4571.Emulator {self.uri}>"

    @property
    def uri(self):
        """Where it is found, "ip:127.0.0.1:PORT"."""
        return f"ip:127.0.0.1:{self._handle.port()}"

    def __enter__(self):
        self._thread.start()
        return self.uri

    def __exit__(self, *exception):
        self._handle.stop()
        self._thread.join()
