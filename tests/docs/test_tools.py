# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""What watches over the documentation sees what it is there to see."""
import pathlib
import sys
import types

import pytest

import blocks
import catalogue
import links

TREE = types.SimpleNamespace(program=pathlib.Path("/bin/true"), python="/", library="/usr/lib",
                             header="/usr/include", interpreter=sys.executable)


def run(tmp_path, text):
    return blocks.run_page(blocks.Runner(TREE, tmp_path, "page"), text)


def test_what_a_command_says_is_shown(tmp_path):
    page = run(tmp_path, "```sh\necho $((6 * 7)) | tee said\n```\n```sh\ncat said\n```\n")
    assert page.count("```text\n42\n```") == 2


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


def test_an_effect_without_physics_ends_the_build():
    assert catalogue.section("## one\n\ntext\n\n## other\n", "one") == "text"
    with pytest.raises(KeyError, match="no section on two"):
        catalogue.section("## one\n\ntext\n", "two")
