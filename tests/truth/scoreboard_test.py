#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Tests of the scoreboard: its gates, and whole runs against a stand-in for iio-angle."""

import importlib.machinery
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import types
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
sys.dont_write_bytecode = True
import score_test  # noqa: E402

loader = importlib.machinery.SourceFileLoader("scoreboard", os.path.join(HERE, "scoreboard"))
scoreboard = importlib.util.module_from_spec(importlib.util.spec_from_loader("scoreboard", loader))
loader.exec_module(scoreboard)


def row(right, name="single"):
    good = (int(right), 1)
    return types.SimpleNamespace(job=(name, "", 1), answered=True, found=good, numbers=good,
                                 invented=(0, 1), quiet=(0, 0), unexplained=(0, 0))


class Gates(unittest.TestCase):
    def test_a_binomial_tail_is_the_sum_of_its_terms(self):
        self.assertAlmostEqual(scoreboard.chance_of_at_most(0, 3, 0.9), 0.001)
        self.assertAlmostEqual(scoreboard.chance_of_at_most(2, 3, 0.9), 0.271)
        self.assertAlmostEqual(scoreboard.chance_of_at_most(3, 3, 0.9), 1.0)

    def test_few_wrong_ones_pass_and_many_do_not(self):
        self.assertTrue(scoreboard.hold_fresh([row(i >= 3) for i in range(20)]))
        self.assertFalse(scoreboard.hold_fresh([row(i >= 10) for i in range(20)]))

    def test_no_answer_is_never_held(self):
        rows = [row(True) for _ in range(20)]
        rows[3].answered = False
        self.assertFalse(scoreboard.hold_fresh(rows))


class WholeRun(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for name in ("scoreboard", "score.py"):
            shutil.copy(os.path.join(HERE, name), self.folder.name)
        self.stand_in = os.path.join(self.folder.name, "iio-angle")
        with open(self.stand_in, "w", encoding="utf-8") as file:
            file.write(score_test.STAND_IN)
        os.chmod(self.stand_in, 0o755)
        # The whole table is a matter of minutes: only the short kinds.
        path = os.path.join(self.folder.name, "scoreboard")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        begin, end = text.index("KINDS = {"), text.index("}", text.index("KINDS = {"))
        with open(path, "w", encoding="utf-8") as file:
            file.write(text[:begin] + 'KINDS = {"null": (2, 12), "outside": (2, 4)' + text[end:])

    def run_it(self, mode, *arguments):
        return subprocess.run(
            [sys.executable, os.path.join(self.folder.name, "scoreboard"), "--iio-angle",
             self.stand_in, "--truth-capture", score_test.TRUTH_CAPTURE, *arguments],
            capture_output=True, text=True, env={**os.environ, "STAND_IN": mode})

    def test_what_was_right_must_stay_right(self):
        run = self.run_it("perfect", "--write")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertEqual(self.run_it("perfect", "--check", "fixed").returncode, 0)
        run = self.run_it("inventive", "--check", "fixed")
        self.assertEqual(run.returncode, 1)
        self.assertIn("no longer right: null - 1000: invented stray-field", run.stdout)

    def test_an_exception_is_named_and_let_pass(self):
        self.assertEqual(self.run_it("perfect", "--write").returncode, 0)
        path = os.path.join(self.folder.name, "scoreboard.md")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        names = [line.split("`")[1] for line in text.splitlines() if line.startswith("| `")]
        with open(path, "a", encoding="utf-8") as file:
            file.writelines(f"- `{name}`: for a test\n" for name in names)
        run = self.run_it("inventive", "--check", "fixed")
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("(excepted: for a test)", run.stdout)

    def test_fresh_captures_are_held_to_the_rates(self):
        run = self.run_it("perfect", "--check", "fresh")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        run = self.run_it("inventive", "--check", "fresh")
        self.assertEqual(run.returncode, 1)
        self.assertIn("NOT HELD", run.stdout)


if __name__ == "__main__":
    unittest.main()
