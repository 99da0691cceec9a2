"""What FMPy's own checks say."""

import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from conftest import SCENES
from lxml import etree


@pytest.mark.parametrize("scene", SCENES)
def test_fmpy_validate_prints_that_there_are_no_problems(fmus, scene):
    command = [sys.executable, "-m", "fmpy", "validate", str(fmus[scene])]
    # What it prints is the verdict; its exit code is zero whatever it finds.
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "No problems found."


@pytest.mark.parametrize("scene", SCENES)
def test_the_model_description_follows_the_schema(unpacked, scene):
    schema = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    description = etree.parse(str(unpacked(scene).folder / "modelDescription.xml"))
    etree.XMLSchema(file=str(schema)).assertValid(description)


def test_the_schema_is_one_that_refuses(unpacked):
    """The test above can fail: an attribute that FMI does not know."""
    schema = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    description = etree.parse(str(unpacked("set1").folder / "modelDescription.xml"))
    description.getroot().set("colour", "red")
    assert not etree.XMLSchema(file=str(schema)).validate(description)
