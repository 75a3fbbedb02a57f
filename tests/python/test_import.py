# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Measurements of other programs, and files of angles."""
import numpy as np
import pytest

import ada4571


@pytest.fixture
def scope(tmp_path, capture):
    """The capture as a German oscilloscope writes it: millivolts, decimal commas."""
    path = tmp_path / "scope.csv"
    rows = [f"{f['time_s']:.7f};{1e3 * f['vsin_v']:.4f};{1e3 * f['vcos_v']:.4f}"
            for f in capture.frames[:2000]]
    path.write_text("Zeit (s);CH1 (mV);CH2 (mV)\n" + "\n".join(rows).replace(".", ",") + "\n")
    return path


def test_a_file_of_an_oscilloscope_becomes_a_recording(scope, capture, tmp_path):
    found = ada4571.Import(scope, time=1, vsin="CH1", vcos=3, supply_v=4.9)
    assert "CH1" in found.text and "CH1" in repr(found)
    assert found.info["supply_v"] == 4.9 and not found.info["has_vtemp"]
    recording = found.save(tmp_path / "out.csv")
    assert isinstance(recording, ada4571.Recording) and recording.supply_v == 4.9
    assert np.allclose(recording.vsin_v, capture.vsin_v[:2000], atol=1e-6)
    assert np.allclose(recording.vcos_v, capture.vcos_v[:2000], atol=1e-6)


def test_columns_are_scaled(scope, capture):
    found = ada4571.Import(scope, time=1, vsin=(2, 2e-3, 0.5), vcos=(3, 1e-3), vtemp=False)
    frames = found.read(5)
    assert frames.dtype == ada4571.frame_dtype and frames.size == 5
    assert np.allclose(frames["vsin_v"], 2.0 * capture.vsin_v[:5] + 0.5, atol=1e-6)
    assert np.allclose(frames["vcos_v"], capture.vcos_v[:5], atol=1e-6)
    assert sum(block.size for block in found.blocks(700)) == 1995 and found.read(1).size == 0


def test_what_cannot_be_told_is_refused(scope, tmp_path):
    with pytest.raises(ada4571.InvalidArgumentError, match="no such column"):
        ada4571.Import(scope, vsin="no such column", vcos=3)
    with pytest.raises(TypeError, match="vsin is a column"):
        ada4571.Import(scope, vsin=(2, 1.0, 0.0, 7))
    with pytest.raises(TypeError, match="vcos is a column"):
        ada4571.Import(scope, vcos=True)
    with pytest.raises(FileNotFoundError):
        ada4571.Import(tmp_path / "none.csv")


def test_a_bad_row_leaves_no_file(scope, tmp_path):
    scope.write_text(scope.read_text() + "0,3;what;1\n")
    with pytest.raises(ada4571.FormatError, match="scope.csv:2002"):
        ada4571.Import(scope, time=1, vsin=2, vcos=3).save(tmp_path / "out.csv")
    assert not (tmp_path / "out.csv").exists()


def test_an_array_of_numpy_is_imported(capture, tmp_path):
    path = tmp_path / "pair.npy"
    np.save(path, np.column_stack([capture.vsin_v, capture.vcos_v]))
    frames = ada4571.Import(path, vsin=1, vcos=2, sample_rate_hz=10000).read(100000)
    assert frames.size == len(capture) and np.array_equal(frames["vcos_v"], capture.vcos_v)
    assert np.allclose(np.diff(frames["time_s"]), 1e-4)


@pytest.mark.parametrize("kind", [ada4571.Converter, ada4571.Tracker])
def test_angles_of_a_recording_go_into_a_file(kind, capture, tmp_path):
    model = ada4571.calibrate(capture)
    steps = []
    kind(model).save(capture, tmp_path / "angles.csv", progress=lambda f, what: steps.append(f))
    lines = (tmp_path / "angles.csv").read_text().splitlines()
    assert len(lines) >= len(capture) + 1 and "time_s,angle_deg,radius,status" in lines
    expected = kind(model)(capture.frames)
    written = np.array([float(line.split(",")[1]) for line in lines[-len(capture):]])
    assert np.allclose(written, expected["angle_deg"], atol=1e-3)
    assert steps and max(steps) <= 1.0


def test_an_exception_of_the_progress_ends_the_work(capture, tmp_path):
    def stop(fraction, what):
        raise ZeroDivisionError("enough")
    with pytest.raises(ZeroDivisionError, match="enough"):
        ada4571.Converter(ada4571.calibrate(capture)).save(capture, tmp_path / "a.csv",
                                                           progress=stop)
    assert not (tmp_path / "a.csv").exists()


def test_the_catalogue_gives_the_ranges():
    stray = next(e for e in ada4571.catalogue() if e.id == "stray-field").parameters["b"]
    assert stray.minimum == 0.0 and stray.minimum <= stray.value <= stray.maximum < 1.0
    assert ada4571.Model().effects == []


def test_a_growing_file_is_there_without_an_end_and_goes_on(capture, tmp_path):
    path = tmp_path / "long.sigmf-meta"
    with pytest.raises(RuntimeError):
        with ada4571.Writer(path, reference=True, growing=True, sample_rate_hz=10000) as writer:
            writer.write(capture.frames[:4000])
            raise RuntimeError("the power fails")
    with ada4571.Writer(path, reference=True, growing=True, resume=True,
                        sample_rate_hz=10000) as writer:
        writer.write(capture.frames[:1000])
    assert len(ada4571.Recording(path)) == 5000
    with pytest.raises(TypeError, match="growing"):
        ada4571.Writer(path, resume=True)


def test_the_number_of_threads_changes_no_angle(capture, tmp_path):
    model = ada4571.calibrate(capture)
    try:
        for jobs in (1, 3):
            ada4571.set_jobs(jobs)
            ada4571.Converter(model).save(capture, tmp_path / f"{jobs}.csv")
    finally:
        ada4571.set_jobs(0)
    assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "3.csv").read_bytes()
