"""The scene inside an unpacked FMU is found however an importer names its folder."""

import os
from urllib.parse import quote

import fmpy
import pytest

NAME = "unpacked here, größer µ"


@pytest.fixture(scope="module")
def folder(fmus, tmp_path_factory):
    """An unpacked FMU in a folder with a space and letters beyond ASCII."""
    return fmpy.extract(str(fmus["set1"]), tmp_path_factory.mktemp("resources") / NAME)


SPELLINGS = {
    "FMPy's own": lambda path: path.as_uri(),
    "three slashes": lambda path: "file://" + quote(str(path)),
    "one slash": lambda path: "file:" + quote(str(path)),
    "four slashes": lambda path: "file:///" + quote(str(path)),
    "localhost": lambda path: "file://localhost" + quote(str(path)),
    "slash at the end": lambda path: "file://" + quote(str(path)) + "/",
    "small hexadecimal digits": lambda path: "file://" + quote(str(path)).replace("%C3", "%c3"),
    "only the space encoded": lambda path: "file://" + str(path).replace(" ", "%20"),
    "nothing encoded": lambda path: "file://" + str(path),
    "a path": lambda path: str(path),
    "NULL": lambda path: None,
    "empty": lambda path: "",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_the_resources_are_found(instance, fmu_in, folder, spelling):
    resources = SPELLINGS[spelling](folder / "resources")
    one = instance(fmu_in(folder), resources=resources)
    assert one.component is not None, one.reason
    assert one.initialize().advance([1e-3]).times[-1] == 1e-3


def test_null_means_the_resources_beside_the_library(instance, fmu_in, folder, tmp_path):
    """Without them there is none to find."""
    bare = tmp_path / "bare"
    library = next((folder / "binaries" / fmpy.platform).glob("*.*"))
    copy = bare / library.relative_to(folder)
    copy.parent.mkdir(parents=True)
    copy.write_bytes(library.read_bytes())
    (bare / "modelDescription.xml").write_bytes((folder / "modelDescription.xml").read_bytes())
    one = instance(fmu_in(bare), resources=None)
    assert one.component is None
    assert f"{bare.resolve()}/resources/scene.toml" in one.reason
    # Named, the other folder's resources serve this library too.
    one = instance(fmu_in(bare), resources=(folder / "resources").as_uri())
    assert one.component is not None


NO_LOCAL_FOLDER = {
    "a folder that is not there": lambda path: "file:///nowhere/resources",
    "another scheme": lambda path: "http://localhost" + quote(str(path)),
    "another host": lambda path: "file://elsewhere" + quote(str(path)),
    "a relative path": lambda path: os.path.relpath(path),
    "a path encoded to half": lambda path: "file://" + quote(str(path)) + "/%2",
    "a path encoded wrongly": lambda path: "file://" + quote(str(path)) + "/%zz",
    "no path": lambda path: "file:",
}


@pytest.mark.parametrize("spelling", NO_LOCAL_FOLDER)
def test_what_names_no_local_folder_is_refused(instance, fmu_in, folder, spelling):
    resources = NO_LOCAL_FOLDER[spelling](folder / "resources")
    one = instance(fmu_in(folder), resources=resources)
    assert one.component is None
    assert one.reason
