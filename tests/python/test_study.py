# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Studies: many captures, one database."""
import os
import pathlib
import sqlite3
import subprocess
import sys
import threading
import time
import types

import pytest

import ada4571


@pytest.fixture(scope="module")
def captures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    paths = []
    for k in range(1, 7):
        sensor = ada4571.Simulation({"amplitude-mismatch": {"k": 0.01 * k}}, seed=k,
                                    motion="constant:rpm=600", sample_rate_hz=2000.0)
        paths.append(folder / f"c{k}.csv")
        sensor.record(1.0).save(paths[-1])
    return paths


def test_a_study_is_run_and_goes_on(captures, tmp_path):
    study, seen = ada4571.Study(tmp_path / "s.db"), []
    absent = str(tmp_path / "absent.csv")
    failed = study.run([*captures[:4], absent], diagnose=False,
                       progress=lambda fraction, path: seen.append((fraction, path)))
    assert list(failed) == [absent] and absent in failed[absent]
    assert [fraction for fraction, _ in seen] == [k / 5 for k in range(1, 6)]
    assert {path for _, path in seen} == {*map(str, captures[:4]), absent}
    seen.clear()
    assert study.run(captures, diagnose=False, jobs=1, progress=lambda *said: seen.append(said)) == {}
    assert [path for _, path in seen] == [str(path) for path in captures[4:]]
    assert list(study.run(diagnose=False, again=True)) == [absent]

    summary = study.summary
    assert (summary.captures, summary.failed) == (7, 1) and study.json["captures"] == 7
    mismatch = next(c for c in summary.causes if c.cause == "amplitude-mismatch")
    assert abs(mismatch.parameters["k"].median - 0.035) < 1e-3
    assert study.missing == [] and "amplitude-mismatch" in str(study) and "s.db" in repr(study)
    study.report(tmp_path / "s.html")
    assert "</html>" in (tmp_path / "s.html").read_text(encoding="utf-8")
    rows = sqlite3.connect(study.path).execute("SELECT state FROM captures").fetchall()
    assert sorted(state for state, in rows) == ["done"] * 6 + ["failed"]


def test_parts_are_merged(captures, tmp_path):
    parts = [ada4571.Study(tmp_path / f"p{k}.db") for k in range(2)]
    for k, part in enumerate(parts):
        part.run(captures[3 * k:3 * k + 3], diagnose=False)
    whole = ada4571.Study.merge(tmp_path / "whole.db", [parts[0], parts[1].path])
    assert whole.json["captures"] == 6
    again = ada4571.Study.merge(tmp_path / "again.db", reversed(parts))
    assert (tmp_path / "again.db").read_bytes() == (tmp_path / "whole.db").read_bytes(), again


def test_what_does_not_fit_is_refused(captures, tmp_path):
    with pytest.raises(ada4571.NotFoundError, match="no such study"):
        ada4571.Study(tmp_path / "none.db").json
    study = ada4571.Study(tmp_path / "s.db")
    study.run(captures[:1], diagnose=False)
    with pytest.raises(ada4571.InvalidArgumentError, match="without the diagnosis"):
        study.run(captures[:1])
    with pytest.raises(ada4571.FormatError):
        ada4571.Study(captures[0]).json


def test_what_ends_in_progress_keeps_what_was_done(captures, tmp_path):
    study = ada4571.Study(tmp_path / "s.db")

    def end(fraction, path):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.run(captures, diagnose=False, jobs=2, progress=end)
    assert len(study.missing) == len(captures) - 1
    assert threading.active_count() == 1
    assert study.run(diagnose=False) == {} and study.missing == []


def test_an_analysis_ends_where_it_is_told_to(captures):
    asked = []

    def end(fraction, what):
        asked.append(what)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ada4571._core.study_analyse(str(captures[0]), True, None, end)
    assert len(asked) == 1
    row, reason = ada4571._core.study_analyse(str(captures[0]), True, None, None)
    assert row and not reason


def test_what_ends_a_run_ends_what_runs(captures, tmp_path, monkeypatch):
    """All analyses but the first work until they are told to end; there is nothing else that ends them."""
    core, ended = ada4571._core, []

    def analyse(name, diagnose, reports, look):
        if name == str(captures[0]):
            return core.study_analyse(name, diagnose, reports, look)
        try:
            while True:
                look(0.5, "works")
                time.sleep(0.01)
        except KeyboardInterrupt:
            ended.append(name)
            raise

    def end(fraction, path):
        raise KeyboardInterrupt

    monkeypatch.setattr("ada4571._study._core",
                        types.SimpleNamespace(**dict(vars(core), study_analyse=analyse)))
    with pytest.raises(KeyboardInterrupt):
        ada4571.Study(tmp_path / "s.db").run(captures, diagnose=False, jobs=3, progress=end)
    assert ended and threading.active_count() == 1


def test_a_diagnosed_capture_has_a_page(captures, tmp_path):
    study = ada4571.Study(tmp_path / "s.db")
    assert study.run(captures[:1], reports=tmp_path / "pages") == {}
    assert [cause.cause for cause in study.summary.causes][0] == "amplitude-mismatch"
    assert len(list((tmp_path / "pages").glob("*.html"))) == 1


def test_pandas_reads_the_database(captures, tmp_path):
    """The example of the documentation, which needs no ada4571."""
    pytest.importorskip("pandas")
    ada4571.Study(tmp_path / "s.db").run(captures, diagnose=False)
    example = pathlib.Path(os.environ["ADA4571_TUTORIAL"]).parent / "study_tables.py"
    run = subprocess.run([sys.executable, example, tmp_path / "s.db"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "amplitude-mismatch" in run.stdout and "simulated-6" in run.stdout
