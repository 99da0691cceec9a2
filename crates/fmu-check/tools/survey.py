#!/usr/bin/env python3
"""Checks all FMUs of a folder and prints a table of them and a summary by rule.

    python3 survey.py FOLDER
    python3 survey.py FOLDER --program target/release/fmu-check --form markdown --output survey.md -- --no-run

What follows `--` is passed to the program. Each FMU is checked by a process of its own with a limit on time. The exit
code is 0 unless the program crashed or hung (1): findings are the result of a survey, not its failure. It is 2 if the
survey cannot be made.
"""

import argparse
import csv
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from collections import Counter
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

CLASSES = ("violation", "defect", "hint")
FORMS = ("text", "markdown", "csv")
# Exit codes of a check that was carried out; 2 says that it could not be carried out in full.
CARRIED_OUT = (0, 1, 2, 3, 4)
INTERRUPTED = 130
# As much of modelDescription.xml as may precede the end of its root element's first tag, bytes.
BEGINNING = 1 << 20
# Notes of the program that say that no library was run.
NOT_RUN = ("nothing is run", "modelDescription.xml has no CoSimulation element")


class Unmade(Exception):
    """The survey cannot be made."""


class Check(NamedTuple):
    """What the program says about one FMU."""

    fmu: str
    tool: str
    seconds: float
    # Empty, or why there are no findings.
    failure: str
    # The program crashed, hung, or printed what is no report: its mistake, not the FMU's.
    is_mistake: bool
    # Numbers of violations, defects and hints.
    numbers: tuple
    findings: list
    # The library of the FMU was run.
    is_run: bool

    def rules(self):
        """The rules that the FMU breaks, each with the number of its findings."""
        count = Counter(finding["rule"] for finding in self.findings)
        return ", ".join(rule if number == 1 else f"{rule} ({number})" for rule, number in sorted(count.items()))


def generation_tool(path):
    """The tool that exported an FMU, as its model description says; empty if it does not say."""
    parser = ElementTree.XMLPullParser(["start"])
    try:
        with zipfile.ZipFile(path) as archive, archive.open("modelDescription.xml") as description:
            parser.feed(description.read(BEGINNING))
        _, root = next(iter(parser.read_events()))
    # An FMU may be broken in any way; the program says how.
    except Exception:
        return ""
    return " ".join(root.get("generationTool", "").split())


def check(program, path, name, options, limit):
    """Checks one FMU in a working folder of its own."""
    begin = time.monotonic()

    def failed(failure, is_mistake=True):
        return Check(name, tool, time.monotonic() - begin, failure, is_mistake, (0, 0, 0), [], False)

    tool = generation_tool(path)
    command = [program, "--format", "json", *options, str(path)]
    with tempfile.TemporaryDirectory() as folder:
        try:
            # What the program has started ends with it.
            done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return failed(f"hangs: no end within {limit:g} s")
    if done.returncode == INTERRUPTED:
        raise KeyboardInterrupt
    said = " ".join(done.stderr.decode(errors="replace").split())
    if done.returncode not in CARRIED_OUT:
        ended = f"signal {-done.returncode}" if done.returncode < 0 else f"exit code {done.returncode}"
        return failed(f"crashes ({ended}): {said}")
    try:
        report = json.loads(done.stdout)
        numbers = tuple(report[kind + "s"] for kind in CLASSES)
        findings = [{key: finding[key] for key in ("class", "rule", "section", "since")} for finding in report["findings"]]
        # Of many findings of a rule the report lists the first, and counts the others.
        for more in report["more"]:
            listed = next(one for one in findings if (one["class"], one["rule"]) == (more["class"], more["rule"]))
            findings += [listed] * more["count"]
        is_run = "--no-run" not in options and not any(note.startswith(NOT_RUN) for note in report["notes"])
    except (ValueError, KeyError, TypeError, StopIteration) as error:
        if done.returncode == 2:
            return failed(said or "cannot be checked", is_mistake=False)
        return failed(f"prints no report: {error!r}; {said}")
    failure = said if done.returncode == 2 else ""
    return Check(name, tool, time.monotonic() - begin, failure, False, numbers, findings, is_run)


def table_of_fmus(checks):
    yield ("FMU", "tool", "violations", "defects", "hints", "seconds", "rules")
    for made in checks:
        numbers = ("", "", "") if made.failure and not made.findings else made.numbers
        told = "; ".join(part for part in (made.failure, made.rules()) if part)
        yield (made.fmu, made.tool, *numbers, f"{made.seconds:.1f}", told)


def table_of_rules(checks):
    """Rules with their findings and FMUs: violations first, and those that most FMUs break first."""
    lines, fmus = Counter(), Counter()
    for made in checks:
        rules = [tuple(finding[key] or "" for key in ("class", "rule", "section", "since")) for finding in made.findings]
        lines.update(rules)
        fmus.update(set(rules))

    def order(rule):
        kind, name, *_ = rule
        return (CLASSES.index(kind) if kind in CLASSES else len(CLASSES), -fmus[rule], name)

    yield ("class", "rule", "section", "since", "findings", "FMUs")
    for rule in sorted(lines, key=order):
        yield (*rule, lines[rule], fmus[rule])


def totals(checks):
    """One sentence: how many FMUs there are of each kind."""
    violating = sum(made.numbers[0] > 0 for made in checks)
    defective = sum(made.numbers[0] == 0 and made.numbers[1] > 0 for made in checks)
    unchecked = sum(bool(made.failure) and not made.is_mistake for made in checks)
    mistakes = sum(made.is_mistake for made in checks)
    clean = sum(made.numbers[:2] == (0, 0) and not made.failure for made in checks)
    idle = sum(not made.is_run and not made.failure for made in checks)
    return (
        f"{len(checks)} FMUs: {violating} with violations, {defective} with defects only, {clean} with neither; "
        f"{idle} without a run of the library; {unchecked} not checked in full; the program crashed or hung on {mistakes}."
    )


def text(rows):
    rows = [[str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows)]
    return "".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() + "\n" for row in rows)


def markdown(rows):
    head, *body = ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |\n" for row in rows]
    return head + "|" + " --- |" * (head.replace("\\|", "").count("|") - 1) + "\n" + "".join(body)


def comma_separated(rows):
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(rows)
    return target.getvalue()


def survey(checks, form):
    """Both tables and the totals; CSV has the tables alone, with an empty line between them."""
    write = {"text": text, "markdown": markdown, "csv": comma_separated}[form]
    parts = [write(table_of_fmus(checks)), write(table_of_rules(checks))]
    if form != "csv":
        parts.append(totals(checks) + "\n")
    return "\n".join(parts)


def arguments(given):
    parser = argparse.ArgumentParser(
        description="Checks all FMUs of a folder and prints a table of them and a summary by rule.",
        usage="%(prog)s FOLDER [options] [-- options of the checker, such as --no-run]",
        epilog="Exit codes: 0 the survey is made, whatever it found; 1 the program crashed or hung on an FMU; 2 the survey cannot be made.",
    )
    parser.add_argument("folder", type=Path, help="folder of FMUs, with all folders below it")
    parser.add_argument("--program", default="fmu-check", help="the checker (fmu-check)")
    parser.add_argument("--limit", type=float, default=180.0, metavar="SECONDS", help="time limit for each FMU (180)")
    parser.add_argument("--form", choices=FORMS, default="text", help="form of the tables (text)")
    parser.add_argument("--output", type=Path, metavar="FILE", help="write the tables into this file")
    given, options = split(given)
    return argparse.Namespace(**vars(parser.parse_args(given)), options=options)


def split(given):
    """Arguments before and after the first `--`: of the survey, and of the checker."""
    at = given.index("--") if "--" in given else len(given)
    return given[:at], given[at + 1 :]


def make(options):
    """Checks all FMUs and writes the tables. Returns what was checked."""
    program = shutil.which(options.program)
    if program is None:
        raise Unmade(f"there is no program {options.program}; name it with --program")
    # Each check runs in another working folder.
    program = os.path.abspath(program)
    paths = sorted(path for path in options.folder.rglob("*") if path.suffix.lower() == ".fmu" and path.is_file())
    if not paths:
        raise Unmade(f"there is no FMU in {options.folder}")
    checks = []
    for number, path in enumerate(paths, 1):
        name = path.relative_to(options.folder).as_posix()
        if sys.stderr.isatty():
            print(f"{number} of {len(paths)}: {name}", file=sys.stderr)
        checks.append(check(program, path.resolve(), name, options.options, options.limit))
    made = survey(checks, options.form)
    if options.output is None:
        sys.stdout.write(made)
    else:
        options.output.write_text(made, encoding="utf-8")
    return checks


def main(given):
    try:
        checks = make(arguments(given))
    except (Unmade, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return INTERRUPTED
    return int(any(made.is_mistake for made in checks))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
