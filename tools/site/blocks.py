# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Runs every code block of a page, in the page's order and in one folder, and sets what a command
says below it. `sh hardware` blocks run against the simulated sensor behind the network; the files that a
page shows are read; `text` shows what only a real board can do, and is the one kind that does not run."""
import json
import os
import re
import subprocess
import textwrap
import tomllib

SHOWN_LINES = 24
SHOWN_WIDTH = 104  # characters that the page has room for

# What a block on hardware does not say, because there is only one device: where it is.
WRAPPER = """#!/bin/bash
case $1 in
  list | record | read | watch)
    [[ " $* " == *" -s "* || " $* " == *" -u "* ]] || set -- "$1" -u "$EMULATED_URI" "${@:2}" ;;
esac
exec {program} "$@" 2> >(grep -v '^ERROR: READ ' >&2)
"""


class BlockFailed(Exception):
    """A block of a page does not do what the page promises."""


class Runner:
    """A page's folder, and what its blocks need."""

    def __init__(self, tree, folder, page):
        self.tree, self.folder, self.page = tree, folder, page
        folder.mkdir(parents=True, exist_ok=True)
        self.python = []
        self.emulator = None
        tools = folder / ".tools"
        tools.mkdir(exist_ok=True)
        self.environment = dict(os.environ, PATH=f"{tree.program.parent}:{os.environ['PATH']}",
                                PYTHONPATH=str(tree.python), XDG_CONFIG_HOME=str(tools),
                                LD_LIBRARY_PATH=str(tree.library), PYTHONDONTWRITEBYTECODE="1")

    def close(self):
        if self.emulator:
            self.emulator.terminate()
            self.emulator.wait()

    def neutral(self, said):
        """Without the places of the machine that builds the pages."""
        return said.replace(self.environment["XDG_CONFIG_HOME"], "~/.config") \
            .replace(f"{self.folder}/", "")

    def _run(self, command, text=None, environment=None):
        done = subprocess.run(command, input=text, cwd=self.folder, text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env=environment or self.environment)
        if done.returncode:
            raise BlockFailed(f"{self.page}: {' '.join(map(str, command))} ended with "
                              f"{done.returncode}:\n{text or ''}\n{done.stdout}")
        return done.stdout

    def _python(self, text):
        return self._run([self.tree.interpreter, "-"], text)

    def _emulated(self):
        if not self.emulator:
            self.emulator = subprocess.Popen(
                [self.tree.program, "emulate", "--seed", "4571"], stdout=subprocess.PIPE, text=True,
                stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
            self.uri = self.emulator.stdout.readline().strip()
            wrapper = self.folder / ".tools" / "iio-angle"
            wrapper.write_text(WRAPPER.replace("{program}", str(self.tree.program)))
            wrapper.chmod(0o755)
        return dict(self.environment, EMULATED_URI=self.uri,
                    PATH=f"{self.folder / '.tools'}:{self.environment['PATH']}")

    def sh(self, text):
        return self._run(["bash", "-euo", "pipefail", "-c", text])

    def sh_hardware(self, text):
        return self._run(["bash", "-euo", "pipefail", "-c", text], environment=self._emulated())

    def python_block(self, text):
        """Blocks go on where the last one ended, so all up to this one are run."""
        before = "\n".join(self.python)
        self.python.append(text)
        said = self._python("\n".join(self.python))
        return said[len(self._python(before)):] if before else said

    def c(self, text):
        source = self.folder / "program.c"
        source.write_text(text)
        self._run(["cc", "-std=c99", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror", "program.c",
                   "-o", "program", f"-I{self.tree.header}", f"-L{self.tree.library}", "-lada4571",
                   "-lpthread"])
        return self._run(["./program"])

    def gnuplot(self, text):
        return self._run(["gnuplot", "-"], text)

    def dts(self, text):
        return self._run(["dtc", "-q", "-@", "-I", "dts", "-O", "dtb", "-o", "/dev/null", "-"], text)

    def csv(self, text):
        """A capture."""
        (self.folder / "shown.csv").write_text(text)
        self._python("import ada4571; ada4571.Recording('shown.csv')")

    def toml(self, text):
        """A model, or a configuration, which would open a device."""
        try:
            names_a_model = "schema" in tomllib.loads(text)
        except ValueError as error:
            raise BlockFailed(f"{self.page}: {error}\n{text}") from error
        if names_a_model:
            (self.folder / "shown.toml").write_text(text)
            self._python("import ada4571; ada4571.Model.load('shown.toml')")

    def json(self, text):
        try:
            json.loads(text)
        except ValueError as error:
            raise BlockFailed(f"{self.page}: {error}\n{text}") from error

    def block(self, kind, text):
        """What the block says; None where it is only shown."""
        runners = {"sh": self.sh, "sh hardware": self.sh_hardware, "python": self.python_block,
                   "c": self.c, "gnuplot": self.gnuplot, "dts": self.dts,
                   "csv": self.csv, "toml": self.toml, "json": self.json}
        if kind == "text":
            return None
        if kind not in runners:
            raise BlockFailed(f"{self.page}: a block of '{kind}' is not run by anything")
        return runners[kind](text)


def shown(said):
    """Output as the page shows it: not longer than a screen, long lines folded below their beginning."""
    lines = said.rstrip().split("\n")
    if len(lines) > SHOWN_LINES:
        lines = lines[:SHOWN_LINES] + ["..."]
    return "\n".join(part for line in lines for part in folded(line))


def folded(line):
    if len(line) <= SHOWN_WIDTH:
        return [line]
    indent = " " * (len(line) - len(line.lstrip()) + 2)
    return textwrap.wrap(line, SHOWN_WIDTH, subsequent_indent=indent, break_on_hyphens=False)


def run_page(runner, text):
    """The page with what its blocks said. gnuplot's own text is not shown, its pictures are."""
    def replace(match):
        kind, block = match[1].strip(), match[2]
        said = runner.neutral(runner.block(kind, textwrap.dedent(block)) or "")
        language = kind.split()[0]
        page = "" if language == "gnuplot" else f"```{language}\n{block}```\n"
        return page + (f"\n```text\n{shown(said)}\n```\n" if said.strip() else "")
    try:
        return re.sub(r"^```([^\n]*)\n(.*?)^```\n", replace, text, flags=re.M | re.S)
    finally:
        runner.close()
