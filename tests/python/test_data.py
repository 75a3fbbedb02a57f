# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Recordings, models, conversion: numbers that Python gets are those of the library."""
import numpy as np
import pytest

import ada4571


def test_columns_are_views_of_one_array(capture):
    assert capture.vsin_v.base is capture.frames or capture.vsin_v.base is capture.frames.base
    assert len(capture) == capture.frames.size == capture.samples
    assert not capture.vsin_v.flags.writeable


def test_columns_are_those_of_the_file(capture, tmp_path):
    capture.save(tmp_path / "c.csv")
    rows = np.genfromtxt(tmp_path / "c.csv", delimiter=",", names=True, comments="#",
                         skip_header=sum(line.startswith("#") for line in open(tmp_path / "c.csv")))
    again = ada4571.Recording(tmp_path / "c.csv")
    for name in rows.dtype.names:
        assert np.array_equal(getattr(again, name), rows[name])


def test_an_absent_channel_is_nan(seed):
    bare = ada4571.Simulation(seed=seed, vtemp=False, vdd=False, reference=False).record(0.1)
    assert np.isnan(bare.vtemp_v).all() and np.isnan(bare.reference_deg).all()
    assert not bare.has_vtemp and np.isfinite(bare.vsin_v).all()


def test_what_is_written_is_read_again(capture, tmp_path):
    with ada4571.Writer(tmp_path / "w.csv", supply_v=capture.supply_v, serial="A7",
                        reference=True) as writer:
        writer.metadata("bench", "3")
        writer.write(capture.frames[:400])
        writer.write(capture.frames[400:])
    again = ada4571.Recording(tmp_path / "w.csv")
    assert again.serial == "A7" and again.metadata("bench") == "3" and again.metadata("x") is None
    # Six decimals, and the rounding of doubles below 8.
    assert np.abs(again.vsin_v - capture.vsin_v).max() <= 5e-7 + np.spacing(4.0)


def test_a_writer_that_fails_leaves_nothing(capture, tmp_path):
    with pytest.raises(ZeroDivisionError):
        with ada4571.Writer(tmp_path / "w.csv", reference=True) as writer:
            writer.write(capture.frames)
            1 / 0
    assert list(tmp_path.iterdir()) == []


def test_the_sentence_of_a_broken_file_is_the_librarys(tmp_path):
    path = tmp_path / "broken.csv"
    path.write_text("# ada4571-capture/1\ntime_s,vsin_v,vcos_v\n0,1,two\n")
    with pytest.raises(ada4571.FormatError, match=r"broken\.csv:3:5: ") as caught:
        ada4571.Recording(path)
    assert caught.value.status == "ADA4571_ERROR_FORMAT" and isinstance(caught.value, ValueError)
    with pytest.raises(FileNotFoundError, match="absent.csv"):
        ada4571.Recording(tmp_path / "absent.csv")


def test_an_ideal_model_gives_the_angle_of_its_volts():
    """With nothing to correct the result is the arc tangent, to rounding."""
    frames = np.full(1000, np.nan, ada4571.frame_dtype)
    degrees = np.arange(1000) * 0.36 / 2 + 0.01
    frames["time_s"] = np.arange(1000) * 1e-3
    frames["vsin_v"] = 2.5 + 1.4 * np.sin(np.radians(2 * degrees))
    frames["vcos_v"] = 2.5 + 1.4 * np.cos(np.radians(2 * degrees))
    model = ada4571.Model(amplitude_v=1.4)
    angles = ada4571.Converter(model)(frames)
    # sin, cos and atan2 in doubles: some ulp of 2.5 V over 1.4 V, in degrees.
    assert np.abs(angles["angle_deg"] - degrees).max() < 1e-12 * 180
    assert np.abs(angles["radius"] - 1).max() < 1e-14 * 10 and (angles["status"] == 0).all()


def test_raw_samples_are_taken_as_they_lie(seed):
    random = np.random.default_rng(seed)
    block = random.integers(-2000, 2000, (500, 3), dtype=np.int16)
    converter = ada4571.Converter(ada4571.Model(amplitude_v=1.0))
    angle, radius = converter.raw(block[:, 0], block[:, 2], scale_v=0.001, offset=2500)
    x, y = block[:, 2] * 0.001, block[:, 0] * 0.001
    expected = np.arctan2(y, x) / 2 % np.pi
    apart = np.abs(angle - expected)
    assert np.minimum(apart, np.pi - apart).max() < 1e-12
    assert np.abs(radius - np.hypot(x, y)).max() < 1e-12
    with pytest.raises(ValueError, match="stride"):
        converter.raw(block[:, 0], block[:, 0].copy(), scale_v=0.001)
    with pytest.raises(TypeError, match="byte"):
        converter.raw(block[:, 0].astype(">i2"), block[:, 0].astype(">i2"), scale_v=0.001)


def test_frames_of_another_type_are_refused(capture):
    converter = ada4571.Converter(ada4571.Model())
    with pytest.raises(TypeError, match="frame_dtype"):
        converter(np.zeros(10))
    with pytest.raises(TypeError, match="contiguous"):
        converter(capture.frames[::2])


def test_a_calibration_finds_what_was_simulated(capture, tmp_path):
    truth = ada4571.Model(amplitude_v=1.4, offset_sin_v=0.02, offset_cos_v=-0.03)
    noise = 1e-4
    made = ada4571.Simulation(model=truth, noise_rms_v=noise, adc_bits=0).record(2.0)
    found = ada4571.calibrate(made)
    # A mean of n samples of a sine stands within 5 sigma sqrt(2/n).
    limit = 5 * noise * np.sqrt(2 / len(made))
    assert abs(found.offset_sin_v - 0.02) < limit and abs(found.offset_cos_v + 0.03) < limit
    found.save(tmp_path / "m.toml")
    again = ada4571.Model.load(tmp_path / "m.toml")
    assert again.offset_sin_v == found.offset_sin_v and again.amplitude_v == found.amplitude_v


def test_effects_have_names_units_and_values():
    model = ada4571.Model()
    model.add("stray-field", b=0.01, direction_deg=30)
    effect, = model.effects
    assert effect.id == "stray-field" and effect.parameters["b"].value == 0.01
    assert effect.parameters["direction_deg"].unit == "deg"
    assert {"stray-field", "amplitude-mismatch"} < {entry.id for entry in ada4571.catalogue()}
    with pytest.raises(ada4571.InvalidArgumentError, match="no-such-effect"):
        model.add("no-such-effect")


def test_a_tracker_gives_angles_and_a_model(capture):
    tracker = ada4571.Tracker(ada4571.calibrate(capture))
    angles = tracker(capture.frames)
    assert angles.dtype == ada4571.angle_dtype and np.isfinite(angles["angle_deg"]).all()
    assert tracker.model.amplitude_v == pytest.approx(ada4571.calibrate(capture).amplitude_v, rel=0.01)


def test_a_notebook_shows_the_figure(capture):
    page = capture._repr_html_()
    assert "<svg" in page and page.count("M") > 1000 and str(len(capture)) in page
