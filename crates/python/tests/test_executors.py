"""Sweeps and studies give the same bytes on every executor, whatever it does to its tasks."""

import multiprocessing
import random
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor

import amontons
import evaluations
import numpy as np
import pytest
from amontons import _executors
from conftest import bytes_of

MU = "friction.coefficient"
SHORT = {"longest": 60.0, "window": 10.0}
DESIGN = {"module[*].k5": "±5%", "module[*].k6": "±5%"}
STUDIES = {
    "sweep": lambda scene, executor: amontons.sweep(
        scene, {MU: np.linspace(0.0, 0.6, 40), "slider.velocity": [0.1, 0.2, 0.5]}, executor=executor
    ),
    "sweep of verdicts": lambda scene, executor: amontons.sweep(
        scene, {MU: np.linspace(0.0, 0.6, 11)}, of="verdict", executor=executor
    ),
    "sweep of motions": lambda scene, executor: amontons.sweep(
        scene, {"slider.velocity": [0.05, 0.7]}, of="motion", executor=executor
    ),
    "limit cycles": lambda scene, executor: scene.limit_cycles(
        "slider.velocity", [0.05, 0.2], resolution=0.1, executor=executor, **SHORT
    ),
    "perturbations": lambda scene, executor: scene.perturbations(
        "mass.block.vx", np.linspace(0.0, 0.3, 4), resolution=0.1, executor=executor, **SHORT
    ),
    "basin": lambda scene, executor: scene.basin(
        ("mass.block.x", [0.0, 0.015]), ("mass.block.vx", [0.0, 0.1, 0.2]), executor=executor, **SHORT
    ),
    "robustness": lambda scene, executor: scene.robustness(
        {MU: "normal(±10%)", "spring.*.stiffness": "uniform(±5%)"},
        points=64,
        pushes="uniform(0,0.3)",
        runs=6,
        executor=executor,
        **SHORT,
    ),
    "loudness": lambda scene, executor: amontons.Scene.builtin("set1")
    .with_values({MU: 3.0})
    .loudness(executor=executor),
    "design": lambda scene, executor: amontons.Scene.builtin("set1").design(
        DESIGN, (0.0, 1.25), starts=3, points=1, runs=3, executor=executor, longest=2.0
    ),
}


@pytest.fixture(scope="module")
def expected(held):
    return {name: bytes_of(study(held, None)) for name, study in STUDIES.items()}


class Shuffled:
    """Finishes its tasks in a random order; fails some, and tells of some ends twice."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.tasks = []
        self.is_over = False
        self.lock = threading.Lock()
        self.thread = threading.Thread(target=self.work)
        self.thread.start()

    def submit(self, function, *arguments):
        future = Future()
        with self.lock:
            self.tasks.append((future, function, arguments))
        return future

    def work(self):
        while not self.is_over:
            with self.lock:
                one = self.tasks.pop(self.random.randrange(len(self.tasks))) if self.tasks else None
            if one is None:
                time.sleep(0.001)
                continue
            future, function, arguments = one
            if not future.set_running_or_notify_cancel():
                continue
            chance = self.random.random()
            if chance < 0.1:
                future.set_exception(ConnectionError("the worker is lost"))
                continue
            result = function(*arguments)
            callbacks = list(future._done_callbacks)
            future.set_result(result)
            if chance > 0.8:
                for callback in callbacks:
                    callback(future)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.is_over = True
        self.thread.join()


class AtOnce:
    """Does its tasks within `submit`."""

    def submit(self, function, *arguments):
        future = Future()
        try:
            future.set_result(function(*arguments))
        except Exception as error:
            future.set_exception(error)
        return future


def spawning():
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


def test_a_push_begins_stick_slip_where_it_reaches_the_speed_of_the_belt(held):
    # From the equilibrium a damped block is never as fast again as at its start.
    found = STUDIES["perturbations"](held, None)
    [low], [high] = found["threshold_low"].values, found["threshold_high"].values
    assert low - 1e-12 <= held["slider.velocity"] <= high


def check_all(scene, expected, executor):
    for name, study in STUDIES.items():
        assert bytes_of(study(scene, executor)) == expected[name], name


@pytest.mark.parametrize("seed", range(2))
def test_tasks_that_end_in_any_order_fail_or_end_twice_give_the_same_bytes(held, expected, seed):
    with Shuffled(seed) as executor:
        check_all(held, expected, executor)


def test_an_executor_that_works_within_submit_gives_the_same_bytes(held, expected):
    check_all(held, expected, AtOnce())


@pytest.mark.parametrize("pool", [lambda: ThreadPoolExecutor(3), spawning], ids=["threads", "spawned processes"])
def test_pools_give_the_same_bytes(held, expected, pool):
    with pool() as executor:
        check_all(held, expected, executor)


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_forked_processes_give_the_same_bytes(held, expected):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("fork")) as executor:
        check_all(held, expected, executor)


def test_a_function_of_a_module_is_evaluated_by_processes(set1):
    values = {MU: np.linspace(0.5, 1.9, 5)}
    with spawning() as executor:
        found = amontons.sweep(set1, values, of=evaluations.amplitude, executor=executor)
    assert bytes_of(found) == bytes_of(amontons.sweep(set1, values, of=evaluations.amplitude))
    alone = set1.with_values({MU: 0.5}).simulate(0.002, outputs=["module[1].x1"])
    assert found["largest"].values[0] == np.abs(alone["module[1].x1"]).max() and found["rows"].values[0] == 11


def test_a_pool_that_loses_a_worker_finishes_with_a_warning(set1, tmp_path, monkeypatch):
    monkeypatch.setenv("AMONTONS_TEST_MARKER", str(tmp_path / "marker"))
    with spawning() as executor, pytest.warns(UserWarning, match="takes no more work .*processes of their own do the rest"):
        found = amontons.sweep(set1, {MU: np.linspace(0.0, 2.0, 41)}, of=evaluations.dies_once, executor=executor)
    assert found["value"].values.tolist() == np.linspace(0.0, 2.0, 41).tolist()
    assert not found["failure"].values.any()


def test_a_point_that_ends_each_process_is_a_row_with_this_reason(set1):
    with spawning() as executor, pytest.warns(UserWarning, match="takes no more work"):
        found = amontons.sweep(set1, {MU: np.linspace(0.0, 2.0, 9)}, of=evaluations.dies_at_one, executor=executor)
    reasons = found["failure"].values.tolist()
    assert reasons == [""] * 4 + ["the process that evaluated it ended each time"] + [""] * 4
    assert found["value"].values.tolist()[:4] == [0.0, 0.25, 0.5, 0.75]


class KilledWorker(Exception):
    """What Dask raises for a task that has ended several workers."""


def test_a_point_that_dask_gives_up_is_a_row_with_this_reason(set1):
    class Killing(AtOnce):
        """Ends a worker with each task that has a point at 1.0."""

        def submit(self, function, work, common, batch, attempt):
            if any(point == (1.0,) for _, point in batch):
                future = Future()
                future.set_exception(KilledWorker())
                return future
            return super().submit(function, work, common, batch, attempt)

    # Tasks with several points are among these.
    values = np.linspace(0.0, 2.0, 129)
    found = amontons.sweep(set1, {MU: values}, of=evaluations.friction, executor=Killing())
    lost = found["failure"].values != ""
    assert values[lost].tolist() == [1.0] and found["value"].values[~lost].tolist() == values[values != 1.0].tolist()


def test_a_point_that_fails_is_a_row_with_its_reason(set1):
    for executor in (None, AtOnce()):
        found = amontons.sweep(set1, {MU: [-1.0, 0.5, 1.5]}, of=evaluations.fails_above_one, executor=executor)
        assert np.isnan(found["value"].values).tolist() == [True, False, True]
        assert found["failure"].values.tolist() == [
            "friction.coefficient = -1: must not be negative",
            "",
            "ZeroDivisionError: too slippery",
        ]


def test_a_task_that_always_fails_is_given_up_with_its_reason(set1):
    class Broken:
        attempts = 0

        def submit(self, function, *arguments):
            self.attempts += 1
            future = Future()
            future.set_exception(ConnectionError("no route to the worker"))
            return future

    executor = Broken()
    with pytest.raises(RuntimeError, match="a task failed 4 times: no route to the worker"):
        amontons.sweep(set1, {MU: [1.0]}, executor=executor)
    assert executor.attempts == 4


def test_an_error_of_the_scene_is_not_tried_again(set1):
    calls = []

    class Counting(AtOnce):
        def submit(self, function, *arguments):
            calls.append(1)
            return super().submit(function, *arguments)

    with pytest.raises(amontons.ArgumentError, match="has no initial value nothing"):
        set1.perturbations("nothing", [0.0, 0.1], executor=Counting())
    assert len(calls) <= 1


@pytest.mark.parametrize("kind", ["numbers", "mixed", "complex"])
def test_results_of_functions_keep_their_values(set1, kind):
    functions = {
        "numbers": lambda scene: {"a": np.float32(0.5), "b": True, "c": 3},
        "mixed": lambda scene: "low" if scene[MU] < 1.0 else scene[MU],
        "complex": lambda scene: scene.eigenvalues()[0],
    }
    found = amontons.sweep(set1, {MU: [0.5, 1.5]}, of=functions[kind])
    if kind == "numbers":
        assert found["a"].values.tolist() == [0.5, 0.5] and found["b"].dtype == bool
        assert found["c"].values.tolist() == [3.0, 3.0]
    elif kind == "mixed":
        assert found["value"].values.tolist() == ["low", "1.5"]
    else:
        assert found["value"].values.tolist() == [set1.eigenvalues(friction=mu)[0] for mu in (0.5, 1.5)]


@pytest.mark.parametrize(
    ("result", "reason"),
    [
        ([1, 2], r"the function gives value = \[1, 2\], which is neither a number nor a text"),
        (np.zeros(2), "the function gives value = array"),
        ({MU: 1.0}, "the function gives friction.coefficient, which is the name of a parameter"),
    ],
)
def test_results_that_no_table_can_have_are_failures_with_reasons(set1, result, reason):
    with pytest.raises(amontons.Error, match=f"no point of the sweep has a result; the first one: {reason}"):
        amontons.sweep(set1, {MU: [0.5, 1.5]}, of=lambda scene: result)


def test_batches_stay_short_where_the_first_items_are_the_fastest(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(_executors.time, "perf_counter", lambda: now[0])
    lasted = []

    def work(_, batch):
        before = now[0]
        now[0] += sum(0.0 if item == 0 else 0.5 for item in batch)
        lasted.append(now[0] - before)
        return batch

    found = [item for batch, _ in _executors.carry_out(work, None, range(2000), AtOnce(), None) for item in batch]
    assert sorted(found) == list(range(2000))
    assert max(lasted) <= 0.5 * _executors.GROWTH


def test_tasks_of_short_items_grow_to_a_second(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(_executors.time, "perf_counter", lambda: now[0])
    sizes = []

    def work(_, batch):
        now[0] += 0.01 * len(batch)
        sizes.append(len(batch))
        return batch

    for _ in _executors.carry_out(work, None, range(100_000), AtOnce(), None):
        pass
    assert 99 <= max(sizes) <= 100 and len(sizes) < 1500


@pytest.mark.parametrize("on", [None, AtOnce()], ids=["here", "executor"])
@pytest.mark.parametrize("name", [name for name in STUDIES if "sweep" not in name] + ["sweep", "run", "locus"])
def test_progress_rises_to_one_and_its_errors_end_the_work(held, name, on):
    values = np.array([0.05, 0.2])
    calls = {
        "sweep": lambda **more: amontons.sweep(held, {MU: np.linspace(0, 1, 300)}, executor=on, **more),
        "run": lambda **more: held.simulate(2.0, **more),
        "locus": lambda **more: held.locus(MU, values, **more),
        "limit cycles": lambda **more: held.limit_cycles(
            "slider.velocity", values, resolution=0.1, executor=on, **SHORT, **more
        ),
        "perturbations": lambda **more: held.perturbations(
            "mass.block.vx", values, resolution=0.1, executor=on, **SHORT, **more
        ),
        "basin": lambda **more: held.basin(
            ("mass.block.x", values), ("mass.block.vx", values), executor=on, **SHORT, **more
        ),
        "robustness": lambda **more: held.robustness(
            {MU: "normal(±10%)"}, pushes="uniform(0,0.3)", runs=4, points=64, executor=on, **SHORT, **more
        ),
        "loudness": lambda **more: amontons.Scene.builtin("set1").loudness(executor=on, **more),
        "design": lambda **more: amontons.Scene.builtin("set1").design(
            DESIGN, (0.0, 1.25), starts=2, points=1, runs=2, longest=2.0, executor=on, **more
        ),
    }
    parts = []
    calls[name](progress=parts.append)
    assert parts == sorted(parts) and parts[0] >= 0.0 and parts[-1] == 1.0

    def fail(part):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        calls[name](progress=fail)
    calls[name]()


def test_progress_true_shows_a_bar(set1, capsys):
    set1.simulate(0.001, progress=True)
    assert "the run: 100 %" in capsys.readouterr().err
