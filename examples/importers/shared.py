"""What the examples share: their arguments, a look at the FMUs before an importer has them, what a run shows, and
whether it is equal to one without an importer. What a user can mend ends the program with a sentence."""

import argparse
import csv
import math
import platform
import re
import struct
import zipfile
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

# The output of the drive and the input of the scene that it goes into, and the way back.
VELOCITY = ("contact.guide.slip_velocity", "slider.velocity")
REACTION = ("slider.tangential_reaction", "mass.table.fx")

# The folder of an FMU's library for this machine.
PLATFORM = {"Linux": "linux64", "Windows": "win64", "Darwin": "darwin64"}.get(platform.system(), platform.system())


class Run(NamedTuple):
    """Values over time: a list for each name, as long as `times`."""

    times: list
    columns: dict
    # Names of outputs that the importer does not read; all are enumerations.
    unread: list = []
    # Whether the first row is that of 0 s.
    from_start: bool = True
    # What else to look at where the comparison says no.
    hint: str = ""


class Variable(NamedTuple):
    """A variable as modelDescription.xml has it."""

    name: str
    causality: str
    kind: str
    reference: int


class Fmu:
    """An FMU file that this machine can run, and its variables."""

    def __init__(self, file):
        self.file, self.path = file, str(Path(file).resolve())
        if not Path(file).exists():
            raise SystemExit(f"{file}: there is no such file")
        if Path(file).is_dir():
            raise SystemExit(f"{file}: this is a folder, not an FMU")
        try:
            with zipfile.ZipFile(file) as archive:
                entries = archive.namelist()
                description = ElementTree.fromstring(archive.read("modelDescription.xml"))
        except (OSError, zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
            raise SystemExit(f"{file}: this is not an FMU: {error}") from None
        if description.get("fmiVersion") != "2.0":
            raise SystemExit(f"{file}: this is not an FMU of FMI 2.0 but of {description.get('fmiVersion')}")
        libraries = sorted({entry.split("/")[1] for entry in entries if re.match("binaries/.+/", entry)})
        if PLATFORM not in libraries:
            has = ", ".join(libraries) or "none"
            raise SystemExit(f"{file}: the FMU has no library for {PLATFORM}; it has {has}")
        self.variables = {
            v.get("name"): Variable(v.get("name"), v.get("causality"), v[0].tag, int(v.get("valueReference")))
            for v in description.find("ModelVariables")
        }

    def outputs(self, *kinds):
        """Its outputs of these kinds, in its order; all where no kind is named."""
        outputs = [v for v in self.variables.values() if v.causality == "output"]
        return [v for v in outputs if v.kind in kinds or not kinds]

    def must_have(self, name, *causalities, hint=""):
        """Ends the program where there is no such real variable."""
        found = self.variables.get(name)
        if found is None or found.kind != "Real" or found.causality not in causalities:
            raise SystemExit(f"{name}: {self.file} has no such {' or '.join(causalities)}{hint}")


def arguments(importer, description, rates=False):
    """The command line, with all that can be checked before the run."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene", help="the FMU, set1.fmu")
    parser.add_argument("--drive", help="an FMU that moves the slider and takes the reaction, drive.fmu")
    parser.add_argument("--stop-time", type=float, default=0.1, help="s (0.1)")
    parser.add_argument("--interval", type=float, default=1e-4, help="time between communication points, s (1e-4)")
    parser.add_argument("--set", type=start_value, action="append", default=[], metavar="NAME=VALUE",
                        help="start value of a variable of the scene; may be repeated")
    parser.add_argument("--compare", metavar="CSV", help="CSV file of the same run without an importer")
    if rates:
        parser.add_argument("--rates", action="store_true", help="exchange rates of change too, with --drive")
    given = parser.parse_args()
    given.importer, given.values = importer, dict(given.set)
    if not (0 < given.interval <= given.stop_time < math.inf):
        parser.error("--interval must be above 0, and --stop-time at least as long")
    given.steps = round(given.stop_time / given.interval)
    if not math.isclose(given.steps * given.interval, given.stop_time):
        parser.error(f"--stop-time {given.stop_time} is not a whole multiple of --interval {given.interval}")
    if rates and given.rates and not given.drive:
        parser.error("--rates needs --drive: one FMU alone exchanges nothing")

    given.scene = Fmu(given.scene)
    for name in given.values:
        given.scene.must_have(name, "parameter", "input")
    if given.drive:
        given.drive = Fmu(given.drive)
        hint = "; a coupling needs the FMU of a scene with a slider first, and --drive drive.fmu"
        for fmu, output, into in [(given.scene, REACTION[0], VELOCITY[1]), (given.drive, VELOCITY[0], REACTION[1])]:
            fmu.must_have(output, "output", hint=hint)
            fmu.must_have(into, "input", hint=hint)
    given.expected = read(given.compare) if given.compare else None
    return given


def start_value(text):
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: write it as NAME=VALUE, with a number") from None


def finish(given, run):
    """Prints what a run shows and, where asked, the comparison; ends the program, with 1 where the two differ."""
    partner = f", coupled to {given.drive.file}" if given.drive else ""
    print(f"{given.scene.file} through {given.importer}{partner}")
    line("rows", f"{len(run.times)}, to {run.times[-1]:.6g} s")
    scene = "scene." if given.drive else ""
    if given.drive:
        line("slider velocity", extremes([run.columns["drive." + VELOCITY[0]]], "m/s"))
    if scene + REACTION[0] in run.columns:
        line("reaction on slider", extremes([run.columns[scene + REACTION[0]]], "N"))
    own = {name: column for name, column in run.columns.items() if name.startswith(scene)}
    forces = [column for name, column in own.items() if name.endswith(".normal_force")]
    if forces:
        line("normal forces", extremes(forces, "N"))
    third = max(1, len(run.times) // 3)
    for name in [name for name in own if name.endswith((".v1", ".vx", ".vy"))][:1]:
        early, late = (max(map(abs, part)) for part in (own[name][:third], own[name][-third:]))
        line(name, f"at most {early:.3g} m/s in the first third, {late:.3g} in the last")
    changes = own.get(scene + "statistics.state_changes")
    if changes:
        lately = changes[-1] - changes[-third]
        line("contact states", f"{changes[-1]:.0f} changes, {lately:.0f} of them in the last third")
    if given.expected is None:
        raise SystemExit(0)

    found = differences(given.expected, run)
    values = len(run.times) * len(run.columns)
    print(f"  equal to {given.compare} to the last bit: {'NO' if found else f'yes, all {values} values'}")
    for text in found[:10]:
        print(f"    {text}")
    if len(found) > 10:
        print(f"    and {len(found) - 10} more")
    if found:
        print(f"  check that both runs used the same FMUs, --set, --stop-time and --interval{run.hint}")
        raise SystemExit(1)
    if run.unread:
        unread = f"{len(run.unread)} enumerations (contact states)"
        print(f"    not compared: {unread}, which {given.importer} does not read")
    if not run.from_start:
        print(f"    not compared: the row of 0 s, which {given.importer} does not show")
    raise SystemExit(0)


def line(what, value):
    print(f"  {what:18} {value}")


def extremes(columns, unit):
    return f"{min(map(min, columns)):.6g} to {max(map(max, columns)):.6g} {unit}"


def read(file):
    """The CSV file of a run without an importer. Python's float reads the double that was written."""
    try:
        with open(file, newline="") as lines:
            names, *rows = csv.reader(lines)
        times, *columns = ([float(value) for value in column] for column in zip(*rows, strict=True))
    except FileNotFoundError:
        raise SystemExit(f"{file}: there is no such file") from None
    except (OSError, ValueError) as error:
        raise SystemExit(f"{file}: this is not a CSV file of a run: {error}") from None
    return Run(times, dict(zip(names[1:], columns)))


def differences(expected, run):
    """What keeps a run from being equal to the expected one to the last bit, in words; empty where nothing does.

    Times may differ by the rounding of an importer's own clock: they say which rows belong together, no more.
    """
    if not run.from_start:
        expected = Run(expected.times[1:], {name: column[1:] for name, column in expected.columns.items()})
    names = expected.columns.keys() - set(run.unread)
    if names != run.columns.keys():
        return [f"{name} is only in one of the two" for name in sorted(names ^ run.columns.keys())]
    if not names or len(expected.times) < 2 or len(expected.times) != len(run.times):
        return [f"{len(run.times)} rows instead of {len(expected.times)}"]
    interval = min(b - a for a, b in zip(expected.times, expected.times[1:]))
    for there, here in zip(expected.times, run.times):
        if not abs(there - here) <= 1e-6 * interval:
            return [f"a row at {here!r} s instead of {there!r} s"]
    found = []
    for name, here in run.columns.items():
        pairs = enumerate(zip(expected.columns[name], here))
        wrong = [row for row, (a, b) in pairs if not math.isfinite(a) or struct.pack("d", a) != struct.pack("d", b)]
        if wrong:
            row = wrong[0]
            found.append(f"{name} in {len(wrong)} rows, first at {expected.times[row]!r} s: "
                         f"{here[row]!r} instead of {expected.columns[name][row]!r}")
    return found
