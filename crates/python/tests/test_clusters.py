"""The same bytes on Dask and MPI, a worker's death included."""

import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import amontons
import evaluations
import numpy as np
import pytest
from amontons._executors import carry_out
from conftest import bytes_of
from test_executors import MU, STUDIES, check_all

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client():
    here = str(Path(__file__).parent)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50
    ) as cluster, distributed.Client(cluster) as client:
        client.run(sys.path.append, here)
        yield client


@pytest.fixture(scope="module")
def expected(held):
    return {name: bytes_of(study(held, None)) for name, study in STUDIES.items()}


@pytest.mark.parametrize("of", ["client", "executor"])
def test_dask_gives_the_same_bytes(client, held, expected, of):
    check_all(held, expected, client if of == "client" else client.get_executor())


@pytest.mark.parametrize("of", ["client", "executor"])
def test_dask_computes_a_task_that_failed_anew(client, tmp_path, of):
    executor = client if of == "client" else client.get_executor()
    found = carry_out(evaluations.fails_once, str(tmp_path / "marker"), [1, 2, 3], executor, None)
    assert sorted(item for batch, _ in found for item in batch) == [1, 2, 3]


def test_dask_finishes_when_a_worker_is_killed(client, set1):
    values = {MU: np.linspace(0.5, 1.9, 60)}
    expected = bytes_of(amontons.sweep(set1, values, of=evaluations.amplitude))
    victim = next(iter(client.scheduler_info()["workers"]))
    killed, done = [], []

    def kill(part):
        if not done:
            killed.append(client.submit(evaluations.end_process, workers=[victim], retries=0))
        done.append(part)

    found = amontons.sweep(set1, values, of=evaluations.amplitude, executor=client, progress=kill)
    assert bytes_of(found) == expected and done == sorted(done) and done[-1] == 1.0
    # The worker is gone; its nanny starts another one.
    assert victim not in client.scheduler_info()["workers"]


MPI = """
import pickle, sys
from pathlib import Path
import amontons
from conftest import bytes_of
from test_executors import STUDIES
from mpi4py.futures import MPIPoolExecutor

if __name__ == "__main__":
    scene = pickle.loads(Path(sys.argv[2]).read_bytes())
    with MPIPoolExecutor() as executor:
        assert executor.num_workers == 2
        found = {name: bytes_of(study(scene, executor)) for name, study in STUDIES.items()}
    Path(sys.argv[1]).write_bytes(pickle.dumps(found))
"""


def test_mpi_gives_the_same_bytes(held, expected, tmp_path):
    pytest.importorskip("mpi4py")
    beside = str(Path(sys.executable).parent)
    mpiexec = shutil.which("mpiexec", path=beside) or shutil.which("mpiexec")
    if not mpiexec:
        pytest.skip("there is no mpiexec")
    script, result, scene = (tmp_path / name for name in ("script.py", "result", "scene"))
    scene.write_bytes(pickle.dumps(held))
    script.write_text(MPI)
    folders = [str(Path(amontons.__file__).parent.parent), str(Path(__file__).parent)]
    subprocess.run(
        [mpiexec, "-n", "3", sys.executable, "-m", "mpi4py.futures", script, result, scene],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(folders)},
        check=True,
        timeout=60,
    )
    assert pickle.loads(result.read_bytes()) == expected
