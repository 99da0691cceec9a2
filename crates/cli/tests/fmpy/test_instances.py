"""Several instances in one process, and one instance used again."""

import threading

import pytest
from fmpy.fmi2 import fmi2OK

TIMES = [2e-3 * i for i in range(1, 26)]
ONE = {"initial.module[1].v2": 0.3}
OTHER = {"initial.module[2].v1": -0.4, "friction.coefficient": 0.9, "module[1].k5": 310e3}


def alone(instance, values, scene="set2"):
    table = instance(scene, name="alone").initialize(values).advance(TIMES)
    assert table["statistics.state_changes"][-1] > 5
    return table


@pytest.mark.parametrize("scene", ["set2", "ring12"])
def test_interleaved_instances_equal_each_alone(instance, assert_same, scene):
    one = instance(scene, name="one")
    other = instance(scene, name="other")
    one.initialize(ONE)
    other.initialize(OTHER)
    rows = []
    for time in TIMES:
        rows.append((one.advance([time], at=[time]), other.advance([time], at=[time])))
    for number, values in enumerate([ONE, OTHER]):
        expected = alone(instance, values, scene)
        for row, tables in enumerate(rows, 1):
            assert_same(expected.part([row]), tables[number])


def test_instances_of_two_fmus_do_not_mix(instance, assert_same):
    one, other = instance("set1").initialize(ONE), instance("set2").initialize(ONE)
    pairs = [(one.advance([t], at=[t]), other.advance([t], at=[t])) for t in TIMES]
    expected = [alone(instance, ONE, scene) for scene in ("set1", "set2")]
    for row, pair in enumerate(pairs, 1):
        for table, part in zip(expected, pair):
            assert_same(table.part([row]), part)
    assert expected[0]["module[1].x1"][-1] != expected[1]["module[1].x1"][-1]


def test_instances_run_in_threads_of_their_own(instance, assert_same):
    """FMPy's calls let other threads run while the FMU computes."""
    expected = alone(instance, ONE)
    ones = [instance("set2", name=f"thread {i}").initialize(ONE) for i in range(4)]
    tables = {}
    threads = [
        threading.Thread(target=lambda one=one: tables.update({one: one.advance(TIMES)}))
        for one in ones
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one in ones:
        assert_same(expected, tables[one])


def test_freeing_one_instance_leaves_the_other(instance, assert_same):
    one, other = instance("set2").initialize(ONE), instance("set2").initialize(OTHER)
    first = one.advance(TIMES[:10])
    other.advance(TIMES[:5])
    other.free()
    rest = one.advance(TIMES[10:])
    expected = alone(instance, ONE)
    assert_same(expected.part(slice(0, 11)), first)
    assert_same(expected.part(slice(10, None)), rest)


def test_reset_gives_the_first_run_again(instance, assert_same):
    one = instance("set2").initialize(ONE)
    first = one.advance(TIMES)
    assert one.Terminate() == fmi2OK
    assert one.Reset() == fmi2OK
    assert_same(first, one.initialize(ONE).advance(TIMES))


def test_reset_forgets_start_values_and_what_was_tuned(instance, assert_same):
    expected = instance("set2").initialize().advance(TIMES)
    one = instance("set2").initialize(OTHER)
    assert one.Set({"damping.beta": 9e-5, "slider.velocity": 0.3, "module[1].f1": 5.0}) == fmi2OK
    one.advance(TIMES[:9])
    assert one.Reset() == fmi2OK
    assert_same(expected, one.initialize().advance(TIMES))
