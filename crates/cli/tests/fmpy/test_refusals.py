"""What makes no sense is refused with a reason that the importer's logger gets."""

import math
from ctypes import byref

import fmpy
import pytest
from conftest import first_order
from fmpy.fmi2 import (
    fmi2Boolean,
    fmi2DoStepStatus,
    fmi2Discard,
    fmi2Error,
    fmi2Integer,
    fmi2LastSuccessfulTime,
    fmi2ModelExchange,
    fmi2OK,
    fmi2Real,
    fmi2Status,
    fmi2String,
    fmi2Terminated,
    fmi2ValueReference,
    fmi2Warning,
)

CALLS = {
    "SetupExperiment": lambda one: one.SetupExperiment(),
    "EnterInitializationMode": lambda one: one.EnterInitializationMode(),
    "ExitInitializationMode": lambda one: one.ExitInitializationMode(),
    "DoStep": lambda one: one.DoStep(0.0, 1e-3),
    "Terminate": lambda one: one.Terminate(),
    "SetReal": lambda one: one.Set({"slider.velocity": 0.02}),
    "GetReal": lambda one: one.GetReal([0])[0],
}


def in_phase(instance, phase):
    one = instance("set1")
    if phase == "error before the run":
        assert one.DoStep(0.0, 1e-3) == fmi2Error
    elif phase != "instantiated":
        assert one.SetupExperiment() == one.EnterInitializationMode() == fmi2OK
        if phase != "initialization":
            assert one.ExitInitializationMode() == fmi2OK
    if phase == "terminated":
        assert one.Terminate() == fmi2OK
    if phase == "error in the run":
        assert one.DoStep(1.0, 1e-3) == fmi2Error
    return one


# ---- Order of calls ----


@pytest.mark.parametrize(
    ("phase", "allowed", "tolerated"),
    [
        ("instantiated", {"SetupExperiment"}, {"EnterInitializationMode", "SetReal", "GetReal"}),
        ("initialization", {"ExitInitializationMode", "SetReal", "GetReal"}, set()),
        ("initialized", {"DoStep", "Terminate", "SetReal", "GetReal"}, set()),
        ("terminated", {"GetReal"}, set()),
        ("error before the run", {"GetReal"}, set()),
        ("error in the run", {"GetReal"}, set()),
    ],
)
def test_calls_out_of_their_order_are_refused(instance, phase, allowed, tolerated):
    for name, call in CALLS.items():
        one = in_phase(instance, phase)
        told = len(one.messages)
        status = call(one)
        expected = fmi2OK if name in allowed else fmi2Warning if name in tolerated else fmi2Error
        assert status == expected, name
        # Warnings are for debug logging.
        assert len(one.messages) == told + (expected == fmi2Error), name
        if expected == fmi2Error and name not in ("SetReal", "GetReal"):
            assert name in one.reason


# ---- What importers do against the standard ----


def read_early(one):
    return one.GetReal([0])[0]


def set_input_early(one):
    return one.Set({"slider.velocity": 0.02})


def ask_early(one):
    return one.call("GetRealStatus", fmi2LastSuccessfulTime, byref(fmi2Real()))


def unknown_category(one):
    return one.call("SetDebugLogging", True, 1, (fmi2String * 1)(b"logGossip"))


def enter_unprepared(one):
    return one.EnterInitializationMode()


def step_of_length_zero(one):
    if not one.time:
        for call in (one.SetupExperiment, one.EnterInitializationMode, one.ExitInitializationMode):
            assert call() == fmi2OK, one.reason
        assert one.DoStep(0.0, 1e-3) == fmi2OK
        one.time = 1e-3
    return one.DoStep(one.time, 0.0)


HABITS = [
    read_early,
    set_input_early,
    ask_early,
    unknown_category,
    enter_unprepared,
    step_of_length_zero,
]


def warnings(one):
    return [m.text for m in one.messages if m.category == "logStatusWarning"]


@pytest.mark.parametrize("habit", HABITS)
def test_a_habit_is_warned_of_once_and_answered(instance, habit):
    one = instance("set1", logging_on=True)
    assert habit(one) == fmi2Warning
    assert len(warnings(one)) == 1 and "FMI requires" in one.reason
    if habit is not enter_unprepared:
        assert habit(one) == habit(one) == fmi2Warning
        assert len(warnings(one)) == 1
    # Another run is another importer's, for all one knows.
    assert one.Reset() == fmi2OK
    one.time = 0.0
    assert habit(one) == fmi2Warning
    assert len(warnings(one)) == 2


@pytest.mark.parametrize("habit", HABITS)
def test_a_strict_instance_refuses_habits_until_it_is_reset(instance, habit):
    one = instance("set1", logging_on=True)
    strict = one.fmu.variables["strict"].valueReference
    one.slave.setBoolean([strict], [True])
    assert habit(one) == fmi2Error
    assert warnings(one) == [] and "FMI requires" in one.reason
    # After an error as after initialization it can be read.
    assert one.slave.getBoolean([strict]) == [True]
    assert one.DoStep(one.time, 1e-3) == fmi2Error
    assert one.Reset() == fmi2OK
    one.time = 0.0
    assert habit(one) == fmi2Warning


def test_what_was_set_can_be_read_though_there_is_no_equilibrium(instance):
    """At once, and to find out what was wrong after initialization has failed: at this angle a contact jams."""
    names = ["slider.angle", "slider.velocity"]
    one = instance("set1")
    assert one.Set({names[0]: -1.0}) == fmi2OK
    references = [one.fmu.variables[name].valueReference for name in names]
    assert one.GetReal(references) == (fmi2Warning, [-1.0, 0.025])
    assert one.SetupExperiment() == one.EnterInitializationMode() == fmi2OK
    assert one.Set({"friction.coefficient": 20.0}) == fmi2OK
    assert one.ExitInitializationMode() == fmi2Error
    assert one.GetReal(references) == (fmi2OK, [-1.0, 0.025])


@pytest.mark.parametrize(
    ("values", "warned"),
    [
        ({"friction.coefficient": 1.9, "module[1].f1": 0.1}, 1),
        ({"module[1].m1": 0.31, "strict": True}, 0),
    ],
)
def test_fmpys_own_run_is_warned_of_inputs_set_early_and_nothing_else(unpacked, values, warned):
    """It sets all start values before initialization, inputs among them."""
    told = []

    def logger(environment, name, status, category, text):
        told.append((category, text))

    fmpy.simulate_fmu(
        str(unpacked("set1").folder),
        stop_time=2e-3,
        output_interval=1e-3,
        start_values=values,
        debug_logging=True,
        logger=logger,
    )
    texts = [text for category, text in told if category == b"logStatusWarning"]
    assert len(texts) == warned and all(b"setting an input" in text for text in texts)
    assert {category for category, _ in told} <= {b"logEvents", b"logStatusWarning"}


def test_an_instance_in_the_error_phase_can_be_saved(instance):
    one = in_phase(instance, "error in the run")
    status, state = one.GetFMUstate()
    assert status == fmi2OK
    other = instance("set1", name="other").initialize()
    assert other.SetFMUstate(state) == fmi2OK
    assert other.DoStep(0.0, 1e-3) == fmi2Error
    assert other.GetReal([0]) == one.GetReal([0])
    one.free_state(state)


@pytest.mark.parametrize(
    "phase",
    ["initialization", "initialized", "terminated", "error before the run", "error in the run"],
)
def test_reset_makes_an_instance_usable_again(instance, assert_same, phase):
    times = [1e-3 * i for i in range(1, 11)]
    expected = instance("set1").initialize().advance(times)
    one = in_phase(instance, phase)
    assert one.Reset() == fmi2OK
    assert_same(expected, one.initialize().advance(times))


def test_after_a_failed_initialization_reset_makes_it_usable_again(instance):
    one = instance("set1")
    assert one.Set({"module[1].m1": 0.0}) == fmi2OK
    assert one.SetupExperiment() == one.EnterInitializationMode() == fmi2OK
    assert one.ExitInitializationMode() == fmi2Error
    assert one.DoStep(0.0, 1e-3) == fmi2Error
    assert one.Reset() == fmi2OK
    assert one.initialize().advance([1e-3]).times[-1] == 1e-3


def test_a_saved_state_leads_out_of_an_error(instance, assert_same):
    times = [1e-3 * i for i in range(1, 11)]
    one = instance("set2").initialize()
    one.advance(times)
    status, state = one.GetFMUstate()
    assert status == fmi2OK
    more = [0.01 + time for time in times]
    expected = one.advance(more)
    assert one.DoStep(0.0, 1e-3) == fmi2Error
    assert one.SetFMUstate(state) == fmi2OK
    one.time = 0.01
    assert_same(expected, one.advance(more))


def test_null_is_no_instance(instance):
    one = instance("set1")
    real, one.component = one.component, None
    for name, call in CALLS.items():
        assert call(one) == fmi2Error, name
    one.slave.fmi2FreeInstance(None)
    one.component = real


# ---- Instantiation ----


def test_a_wrong_guid_is_refused(instance):
    wrong = "{00000000-0000-5000-8000-000000000000}"
    one = instance("set1", guid=wrong)
    assert one.component is None
    assert wrong in one.reason
    assert one.fmu.description.guid not in (wrong, "") and one.fmu.description.guid in one.reason


def test_the_guid_of_another_scene_is_refused(instance, unpacked):
    assert instance("set1", guid=unpacked("set2").description.guid).component is None


def test_model_exchange_is_refused(instance):
    one = instance("set1", kind=fmi2ModelExchange)
    assert one.component is None and "co-simulation" in one.reason


def test_an_empty_name_is_refused(instance):
    one = instance("set1", name="")
    assert one.component is None and "name" in one.reason


# ---- Values ----


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"module[1].m1": 0.0}, "module[1].m1 = 0:"),
        ({"module[2].m2": -0.7}, "module[2].m2 = -0.7:"),
        ({"module[2].k3": -22e3}, "module[2].k3 = -22000:"),
        ({"integrator.step": 0.0}, "integrator.step = 0:"),
        pytest.param(
            # The critical step of set1 is 1.34 ms.
            {"integrator.step": 1.5e-3},
            "integrator.step = 1.5e-3 s is above the critical step",
            marks=first_order,
        ),
        ({"damping.beta": -1e-5}, "damping.beta = -0.00001:"),
        ({"friction.coefficient": -0.1}, "friction.coefficient = -0.1:"),
        # Here friction draws the masses into the slider.
        (
            {"slider.angle": -1.4, "friction.coefficient": 5.0},
            "no equilibrium in sliding with a friction coefficient of 5: contact[1] jams",
        ),
        ({"initial.module[1].x4": -1e-6}, "initial.module[1].x4 = -0.000001:"),
        ({"slider.velocity": math.nan}, "slider.velocity = NaN:"),
        ({"module[1].k1": math.inf}, "module[1].k1 = inf:"),
        ({"initial.module[2].v3": -math.inf}, "initial.module[2].v3 = -inf:"),
    ],
)
def test_impossible_values_are_refused_before_the_run_starts(instance, values, named):
    one = instance("set1")
    assert one.SetupExperiment() == fmi2OK
    # Inputs among them are set early.
    statuses = [one.Set(values), one.EnterInitializationMode(), one.ExitInitializationMode()]
    assert fmi2Error in statuses
    assert named in one.messages[0].text
    assert one.DoStep(0.0, 1e-3) == fmi2Error


def test_the_neighbours_of_impossible_values_are_possible(instance):
    """The refusals above are not of anything that is set."""
    for values in [
        {"module[1].m1": 0.01, "module[2].k3": 0.0, "damping.beta": 0.0},
        {"integrator.step": 3.0e-4},
        {"slider.angle": -1.4, "friction.coefficient": 4.5},
        {"module[2].preload": 0.0},
        {"initial.module[1].x4": 0.0},
        {"friction.coefficient": 0.0},
    ]:
        one = instance("set1").initialize(values)
        assert one.DoStep(0.0, 1e-3) == fmi2OK, one.reason


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_input_that_is_not_finite_is_refused_during_the_run(instance, value):
    one = instance("set1").initialize()
    assert one.DoStep(0.0, 1e-3) == fmi2OK
    assert one.Set({"module[2].f1": value}) == fmi2Error
    assert "module[2].f1" in one.reason and "finite" in one.reason
    assert one.read(["module[2].f1"]) == [0.0]


def test_values_that_are_set_together_are_set_all_or_none(instance):
    one = instance("set1").initialize()
    assert one.Set({"slider.velocity": 0.5, "friction.coefficient": -1.0}) == fmi2Error
    assert one.read(["slider.velocity", "friction.coefficient"]) == [0.025, 1.96]


@pytest.mark.parametrize(
    "name", ["module[1].m1", "module[2].k5", "slider.angle", "integrator.step"]
)
def test_a_fixed_parameter_cannot_be_set_after_initialization(instance, name):
    one = instance("set1").initialize()
    assert one.Set({name: one.read([name])[0]}) == fmi2Error
    assert name in one.reason and "after initialization" in one.reason


@pytest.mark.parametrize("phase", ["instantiated", "initialization", "initialized"])
def test_an_output_cannot_be_set(instance, phase):
    one = in_phase(instance, phase)
    assert one.Set({"module[1].x1": 1e-3}) == fmi2Error
    assert "module[1].x1" in one.reason


@first_order
def test_a_tuned_value_that_makes_the_step_too_large_is_refused_at_the_step(instance):
    one = instance("set1").initialize()
    assert one.Set({"damping.beta": 1.0}) == fmi2OK
    assert one.DoStep(0.0, 1e-3) == fmi2Error
    assert "critical step" in one.reason


def test_unknown_value_references_are_refused(instance):
    one = instance("set1").initialize()
    beyond = len(one.fmu.variables)
    state = one.fmu.variables["contact[1].state"].valueReference
    for reference in (beyond, 2**32 - 1, state):
        for call in (
            lambda: one.GetReal([reference])[0],
            lambda: one.SetReal([reference], [1.0]),
        ):
            assert one.Reset() == fmi2OK
            one.initialize()
            assert call() == fmi2Error
            assert str(reference) in one.reason


@pytest.mark.parametrize(
    ("kind", "type"), [("Integer", fmi2Integer), ("Boolean", fmi2Boolean), ("String", fmi2String)]
)
def test_references_of_another_type_are_refused(instance, kind, type):
    one = instance("set1").initialize()
    real = one.fmu.variables["module[1].x1"].valueReference
    references, values = (fmi2ValueReference * 1)(real), (type * 1)()
    for access in ("Get", "Set"):
        assert one.call(f"{access}{kind}", references, 0, values) == fmi2OK
        assert one.call(f"{access}{kind}", references, 1, values) == fmi2Error
        assert kind in one.reason
        assert one.Reset() == fmi2OK
        one.initialize()


def test_arrays_that_are_null_are_refused(instance):
    one = instance("set1").initialize()
    assert one.call("GetReal", None, 0, None) == fmi2OK
    assert one.call("GetReal", None, 1, None) == fmi2Error
    assert "NULL" in one.reason


# ---- Steps ----


@pytest.mark.parametrize(
    ("time", "size"),
    [
        (0.0, 1e-3),
        (0.02, 1e-3),
        (0.01, -1e-3),
        (0.01, math.nan),
        (math.nan, 1e-3),
        (0.01, math.inf),
        (0.01, 1e300),
    ],
)
def test_steps_that_do_not_go_on_from_here_are_refused(instance, time, size):
    one = instance("set1").initialize()
    assert one.DoStep(0.0, 0.01) == fmi2OK
    assert one.DoStep(time, size) == fmi2Error
    assert one.reason


def test_a_step_of_length_zero_does_nothing_and_warns(instance, assert_same):
    one, other = (instance("set2", logging_on=True).initialize() for _ in range(2))
    for each in (one, other):
        each.advance([0.01])
    assert one.DoStep(0.01, 0.0) == fmi2Warning
    assert one.messages[-1].category == "logStatusWarning"
    assert_same(other.advance([0.02]), one.advance([0.02]))


def test_no_step_goes_beyond_the_stop_time(instance):
    one = instance("set1")
    assert one.SetupExperiment(stop=0.3) == fmi2OK
    assert one.EnterInitializationMode() == one.ExitInitializationMode() == fmi2OK
    # 0.1 + 0.2 lies above 0.3 by a rounding error, which is no reason to refuse.
    assert one.DoStep(0.0, 0.1) == fmi2OK
    assert one.DoStep(0.1, 0.2) == fmi2OK
    assert one.DoStep(0.3, 1e-3) == fmi2Error
    assert "stop time" in one.reason


@pytest.mark.parametrize(("start", "stop"), [(math.nan, None), (math.inf, None), (1.0, 0.5)])
def test_an_experiment_that_makes_no_sense_is_refused(instance, start, stop):
    assert instance("set1").SetupExperiment(start, stop) == fmi2Error


def test_status_queries(instance):
    one = instance("set1").initialize()
    assert one.DoStep(0.0, 0.01) == fmi2OK
    time, terminated, status = fmi2Real(), fmi2Boolean(1), fmi2Status()
    assert one.call("GetRealStatus", fmi2LastSuccessfulTime, byref(time)) == fmi2OK
    assert time.value == 0.01
    assert one.call("GetBooleanStatus", fmi2Terminated, byref(terminated)) == fmi2OK
    assert not terminated.value
    # Steps are done when doStep returns; there is nothing to ask, and nothing to cancel.
    assert one.call("GetStatus", fmi2DoStepStatus, byref(status)) == fmi2Discard
    assert one.call("CancelStep") == fmi2Error


# ---- The logger ----


def test_messages_carry_name_category_and_environment(instance):
    name = "Bremse vorn/links µ 100 %s"
    one = instance("set2", name=name, logging_on=True).initialize()
    one.advance([0.01, 0.02])
    one.DoStep(0.02, 0.0)
    one.DoStep(0.0, 1.0)
    declared = {category.get("name") for category in one.fmu.xml.find("LogCategories")}
    assert {message.category for message in one.messages} == declared - {"logAll"}
    assert {message.instance for message in one.messages} == {name}
    statuses = {"logEvents": fmi2OK, "logStatusWarning": fmi2Warning, "logStatusError": fmi2Error}
    assert all(message.status == statuses[message.category] for message in one.messages)


def test_without_debug_logging_only_errors_are_told(instance):
    one = instance("set2").initialize()
    one.advance([0.01])
    one.DoStep(0.01, 0.0)
    assert one.messages == []
    one.DoStep(0.0, 1.0)
    assert [message.category for message in one.messages] == ["logStatusError"]


@pytest.mark.parametrize(
    ("categories", "told"),
    [
        ([], {"logEvents", "logStatusWarning"}),
        (["logAll"], {"logEvents", "logStatusWarning"}),
        (["logEvents"], {"logEvents"}),
        (["logStatusWarning", "logStatusError"], {"logStatusWarning"}),
    ],
)
def test_categories_are_turned_on_and_off(instance, categories, told):
    one = instance("set2")
    names = (fmi2String * len(categories))(*(name.encode() for name in categories))

    def cause_messages():
        before = len(one.messages)
        start = one.time
        one.advance([start + 0.01])
        one.DoStep(one.time, 0.0)
        return {message.category for message in one.messages[before:]}

    one.initialize()
    assert one.call("SetDebugLogging", True, len(categories), names) == fmi2OK
    assert cause_messages() == told
    assert one.call("SetDebugLogging", False, len(categories), names) == fmi2OK
    assert cause_messages() == set()


def test_an_unknown_category_is_warned_of(instance):
    one = instance("set1", logging_on=True)
    names = (fmi2String * 1)(b"logGossip")
    assert one.call("SetDebugLogging", True, 1, names) == fmi2Warning
    assert "logGossip" in one.reason


def test_percent_signs_in_a_message_stay_what_they_are(instance):
    one = instance("set1", resources="file:///nowhere%25d%25s%25n")
    assert one.component is None
    assert "/nowhere%d%s%n/" in one.reason


def test_a_null_logger_is_not_called(instance, assert_same):
    assert instance("set1", logger=None, guid="{}").component is None
    one = instance("set2", logger=None, logging_on=True)
    with_logger = instance("set2").initialize().advance([0.01, 0.02])
    assert_same(with_logger, one.initialize().advance([0.01, 0.02]))
    assert one.DoStep(0.0, 1.0) == fmi2Error
