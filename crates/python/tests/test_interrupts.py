"""Ctrl-C ends long work within about a second, and the objects can be used afterwards."""

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import amontons
import pytest

pytestmark = pytest.mark.skipif(os.name == "nt", reason="a process of Windows cannot be sent Ctrl-C alone")

HERE = {
    "run": "scene.simulate(stop_time=3600.0, output_interval=1.0)",
    "run with many rows": "scene.simulate(stop_time=3600.0, output_interval=1e-5)",
    "simulation": "simulation.advance_to(3600.0)",
    "locus": 'scene.locus("friction.coefficient", np.linspace(0.0, 1.9, 2_000_000))',
    "states": "ring.states()",
    "limit cycles": 'scene.limit_cycles("slider.velocity", np.linspace(0.01, 0.1, 1000), longest=1000.0)',
    "perturbations": 'scene.perturbations("module[1].v1", np.linspace(0.0, 0.1, 1000), longest=1000.0)',
    "basin": 'scene.basin(("module[1].v1", np.linspace(0, 1, 99)), ("module[1].x1", np.linspace(0, 1e-3, 99)))',
    "continuation": "scene.continuation(np.linspace(1.0, 2.0, 1000))",
    "orbit": "scene.orbit(longest=1000.0)",
    "branches": 'scene.branches("slider.velocity", 0.01, 0.2)',
    "robustness": 'scene.robustness({"friction.coefficient": "normal(±5%)"}, points=2**18)',
    "robustness with runs": 'scene.robustness({}, pushes="uniform(0.1,1)", runs=1000, longest=1000.0)',
    "growth rates": 'scene.growth_rates(["friction.coefficient"], np.linspace(0.0, 1.9, 2_000_000).reshape(-1, 1))',
    "loudness": 'slow.loudness(longest=1000.0)',
    "design": 'ring.design({"module[*].k6": "±5%", "module[*].k5": "±5%"}, (0.0, 1.6), runs=0)',
    "transient": 'scene.transient(stop_time=1000.0, of="module[1].x1")',
}
SHARED = {
    "sweep": 'amontons.sweep(scene, {"friction.coefficient": many})',
    "sweep of long motions": 'amontons.sweep(slow, {"friction.coefficient": [1.5, 1.9]}, of="motion")',
    "sweep of long runs": 'amontons.sweep(scene, {"friction.coefficient": [1.5, 1.9]}, of=long)',
    "sweep on threads": 'amontons.sweep(scene, {"friction.coefficient": many}, executor=threads)',
    "sweep on processes": 'amontons.sweep(scene, {"friction.coefficient": many}, executor=processes)',
    "robustness on processes": 'scene.robustness({"friction.coefficient": "normal(±5%)"}, points=2**16, executor=processes)',
    "limit cycles on processes": 'scene.limit_cycles("slider.velocity", np.linspace(0.01, 0.1, 9), longest=0.3, executor=processes)',
}
SCRIPT = """
import os, signal, threading, time
import xarray  # Ctrl-C within an import would leave half of a module
import numpy as np
import amontons
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

def long(scene):
    return scene.simulate(3600.0)["time"].size

if __name__ == "__main__":
    # A process that is started in the background ignores Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    scene = amontons.Scene.builtin("set1")
    slow = scene.with_integrator("forward-increment", step=1e-8)
    ring = amontons.Scene.from_toml(scene.text.replace("modules = 2", "modules = 8"))
    simulation = scene.start()
    many = np.linspace(0.0, 2.0, 300_000)
    threads, processes = ThreadPoolExecutor(2), ProcessPoolExecutor(2)
    list(processes.map(abs, [1, 2]))
    for name, text in WORK.items():
        print(name, end=" ", flush=True)
        sent = []
        def interrupt():
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        timer = threading.Timer(0.25, interrupt)
        timer.start()
        try:
            exec(text)
            print("was not long enough")
        except KeyboardInterrupt:
            print("ended after", time.monotonic() - sent[0], flush=True)
    assert len(scene.eigenvalues()) == 6
    assert len(scene.simulate(0.001)["time"]) == 6
    try:
        simulation.time
    except amontons.Error as error:
        assert "restore a saved state" in str(error)
    simulation.restore(scene.start().save())
    simulation.advance_to(0.001)
    assert simulation.time == 0.001
    print("all can be used", flush=True)
    os._exit(0)
"""


def interrupted(work, tmp_path, seconds):
    """The lines of a process that interrupts its own work; it and its workers are killed after some time."""
    script = tmp_path / "script.py"
    script.write_text(f"WORK = {work!r}\n{SCRIPT}")
    environment = {**os.environ, "PYTHONPATH": str(Path(amontons.__file__).parent.parent)}
    with open(tmp_path / "lines", "w") as lines:
        process = subprocess.Popen(
            [sys.executable, script], env=environment, start_new_session=True, stdout=lines, stderr=lines
        )
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            pass
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    return (tmp_path / "lines").read_text().splitlines()


@pytest.mark.parametrize("work", [HERE, SHARED], ids=["here", "shared"])
def test_ctrl_c_ends_work_and_leaves_all_usable(work, tmp_path):
    *lines, last = interrupted(work, tmp_path, 40.0)
    assert last == "all can be used", "\n".join([*lines, last])
    for name, line in zip(work, lines):
        what, _, seconds = line.partition(" ended after ")
        assert what == name and float(seconds) < 2.0, line
    assert len(lines) == len(work)


def test_ctrl_c_ends_the_search_for_candidates(tmp_path):
    lines = interrupted({"candidates": "ring.candidates(0.0, 1.9)"}, tmp_path, 3.5)
    assert lines[-1] == "all can be used", "\n".join(lines)
