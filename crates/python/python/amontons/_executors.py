"""Work on any executor: threads, processes, a cluster."""

from __future__ import annotations

import os
import queue
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor
from typing import Any, Protocol, TypeVar

from . import _core

Item = TypeVar("Item")
Result = TypeVar("Result")

TASK_SECONDS = 1.0
"""The time that a task is to last."""
SINGLE = 32
"""The most items that are tasks of their own, before it is known how long an item lasts."""
ATTEMPTS = 4
"""Attempts at a task whose worker is lost."""


class Executor(Protocol):
    """Where work is done: `concurrent.futures` has executors of threads and processes, `dask.distributed` and
    `mpi4py.futures` those of clusters."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        """Has a function called, and gives a future of its result."""


def carry_out(
    work: Callable[[Any, Sequence[Item]], Result],
    common: Any,
    items: Sequence[Item],
    executor: Executor | None,
    report: Callable[[float], object] | None,
) -> Iterator[tuple[Sequence[Item], Result]]:
    """Calls ``work(common, batch)`` for batches of the items on an executor, and yields each batch with its result as
    they come.

    A task lasts about a second. A task whose worker is lost is done again; where the executor takes no more tasks, the
    rest is done by threads of this process. Without an executor, all of it is.
    """
    own = ThreadPoolExecutor(os.cpu_count()) if executor is None else None
    tasks = _Tasks(work, common, own or _futures(executor))
    done = 0
    try:
        rest = tasks.submit_singly(items)
        while tasks.waiting:
            batch, (seconds, result) = tasks.next()
            if rest:
                tasks.submit_in_batches(rest, seconds)
                rest = []
            done += len(batch)
            if report:
                report(done / len(items))
            yield batch, result
    finally:
        tasks.cancel()
        for pool in (own, tasks.own):
            if pool:
                pool.shutdown(wait=True, cancel_futures=True)


def _futures(executor: Any) -> Executor:
    """The executor itself, or that of a client of Dask, whose own `submit` gives equal tasks one result."""
    if not callable(getattr(executor, "submit", None)):
        raise TypeError(f"{executor!r} is no executor: it has no method submit, as those of concurrent.futures have")
    return executor.get_executor(pure=False) if hasattr(executor, "get_executor") else executor


class _Tasks:
    """Tasks on an executor."""

    def __init__(self, work: Callable[..., Any], common: Any, executor: Executor) -> None:
        self.work = work
        self.common = common
        self.executor = executor
        self.own: ThreadPoolExecutor | None = None
        """Threads of this process, after the executor has broken."""
        self.finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.waiting: dict[Any, tuple[Sequence[Any], int]] = {}
        """The batch of each future, and the attempts at it."""

    def submit(self, batch: Sequence[Any], attempt: int = 1) -> None:
        try:
            future = self.executor.submit(_timed, self.work, self.common, batch)
        except BrokenExecutor as error:
            if self.own:
                raise
            warnings.warn(f"the executor takes no more work ({error}); this process does the rest", stacklevel=5)
            self.executor = self.own = ThreadPoolExecutor(os.cpu_count())
            future = self.executor.submit(_timed, self.work, self.common, batch)
        self.waiting[future] = batch, attempt
        future.add_done_callback(self.finished.put)

    def submit_singly(self, items: Sequence[Any]) -> list[Any]:
        """Submits some items, spread over all, as tasks of their own; gives the others."""
        stride = max(1, len(items) // SINGLE)
        single = range(0, len(items), stride)
        for place in single:
            self.submit([items[place]])
        return [item for place, item in enumerate(items) if place not in single]

    def submit_in_batches(self, items: Sequence[Any], seconds: float) -> None:
        """Submits items of which each lasts so long."""
        size = max(1, min(int(TASK_SECONDS / max(seconds, 1e-9)), len(items) // (4 * (os.cpu_count() or 1)) + 1))
        for first in range(0, len(items), size):
            self.submit(items[first : first + size])

    def next(self) -> tuple[Sequence[Any], tuple[float, Any]]:
        """Waits for a task; gives its batch, the seconds of an item and its result."""
        while True:
            future = self._finished()
            batch, attempt = self.waiting.pop(future)
            try:
                return batch, future.result()
            except _core.Error:
                raise
            except Exception as error:
                # Workers are lost in ways that each executor names as it likes.
                if attempt == ATTEMPTS:
                    raise RuntimeError(f"a task failed {ATTEMPTS} times: {error}") from error
                self.submit(batch, attempt + 1)

    def _finished(self) -> Any:
        # A wait without an end cannot be interrupted on every system.
        while True:
            try:
                return self.finished.get(timeout=0.2)
            except queue.Empty:
                continue

    def cancel(self) -> None:
        for future in self.waiting:
            future.cancel()


def _timed(work: Callable[..., Any], common: Any, batch: Sequence[Any]) -> tuple[float, Any]:
    """The result of a task, and how long each of its items took, s. Many tasks share the cores, so none starts threads."""
    begin = time.perf_counter()
    result = _core.on_this_thread(lambda: work(common, batch))
    return (time.perf_counter() - begin) / len(batch), result
