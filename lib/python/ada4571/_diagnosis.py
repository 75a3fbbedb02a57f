# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""What the simulation gets wrong about a capture, and whether the sensor is healthy."""
import html
import json
import os
import tempfile
from types import SimpleNamespace

from . import _core
from ._files import Recording
from ._models import Model, Parameter


class Record(SimpleNamespace):
    """What the library's JSON says, by names. A key that is absent raises AttributeError."""


def _objects(value):
    """JSON as objects: {"value", "unit"} is a Parameter, other dictionaries are Records."""
    if isinstance(value, list):
        return [_objects(item) for item in value]
    if not isinstance(value, dict):
        return value
    if "value" in value and "unit" in value:
        return Parameter(value["value"], value.get("std_error"), value["unit"])
    # What is keyed by names of parameters stays a dictionary.
    return Record(**{key: ({name: _objects(item) for name, item in inner.items()}
                           if key == "parameters" else _objects(inner))
                     for key, inner in value.items()})


class Diagnosis:
    """A diagnosis: `verdict`, `findings` (cause, alternatives, separate_by, explanation, parameters,
    gain, correctable), `capture`, `baseline`, `unexplained`. What an older library does not tell is
    None: `budget`, `remainder`, `anonymous`, `noise`, `next_experiments`. A notebook shows the
    report with its pictures."""

    _LATER = ("budget", "remainder", "anonymous", "noise", "next_experiments")

    def __init__(self, handle):
        self._handle = handle
        self.json = json.loads(handle.json())
        # The extended model's numbers; the model itself is `extended`.
        self._said = _objects(self.json)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._LATER:
            return getattr(self._said, name, None)
        try:
            return getattr(self._said, name)
        except AttributeError:
            raise AttributeError(f"a Diagnosis has no '{name}'") from None

    def __dir__(self):
        return [*super().__dir__(), *self.json]

    @property
    def extended(self):
        """The extended Model, ready for a Converter."""
        return Model._of(self._handle.model())

    @property
    def heldout(self):
        """What the extended model leaves on held-out data: residual_rms_v (V), and
        angle_error_rms_deg (mechanical degrees) with a reference."""
        return self._said.extended.heldout

    def report(self, path):
        """Writes the report, one self-contained HTML page."""
        self._handle.report(os.fspath(path))

    def __str__(self):
        return self._handle.text()

    def __repr__(self):
        causes = ", ".join(finding.cause for finding in self.findings) or "no findings"
        return f"<ada4571.Diagnosis: {self.verdict}; {causes}>"

    def _repr_html_(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "report.html")
            self.report(path)
            with open(path, encoding="utf-8") as file:
                page = file.read()
        # In a frame of its own, so that the page's styles do not reach the notebook's.
        return (f'<iframe srcdoc="{html.escape(page)}" title="diagnosis" '
                'style="width:100%;height:40em;border:1px solid #ccc"></iframe>')


def diagnose(recordings, *, heldout=None, model=None, name=None, progress=None):
    """What the simulation gets wrong about a capture, why, and what is gained.

    recordings: a Recording, or a list of them, of one sensor; each may have a zero angle of its own.
    heldout: what the gain is measured on, likewise (None: a part of the recordings). model: the Model to test
    (None: the application note's), printed as `name`. progress(fraction, what) is called meanwhile;
    its exceptions, and Ctrl-C, end the work.
    """
    captures = [recordings] if isinstance(recordings, Recording) else list(recordings)
    measured = [heldout] if isinstance(heldout, Recording) else list(heldout or [])
    if not captures:
        raise ValueError("there is no recording to diagnose")
    return Diagnosis(_core.diagnose([capture._handle for capture in captures],
                                    [capture._handle for capture in measured],
                                    model._handle if model else None, name, progress))


class Health:
    """The result of check(): `sound`, `checks` (id, state, measured, limit, unit, explanation)."""

    def __init__(self, text, sentences):
        self.json = json.loads(text)
        self._text = sentences
        self.sound = self.json["sound"]
        self.checks = [Record(**row) for row in self.json["checks"]]

    def __bool__(self):
        return self.sound

    def __str__(self):
        return self._text

    def __repr__(self):
        failed = [row.id for row in self.checks if row.state == "failed"]
        return f"<ada4571.Health: {'sound' if self.sound else 'failed: ' + ', '.join(failed)}>"


def check(recording, model=None):
    """Is the sensor healthy: radius, rails, clipping, stuck channels, missing samples, noise."""
    return Health(*_core.check(recording._handle, model._handle if model else None))
