"""ecospy, the Python side of ecos: an FMU alone, and two that are coupled.

    python ecospy_example.py set1.fmu
    python ecospy_example.py set1.fmu --drive drive.fmu
"""

import os
import re
import sys
import tempfile
from contextlib import contextmanager
from importlib.metadata import version

from shared import REACTION, VELOCITY, Run, arguments, finish

try:
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
except (ImportError, OSError) as error:  # OSError: a library that its own needs is not there
    raise SystemExit(f"{error}: pip install ecospy, and Debian's libtbb12") from None


@contextmanager
def errors_end_the_program():
    """ecos goes on where a call of an FMU fails; only its log of level debug, on standard output, says so."""
    sys.stdout.flush()
    standard_output = os.dup(1)
    with tempfile.TemporaryFile() as log:
        os.dup2(log.fileno(), 1)
        EcosLib.set_log_level("debug")
        try:
            yield
        finally:
            EcosLib.set_log_level("warn")
            os.dup2(standard_output, 1)
            os.close(standard_output)
        log.seek(0)
        said = log.read().decode(errors="replace")
    # The first one is the reason, and the others follow from it.
    failed = re.search(r"\[debug\] \[(.*)\] fmi2(?:Error|Fatal|Discard) (.*)", said)
    if failed:
        raise SystemExit(f"{os.path.relpath(failed[1])}: {failed[2]}")


def simulate(given):
    fmus = {"scene": given.scene} | ({"drive": given.drive} if given.drive else {})
    structure = EcosSimulationStructure()
    for name, fmu in fmus.items():
        structure.add_model(name, fmu.path)
    if given.drive:
        structure.make_real_connection(f"drive::{VELOCITY[0]}", f"scene::{VELOCITY[1]}")
        structure.make_real_connection(f"scene::{REACTION[0]}", f"drive::{REACTION[1]}")
    if given.values:
        structure.add_parameter_set("start", {f"scene::{name}": value for name, value in given.values.items()})

    def names(kind):
        """Names of outputs as ecos has them, with those of the columns."""
        known = [(part, output.name) for part, fmu in fmus.items() for output in fmu.outputs(kind)]
        return {f"{part}::{name}": f"{part}.{name}" if given.drive else name for part, name in known}

    reals, counts, states = names("Real"), names("Integer"), names("Enumeration")
    times, rows = [], []
    with errors_end_the_program(), EcosSimulation(structure=structure, step_size=given.interval) as simulation:
        simulation.init(parameter_set="start" if given.values else None)
        for step in range(given.steps + 1):
            # Steps are counted: step_until adds them up, and rounding decides about the last one.
            if step:
                simulation.step()
            times.append(simulation.get_time())
            row = {column: simulation.get_real(name) for name, column in reals.items()}
            rows.append(row | {column: float(simulation.get_integer(name)) for name, column in counts.items()})
        simulation.terminate()
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    hint = ", and with --rows after" if given.drive else ""
    return Run(times, columns, list(states.values()), hint=hint)


if __name__ == "__main__":
    EcosLib.set_log_level("warn")
    given = arguments(f"ecospy {version('ecospy')}", __doc__.splitlines()[0])
    finish(given, simulate(given))
