"""What the examples share: their arguments, what an FMU's outputs are, what a run shows, and whether it is equal to
one without an importer."""

import argparse
import csv
import math
import struct
import zipfile
from typing import NamedTuple
from xml.etree import ElementTree

# The output of the drive and the input of the scene that it goes into, and the way back.
VELOCITY = ("contact.guide.slip_velocity", "slider.velocity")
REACTION = ("slider.tangential_reaction", "mass.table.fx")


class Run(NamedTuple):
    """Values over time: a list for each name, as long as `times`."""

    times: list
    columns: dict
    # Why rows or columns of the run without an importer have nothing here to be compared with.
    missing: dict = {}


class Output(NamedTuple):
    """A variable as modelDescription.xml has it."""

    name: str
    kind: str
    reference: int


def arguments(importer, description, rates=False):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene", help="an FMU with contacts on a slider, set1.fmu")
    parser.add_argument("--drive", help="an FMU that moves the slider and takes the reaction, drive.fmu")
    parser.add_argument("--stop-time", type=float, default=0.1, help="s (0.1)")
    parser.add_argument("--interval", type=float, default=1e-4, help="time between communication points, s (1e-4)")
    parser.add_argument("--set", type=start_value, action="append", default=[], metavar="NAME=VALUE",
                        help="a start value of the scene; may be repeated")
    parser.add_argument("--compare", metavar="CSV", help="the same run without an importer")
    if rates:
        parser.add_argument("--rates", action="store_true", help="exchange rates of change too, with --drive")
    given = parser.parse_args()
    given.importer, given.values = importer, dict(given.set)
    given.steps = round(given.stop_time / given.interval)
    return given


def start_value(text):
    name, _, value = text.partition("=")
    return name, float(value)


def outputs(fmu):
    """The outputs of an FMU, in its order."""
    with zipfile.ZipFile(fmu) as archive:
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return [
        Output(variable.get("name"), variable[0].tag, int(variable.get("valueReference")))
        for variable in description.find("ModelVariables")
        if variable.get("causality") == "output"
    ]


def finish(given, run):
    """Prints what a run shows and, where asked, the comparison; ends the program, with 1 where the two differ."""
    partner = f", coupled to {given.drive}" if given.drive else ""
    print(f"{given.scene} through {given.importer}{partner}")
    scene = "scene." if given.drive else ""
    print(f"  rows               {len(run.times)}, to {run.times[-1]:.6g} s")
    if given.drive:
        show("slider velocity", "m/s", [run.columns["drive." + VELOCITY[0]]])
    show("reaction on slider", "N", [run.columns[scene + REACTION[0]]])
    show("normal forces", "N", [
        column for name, column in run.columns.items() if name.startswith(scene) and name.endswith(".normal_force")
    ])
    changes = run.columns[scene + "statistics.state_changes"]
    third = len(run.times) // 3
    name, motion = next((name, c) for name, c in run.columns.items() if name.endswith(".v1"))
    early, late = (max(map(abs, part)) for part in (motion[:third], motion[-third:]))
    print(f"  {name:18} at most {early:.3g} m/s in the first third, {late:.3g} in the last")
    lately = changes[-1] - changes[-third]
    verdict = "squeals" if lately else "grows" if late > early else "decays"
    print(f"  contact states     {changes[-1]:.0f} changes, {lately:.0f} in the last third: it {verdict}")
    if given.compare is None:
        raise SystemExit(0)
    found = differences(read(given.compare), run)
    values = len(run.times) * len(run.columns)
    print(f"  equal to {given.compare} to the last bit: {'NO' if found else f'yes, all {values} values'}")
    for line in found or [f"not compared: {name}, {reason}" for name, reason in run.missing.items()]:
        print(f"    {line}")
    raise SystemExit(1 if found else 0)


def show(what, unit, columns):
    low, high = min(map(min, columns)), max(map(max, columns))
    print(f"  {what:18} {low:.6g} to {high:.6g} {unit}")


def read(file):
    """The CSV file of a run without an importer. Python's float reads the double that was written."""
    with open(file, newline="") as lines:
        names, *rows = csv.reader(lines)
    times, *columns = ([float(value) for value in column] for column in zip(*rows))
    return Run(times, dict(zip(names[1:], columns)))


def differences(expected, run):
    """What keeps a run from being equal to the expected one to the last bit, in words; empty where nothing does.

    Times may differ by the rounding of an importer's own clock: they say which rows belong together, no more.
    """
    if "first row" in run.missing:
        expected = Run(expected.times[1:], {name: column[1:] for name, column in expected.columns.items()})
    names = expected.columns.keys() - run.missing.keys()
    if names != run.columns.keys():
        return [f"other columns: {', '.join(sorted(names ^ run.columns.keys()))}"]
    if not names or len(expected.times) < 2 or len(expected.times) != len(run.times):
        return [f"{len(run.times)} rows in place of {len(expected.times)}"]
    interval = min(b - a for a, b in zip(expected.times, expected.times[1:]))
    for there, here in zip(expected.times, run.times):
        if not abs(there - here) <= 1e-6 * interval:
            return [f"a row at {here!r} s in place of {there!r} s"]
    found = []
    for name, column in expected.columns.items():
        if name in run.missing:
            continue
        pairs = enumerate(zip(column, run.columns[name]))
        wrong = [row for row, (a, b) in pairs if not math.isfinite(a) or struct.pack("d", a) != struct.pack("d", b)]
        if wrong:
            row = wrong[0]
            found.append(f"{name} in {len(wrong)} rows, first at {expected.times[row]!r} s: "
                         f"{run.columns[name][row]!r} in place of {column[row]!r}")
    return found
