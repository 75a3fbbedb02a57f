# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""diagnose() and check()."""
import json
import signal
import subprocess
import sys

import pytest

import ada4571


@pytest.fixture(scope="module")
def diagnosis(mismatched):
    return ada4571.diagnose(mismatched)


def test_a_finding_has_its_numbers(diagnosis):
    finding = next(f for f in diagnosis.findings if f.cause == "amplitude-mismatch")
    k = finding.parameters["k"]
    assert abs(k.value - 0.01) < 5 * k.std_error and k.unit == "1"
    assert finding.gain.residual_rms_after_v < finding.gain.residual_rms_before_v
    assert diagnosis.verdict == "explained" and diagnosis.capture.samples == 40000
    assert finding.cause in str(diagnosis) and finding.cause in repr(diagnosis)


def test_objects_say_what_the_json_says(diagnosis):
    assert diagnosis.json["schema"] == "ada4571-diagnosis/1"
    for key in ("budget", "remainder", "anonymous", "noise", "next_experiments"):
        assert (getattr(diagnosis, key) is None) == (key not in diagnosis.json)
    assert diagnosis.heldout.residual_rms_v == diagnosis.json["extended"]["heldout"]["residual_rms_v"]
    with pytest.raises(AttributeError, match="nothing_such"):
        diagnosis.nothing_such


def test_keys_of_a_newer_library_are_objects_too():
    from ada4571._diagnosis import _objects
    said = _objects(json.loads(
        '{"budget": [{"axis": "angle", "rms_v": 0.1}], "noise": {"sin_rms_v": 0.2},'
        ' "findings": [{"parameters": {"k": {"value": 1.5, "std_error": 0.1, "unit": "1"}}}]}'))
    assert said.budget[0].axis == "angle" and said.noise.sin_rms_v == 0.2
    assert said.findings[0].parameters["k"] == ada4571.Parameter(1.5, 0.1, "1")


def test_the_extended_model_is_a_calibration(diagnosis, mismatched, tmp_path):
    diagnosis.extended.save(tmp_path / "sensor.toml")
    model = ada4571.Model.load(tmp_path / "sensor.toml")
    assert "amplitude-mismatch" in {effect.id for effect in model.effects}
    assert ada4571.Converter(model)(mismatched).size == len(mismatched)


def test_the_report_is_a_page_and_a_notebook_shows_it(diagnosis, tmp_path):
    diagnosis.report(tmp_path / "report.html")
    assert "</html>" in (tmp_path / "report.html").read_text()
    shown = diagnosis._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and "&lt;/html&gt;" in shown


def test_progress_is_told_and_its_exceptions_end_the_work(mismatched):
    seen = []
    ada4571.diagnose(mismatched, progress=lambda fraction, what: seen.append((fraction, what)))
    assert seen and all(0 <= fraction <= 1 and what for fraction, what in seen)

    class Enough(Exception):
        pass

    def stop(fraction, what):
        raise Enough(what)

    with pytest.raises(Enough):
        ada4571.diagnose(mismatched, progress=stop)


def test_several_recordings_are_diagnosed_together(mismatched, seed):
    """The amplitudes of one sensor at two more motions; a recording may judge itself."""
    model = ada4571.Simulation({"amplitude-mismatch": {"k": 0.01}}, seed=seed).model
    other, third = (ada4571.Simulation(model=model, motion=f"constant:rpm={rpm}", seed=seed + rpm)
                    .record(3.0) for rpm in (240, 300))
    for heldout in ([third], [third, third], None):
        said = ada4571.diagnose([mismatched, other], heldout=heldout)
        k = next(f for f in said.findings if f.cause == "amplitude-mismatch").parameters["k"]
        assert abs(k.value - 0.01) < 5 * k.std_error
        assert said.capture.samples == len(mismatched) + len(other)


def test_recordings_that_do_not_go_together_are_refused(mismatched):
    other = ada4571.Simulation(model=ada4571.Model(periods_per_turn=1)).record(2.0)
    with pytest.raises(ValueError, match="per"):
        ada4571.diagnose([mismatched, other])


def test_no_recording_is_refused():
    with pytest.raises(ValueError, match="no recording"):
        ada4571.diagnose([])


def test_ctrl_c_stops_a_diagnosis(tmp_path):
    script = ("import ada4571, sys\n"
              "capture = ada4571.Simulation(motion='steps:rpm=60/600/-600').record(20.0)\n"
              "say = iter(['started'])\n"
              "ada4571.diagnose(capture, progress=lambda f, w: print(next(say, 'on'), flush=True))\n"
              "print('finished')\n")
    # A test in the background would hand on that SIGINT is ignored.
    run = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True,
                           preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    assert run.stdout.readline() == "started\n"
    run.send_signal(signal.SIGINT)
    out, err = run.communicate()
    assert "KeyboardInterrupt" in err and "finished" not in out and run.returncode != 0


def test_a_sound_sensor_passes(capture):
    health = ada4571.check(capture)
    assert health and health.sound and {row.state for row in health.checks} <= {"passed", "unknown"}


def test_a_stuck_channel_fails(seed):
    stuck = ada4571.Simulation({"stuck-channel": {"channel": "vsin", "time_s": 0}},
                               seed=seed).record(1.0)
    health = ada4571.check(stuck)
    assert not health and "failed" in repr(health)
