"""FMPy: an FMU alone by `simulate_fmu`, and two that are coupled by a loop of one's own.

    python fmpy_example.py set1.fmu
    python fmpy_example.py set1.fmu --drive drive.fmu
    python fmpy_example.py set1.fmu --drive drive.fmu --rates
"""

import shutil
from contextlib import ExitStack

from shared import REACTION, VELOCITY, Run, arguments, finish

try:
    import fmpy
    from fmpy.fmi2 import FMU2Slave
except ImportError as error:
    raise SystemExit(f"{error}: pip install fmpy") from None


def alone(given):
    result = fmpy.simulate_fmu(
        given.scene.path, stop_time=given.stop_time, output_interval=given.interval, start_values=given.values
    )
    names = [name for name in result.dtype.names if name != "time"]
    return Run(result["time"].tolist(), {name: result[name].astype(float).tolist() for name in names})


class Part:
    """An instance whose variables are known by name."""

    def __init__(self, fmu, name, stack):
        description = fmpy.read_model_description(fmu.path)
        folder = fmpy.extract(fmu.path)
        stack.callback(shutil.rmtree, folder)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.reals = [output.name for output in fmu.outputs("Real")]
        self.others = [output.name for output in fmu.outputs("Integer", "Enumeration")]
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()
        stack.callback(self.slave.freeInstance)
        self.slave.setupExperiment(startTime=0.0)

    def set(self, name, value):
        self.slave.setReal([self.references[name]], [value])

    def get(self, name):
        return self.slave.getReal([self.references[name]])[0]

    def set_rate(self, name, value):
        self.slave.setRealInputDerivatives([self.references[name]], [1], [value])

    def get_rate(self, name):
        return self.slave.getRealOutputDerivatives([self.references[name]], [1])[0]

    def row(self):
        reals = self.slave.getReal([self.references[name] for name in self.reals])
        others = self.slave.getInteger([self.references[name] for name in self.others])
        return dict(zip(self.reals, reals)) | dict(zip(self.others, map(float, others)))


def coupled(given):
    """Both go on at once, with each other's outputs of the step's beginning."""
    with ExitStack() as stack:
        scene, drive = Part(given.scene, "scene", stack), Part(given.drive, "drive", stack)
        for name, value in given.values.items():
            scene.set(name, value)

        def exchange():
            velocity, reaction = drive.get(VELOCITY[0]), scene.get(REACTION[0])
            scene.set(VELOCITY[1], velocity)
            drive.set(REACTION[1], reaction)

        def exchange_rates():
            scene.set_rate(VELOCITY[1], drive.get_rate(VELOCITY[0]))
            drive.set_rate(REACTION[1], scene.get_rate(REACTION[0]))

        for part in (scene, drive):
            part.slave.enterInitializationMode()
        # What one gives the other at the start can change what that one gives.
        for _ in range(2):
            exchange()
        for part in (scene, drive):
            part.slave.exitInitializationMode()

        times, rows = [], []
        for step in range(given.steps + 1):
            time = step * given.interval
            named = [("scene", scene), ("drive", drive)]
            rows.append({f"{prefix}.{name}": value for prefix, part in named for name, value in part.row().items()})
            times.append(time)
            if step < given.steps:
                exchange()
                if given.rates:
                    exchange_rates()
                for part in (scene, drive):
                    part.slave.doStep(time, (step + 1) * given.interval - time)
        for part in (scene, drive):
            part.slave.terminate()
    return Run(times, {name: [row[name] for row in rows] for name in rows[0]})


if __name__ == "__main__":
    given = arguments(f"FMPy {fmpy.__version__}", __doc__.splitlines()[0], rates=True)
    try:
        run = coupled(given) if given.drive else alone(given)
    except Exception as error:  # FMPy has no class of its own for what can go wrong; it has printed what the FMU says.
        raise SystemExit(f"FMPy: {error}") from None
    finish(given, run)
