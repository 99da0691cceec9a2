"""What importers rely on in a model description and fmpy validate does not look at."""

import pytest
from conftest import EFFECTS, SCENES

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
def test_what_the_fmu_can_do(unpacked, scene):
    fmu = unpacked(scene)
    assert fmu.xml.find("ModelExchange") is None
    capabilities = dict(fmu.xml.find("CoSimulation").items())
    assert capabilities.pop("modelIdentifier") == scene
    assert capabilities == {
        "canHandleVariableCommunicationStepSize": "true",
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
