"""libcosimpy, the Python side of the Open Simulation Platform: an FMU alone, and two that are coupled.

    python libcosimpy_example.py set1.fmu
    python libcosimpy_example.py set1.fmu --drive drive.fmu
"""

from importlib.metadata import version

from shared import REACTION, VELOCITY, Run, arguments, finish

try:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
except ImportError as error:
    raise SystemExit(f"{error}: pip install libcosimpy") from None

NANOSECOND = 1e-9  # s; libcosim counts its time in whole ones


class Part:
    """A slave of an execution whose variables are known by name."""

    def __init__(self, execution, fmu, name):
        self.reals, self.integers = fmu.outputs("Real"), fmu.outputs("Integer")
        self.unread = [output.name for output in fmu.outputs("Enumeration")]
        # Kept: the slave of an execution must outlive it.
        self.slave = CosimLocalSlave(fmu_path=fmu.path, instance_name=name)
        self.index = execution.add_local_slave(self.slave)
        self.references = {v.name.decode(): v.reference for v in execution.slave_variables(self.index)}

    def row(self, observer):
        values = observer.last_real_values(self.index, [output.reference for output in self.reals])
        counts = observer.last_integer_values(self.index, [output.reference for output in self.integers])
        names = [output.name for output in self.reals + self.integers]
        return dict(zip(names, map(float, values + counts)))


def simulate(given):
    execution = CosimExecution.from_step_size(step_size=round(given.interval / NANOSECOND))
    parts = {"": Part(execution, given.scene, "scene")}
    if given.drive:
        parts = {"scene.": parts[""], "drive.": Part(execution, given.drive, "drive")}
        scene, drive = parts.values()
        for source, sink, (output, into) in [(drive, scene, VELOCITY), (scene, drive, REACTION)]:
            execution.connect_real_variables(
                source.index, source.references[output], sink.index, sink.references[into]
            )
    scene = next(iter(parts.values()))
    for name, value in given.values.items():
        assert execution.real_initial_value(scene.index, scene.references[name], value), name
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)

    times, rows = [], []
    for _ in range(given.steps):
        if not execution.step():
            raise SystemExit(f"a step failed at {execution.status().current_time * NANOSECOND} s")
        times.append(execution.status().current_time * NANOSECOND)
        rows.append({prefix + n: v for prefix, part in parts.items() for n, v in part.row(observer).items()})
    unread = [prefix + name for prefix, part in parts.items() for name in part.unread]
    # libcosim initializes with its first step: there is nothing to be read before.
    return Run(times, {name: [row[name] for row in rows] for name in rows[0]}, unread, from_start=False)


if __name__ == "__main__":
    log_output_level(CosimLogLevel.ERROR)
    given = arguments(f"libcosimpy {version('libcosimpy')}", __doc__.splitlines()[0])
    finish(given, simulate(given))
