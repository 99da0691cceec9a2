"""The pages of the book on Python do what they say, and its notebook runs."""

import contextlib
import io
import os
import subprocess
import sys
from pathlib import Path

import amontons
import pytest

DOCS = Path(__file__).resolve().parents[3] / "docs"


def blocks(page):
    """The kind and text of each block of code."""
    kind, lines = None, []
    for line in page.read_text().splitlines():
        if not line.startswith("```"):
            lines.append(line)
        elif kind is None:
            kind, lines = line[3:], []
        else:
            yield kind, "\n".join(lines) + "\n"
            kind = None


@pytest.mark.parametrize("page", ["analyses/python.md", "analyses/python-tools.md"])
def test_the_examples_of_the_book_print_what_they_say(page, tmp_path, monkeypatch):
    if page.endswith("tools.md"):
        for package in ("SALib", "openturns", "sklearn"):
            pytest.importorskip(package)
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    module = Path(amontons.__file__).parent.parent
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(module), str(tmp_path)]))
    space = {"__name__": "__main__"}
    printed = None
    for kind, text in blocks(DOCS / page):
        first = text.partition("\n")[0]
        if kind == "python,ignore" and first.startswith("# ") and first.endswith(".py"):
            Path(first[2:]).write_text(text)
        elif kind == "python,ignore":
            with contextlib.redirect_stdout(io.StringIO()) as output:
                exec(compile(text, page, "exec"), space)
            printed = output.getvalue()
        elif kind == "sh,ignore" and "mpiexec" in text:
            beside = Path(sys.executable).parent
            path = os.pathsep.join([str(beside), os.environ["PATH"]])
            printed = subprocess.run(
                text, shell=True, check=True, capture_output=True, text=True, env={**os.environ, "PATH": path}
            ).stdout
        elif kind == "text":
            assert printed == text
            printed = None


def test_the_notebook_runs(tmp_path, monkeypatch):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("PYTHONPATH", str(Path(amontons.__file__).parent.parent))
    notebook = nbformat.read(DOCS / "notebooks" / "cluster.ipynb", as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "clear the outputs of the notebook"
    client = nbclient.NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    assert "image/png" in str(notebook.cells)
