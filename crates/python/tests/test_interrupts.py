"""Ctrl-C ends long work within about a second, and the objects can be used afterwards."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import amontons
import pytest

WORK = {
    "run": "scene.simulate(stop_time=3600.0, output_interval=1.0)",
    "run_with_many_rows": "scene.simulate(stop_time=3600.0, output_interval=1e-5)",
    "simulation": "simulation.advance_to(3600.0)",
    "locus": "scene.locus(np.linspace(0.0, 1.9, 2_000_000))",
    "states": "ring.states()",
    "candidates": "ring.candidates(0.0, 1.9)",
    "sweep": 'amontons.sweep(scene, {"friction.coefficient": np.linspace(0.0, 2.0, 300_000)})',
    "sweep_of_long_motions": 'amontons.sweep(slow, {"friction.coefficient": [1.5, 1.9]}, of="motion")',
    "sweep_of_long_runs": (
        'amontons.sweep(scene, {"friction.coefficient": [1.5, 1.9]}, of=lambda s: s.simulate(3600.0)["time"].size)'
    ),
    "sweep_on_threads": (
        'amontons.sweep(scene, {"friction.coefficient": np.linspace(0.0, 2.0, 300_000)}, executor=threads)'
    ),
    "sweep_on_processes": (
        'amontons.sweep(scene, {"friction.coefficient": np.linspace(0.0, 2.0, 300_000)}, executor=processes)'
    ),
    "limit_cycles": "scene.limit_cycles(np.linspace(0.01, 0.1, 1000), longest=1000.0)",
    "limit_cycles_on_threads": "scene.limit_cycles(np.linspace(0.01, 0.1, 1000), executor=threads)",
    "perturbations": 'scene.perturbations(np.linspace(0.0, 0.1, 1000), "module[1].v1", longest=1000.0)',
    "basin": 'scene.basin(("module[1].v1", np.linspace(0, 1, 99)), ("module[1].x1", np.linspace(0, 1e-3, 99)))',
    "continuation": "scene.continuation(np.linspace(1.0, 2.0, 1000))",
    "orbit": 'slow.orbit(longest=1000.0)',
    "branches": 'scene.branches("slider.velocity", 0.01, 0.2)',
    "transient": "scene.transient(stop_time=3600.0)",
}
SCRIPT = """
import signal, time
import numpy as np
import amontons
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

if __name__ == "__main__":
    # A process that is started in the background ignores Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    scene = amontons.Scene.builtin("set1")
    slow = scene.with_values({{"slider.velocity": 0.5}}).with_integrator("forward-increment", step=1e-7)
    ring = amontons.Scene.from_toml(scene.text.replace("modules = 2", "modules = 8"))
    simulation = scene.start()
    threads, processes = ThreadPoolExecutor(2), ProcessPoolExecutor(2)
    list(processes.map(abs, [1, 2]))
    print("begins", flush=True)
    try:
        {work}
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    for pool in (threads, processes):
        pool.shutdown(wait=False, cancel_futures=True)
    assert len(scene.eigenvalues()) == 6
    assert len(scene.simulate(0.001)["time"]) == 6
    if {is_simulation}:
        try:
            simulation.time
        except amontons.Error as error:
            assert "restore a saved state" in str(error)
        simulation.restore(scene.start().save())
        simulation.advance_to(0.001)
        assert simulation.time == 0.001
    print("usable", flush=True)
    import os
    os._exit(0)
"""


@pytest.mark.skipif(os.name == "nt", reason="a process of Windows cannot be sent Ctrl-C alone")
@pytest.mark.parametrize("what", WORK)
def test_ctrl_c_ends(what, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(work=WORK[what], is_simulation=what == "simulation"))
    environment = {**os.environ, "PYTHONPATH": str(Path(amontons.__file__).parent.parent)}
    process = subprocess.Popen(
        [sys.executable, script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    try:
        assert process.stdout.readline() == "begins\n", process.stderr.read()
        time.sleep(0.4)
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        assert process.stdout.readline() == "interrupted\n", process.stderr.read()
        waited = time.monotonic() - sent
        assert process.stdout.readline() == "usable\n", process.stderr.read()
        assert waited < 2.0, f"Ctrl-C took {waited:.1f} s"
    finally:
        process.kill()
        process.communicate()
