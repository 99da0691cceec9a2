"""What importers rely on in a model description and fmpy validate does not look at."""

import math

import pytest
from conftest import EFFECTS, SCENES
from fmpy.fmi2 import fmi2OK

RINGS = {"set1": 2, "set2": 2, "ring12": 12}

# Which of the scenes in scenes/effects/ have these variables. Where there is a law of friction, and there is unless
# a scene says otherwise, there is a coefficient for contacts that have none of their own.
OF_EFFECTS = {
    "friction.coefficient": "coulomb energy links modules stability static sticking stribeck",
    "friction.static": "energy static stribeck",
    "friction.stribeck_velocity": "stribeck",
    "damping.alpha": "damping stability",
    "damping.beta": "damping stability",
    "module[3].k1": "links",
    "module[1].k2": "links",
    "module[1].preload": "links modules",
    "statistics.reversed_slips": "sticking",
    "statistics.pulled_contacts": "detachment",
    "energy.friction": "energy",
    "energy.residual": "energy",
    "stability.growth_rate": "stability",
    "stability.frequency": "stability",
    "stability.modes": "stability",
}

every_scene = pytest.mark.parametrize("scene", SCENES)


def indices(fmu, listing):
    return [int(unknown.get("index")) for unknown in fmu.xml.find(f"ModelStructure/{listing}")]


def types(fmu):
    """The type elements of all variables, by name."""
    return {v.get("name"): v[0] for v in fmu.xml.find("ModelVariables")}


@every_scene
def test_initial_unknowns_are_ascending_unique_and_the_outputs(unpacked, scene):
    fmu = unpacked(scene)
    unknowns = indices(fmu, "InitialUnknowns")
    assert unknowns == sorted(set(unknowns))
    assert unknowns == indices(fmu, "Outputs")
    variables = fmu.xml.find("ModelVariables")
    outputs = [i for i, v in enumerate(variables, 1) if v.get("causality") == "output"]
    assert unknowns == outputs


@every_scene
def test_no_start_value_is_below_its_minimum(unpacked, scene):
    bounded = 0
    for name, kind in types(unpacked(scene)).items():
        if kind.get("min") is not None and kind.get("start") is not None:
            bounded += 1
            assert float(kind.get("min")) <= float(kind.get("start")), name
    assert bounded >= 3


@every_scene
def test_what_has_a_start_value_is_an_input_or_a_parameter(unpacked, scene):
    for variable in unpacked(scene).xml.find("ModelVariables"):
        given = variable.get("causality") in ("input", "parameter")
        assert (variable[0].get("start") is not None) == given, variable.get("name")


# Causality, variability and initial, of the combinations of FMI 2.0.4, section 2.2.7, that an FMU of ours uses.
LEGAL = {
    ("input", "continuous", None),
    ("output", "continuous", "calculated"),
    ("output", "discrete", "calculated"),
    ("parameter", "fixed", "exact"),
    ("parameter", "tunable", "exact"),
}


@every_scene
def test_causality_variability_and_initial_go_together(unpacked, scene):
    for variable in unpacked(scene).xml.find("ModelVariables"):
        # What is not a Real changes in jumps alone.
        triple = tuple(variable.get(name) for name in ("causality", "variability", "initial"))
        assert triple in LEGAL, variable.get("name")
        assert variable[0].tag == "Real" or triple[1] != "continuous", variable.get("name")


@every_scene
def test_names_are_unique_among_variables_and_types_and_describe_something(unpacked, scene):
    xml = unpacked(scene).xml
    variables = list(xml.find("ModelVariables"))
    names = [variable.get("name") for variable in variables]
    types = [simple.get("name") for simple in xml.find("TypeDefinitions")]
    assert len(set(names + types)) == len(names + types)
    assert all(variable.get("description") for variable in variables)
    for enumeration in xml.find("TypeDefinitions").iter("Enumeration"):
        items = [(item.get("name"), item.get("value")) for item in enumeration]
        assert len(set(name for name, _ in items)) == len(set(value for _, value in items)) == len(items)


@every_scene
def test_numbers_are_finite_and_files_are_where_the_description_says(unpacked, scene):
    fmu = unpacked(scene)
    for name, kind in types(fmu).items():
        for key in ("start", "min", "max"):
            assert kind.get(key) is None or kind.tag == "Boolean" or math.isfinite(float(kind.get(key))), name
    identifier = fmu.xml.find("CoSimulation").get("modelIdentifier")
    assert identifier.isidentifier() and fmu.library.stem == identifier
    assert fmu.xml.get("variableNamingConvention") == "structured"


@every_scene
def test_the_default_experiment_names_no_tolerance(unpacked, scene):
    """Importers would pass it on, and nothing here depends on one."""
    experiment = unpacked(scene).xml.find("DefaultExperiment")
    assert set(experiment.keys()) == {"startTime", "stopTime", "stepSize"}
    assert float(experiment.get("startTime")) < float(experiment.get("stopTime"))


@every_scene
def test_every_unit_is_declared_and_every_real_has_one(unpacked, scene):
    fmu = unpacked(scene)
    declared = [unit.get("name") for unit in fmu.xml.find("UnitDefinitions")]
    assert len(declared) == len(set(declared))
    for name, kind in types(fmu).items():
        if kind.tag == "Real":
            assert kind.get("unit") in declared, name


@every_scene
def test_every_enumeration_is_declared(unpacked, scene):
    fmu = unpacked(scene)
    declared = {simple.get("name") for simple in fmu.xml.find("TypeDefinitions")}
    used = {kind.get("declaredType") for kind in types(fmu).values() if kind.tag == "Enumeration"}
    # There is one contact at the least, but for the scene of damping.
    assert used == (set() if scene == "damping" else {"ContactState"}) and used <= declared


@every_scene
def test_value_references_are_unique(unpacked, scene):
    references = [v.get("valueReference") for v in unpacked(scene).xml.find("ModelVariables")]
    assert len(references) == len(set(references))


@every_scene
def test_the_fmus_own_variable_is_a_boolean_parameter_and_the_last(unpacked, scene):
    *others, strict = unpacked(scene).xml.find("ModelVariables")
    attributes = dict(strict.items())
    assert attributes.pop("description") and attributes.pop("valueReference") == str(len(others))
    assert attributes == {
        "name": "strict",
        "causality": "parameter",
        "variability": "fixed",
        "initial": "exact",
    }
    assert [(kind.tag, dict(kind.items())) for kind in strict] == [("Boolean", {"start": "false"})]
    assert "strict" not in {v.get("name") for v in others}


@every_scene
def test_what_the_fmu_can_do(unpacked, scene):
    fmu = unpacked(scene)
    assert fmu.xml.find("ModelExchange") is None
    capabilities = dict(fmu.xml.find("CoSimulation").items())
    assert capabilities.pop("modelIdentifier") == scene
    assert capabilities == {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "1",
        "providesDirectionalDerivative": "true",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }


@pytest.mark.parametrize(("scene", "modules"), RINGS.items())
def test_the_names_that_scripts_rely_on_exist(unpacked, scene, modules):
    fmu = unpacked(scene)
    inputs = ["friction.coefficient", "slider.velocity"]
    parameters = ["slider.angle", "damping.beta", "integrator.step"]
    outputs = []
    for i in range(1, modules + 1):
        structure = [f"k{j}" for j in range(1, 7)] + ["m1", "m2", "preload"]
        parameters += [f"module[{i}].{name}" for name in structure]
        motion = [f"{letter}{j}" for letter in "xv" for j in range(1, 5)]
        parameters += [f"initial.module[{i}].{name}" for name in motion]
        outputs += [f"module[{i}].{name}" for name in motion]
        forces = ["state", "normal_force", "friction_force", "slip_velocity"]
        outputs += [f"contact[{i}].{name}" for name in forces]
    for causality, names in [("input", inputs), ("parameter", parameters), ("output", outputs)]:
        for name in names:
            assert name in fmu.variables, name
            assert fmu.variables[name].causality == causality, name


@pytest.mark.parametrize("name", OF_EFFECTS)
def test_a_variable_of_an_effect_is_there_where_the_effect_is_and_nowhere_else(unpacked, name):
    having = {scene for scene in EFFECTS if name in unpacked(scene).variables}
    assert having == set(OF_EFFECTS[name].split()) & set(EFFECTS)


def dependencies(fmu):
    """The inputs that each output says it depends on, by their names, of those that say so."""
    names = [v.get("name") for v in fmu.xml.find("ModelVariables")]
    return {
        names[int(unknown.get("index")) - 1]: [names[int(i) - 1] for i in unknown.get("dependencies").split()]
        for unknown in fmu.xml.find("ModelStructure/Outputs")
        if unknown.get("dependencies") is not None
    }


@every_scene
def test_an_input_acts_at_once_on_none_but_the_outputs_that_depend_on_it(instance, scene):
    """Whatever the contacts do: inputs are changed by little and by much, in the midst of a motion."""
    one = instance(scene).initialize()
    stated = dependencies(one.fmu)
    inputs = [v.get("name") for v in one.fmu.xml.find("ModelVariables") if v.get("causality") == "input"]
    interval = float(one.fmu.description.defaultExperiment.stepSize)
    for step in range(1, 6):
        one.advance([float(f"{step * interval:.12g}")], [])
        for name in inputs:
            (present,) = one.read([name])
            before = dict(zip(stated, one.read(stated)))
            for value in (present + 1e-3, 0.5 * present, 10.0 + present):
                if one.Set({name: value}) != fmi2OK:
                    continue
                for output, after in zip(stated, one.read(stated)):
                    assert name in stated[output] or after == before[output], (output, name, value)
            assert one.Set({name: present}) == fmi2OK


@every_scene
def test_positions_and_velocities_need_no_input_and_a_slip_that_cannot_stop_the_surfaces_alone(unpacked, scene):
    fmu = unpacked(scene)
    stated = dependencies(fmu)
    motion = [n for n in fmu.outputs if n.startswith(("module[", "mass."))]
    assert motion and all(stated[name] == [] for name in motion)
    text = (fmu.folder / "resources" / "scene.toml").read_text()
    cannot_stick = 'law = "none"' in text or "sticking = false" in text
    expected = ["slider.velocity"] if cannot_stick else None
    for name in fmu.outputs:
        if name.endswith(".slip_velocity"):
            assert stated.get(name) == expected, name
