"""The files of `amontons export --with-reference`, read as their rules say: FMPy's run with `_in.csv` and the options
in `_ref.opt` gives `_ref.csv`, to the last bit."""

import fmpy
import numpy as np
import pytest
from conftest import EFFECTS, SCENES, Table


def options(path):
    pairs = (line.split(",") for line in path.read_text().splitlines())
    return {key.strip(): value.strip() for key, value in pairs}


def table(path):
    """A CSV with quoted names, read by Python's own float."""
    names, *rows = (line.split(",") for line in path.read_text().splitlines())
    assert all(name.startswith('"') and name.endswith('"') for name in names)
    columns = np.array([[float(value) for value in row] for row in rows]).T
    names = [name.strip('"') for name in names]
    assert names[0] == "time"
    return Table(columns[0], dict(zip(names[1:], columns[1:])))


@pytest.fixture(scope="module", params=SCENES)
def exported(request, amontons, tmp_path_factory):
    fmu = tmp_path_factory.mktemp("exported") / f"{request.param}.fmu"
    amontons("export", EFFECTS.get(request.param, request.param), "-o", fmu, "--with-reference")
    return fmu


def run(fmu):
    """As an importer that takes part in the cross-check."""
    wanted = options(fmu.with_name(fmu.stem + "_ref.opt"))
    inputs = fmu.with_name(fmu.stem + "_in.csv")
    return fmpy.simulate_fmu(
        str(fmu),
        start_time=float(wanted["StartTime"]),
        stop_time=float(wanted["StopTime"]),
        output_interval=float(wanted["OutputIntervalLength"]),
        step_size=float(wanted["StepSize"]),
        relative_tolerance=float(wanted["RelTol"]),
        input=fmpy.read_csv(str(inputs)) if inputs.exists() else None,
    )


def test_fmpy_gets_the_reference_from_the_inputs_and_the_options(exported, assert_same):
    expected = table(exported.with_name(exported.stem + "_ref.csv"))
    result = run(exported)
    found = Table(result["time"], {n: result[n] for n in result.dtype.names if n != "time"})
    assert len(expected.times) > 20
    assert_same(expected, found)


def test_the_files_keep_to_the_rules(exported):
    description = fmpy.read_model_description(str(exported))
    by = {
        causality: [v.name for v in description.modelVariables if v.causality == causality]
        for causality in ("input", "output")
    }
    for end, causality in (("_ref.csv", "output"), ("_in.csv", "input")):
        path = exported.with_name(exported.stem + end)
        assert path.exists() == bool(by[causality])
        if path.exists():
            assert path.stat().st_size <= 1_000_000
            assert list(table(path).columns) == by[causality]
