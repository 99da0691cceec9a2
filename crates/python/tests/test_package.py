"""The package itself: its import, its types, its examples, and its tables without xarray."""

import ast
import doctest
import inspect
import pkgutil
import subprocess
import sys
import time
from pathlib import Path

import amontons
import numpy as np
import pytest
from amontons import _core

PACKAGE = Path(amontons.__file__).parent


def test_the_import_is_fast_and_without_numpy(python):
    script = """
import sys, time
begin = time.process_time()
import amontons
print(time.process_time() - begin, "numpy" in sys.modules, "xarray" in sys.modules)
"""
    runs = [python(script).split() for _ in range(5)]
    assert {tuple(rest) for _, *rest in runs} == {("False", "False")}
    assert min(float(seconds) for seconds, *_ in runs) < 0.1


def stub():
    return ast.parse((PACKAGE / "_core.pyi").read_text())


def test_the_stub_has_the_names_of_the_compiled_module():
    classes = {node.name: node for node in stub().body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stub().body if isinstance(node, ast.FunctionDef)}
    public = {name for name in vars(_core) if not name.startswith("_")}
    assert public == {*classes, *functions, "VERSION"}
    for name, node in classes.items():
        members = {
            part.name if isinstance(part, ast.FunctionDef) else part.target.id
            for part in node.body
            if isinstance(part, (ast.FunctionDef, ast.AnnAssign))
        } - {"__init__"}
        found = {member for member in vars(getattr(_core, name)) if not member.startswith("_")}
        assert members == found, name


def test_the_stub_has_the_parameters_of_the_compiled_module():
    def parameters(node, is_method):
        both = [*node.args.posonlyargs, *node.args.args]
        missing = [inspect.Parameter.empty] * (len(both) - len(node.args.defaults))
        defaults = missing + [ast.literal_eval(default) for default in node.args.defaults]
        names = [(argument.arg, default) for argument, default in zip(both, defaults)]
        return [(name, default) for name, default in names if name != "self"]

    checked = 0
    for node in stub().body:
        owner = getattr(_core, node.name) if isinstance(node, ast.ClassDef) else _core
        for function in node.body if isinstance(node, ast.ClassDef) else [node]:
            if not isinstance(function, ast.FunctionDef) or function.name == "__init__":
                continue
            found = inspect.signature(getattr(owner, function.name)).parameters.values()
            compiled = [(part.name, part.default) for part in found if part.name != "self"]
            assert parameters(function, owner is not _core) == compiled, function.name
            checked += 1
    assert checked > 20


def test_types_of_the_sources_agree():
    pytest.importorskip("mypy")
    result = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", "/dev/null", "--ignore-missing-imports"]
        + ["--follow-imports", "silent", str(PACKAGE)],
        capture_output=True,
        text=True,
    )
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("name", sorted(module.name for module in pkgutil.iter_modules([str(PACKAGE)])))
def test_the_examples_of_docstrings_run(name):
    if name == "_core":
        pytest.skip("its examples are in Python")
    module = __import__(f"amontons.{name}", fromlist=["*"])
    failed, _ = doctest.testmod(module, extraglobs={"amontons": amontons, "np": np}, optionflags=doctest.ELLIPSIS)
    assert failed == 0


def test_the_examples_of_the_package_run():
    failed, tried = doctest.testmod(amontons)
    assert failed == 0 and tried


def test_every_public_name_is_described():
    for owner in (amontons.Scene, amontons.Simulation):
        for name, member in vars(owner).items():
            if not name.startswith("_"):
                assert inspect.getdoc(member), f"{owner.__name__}.{name}"
    for name in amontons.__all__:
        assert inspect.getdoc(getattr(amontons, name)), name


def test_tables_are_dictionaries_where_xarray_is_missing(python):
    python(
        """
import sys
sys.modules["xarray"] = sys.modules["tqdm"] = sys.modules["tqdm.auto"] = None
import amontons, numpy as np
scene = amontons.Scene.builtin("set1")
run = scene.simulate(0.001, outputs=["module[1].x1"], progress=True)
assert sorted(run) == ["module[1].x1", "time"] and run["time"].shape == (6,)
found = amontons.sweep(scene, {"friction.coefficient": [1.0, 1.5], "slider.velocity": [0.1, 0.2, 0.3]})
assert found["growth_rate"].shape == (2, 3) and found["slider.velocity"].tolist() == [0.1, 0.2, 0.3]
assert found.attrs["scene"] == "set1"
locus = scene.locus("friction.coefficient", np.linspace(1.0, 1.5, 3))
assert locus["frequency"].shape == (6, 3) and len(locus["crossing_value"]) == 1
slip = amontons.Scene.builtin("stick_slip")
found = slip.basin(("mass.block.x", [0.0, 0.01]), ("mass.block.vx", [0.0, 0.1]), longest=60.0, window=10.0)
assert found["attractor"].shape == (2, 2)
found = slip.limit_cycles("slider.velocity", [0.05, 0.2], resolution=0.5, longest=60.0, window=10.0)
assert found["kind"].tolist() == ["periodic", "periodic"]
found = slip.perturbations("mass.block.vx", [0.0, 0.1], resolution=0.5, longest=60.0, window=10.0)
assert len(found["attractor"]) == len(found["mass.block.vx"]) >= 2
found = scene.robustness({"friction.coefficient": "uniform(1,1.4)"}, points=16)
assert found["probability"].tolist() == ["unstable", "stable", "no equilibrium"] and found["growth_first"].shape == (1,)
found = scene.loudness()
assert found["speed_rms"].shape == (len(found["motion_kind"]), len(found["point"]))
"""
    )


def test_a_notebook_shows_a_scene(set1):
    html = set1._repr_html_()
    assert html.startswith("<figure><svg") and "set1: 2 contacts" in html
    assert set1.draw()._repr_svg_() == set1._repr_svg_()


def test_pictures_are_written(set1, tmp_path):
    set1.draw(tmp_path / "set1.svg")
    set1.draw(tmp_path / "set1.png")
    assert (tmp_path / "set1.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "set1.svg").read_text()


def test_an_fmu_is_written_with_the_chosen_step(set1, tmp_path):
    import zipfile

    path = set1.with_integrator(step=5e-7).export(tmp_path / "set1.fmu")
    with zipfile.ZipFile(path) as fmu:
        text = fmu.read("modelDescription.xml").decode()
    assert 'modelName="set1"' in text and 'stepSize="' in text
