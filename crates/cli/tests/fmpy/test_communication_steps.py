"""However an importer parts a run into communication steps, the doubles are the same."""

import numpy as np
import pytest
from conftest import INTEGRATOR, STEP

KICK = {"initial.module[1].v2": 0.3}
# Small, so that both contacts slide throughout, but of a size that rounding cannot reach.
WHISPER = {"initial.module[1].v1": 1e-5, "initial.module[2].v2": 2e-5}


def multiples(interval, stop):
    return [i * interval for i in range(1, round(stop / interval) + 1)]


@pytest.mark.parametrize("scene", ["set1", "set2", "ring12"])
def test_regular_and_irregular_steps_give_the_doubles_of_the_program(
    instance, native, assert_same, scene
):
    stop = 0.06
    expected = native(scene, stop, 1e-2, KICK)
    assert expected["statistics.state_changes"][-1] > 10
    rows = range(len(expected.times))
    # 1e-2, 1e-3 and 2e-4 s, and points that chance puts on the grid of internal steps.
    parts = {n: [i * 1e-2 / n for i in range(1, 6 * n + 1)] for n in (1, 10, 50)}
    random = np.random.default_rng(1)
    whole, row = round(stop / STEP), round(1e-2 / STEP)
    grid = sorted({*random.choice(whole, 300), *range(0, whole + 1, row)} - {0})
    parts["irregular"] = [int(i) * STEP for i in grid]
    for part, times in parts.items():
        table = instance(scene, name=str(part)).initialize(KICK).advance(times)
        common = [int(np.abs(table.times - expected.times[row]).argmin()) for row in rows]
        table = table.part(common)
        assert np.allclose(table.times, expected.times, rtol=1e-15), part
        assert_same(expected, table._replace(times=expected.times))


def test_steps_that_arrive_rounded_lose_nothing(instance, assert_same):
    """A host that adds up 0.1 is at 0.9999999999999999 s after ten steps, and then takes one of
    1.1e-16 s to the end."""
    host = 0.0
    summed = []
    for _ in range(10):
        host += 0.1
        summed.append(host)
    assert host != 1.0 and 1.0 - host == pytest.approx(1.1e-16, rel=0.01)
    exact = instance("set2").initialize(KICK).advance(multiples(0.1, 1.0))
    rounded = instance("set2").initialize(KICK).advance([*summed, 1.0])
    assert_same(exact, rounded.part(slice(0, 11))._replace(times=exact.times))
    assert_same(exact.part([10]), rounded.part([11]))
    # And nothing is lost after such a step.
    more = [1.0 + t for t in multiples(1e-2, 0.1)]
    assert_same(*(one.advance(more) for one in continued(instance, summed)))


def continued(instance, summed):
    """Two instances at 1 s, the second by way of a last step of 1.1e-16 s."""
    for times in ([1.0], [*summed, 1.0]):
        one = instance("set2").initialize(KICK)
        one.advance(times, names=[])
        yield one


def test_steps_that_are_summed_for_long_stay_on_the_grid(instance, assert_same):
    """A host that adds up its steps is off by 2e-13 s after 20 000 of 1e-4 s."""
    names = [f"module[{i}].{letter}{j}" for i in (1, 2) for letter in "xv" for j in range(1, 5)]
    times = list(np.cumsum(np.full(20_000, 1e-4)))
    assert 1e-13 < abs(times[-1] - 2.0) < 1e-12
    summed = instance("set2").initialize(KICK).advance(times, names, at=times[::100])
    grid = multiples(1e-4, 2.0)
    exact = instance("set2").initialize(KICK).advance(grid, names, at=grid[::100])
    assert_same(exact, summed._replace(times=exact.times))


def test_a_step_off_the_grid_is_parted_evenly(instance, assert_same):
    """2.5 internal steps become three equal ones. In powers of two there is no rounding in the
    times, so the run is the one with that internal step, to the last bit."""
    step = 2.0**-20
    times = [2.5 * step * i for i in range(1, 20_001)]
    at = times[999::1000]
    parted = instance("set2").initialize({**KICK, "integrator.step": step})
    equal = instance("set2").initialize({**KICK, "integrator.step": 2.5 * step / 3})
    parted, equal = parted.advance(times, at=at), equal.advance(at, at=at)
    assert parted["statistics.state_changes"][-1] > 10
    assert_same(equal, parted)


def test_a_step_shorter_than_the_internal_one_is_taken_as_it_is(instance, assert_same):
    step = 2.0**-17
    times = [step / 8 * i for i in range(1, 40_001)]
    at = times[999::1000]
    short = instance("set2").initialize({**KICK, "integrator.step": step})
    equal = instance("set2").initialize({**KICK, "integrator.step": step / 8})
    short, equal = short.advance(times, at=at), equal.advance(at, at=at)
    assert short["statistics.state_changes"][-1] > 10
    assert_same(equal, short)


def test_steps_off_the_grid_stay_as_near_to_the_program_as_the_integrator_says(instance, native):
    """In uniform sliding the error of the paper's scheme is proportional to the step h. The program's
    runs with 2 h and h differ by the error of h itself; steps of 2.5 h, parted into three of 5/6 h,
    must differ from the run with h by a sixth of that. The event-driven integrator has no error but
    rounding."""
    h, stop = STEP, 0.05
    names = [f"module[{i}].{quantity}" for i in (1, 2) for quantity in ("x1", "x2", "x3")]
    fine = native("set1", stop, stop, WHISPER)
    coarse = native("set1", stop, stop, {**WHISPER, "integrator.step": 2 * h})
    odd = instance("set1").initialize(WHISPER)
    odd = odd.advance(multiples(2.5 * h, stop), at=[multiples(2.5 * h, stop)[-1]])
    assert fine["statistics.state_changes"][-1] == 0

    def distance(a, b):
        return np.linalg.norm([a[name][-1] - b[name][-1] for name in names])

    assert np.isfinite([odd[name] for name in odd.columns]).all()
    if INTEGRATOR == "event-driven":
        assert distance(odd, fine) < 1e-11 * np.linalg.norm([fine[name][-1] for name in names])
        return
    assert distance(odd, fine) / distance(coarse, fine) == pytest.approx(1 / 6, rel=0.02)
