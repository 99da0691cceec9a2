"""ecospy, the Python side of ecos: an FMU alone, and two that are coupled.

    python ecospy_example.py set1.fmu
    python ecospy_example.py set1.fmu --drive drive.fmu
"""

from importlib.metadata import version
from pathlib import Path

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
from shared import REACTION, VELOCITY, Run, arguments, finish, outputs


def simulate(given):
    fmus = {"scene": given.scene} | ({"drive": given.drive} if given.drive else {})
    structure = EcosSimulationStructure()
    for name, fmu in fmus.items():
        if not Path(fmu).is_file():
            raise SystemExit(f"there is no file {fmu}")
        structure.add_model(name, str(Path(fmu).resolve()))
    if given.drive:
        structure.make_real_connection(f"drive::{VELOCITY[0]}", f"scene::{VELOCITY[1]}")
        structure.make_real_connection(f"scene::{REACTION[0]}", f"drive::{REACTION[1]}")
    if given.values:
        structure.add_parameter_set("start", {f"scene::{name}": value for name, value in given.values.items()})

    known = {f"{name}::{output.name}": output.kind for name, fmu in fmus.items() for output in outputs(fmu)}
    read = {name: kind for name, kind in known.items() if kind in ("Real", "Integer")}

    def column(name):
        return name.replace("::", ".") if given.drive else name.removeprefix("scene::")

    times, rows = [], []
    with EcosSimulation(structure=structure, step_size=given.interval) as simulation:
        simulation.init(parameter_set="start" if given.values else None)
        for step in range(given.steps + 1):
            # Steps are counted: step_until adds them up, and rounding decides about the last one.
            if step:
                simulation.step()
            times.append(simulation.get_time())
            get = {"Real": simulation.get_real, "Integer": simulation.get_integer}
            rows.append({column(name): float(get[kind](name)) for name, kind in read.items()})
        # ecos goes on, with zeros, where an FMU refuses to start, and ignores start values that there are not.
        for name, value in given.values.items():
            if simulation.get_real(f"scene::{name}") != value:
                raise SystemExit(f"{name} is {simulation.get_real(f'scene::{name}')!r} in place of {value!r}")
        simulation.terminate()
    for name, fmu in fmus.items():
        if not any(rows[-1][column(known_name)] for known_name in read if known_name.startswith(f"{name}::")):
            raise SystemExit(f"{fmu} refused to start; FMPy tells why")
    missing = {column(name): "ecos reads no enumerations" for name in known.keys() - read.keys()}
    return Run(times, {name: [row[name] for row in rows] for name in rows[0]}, missing)


if __name__ == "__main__":
    EcosLib.set_log_level("warn")
    given = arguments(f"ecospy {version('ecospy')}", __doc__.splitlines()[0])
    finish(given, simulate(given))
