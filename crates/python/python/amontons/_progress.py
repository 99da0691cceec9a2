"""Progress of long work."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_thread = threading.local()


class Ended(BaseException):
    """Ends work of a thread of which nobody awaits the result any more."""


@contextmanager
def ended_by(is_over: threading.Event) -> Iterator[None]:
    """Work of this thread ends at its next report of progress once the event is set: only the main thread sees Ctrl-C."""

    def look(_: float) -> None:
        if is_over.is_set():
            raise Ended

    _thread.look = look
    try:
        yield
    finally:
        del _thread.look


@contextmanager
def reporting(
    progress: Callable[[float], object] | bool | None, what: str
) -> Iterator[Callable[[float], object] | None]:
    """The function that receives the part of the work that is done, from 0 to 1; None for nobody.

    `progress` is such a function, or True for a bar of tqdm, which is left out where tqdm is not installed.
    """
    if not progress:
        yield getattr(_thread, "look", None)
        return
    if callable(progress):
        yield progress
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    form = "{desc}: {percentage:3.0f} %|{bar}| {elapsed}, {remaining} left"
    with tqdm(total=1.0, desc=what, bar_format=form) as bar:

        def report(part: float) -> None:
            bar.n = part
            bar.refresh()

        yield report
