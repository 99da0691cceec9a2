"""The same bytes on Dask and MPI, a worker's death included."""

import shutil
import sys
import threading
import time
from pathlib import Path

import amontons
import evaluations
import numpy as np
import pytest
from conftest import bytes_of
from test_executors import MU, STUDIES, check_all

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def client():
    here = str(Path(__file__).parent)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster, distributed.Client(cluster) as client:
        client.run(sys.path.append, here)
        yield client


@pytest.fixture(scope="module")
def expected(stick_slip):
    return {name: bytes_of(study(stick_slip, None)) for name, study in STUDIES.items()}


@pytest.mark.parametrize("of", ["client", "executor"])
def test_dask_gives_the_same_bytes(client, stick_slip, expected, of):
    check_all(stick_slip, expected, client if of == "client" else client.get_executor())


def test_dask_finishes_when_a_worker_is_killed(client, set1):
    values = {MU: np.linspace(0.5, 1.9, 60)}
    expected = bytes_of(amontons.sweep(set1, values, of=evaluations.amplitude))
    before = client.scheduler_info()["workers"]
    done = []

    def kill(part):
        if not done:
            victim = next(iter(before))
            client.submit(evaluations.end_process, workers=[victim], allow_other_workers=False, retries=0)
        done.append(part)

    found = amontons.sweep(set1, values, of=evaluations.amplitude, executor=client, progress=kill)
    assert bytes_of(found) == expected and done == sorted(done) and done[-1] == 1.0


def test_mpi_gives_the_same_bytes(stick_slip, expected, python, tmp_path):
    pytest.importorskip("mpi4py")
    mpiexec = shutil.which("mpiexec", path=str(Path(sys.executable).parent)) or shutil.which("mpiexec")
    if not mpiexec:
        pytest.skip("there is no mpiexec")
    script = """
import pickle, sys
from pathlib import Path
import amontons
from conftest import bytes_of
from test_executors import STUDIES
from mpi4py.futures import MPIPoolExecutor

if __name__ == "__main__":
    scene = amontons.Scene.builtin("stick_slip")
    with MPIPoolExecutor() as executor:
        assert executor.num_workers == 2
        found = {name: bytes_of(study(scene, executor)) for name, study in STUDIES.items()}
    Path(sys.argv[1]).write_bytes(pickle.dumps(found))
"""
