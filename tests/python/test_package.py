# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The package as such: stubs, docstrings, memory, the tutorial."""
import ast
import gc
import inspect
import os
import pathlib
import subprocess
import sys

import pytest

import ada4571

STUB = ast.parse((pathlib.Path(ada4571.__file__).parent / "__init__.pyi").read_text())


def public(nodes):
    return {node.name: node for node in nodes
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_")}


def parameters(node):
    names = [a.arg for a in node.args.args + node.args.kwonlyargs]
    return [name for name in names if name not in ("self", "cls")]


def runtime_parameters(function):
    return [name for name, p in inspect.signature(function).parameters.items()
            if name not in ("self", "cls") and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]


def test_the_stubs_name_what_there_is():
    names = {name for name in ada4571.__all__ if not name.endswith("dtype")}
    assert set(public(STUB.body)) == names


@pytest.mark.parametrize("name", sorted(public(STUB.body)))
def test_the_stubs_have_the_parameters(name):
    node, real = public(STUB.body)[name], getattr(ada4571, name)
    if isinstance(node, ast.FunctionDef):
        assert parameters(node) == runtime_parameters(real)
        return
    for method in (n for n in node.body if isinstance(n, ast.FunctionDef)):
        found = inspect.getattr_static(real, method.name)
        if isinstance(found, property):
            continue
        assert parameters(method) == runtime_parameters(getattr(real, method.name)), method.name


@pytest.mark.parametrize("name", [n for n in ada4571.__all__ if not n.endswith("dtype")])
def test_everything_says_what_it_is(name):
    assert inspect.getdoc(getattr(ada4571, name)), f"{name} has no docstring"


def rounds(work, count):
    """Blocks of memory that the interpreter holds after so many rounds, more than before."""
    gc.collect()
    before = sys.getallocatedblocks()
    for _ in range(count):
        work()
    gc.collect()
    return sys.getallocatedblocks() - before


def resident_bytes():
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def test_nothing_is_kept(capture, tmp_path):
    """What leaks one object a round holds `count` blocks more; caches stay far below."""
    capture.save(tmp_path / "c.csv")
    model = ada4571.calibrate(capture)

    def work():
        recording = ada4571.Recording(tmp_path / "c.csv")
        ada4571.Converter(model)(recording.frames)
        ada4571.check(recording).checks
        model.effects
        for block in recording.play().blocks(0.2):
            block.size
        try:
            ada4571.Model.load(tmp_path / "c.csv")
        except ada4571.FormatError:
            pass

    sets, count = 8, 20
    rounds(work, 10)  # what is imported and cached at first use
    held = resident_bytes()
    # Caches of the interpreter and of numpy fill up slowly; what leaks shows in every set.
    assert min(rounds(work, count) for _ in range(sets)) < count / 2
    # A recording that is kept would hold its 10000 frames of 48 bytes each round.
    assert resident_bytes() - held < sets * count * capture.frames.nbytes / 4


@pytest.mark.parametrize("options", [[], ["-X", "dev", "-W", "error"]])
def test_the_tutorial_runs(options, tmp_path):
    run = subprocess.run([sys.executable, *options, os.environ["ADA4571_TUTORIAL"]], cwd=tmp_path,
                         capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    said = run.stdout
    assert "amplitude-mismatch" in said and "block 2" in said
    before, after = (float(line.split()[1]) for line in said.splitlines()
                     if line.startswith(("calibrated:", "extended:")))
    assert after < before / 2
    assert {"capture.csv", "sensor.toml", "extended.toml", "report.html"} == {
        path.name for path in tmp_path.iterdir()}
