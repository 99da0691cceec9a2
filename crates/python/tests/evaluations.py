"""Functions of scenes, in a module so that processes can have them."""

import os
import time
from pathlib import Path


def work(item_seconds, batch):
    """Squares after some time."""
    time.sleep(item_seconds * len(batch))
    return [number * number for number in batch]


def friction(scene):
    """The friction coefficient."""
    return scene["friction.coefficient"]


def amplitude(scene):
    """The largest displacement in a short run."""
    run = scene.simulate(stop_time=0.002, outputs=["module[1].x1"])
    return {"largest": float(abs(run["module[1].x1"].values).max()), "rows": len(run["time"])}


def dies_once(scene):
    """The friction coefficient; the first process that asks for 1.0 dies."""
    marker = Path(os.environ["AMONTONS_TEST_MARKER"])
    if scene["friction.coefficient"] == 1.0 and not marker.exists():
        marker.touch()
        os._exit(9)
    return scene["friction.coefficient"]


def fails_above_one(scene):
    """A result, or an error above 1."""
    if scene["friction.coefficient"] > 1.0:
        raise ZeroDivisionError("too slippery")
    return scene["friction.coefficient"]


def fails_once(marker, batch):
    """The batch; the first call of all fails."""
    if not Path(marker).exists():
        Path(marker).touch()
        raise ConnectionError("the worker is lost")
    return list(batch)


def end_process():
    """Kills the process that calls it."""
    os._exit(9)


def dies_at_one(scene):
    """The friction coefficient; each process that asks for 1.0 dies."""
    if scene["friction.coefficient"] == 1.0:
        os._exit(9)
    return scene["friction.coefficient"]
