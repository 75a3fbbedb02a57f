#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Tests of score.py: its judgement, and a whole run against a stand-in for iio-angle that
reads the truth beside the capture."""

import os
import subprocess
import sys
import tempfile
import textwrap
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
sys.dont_write_bytecode = True
import score  # noqa: E402

TRUTH_CAPTURE = os.environ.get("TRUTH_CAPTURE", "truth-capture")

STAND_IN = textwrap.dedent("""\
    #!/usr/bin/env python3
    import json, os, sys
    if sys.argv[1] == "convert":
        rows = [l.split(",") for l in open(sys.argv[4]) if not l.startswith("#")]
        index = rows[0].index("reference_deg\\n")
        with open(sys.argv[6], "w") as out:
            out.write("time_s,angle_deg,radius,status\\n")
            for row in rows[1:]:
                error = 1.0 if float(row[0]) > 1 and os.environ["STAND_IN"] == "crooked" else 0.0
                out.write("%s,%.6f,1,0\\n" % (row[0], (float(row[index]) + 7 + error) % 180))
        sys.exit()
    capture = sys.argv[-1]
    assert sys.argv[1:3] == ["diagnose", "--json"], sys.argv
    assert open(capture).readline() == "# ada4571-capture/1\\n"
    truth = json.load(open(os.path.join(os.path.dirname(capture), "truth.json")))
    findings = []
    for effect in truth["effects"]:
        parameters = {}
        for name, p in effect["parameters"].items():
            value = p["text"] if "text" in p else p["value"] + p.get("period", 0)
            parameters[name] = {"value": value, "std_error": 1e-3, "unit": p.get("unit", "")}
        findings.append({"cause": effect["cause"], "parameters": parameters,
                         "alternatives": [n for n in effect["require"] if n != effect["cause"]]})
    mode = os.environ.get("STAND_IN", "perfect")
    if mode == "blind":
        findings = []
    if mode == "inventive":
        findings.append({"cause": "stray-field", "parameters": {}, "alternatives": []})
    if mode == "broken":
        sys.exit("cannot read")
    print(json.dumps({"schema": "ada4571-diagnosis/1", "findings": findings,
                      "unexplained": {"present": truth["unexplained"]},
                      "verdict": truth["verdicts"][0]}))
    """)


def truth_of(effects=(), tolerated=(), unexplained=False, verdicts=("explained",)):
    return {"effects": list(effects), "tolerated": list(tolerated), "unexplained": unexplained,
            "verdicts": list(verdicts)}


def effect_of(cause, accept=(), require=(), **parameters):
    return {"cause": cause, "accept": list(accept), "require": list(require),
            "parameters": parameters}


def report_of(*findings, unexplained=False, verdict="explained"):
    return {"schema": "ada4571-diagnosis/1", "findings": list(findings),
            "unexplained": {"present": unexplained}, "verdict": verdict}


def finding_of(cause, alternatives=(), **values):
    return {"cause": cause, "alternatives": list(alternatives),
            "parameters": {n: {"value": v, "std_error": 0.1} for n, v in values.items()}}


class Judgement(unittest.TestCase):
    def problems(self, truth, report):
        return score.judge(truth, report).problems

    def test_right_name_and_number(self):
        truth = truth_of([effect_of("amplitude-mismatch", k={"value": 0.01, "tolerance": 0.001})])
        self.assertEqual(self.problems(truth, report_of(finding_of("amplitude-mismatch", k=0.0105))),
                         [])
        wrong = self.problems(truth, report_of(finding_of("amplitude-mismatch", k=-0.01)))
        self.assertEqual(len(wrong), 1)
        self.assertIn("k=-0.01", wrong[0])
        self.assertIn("missing", self.problems(truth, report_of(finding_of("amplitude-mismatch")))[0])

    def test_angles_are_compared_modulo_their_symmetry(self):
        wanted = {"value": 178.0, "tolerance": 6.0, "period": 180.0, "other": 90.0}
        truth = truth_of([effect_of("sensor-off-axis", direction_deg=wanted)])
        for value in (179.0, -1.0, 358.0, 2.0, 91.0):
            report = report_of(finding_of("sensor-off-axis", direction_deg=value))
            self.assertEqual(self.problems(truth, report), [], value)
        report = report_of(finding_of("sensor-off-axis", direction_deg=120.0))
        self.assertEqual(len(self.problems(truth, report)), 1)

    def test_missed_and_invented(self):
        truth = truth_of([effect_of("hysteresis")])
        result = score.judge(truth, report_of(finding_of("clipping")))
        self.assertEqual(result.invented, ["clipping"])
        self.assertEqual(result.problems, ["missed hysteresis", "invented clipping"])

    def test_a_second_finding_of_the_same_cause_is_invented(self):
        truth = truth_of([effect_of("hysteresis")])
        result = score.judge(truth, report_of(finding_of("hysteresis"), finding_of("hysteresis")))
        self.assertEqual(result.invented, ["hysteresis"])

    def test_only_an_alternative_is_not_found_unless_accepted(self):
        report = report_of(finding_of("cubic-nonlinearity", ["weak-field"]))
        self.assertIn("missed weak-field (an alternative of cubic-nonlinearity)",
                      self.problems(truth_of([effect_of("weak-field")]), report))
        accepted = truth_of([effect_of("weak-field", accept=["cubic-nonlinearity"])])
        self.assertEqual(self.problems(accepted, report), [])
        without = report_of(finding_of("cubic-nonlinearity"))
        self.assertEqual(len(self.problems(accepted, without)), 2)

    def test_naming_one_of_an_undecidable_set_is_wrong(self):
        truth = truth_of([effect_of("quadrature-error",
                                    require=["quadrature-error", "channel-skew"])])
        result = score.judge(truth, report_of(finding_of("quadrature-error")))
        self.assertFalse(result.effects[0][1])
        self.assertEqual(
            self.problems(truth, report_of(finding_of("quadrature-error", ["channel-skew"]))), [])

    def test_unknown_must_be_called_so(self):
        truth = truth_of(tolerated=["excess-noise"], unexplained=True, verdicts=["unexplained"])
        self.assertEqual(self.problems(truth, report_of(finding_of("excess-noise"), unexplained=True,
                                                        verdict="unexplained")), [])
        self.assertEqual(len(self.problems(truth, report_of())), 2)

    def test_a_name_may_stand_instead_of_unexplained(self):
        truth = truth_of(tolerated=["gain-wander"], unexplained=True,
                         verdicts=["unexplained", "explained"])
        truth["named_instead"] = ["gain-wander"]
        self.assertEqual(self.problems(truth, report_of(finding_of("gain-wander"))), [])
        self.assertEqual(len(self.problems(truth, report_of())), 1)

    def test_either_may_be_right(self):
        truth = truth_of(unexplained=None, verdicts=["unexplained", "explained"])
        self.assertEqual(self.problems(truth, report_of()), [])
        self.assertEqual(self.problems(truth, report_of(unexplained=True, verdict="unexplained")),
                         [])

    def test_null_must_be_quiet(self):
        truth = truth_of(verdicts=["no-discrepancy"])
        self.assertEqual(self.problems(truth, report_of(verdict="no-discrepancy")), [])
        self.assertEqual(len(self.problems(truth, report_of(unexplained=True))), 2)


class WholeRun(unittest.TestCase):
    def run_score(self, mode, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            stand_in = os.path.join(folder, "iio-angle")
            with open(stand_in, "w", encoding="utf-8") as file:
                file.write(STAND_IN)
            os.chmod(stand_in, 0o755)
            return subprocess.run(
                [sys.executable, os.path.join(HERE, "score.py"), "--iio-angle", stand_in,
                 "--truth-capture", TRUTH_CAPTURE, "--seed", "1", "--runs", "3", *arguments],
                capture_output=True, text=True, env={**os.environ, "STAND_IN": mode})

    def test_perfect_answers_meet_every_demand(self):
        for category in ("two", "ambiguous", "null", "unknown", "short", "bench", "outside"):
            run = self.run_score("perfect", "--category", category)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            self.assertRegex(run.stdout, r"nothing wrong at all +3/3 \(100.0 %\)")

    def test_failures_name_the_capture_that_shows_them(self):
        run = self.run_score("blind", "--category", "single", "--effect", "angle-slip")
        self.assertEqual(run.returncode, 1)
        self.assertIn("--category single --seed 2 --effect angle-slip: missed angle-slip",
                      run.stdout)
        self.assertIn("NOT MET", run.stdout)

    def test_invented_causes_fail_a_null(self):
        run = self.run_score("inventive", "--category", "null")
        self.assertEqual(run.returncode, 1)
        self.assertIn("invented: stray-field 3", run.stdout)

    def test_second_capture_is_measured_against_the_noise_floor(self):
        arguments = ("--effect", "weak-field", "--second")  # two periods a turn in any case
        run = self.run_score("perfect", *arguments)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertRegex(run.stdout, r"corrected +3/3")
        run = self.run_score("crooked", *arguments)
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stdout, r"corrected +0/3")

    def test_no_answer_is_a_failure(self):
        run = self.run_score("broken", "--category", "null")
        self.assertEqual(run.returncode, 1)
        self.assertIn("exit status 1: cannot read", run.stdout)


if __name__ == "__main__":
    unittest.main()
