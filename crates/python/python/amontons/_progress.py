"""Progress of long work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def reporting(
    progress: Callable[[float], object] | bool | None, what: str
) -> Iterator[Callable[[float], object] | None]:
    """The function that receives the part of the work that is done, from 0 to 1; None for nobody.

    `progress` is such a function, or True for a bar of tqdm, which is left out where tqdm is not installed.
    """
    if callable(progress) or not progress:
        yield progress or None
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
