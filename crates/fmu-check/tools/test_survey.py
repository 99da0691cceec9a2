"""Tests of survey.py with a program that stands in for the checker: `python3 -m unittest test_survey`."""

import contextlib
import csv
import io
import tempfile
import unittest
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import survey

# A checker that does what the name of the FMU says.
PROGRAM = """#!/usr/bin/env python3
import json, os, sys, time
assert sys.argv[1:3] == ["--format", "json"], sys.argv
name = os.path.basename(sys.argv[-1])
if name == "crash.fmu":
    os.abort()
if name == "panic.fmu":
    print("thread 'main' panicked", file=sys.stderr)
    sys.exit(101)
if name == "hang.fmu":
    time.sleep(60)
if name == "chatter.fmu":
    print("no report")
    sys.exit(0)
if name == "damaged.fmu":
    print("error: damaged.fmu is not a zip archive", file=sys.stderr)
    sys.exit(2)
def finding(kind, rule, section=None, since=None):
    return {"class": kind, "rule": rule, "place": "x", "line": None, "message": "m", "section": section, "since": since}
findings, more, notes = [], [], []
if name == "broken.fmu":
    findings = [finding("violation", "a-rule", "2.2.7", "2.0.1")] * 2 + [finding("hint", "c-rule")]
    more = [{"class": "violation", "rule": "a-rule", "count": 5}]
if name == "defect.fmu":
    findings = [finding("defect", "b-rule")]
numbers = {kind + "s": sum(f["class"] == kind for f in findings) for kind in ("violation", "defect", "hint")}
if name == "clean.fmu":
    notes = ["nothing is run: there is no library for this host"]
if name == "options.fmu":
    findings = [finding("hint", option) for option in sys.argv[3:-1]]
print(json.dumps({"file": sys.argv[-1], **numbers, "findings": findings, "more": more, "notes": notes}))
sys.exit(1 if numbers["violations"] else 3 if numbers["defects"] else 0)
"""


class Survey(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.program = self.folder / "checker"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.fmus = self.folder / "fmus"
        self.fmus.mkdir()

    def add(self, name, tool="Tool 1"):
        path = self.fmus / name
        path.parent.mkdir(exist_ok=True)
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", f"<fmiModelDescription generationTool={quoteattr(tool)}><a/>")

    def run_survey(self, *options):
        printed, complained = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(complained):
            code = survey.main([str(self.fmus), "--program", str(self.program), *options])
        return code, printed.getvalue(), complained.getvalue()

    def test_findings_are_no_failure_of_the_survey(self):
        for name in ("broken.fmu", "defect.fmu", "below/clean.fmu"):
            self.add(name)
        code, printed, _ = self.run_survey()
        self.assertEqual(code, 0)
        rows = [line.split() for line in printed.splitlines()]
        self.assertIn(["broken.fmu", "Tool", "1", "2", "0", "1"], [row[:6] for row in rows])
        self.assertIn(["violation", "a-rule", "2.2.7", "2.0.1", "7", "1"], rows)
        self.assertIn("3 FMUs: 1 with violations, 1 with defects only, 1 with neither; 1 without a run of the library; 0 not", printed)
        self.assertIn("below/clean.fmu", printed)

    def test_a_crash_a_panic_a_hang_and_chatter_are_mistakes_of_the_program(self):
        for name, said in [("crash", "signal 6"), ("panic", "exit code 101"), ("hang", "no end within"), ("chatter", "prints no report")]:
            with self.subTest(name):
                self.add(f"{name}.fmu")
                code, printed, _ = self.run_survey("--limit", "2")
                self.assertEqual(code, 1)
                self.assertIn(said, printed)
                self.assertIn("crashed or hung on 1.", printed)
                (self.fmus / f"{name}.fmu").unlink()

    def test_an_fmu_that_cannot_be_read_is_listed_with_the_reason(self):
        (self.fmus / "damaged.fmu").write_text("no zip")
        code, printed, _ = self.run_survey()
        self.assertEqual(code, 0)
        self.assertIn("damaged.fmu is not a zip archive", printed)
        self.assertIn("1 not checked in full", printed)

    def test_both_tables_of_csv_can_be_read_back(self):
        self.add("broken.fmu", tool='A, "B" | C')
        _, printed, _ = self.run_survey("--form", "csv", "--", "--no-run")
        first, second = [list(csv.DictReader(io.StringIO(part))) for part in printed.split("\n\n")]
        self.assertEqual((first[0]["FMU"], first[0]["tool"]), ("broken.fmu", 'A, "B" | C'))
        self.assertEqual([row["rule"] for row in second], ["a-rule", "c-rule"])

    def test_markdown_keeps_its_columns_whatever_the_cells_hold(self):
        self.add("broken.fmu", tool="A | B")
        _, printed, _ = self.run_survey("--form", "markdown")
        columns = [line.replace("\\|", "").count("|") for line in printed.splitlines() if line.startswith("|")]
        self.assertEqual(columns, [8] * 3 + [7] * 4)

    def test_tables_can_go_into_a_file(self):
        self.add("clean.fmu")
        target = self.folder / "survey.md"
        code, printed, _ = self.run_survey("--output", str(target))
        self.assertEqual((code, printed), (0, ""))
        self.assertIn("clean.fmu", target.read_text())

    def test_options_after_two_dashes_go_to_the_checker(self):
        self.add("options.fmu")
        _, printed, _ = self.run_survey("--", "--no-run", "--timeout", "5")
        self.assertIn("--no-run, --timeout, 5", printed)

    def test_a_survey_without_program_or_fmus_is_refused(self):
        code, _, complained = self.run_survey()
        self.assertEqual(code, 2)
        self.assertIn("there is no FMU", complained)
        self.add("clean.fmu")
        code, _, complained = self.run_survey("--program", "no-such-program")
        self.assertEqual(code, 2)
        self.assertIn("no-such-program", complained)


if __name__ == "__main__":
    unittest.main()
