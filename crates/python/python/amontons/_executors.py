"""Work on any executor: threads, processes, a cluster."""

from __future__ import annotations

import os
import queue
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor
from pickle import PicklingError
from typing import Any, Protocol, TypeVar

from . import _core
from ._errors import ArgumentError, Error
from ._progress import ended_by

Item = TypeVar("Item")
Result = TypeVar("Result")

TASK_SECONDS = 1.0
"""The time that a task is to last."""
SINGLE = 32
"""The most items that are tasks of their own, before it is known how long an item lasts."""
GROWTH = 8
"""The most items of a task, as a multiple of those of the task after which it is submitted."""
ATTEMPTS = 4
"""Attempts at a task whose worker is lost."""


class Executor(Protocol):
    """Something that does work: `concurrent.futures` has executors of threads and processes, `dask.distributed` and
    `mpi4py.futures` those of clusters."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        """Begins a call of a function, and returns a future of the result."""


def carry_out(
    work: Callable[[Any, Sequence[Item]], Result],
    common: Any,
    items: Sequence[Item],
    executor: Executor | None,
    report: Callable[[float], object] | None,
) -> Iterator[tuple[Sequence[Item], Result]]:
    """Calls ``work(common, batch)`` for batches of the items on an executor, and yields each batch with its result as
    they come.

    A task lasts about a second. A task whose worker is lost is done again; where the executor takes no more tasks, each
    is done by a process of its own. The result is None where the worker is lost each time. Without an executor, threads of
    this process do all of it.
    """
    tasks = _Tasks(work, common, items, executor)
    done = 0
    try:
        tasks.begin()
        while tasks.waiting:
            batch, (seconds, result) = tasks.next()
            tasks.submit_after(batch, seconds)
            done += len(batch)
            if report:
                report(done / len(items))
            yield batch, result
    finally:
        tasks.end()


def _futures(executor: Any) -> Executor:
    """The executor itself, or that of a client of Dask, whose own `submit` gives equal tasks one result."""
    if not callable(getattr(executor, "submit", None)):
        raise TypeError(f"{executor!r} is no executor: it has no method submit, as those of concurrent.futures have")
    futures: Executor = executor.get_executor(pure=False) if hasattr(executor, "get_executor") else executor
    return futures


class _OwnThreads:
    """Threads of this process, whose work can be ended."""

    def __init__(self) -> None:
        self.pool = ThreadPoolExecutor(_cores())
        self.is_over = threading.Event()

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        return self.pool.submit(self._call, function, *arguments)

    def _call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        with ended_by(self.is_over):
            return function(*arguments)

    def end(self) -> None:
        self.is_over.set()
        self.pool.shutdown(wait=True, cancel_futures=True)


class _OwnProcesses:
    """A process for each task, at most as many at a time as there are cores: one that dies takes no other task with it."""

    def __init__(self, context: Any) -> None:
        self.context = context
        self.pool = ThreadPoolExecutor(_cores())

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        return self.pool.submit(self._call, function, *arguments)

    def _call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        with ProcessPoolExecutor(1, mp_context=self.context) as pool:
            return pool.submit(function, *arguments).result()

    def end(self) -> None:
        self.pool.shutdown(wait=True, cancel_futures=True)


def _cores() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Tasks:
    """Tasks on an executor, or on threads of this process."""

    def __init__(self, work: Callable[..., Any], common: Any, items: Sequence[Any], executor: Any) -> None:
        self.work = work
        self.common = common
        # How long an item lasts is learnt from some that are spread over all.
        single = range(0, len(items), max(1, -(-len(items) // SINGLE)))
        self.first = [items[place] for place in single]
        self.rest = deque(item for place, item in enumerate(items) if place not in single)
        self.own: _OwnThreads | _OwnProcesses | None = _OwnThreads() if executor is None else None
        """Workers of this module's own, without an executor and after it has broken."""
        self.executor: Executor = self.own or _futures(executor)
        self.finished: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.waiting: dict[Any, tuple[Sequence[Any], int]] = {}
        """The batch of each future, and the attempts at it."""

    def begin(self) -> None:
        for item in self.first:
            self.submit([item])

    def submit_after(self, batch: Sequence[Any], seconds: float) -> None:
        """Submits two batches after one whose items have lasted so long, until there are none.

        An item may last much longer than those before it, so batches grow step by step and are small at the end.
        """
        for _ in range(2):
            share = len(self.rest) // SINGLE + 1
            size = max(1, min(int(TASK_SECONDS / max(seconds, 1e-9)), GROWTH * len(batch), share))
            following = [self.rest.popleft() for _ in range(min(size, len(self.rest)))]
            if following:
                self.submit(following)

    def submit(self, batch: Sequence[Any], attempt: int = 1) -> None:
        try:
            future = self.executor.submit(_timed, self.work, self.common, batch, attempt)
        except BrokenExecutor as error:
            if self.own:
                raise
            warnings.warn(f"the executor takes no more work ({error}); processes of their own do the rest", stacklevel=6)
            # Not in this process: what has ended a worker would end it too.
            self.executor = self.own = _OwnProcesses(getattr(self.executor, "_mp_context", None))
            future = self.executor.submit(_timed, self.work, self.common, batch, attempt)
        self.waiting[future] = batch, attempt
        future.add_done_callback(self.finished.put)

    def next(self) -> tuple[Sequence[Any], tuple[float, Any]]:
        """Waits for a task; gives its batch, the seconds of an item and its result, None where its worker is lost each time."""
        while True:
            future = self._finished()
            if future not in self.waiting:
                # Some executors tell of an end twice.
                continue
            batch, attempt = self.waiting.pop(future)
            try:
                return batch, future.result()
            except Error:
                raise
            except Exception as error:
                # Workers are lost in ways that each executor names as it likes.
                if isinstance(error, PicklingError) or "pickle" in str(error):
                    raise ArgumentError(
                        f"the work cannot be sent to another process: {error}; a function must be in a module of its own"
                    ) from error
                # Dask has tried such a task again already.
                is_killed = type(error).__name__ == "KilledWorker"
                if attempt < ATTEMPTS and not (is_killed and len(batch) == 1):
                    # Items that have done nothing are parted from one that ends its workers.
                    for item in batch:
                        self.submit([item], attempt + 1)
                elif is_killed or isinstance(error, BrokenExecutor):
                    return batch, (TASK_SECONDS, None)
                else:
                    raise RuntimeError(f"a task failed {ATTEMPTS} times: {error}") from error

    def _finished(self) -> Any:
        # A wait without an end cannot be interrupted on every system.
        while True:
            try:
                return self.finished.get(timeout=0.2)
            except queue.Empty:
                continue

    def end(self) -> None:
        for future in self.waiting:
            future.cancel()
        if self.own:
            self.own.end()


def _timed(work: Callable[..., Any], common: Any, batch: Sequence[Any], attempt: int) -> tuple[float, Any]:
    """The result of a task, and how long each of its items took, s. Many tasks share the cores, so none starts threads.

    Dask remembers the failure of a task for all equal ones; `attempt` makes a task that is done again another one.
    """
    begin = time.perf_counter()
    result = _core.on_this_thread(lambda: work(common, batch))
    return (time.perf_counter() - begin) / len(batch), result
