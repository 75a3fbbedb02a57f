# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""What watches over the documentation sees what it is there to see."""
import pathlib
import sys
import types

import numpy as np
import pytest

import blocks
import catalogue
import links
import pictures

TREE = types.SimpleNamespace(program=pathlib.Path("/bin/true"), python="/", library="/usr/lib",
                             header="/usr/include", interpreter=sys.executable)


def run(tmp_path, text):
    return blocks.run_page(blocks.Runner(TREE, tmp_path, "page"), text)


def test_what_a_command_says_is_shown(tmp_path):
    page = run(tmp_path, "```sh\necho $((6 * 7)) | tee said\n```\n```sh\ncat said\n```\n")
    assert page.count("```text\n42\n```") == 2


def test_nothing_of_a_long_line_is_lost():
    line = "   left over: " + "words of a sentence that no page is wide enough for, " * 5 + "x" * 300
    said = blocks.shown(f"short\n{line}\nshort")
    assert said.startswith("short\n   left over: words") and said.endswith("\nshort")
    assert all(len(part) <= blocks.SHOWN_WIDTH for part in said.splitlines())
    assert all(part.startswith("     ") for part in said.splitlines()[2:-1])
    assert "".join(said.split()) == "".join(f"short{line}short".split())


def test_a_block_that_fails_ends_the_build(tmp_path):
    with pytest.raises(blocks.BlockFailed, match="ended with 3"):
        run(tmp_path, "```sh\nexit 3\n```\n")
    with pytest.raises(blocks.BlockFailed, match="ended with 1"):
        run(tmp_path, "```python\nassert 1 == 2\n```\n")


def test_a_block_of_an_unknown_kind_is_refused(tmp_path):
    with pytest.raises(blocks.BlockFailed, match="fortran"):
        run(tmp_path, "```fortran\nend\n```\n")


@pytest.mark.parametrize("kind, text", [("toml", "key = 'a"), ("json", "{"), ("json", "{} {}")])
def test_a_file_that_cannot_be_read_ends_the_build(kind, text, tmp_path):
    with pytest.raises(blocks.BlockFailed, match="page: "):
        run(tmp_path, f"```{kind}\n{text}\n```\n")


def test_python_goes_on_where_it_ended(tmp_path):
    page = run(tmp_path, "```python\nx = 6\nprint('first')\n```\n```python\nprint(x * 7)\n```\n")
    assert page.count("first") == 2 and page.rstrip().endswith("```text\n42\n```")


@pytest.mark.parametrize("body, wrong", [
    ('<a href="there.html">', []), ('<a href="there.html#place">', []),
    ('<a href="gone.html">', ["gone.html"]), ('<img src="gone.svg">', ["gone.svg"]),
    ('<a href="there.html#nowhere">', ["there.html#nowhere"]), ('<a href="#nowhere">', ["#nowhere"]),
    ('<a href="https://example.org/">', []),
    ('<img src="https://example.org/x.png">', ["https://example.org/x.png"])])
def test_links_that_lead_nowhere_are_seen(body, wrong, tmp_path):
    (tmp_path / "there.html").write_text('<p id="place">')
    (tmp_path / "index.html").write_text(body)
    assert [link for _, link in links.broken(tmp_path)] == wrong


def test_a_place_of_this_machine_is_not_shown(tmp_path):
    page = run(tmp_path, "```sh\necho $XDG_CONFIG_HOME/bench.toml: and $PWD/capture.csv\n```\n")
    assert "```text\n~/.config/bench.toml: and capture.csv\n```" in page


def test_an_effect_without_physics_or_source_ends_the_build():
    cited = "text (A. Author, *A title*, 1999)"
    assert catalogue.section(f"## one\n\n{cited}\n\n## other\n", "one") == cited
    assert catalogue.section("## one\n\nAlgebra. (Derived here.)\n", "one")
    with pytest.raises(KeyError, match="no section on two"):
        catalogue.section(f"## one\n\n{cited}\n", "two")
    with pytest.raises(KeyError, match="no source of one"):
        catalogue.section(f"## one\n\ntext *with stress*\n\n## two\n\n{cited}\n", "one")


def test_a_rival_is_one_both_ways():
    facts = [{"id": "one", "separations": [{"rival": "two", "experiment": "look"}]},
             {"id": "two", "separations": []}, {"id": "three", "separations": []}]
    assert [catalogue.rivals_of(fact, facts) for fact in facts] == [{"two": "look"}, {"one": "look"}, {}]


def wave(cycles, samples=4000):
    return np.sin(2 * np.pi * cycles * np.arange(samples) / samples)


@pytest.mark.parametrize("cycles, too_fast", [(2, False), (100, False), (200, False), (600, True),
                                              (1900, True)])
def test_a_wave_of_few_samples_a_cycle_is_seen(cycles, too_fast):
    assert catalogue.undersampled(wave(cycles)) == too_fast
    assert catalogue.undersampled(5 * wave(1) + wave(cycles)) == too_fast


def test_what_does_not_come_again_is_never_too_fast():
    assert not catalogue.undersampled(np.zeros(4000))
    assert not catalogue.undersampled(1e-5 * wave(1900))  # rounding
    assert not catalogue.undersampled(np.where(np.arange(4000) > 1000, 1.0, 0.0))


@pytest.mark.parametrize("cycles", [1, 20, 100, 200])
def test_a_picture_over_time_shows_few_cycles(cycles):
    shown = catalogue.first_cycles(wave(cycles))
    assert shown == 4000 if cycles <= catalogue.CYCLES else cycles * shown / 4000 <= catalogue.CYCLES + 1


class Saw:
    """A simulation whose angle errs by a saw of so many teeth a second; none where nothing acts."""

    def __init__(self, teeth):
        self.teeth = teeth

    def __call__(self, effects, motion, rate, duration):
        time = np.arange(int(rate * duration)) / rate
        psi = np.radians(2.0) * (self.teeth * time % 1) if effects else 0 * time
        table = np.zeros(time.size, dtype=[(name, float) for name in
                                           ("time_s", "vsin_v", "vcos_v", "reference_deg")])
        table["time_s"], table["vsin_v"] = time, 2.5 + 1.45 * np.sin(psi)
        table["vcos_v"] = 2.5 + 1.45 * np.cos(psi)
        return table


@pytest.mark.parametrize("teeth, rate", [(5, 1000), (300, 10_000), (2700, 100_000)])
def test_what_is_too_fast_is_looked_at_from_nearer(teeth, rate):
    shown = catalogue.course(Saw(teeth), {}, [], ["effect"], False)
    assert shown[1, 0] == pytest.approx(1 / rate)
    assert shown[-1, 0] * teeth <= catalogue.CYCLES + 1 and shown[:, 1].max() == pytest.approx(1, abs=0.1)
    with pytest.raises(ValueError, match="too fast"):
        catalogue.course(Saw(29_137), {}, [], ["effect"], False)


REPORT = ('<style>p{}</style><main><header id="verdict"><p>two causes, 1.25 mV</p>'
          '<svg aria-label="means 0.5 mV"><text>12.5</text><text>speed, rpm</text></svg>'
          '<section class="finding" id="finding-1"></section>'
          '<section class="finding" id="finding-4">late</section>'
          '<h2 id="record">The record</h2>over time<h2>')
PNG = (b"\x89PNG\r\n\x1a\n" + pictures.chunk(b"IHDR", b"h") + pictures.chunk(b"tEXt", b"Software\0x") +
       pictures.chunk(b"IDAT", b"d") + pictures.chunk(b"IEND", b""))


@pytest.mark.parametrize("change, fresh", [
    (("1.25", "1.26"), True), (("0.5 mV", "0.6 mV"), True), (("1.25", "1.45"), False),
    (("12.5", "15"), True), (("causes", "faults"), False), (("rpm", "1/s"), False),
    (("p{}", "p{color:red}"), False)])
def test_a_stale_picture_is_seen(change, fresh):
    name = "report-budget.png"
    picture = pictures.with_words(PNG, pictures.words_of(REPORT, name))
    assert picture.count(b"IDAT") == 1 and b"Software" not in picture
    assert pictures.same(pictures.shown_by(picture), pictures.words_of(REPORT, name))
    today = pictures.words_of(REPORT.replace(*change), name)
    assert pictures.same(pictures.shown_by(picture), today) == fresh


def test_a_picture_that_says_nothing_is_stale():
    assert pictures.shown_by(PNG) == ""
    assert not pictures.same("", pictures.words_of(REPORT, "report-cause.png"))
