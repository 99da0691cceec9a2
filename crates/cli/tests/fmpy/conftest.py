"""What the tests share: the FMUs, runs of the program without an importer, and instances through
FMPy's low-level calls.

`cargo test --test importers` runs these tests. To run one by hand, set AMONTONS to the program,
AMONTONS_INTEGRATOR to one that it has, AMONTONS_FMUS to a folder with the FMUs of all built-in scenes and
of those in scenes/effects/ exported with that integrator, and call pytest.
"""

import itertools
import os
import subprocess
from ctypes import byref, c_size_t, create_string_buffer
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
    fmi2FMUstate,
    fmi2OK,
    fmi2Real,
    fmi2ValueReference,
)
from fmpy.logging import addLoggerProxy


def environment(name):
    if name not in os.environ:
        pytest.exit(f"{name} is not set; run `cargo test --test importers`, or see conftest.py", 2)
    return os.environ[name]


# The names of all exported scenes, and the files of those that are not built in.
SCENES = sorted(file.stem for file in Path(environment("AMONTONS_FMUS")).glob("*.fmu"))
EFFECTS = {
    file.stem: file
    for file in (Path(__file__).parents[4] / "scenes" / "effects").glob("*.toml")
    if file.stem in SCENES
}
# With which all runs and FMUs are made, and the internal step of the rings, s.
INTEGRATOR = environment("AMONTONS_INTEGRATOR")
STEP = {"forward-increment": 1e-6, "event-driven": 1e-5}[INTEGRATOR]

first_order = pytest.mark.skipif(
    INTEGRATOR != "forward-increment", reason="of the paper's scheme, which is of first order"
)


# ---- Tables and their comparison ----


class Table(NamedTuple):
    """Values over time, one column a name."""

    times: np.ndarray
    columns: dict

    def __getitem__(self, name):
        return self.columns[name]

    def part(self, rows):
        """The rows that a mask, a slice or a list picks."""
        return Table(self.times[rows], {name: c[rows] for name, c in self.columns.items()})


def find_differences(expected, actual):
    """What keeps two tables from being equal to the last bit, in words; empty where nothing does.

    FMPy's own validate_result allows a tenth of a signal's range.
    """
    if expected.columns.keys() != actual.columns.keys():
        return [f"columns: {sorted(expected.columns.keys() ^ actual.columns.keys())}"]
    if not len(expected.times):
        return ["no rows to compare"]
    if expected.times.tobytes() != actual.times.tobytes():
        return [f"times: {expected.times} against {actual.times}"]
    found = []
    for name, column in expected.columns.items():
        bits = [np.ascontiguousarray(c, float).view(np.int64) for c in (column, actual[name])]
        rows = np.flatnonzero(bits[0] != bits[1])
        if len(rows):
            row = rows[0]
            found.append(
                f"{name} in {len(rows)} rows, first at {expected.times[row]!r} s: "
                f"{float(column[row])!r} against {float(actual[name][row])!r}"
            )
    return found


@pytest.fixture
def differences():
    return find_differences


@pytest.fixture
def assert_same():
    def check(expected, actual):
        found = find_differences(expected, actual)
        if found:
            pytest.fail("\n".join(found))

    return check


# ---- The program ----


@pytest.fixture(scope="session")
def amontons():
    """Runs the program, with environment variables given by name; gives what it prints."""
    program = environment("AMONTONS")

    def run(*arguments, **variables):
        command = [program, *map(str, arguments)]
        if arguments[0] in ("simulate", "export"):
            command += ["--integrator", INTEGRATOR]
            if INTEGRATOR == "event-driven" and not any("integrator.step" in a for a in command):
                command += ["--step", repr(STEP)]
        settings = {**os.environ, **variables}
        done = subprocess.run(command, env=settings, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def native(amontons, tmp_path_factory):
    """A run of `amontons simulate` as a table."""
    folder = tmp_path_factory.mktemp("native")
    numbers = itertools.count()

    def simulate(scene, stop_time, interval, values=None, inputs=None):
        file = folder / f"{next(numbers)}.csv"
        settings = [f"--set={name}={value!r}" for name, value in (values or {}).items()]
        times = ["--stop-time", repr(stop_time), "--output-interval", repr(interval)]
        if inputs is not None:
            settings += ["--input", inputs]
        amontons("simulate", EFFECTS.get(scene, scene), *times, *settings, "-o", file)
        names, *rows = (line.split(",") for line in file.read_text().splitlines())
        # Python's float reads the double that the program wrote; NumPy's readers promise less.
        columns = np.array([[float(value) for value in row] for row in rows]).T
        return Table(columns[0], dict(zip(names[1:], columns[1:])))

    return simulate


# ---- FMUs and instances ----


class Message(NamedTuple):
    """What an instance told its logger."""

    environment: int
    instance: str
    status: int
    category: str
    text: str


_messages = []


@fmi2CallbackLoggerTYPE
def _logger(component_environment, instance, status, category, text):
    strings = (value.decode("utf-8") for value in (category, text))
    _messages.append(
        Message(component_environment or 0, instance.decode("utf-8"), status, *strings)
    )


class Fmu:
    """An unpacked FMU."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.description = fmpy.read_model_description(str(self.folder))
        self.xml = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        variables = self.description.modelVariables
        self.variables = {variable.name: variable for variable in variables}
        self.outputs = [variable.name for variable in variables if variable.causality == "output"]
        self.library = next((self.folder / "binaries" / fmpy.platform).glob("*.*"))


class Instance:
    """An instance through FMPy's low-level calls. Calls named after FMI give the status, whatever
    it is; the others assert that it is OK."""

    _environments = itertools.count(1)

    def __init__(
        self,
        fmu,
        name="instance",
        kind=fmi2CoSimulation,
        guid=None,
        resources=...,
        logger=_logger,
        logging_on=False,
    ):
        self.fmu = fmu
        self.time = 0.0
        self.environment = next(self._environments)
        guid = fmu.description.guid if guid is None else guid
        self.slave = FMU2Slave(
            guid=guid,
            unzipDirectory=str(fmu.folder),
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.callbacks = fmi2CallbackFunctions(componentEnvironment=self.environment)
        if logger is not None:
            self.callbacks.logger = logger
            # Formats each message with its arguments, as a host in C does.
            addLoggerProxy(byref(self.callbacks))
        if resources is ...:
            resources = (fmu.folder / "resources").as_uri()
        self.component = self.slave.fmi2Instantiate(
            name.encode(),
            kind,
            guid.encode(),
            None if resources is None else resources.encode(),
            byref(self.callbacks),
            False,
            logging_on,
        )
        # FMPy's own getters go by it.
        self.slave.component = self.component

    @property
    def messages(self):
        return [message for message in _messages if message.environment == self.environment]

    @property
    def reason(self):
        """The last message."""
        return self.messages[-1].text if self.messages else ""

    def call(self, name, *arguments):
        try:
            return getattr(self.slave, f"fmi2{name}")(self.component, *arguments)
        except FMICallException as error:
            return error.status

    def SetupExperiment(self, start=0.0, stop=None):
        return self.call("SetupExperiment", False, 0.0, start, stop is not None, stop or 0.0)

    def EnterInitializationMode(self):
        return self.call("EnterInitializationMode")

    def ExitInitializationMode(self):
        return self.call("ExitInitializationMode")

    def Terminate(self):
        return self.call("Terminate")

    def Reset(self):
        return self.call("Reset")

    def DoStep(self, time, size):
        return self.call("DoStep", time, size, True)

    def SetReal(self, references, values):
        count = len(references)
        references = (fmi2ValueReference * count)(*references)
        return self.call("SetReal", references, count, (fmi2Real * count)(*values))

    def GetReal(self, references):
        """Status and values."""
        count = len(references)
        values = (fmi2Real * count)()
        references = (fmi2ValueReference * count)(*references)
        return self.call("GetReal", references, count, values), list(values)

    def Set(self, values):
        """SetReal by names."""
        references = [self.fmu.variables[name].valueReference for name in values]
        return self.SetReal(references, values.values())

    def GetFMUstate(self, state=None):
        """Status and state."""
        state = fmi2FMUstate() if state is None else state
        return self.call("GetFMUstate", byref(state)), state

    def SetFMUstate(self, state):
        return self.call("SetFMUstate", state)

    def DeSerializeFMUstate(self, content):
        """Status and state."""
        state = fmi2FMUstate()
        buffer = create_string_buffer(content, len(content))
        return self.call("DeSerializeFMUstate", buffer, len(content), byref(state)), state

    def serialize(self, state):
        size = c_size_t()
        assert self.call("SerializedFMUstateSize", state, byref(size)) == fmi2OK
        buffer = create_string_buffer(size.value)
        assert self.call("SerializeFMUstate", state, buffer, size) == fmi2OK
        return buffer.raw

    def free_state(self, state):
        assert self.call("FreeFMUstate", byref(state)) == fmi2OK

    def initialize(self, values=None, start=0.0):
        assert self.SetupExperiment(start) == fmi2OK
        given = {"parameter": {}, "input": {}}
        for name, value in (values or {}).items():
            given[self.fmu.variables[name].causality][name] = value
        assert self.Set(given["parameter"]) == fmi2OK, self.reason
        assert self.EnterInitializationMode() == fmi2OK
        # Inputs no sooner than FMI has it.
        assert self.Set(given["input"]) == fmi2OK, self.reason
        assert self.ExitInitializationMode() == fmi2OK, self.reason
        self.time = start
        return self

    def read(self, names):
        """Values of reals, integers and enumerations, all as doubles."""
        values = {}
        for kind in ("Real", "Integer"):
            group = [n for n in names if (self.fmu.variables[n].type == "Real") == (kind == "Real")]
            references = [self.fmu.variables[name].valueReference for name in group]
            values.update(zip(group, getattr(self.slave, f"get{kind}")(references)))
        return [float(values[name]) for name in names]

    def advance(self, times, names=None, at=None):
        """Steps to all times; a table of those in `at`, by default of all and the present one."""
        names = self.fmu.outputs if names is None else names
        wanted = None if at is None else set(at)
        kept = [self.time] if wanted is None or self.time in wanted else []
        rows = [self.read(names)] if kept else []
        for time in times:
            status = self.DoStep(self.time, time - self.time)
            assert status == fmi2OK, (time, self.reason)
            self.time = time
            if wanted is None or time in wanted:
                kept.append(time)
                rows.append(self.read(names))
        columns = np.array(rows).reshape(len(kept), len(names)).T
        return Table(np.array(kept), dict(zip(names, columns)))

    def free(self):
        if self.component:
            self.slave.fmi2FreeInstance(self.component)
            self.component = None


@pytest.fixture(scope="session")
def fmus():
    """The FMU files by the names of their scenes."""
    folder = Path(environment("AMONTONS_FMUS"))
    return {scene: folder / f"{scene}.fmu" for scene in SCENES}


@pytest.fixture(scope="session")
def unpacked(fmus, tmp_path_factory):
    """The unpacked FMU of a scene."""
    known = {}

    def unpack(scene):
        if scene not in known:
            folder = tmp_path_factory.mktemp(scene)
            known[scene] = Fmu(fmpy.extract(str(fmus[scene]), folder))
        return known[scene]

    return unpack


@pytest.fixture
def fmu_in():
    """The FMU that was unpacked into a folder."""
    return Fmu


@pytest.fixture
def imported(unpacked):
    """A run by FMPy's own simulate_fmu as a table."""

    def simulate(fmu, stop_time, interval, values=None, inputs=None):
        fmu = unpacked(fmu) if isinstance(fmu, str) else fmu
        settings = {"stop_time": stop_time, "output_interval": interval}
        if inputs is not None:
            settings["input"] = fmpy.read_csv(inputs)
        result = fmpy.simulate_fmu(str(fmu.folder), start_values=values or {}, **settings)
        return Table(result["time"], {n: result[n] for n in result.dtype.names if n != "time"})

    return simulate


@pytest.fixture
def instance(unpacked):
    """Makes instances of a scene's FMU, or of an unpacked one, that end with the test."""
    made = []

    def instantiate(fmu, **arguments):
        fmu = unpacked(fmu) if isinstance(fmu, str) else fmu
        made.append(Instance(fmu, **arguments))
        return made[-1]

    yield instantiate
    for one in made:
        one.free()
    _messages.clear()
