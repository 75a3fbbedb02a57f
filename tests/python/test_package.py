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


# The interpreter remembers up to 4096 names by which attributes were looked up, a name of its own for
# each look-up from C: they are held until another one falls upon their place, and are no leak.
forget_names = getattr(sys, "_clear_internal_caches", None) or sys._clear_type_cache


def held_blocks():
    gc.collect()
    forget_names()
    return sys.getallocatedblocks()


def kept(work, count):
    """Blocks of memory that the interpreter holds after so many rounds, more than before."""
    before = held_blocks()
    for _ in range(count):
        work()
    return held_blocks() - before


def resident_bytes():
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def test_what_is_kept_is_seen():
    """The measure itself: an object every other round is a leak, a name that is looked up is none."""
    leaked, count = [], 100
    nothing = kept(lambda: None, count)
    assert kept(lambda: getattr(ada4571.Model, "".join(["lo", "ad"])), count) == nothing
    assert kept(lambda: leaked.append(object()), count) >= nothing + count
    numbers = iter(range(count))
    assert kept(lambda: next(numbers) % 2 and leaked.append(object()), count) >= nothing + count // 2


def test_nothing_is_kept(capture, tmp_path):
    """As many blocks are held after a hundred rounds as after a hundred rounds of nothing."""
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

    count = 100
    kept(work, 10)  # what is imported and cached at first use
    resident = resident_bytes()
    assert kept(work, count) == kept(lambda: None, count)
    # A recording that is kept would hold its 10000 frames of 48 bytes each round.
    assert resident_bytes() - resident < count * capture.frames.nbytes / 4


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


def test_what_a_notebook_shows_names_the_object(tmp_path):
    simulation = ada4571.Simulation(seed=3, motion="constant:rpm=60")
    assert "seed 3" in repr(simulation) and "constant:rpm=60" in repr(simulation)
    assert "Model" in repr(ada4571.Converter(simulation.model))
    assert "amplitude" in repr(ada4571.Tracker(simulation.model, amplitude=True))
    assert "w.csv" in repr(ada4571.Writer(tmp_path / "w.csv"))
    with simulation.emulate() as uri:
        assert uri.startswith("ip:")
    for thing in public(STUB.body).values():
        kind = getattr(ada4571, thing.name)
        if isinstance(kind, type) and hasattr(kind, "__enter__"):
            assert kind.__repr__ is not object.__repr__, thing.name
