"""What a run needs that its scene leaves out of the law of contact is said once, and stops nothing."""

import math
import zipfile
from pathlib import Path

import pytest
from fmpy.fmi2 import fmi2OK, fmi2Warning

SCENES = Path(__file__).parents[4] / "scenes" / "effects"
# ω of both scenes, 1/s, and the communication steps of a run: as many in a second.
PULSATION = 10.0
STEPS = 100


@pytest.fixture
def effect(amontons, fmu_in, tmp_path):
    """The FMU of a scene of single effects, with something in its file replaced."""

    def make(name, old="", new=""):
        scene = tmp_path / f"{name}.toml"
        text = (SCENES / scene.name).read_text(encoding="utf-8")
        assert old in text
        scene.write_text(text.replace(old, new), encoding="utf-8")
        fmu = tmp_path / f"{name}.fmu"
        amontons("export", scene, "-o", fmu)
        folder = tmp_path / name
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        return fmu_in(folder)

    return make


def warned(one):
    """Runs for a second; the numbers of the steps, from 1, that told something, and what."""
    one.initialize({"integrator.step": 1e-5})
    found = []
    for step in range(STEPS):
        told = len(one.messages)
        assert one.DoStep(step / STEPS, 1 / STEPS) == fmi2OK
        for message in one.messages[told:]:
            if message.category != "logEvents":
                assert (message.status, message.category) == (fmi2Warning, "logStatusWarning")
                found.append((step + 1, message.text))
    return found


@pytest.mark.parametrize(
    ("name", "phase", "count"),
    [
        # The block is faster than the belt first where sin(ω t) < -1/2,
        ("sticking", 7 * math.pi / 6, "reversed_slips"),
        # and the foot would have to be pulled where cos(ω t) < -3/4.
        ("detachment", math.acos(-0.75), "pulled_contacts"),
    ],
)
def test_the_first_step_that_needs_what_is_left_out_says_so(effect, instance, name, phase, count):
    one = instance(effect(name), logging_on=True)
    [(step, text)] = warned(one)
    assert step == math.ceil(STEPS * phase / PULSATION)
    assert f"statistics.{count} = " in text and f"`{name} = false`" in text
    # And again in another run.
    assert one.Reset() == fmi2OK
    assert warned(one) == [(step, text)]


@pytest.mark.parametrize("name", ["sticking", "detachment"])
def test_the_whole_law_of_contact_warns_of_nothing(effect, instance, name):
    assert warned(instance(effect(name, f"{name} = false", ""), logging_on=True)) == []


def warnings_of(one):
    return [message.text for message in one.messages if message.category == "logStatusWarning"]


def test_an_equilibrium_without_friction_at_a_slider_held_at_zero_is_said_once(instance):
    # A container that couples FMUs sets linked inputs to 0 until their values come.
    one = instance("set1", logging_on=True)
    one.initialize({"slider.velocity": 0.0})
    [text] = warnings_of(one)
    assert text.startswith("initialized with slider.velocity = 0: equilibrium without friction")
    assert one.DoStep(0.0, 1e-3) == fmi2OK
    assert len(warnings_of(one)) == 1
    for values in ({"slider.velocity": 1e-9}, {"slider.velocity": 0.0, "friction.coefficient": 0.0}):
        other = instance("set1", logging_on=True)
        other.initialize(values)
        assert warnings_of(other) == []


def test_a_scene_whose_slider_stands_by_itself_warns_of_nothing(instance):
    one = instance("den_hartog", logging_on=True)
    one.initialize()
    assert warnings_of(one) == []
