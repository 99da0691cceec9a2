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
