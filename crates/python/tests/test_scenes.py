"""Scenes keep what they are given, and say what they leave out."""

import pickle

import amontons
import numpy as np
import pytest

DRIVEN = """
[[signal]]
input = "friction.coefficient"
sine = { amplitude = 0.1, frequency = 5.0 }
"""


@pytest.fixture
def driven(set1):
    return amontons.Scene.from_toml(set1.text + DRIVEN, "driven")


def step_of(scene):
    return scene.start().internal_step


def test_changes_of_method_and_step_add_up_and_survive_a_pickle(set1):
    for changed in (
        set1.with_integrator(method="event-driven").with_integrator(step=3e-6),
        set1.with_integrator(step=3e-6).with_values({"integrator.step": 5e-7}),
        set1.with_values({"integrator.step": 5e-7}).with_integrator(step=3e-6),
        set1.with_integrator(preset="design").with_integrator("forward-increment", 2e-6),
    ):
        again = pickle.loads(pickle.dumps(changed))
        assert again == changed and step_of(again) == step_of(changed)
        runs = [scene.simulate(0.002, outputs=["module[1].x1"]) for scene in (changed, again)]
        assert runs[0].identical(runs[1])
    assert step_of(set1.with_integrator(step=3e-6).with_values({"integrator.step": 5e-7})) == 5e-7


def test_a_value_counts_once_and_equal_scenes_have_one_hash(set1):
    twice = set1.with_values({"friction.coefficient": 1.0}).with_values({"friction.coefficient": 0.9})
    once = set1.with_values({"friction.coefficient": 0.9})
    assert twice == once and hash(twice) == hash(once) and twice.values == {"friction.coefficient": 0.9}
    a, b = ({"module[1].m1": 0.3, "module[2].m1": 0.4}, {"module[2].m1": 0.4, "module[1].m1": 0.3})
    assert set1.with_values(a) == set1.with_values(b)
    assert once != set1 and len({once, twice, set1}) == 2


def test_an_analysis_at_one_instant_says_what_it_leaves_out(driven):
    with pytest.warns(UserWarning, match="selects another instant"):
        at_zero = driven.eigenvalues()
    # A quarter of the period later the sine adds its amplitude.
    later = driven.eigenvalues(at=0.05)
    plain = amontons.Scene.builtin("set1")
    assert np.array_equal(at_zero, plain.eigenvalues())
    assert np.allclose(later, plain.eigenvalues(friction=1.96 + 0.1), rtol=1e-12)


def test_a_parameter_that_a_signal_drives_is_not_swept_at_an_instant(driven):
    for call in (
        lambda: driven.eigenvalues(friction=0.5, at=0.0),
        lambda: amontons.sweep(driven, {"friction.coefficient": [0.5, 0.9]}, at=0.0),
        lambda: driven.locus("friction.coefficient", [0.5, 0.9], at=0.0),
        lambda: driven.candidates(0.5, 0.9, at=0.0),
    ):
        with pytest.raises(amontons.Error, match="signal"):
            call()


def test_a_state_belongs_to_one_scene_with_its_values_and_its_step(set1):
    state = set1.start().save()
    for other in (
        set1.with_integrator(step=5e-7),
        set1.with_integrator("event-driven"),
        set1.with_values({"module[1].m1": 0.3}),
        amontons.Scene.builtin("set2"),
    ):
        with pytest.raises(amontons.Error, match="belongs to another scene"):
            other.start().restore(state)


def test_each_flipped_bit_of_a_state_is_found(set1):
    simulation = set1.start()
    simulation.advance_to(0.001)
    state = simulation.save()
    for bit in range(0, 8 * len(state), 37):
        flipped = bytearray(state)
        flipped[bit // 8] ^= 1 << bit % 8
        with pytest.raises(amontons.Error):
            simulation.restore(bytes(flipped))
    simulation.restore(state)


def test_values_that_cannot_be_are_told_and_left_out():
    scene = amontons.Scene.builtin("stick_slip")
    with pytest.warns(UserWarning, match="skipped"):
        found = scene.limit_cycles("friction.coefficient", [0.1, 0.2, 0.9], longest=60.0, window=10.0)
    assert found["friction.coefficient"].values.tolist() == [0.1, 0.2]


def test_a_motion_needs_no_friction():
    text = """
[[mass]]
name = "m"
mass = 1.0
locked = ["y"]
[[spring]]
name = "k"
between = ["m", "ground"]
direction = "x"
stiffness = 100.0
[[damper]]
name = "c"
between = ["m", "ground"]
direction = "x"
damping = 1.0
[[initial]]
mass = "m"
x = 0.01
[integrator]
method = "event-driven"
step = 1e-3
"""
    found = amontons.sweep(amontons.Scene.from_toml(text), {"mass.m.mass": [1.0, 2.0]}, of="motion")
    assert found["kind"].values.tolist() == ["equilibrium", "equilibrium"]


def test_an_orbit_of_another_scene_is_no_start(set1):
    orbit = amontons.Scene.builtin("stick_slip").orbit()
    for start in (orbit, {**orbit["orbit"], "displacement": []}, {**orbit["orbit"], "period": -1.0}):
        with pytest.raises(amontons.ArgumentError, match="orbit"):
            set1.orbit(start)


def test_tables_can_be_written_to_a_file(set1, tmp_path):
    pytest.importorskip("scipy")
    locus = set1.locus("friction.coefficient", [1.0, 1.25, 1.5])
    locus.to_netcdf(tmp_path / "locus.nc", engine="scipy")
    slip = amontons.Scene.builtin("stick_slip")
    found = slip.perturbations("mass.block.vx", [0.0, 0.1], resolution=0.5, longest=60.0, window=10.0)
    found.drop_vars([name for name in found.variables if found[name].dtype.kind == "U"]).to_netcdf(
        tmp_path / "found.nc", engine="scipy"
    )
    assert all(isinstance(value, (str, int, float)) for value in found.attrs.values())


def test_a_missing_file_is_an_oserror(tmp_path):
    with pytest.raises(OSError):
        amontons.Scene.read(tmp_path / "none.toml")


def test_a_point_without_an_equilibrium_in_sliding_has_no_growth_rate():
    text = """
[slider]
velocity = 0.1
angle = 0.0
[friction]
coefficient = 0.4
[[mass]]
name = "pad"
mass = 2.0
force = [0.0, -50.0]
[[spring]]
name = "k"
between = ["pad", "ground"]
direction = "x"
stiffness = 100.0
[[contact]]
name = "c"
mass = "pad"
[integrator]
step = 1e-5
"""
    scene = amontons.Scene.from_toml(text)
    with pytest.warns(UserWarning, match="1 of 2 points have no result"):
        found = amontons.sweep(scene, {"slider.angle": [0.0, 3.0]})
    # Turned upside down, the load pulls the pad off.
    assert found["growth_rate"].notnull().values.tolist() == [True, False]
    assert "pulls the structure off" in str(found["failure"].values[1])


def test_an_output_has_no_value_in_a_scene(set1):
    with pytest.raises(amontons.ArgumentError, match="is an output"):
        set1["module[1].v2"]


def test_numbers_of_contact_states_have_their_names(set1):
    run = set1.simulate(0.001, outputs=["contact[1].state"])
    meanings = dict(zip(run["contact[1].state"].flag_values.tolist(), run["contact[1].state"].flag_meanings.split()))
    assert meanings[int(run["contact[1].state"][-1])] == "Sl" and meanings[4] == "Dt"


def test_a_branch_has_points_and_a_start_without_one_its_reason():
    scene = amontons.Scene.builtin("set2")
    found = scene.branches("friction.coefficient", 2.0, 2.02, [("mode", 4), ("mode", 99)], points=3)
    assert len(found["branches"]) == 2 and "failure" in found["branches"][1]
    assert "rest" in found and "look" in found


def test_thresholds_and_crossings_have_units(set1):
    slip = amontons.Scene.builtin("stick_slip")
    text = slip.text + "\n[damping]\nalpha = 0.3\n"
    found = amontons.Scene.from_toml(text).perturbations(
        "mass.block.vx", [0.0, 0.3], resolution=0.5, longest=60.0, window=10.0
    )
    assert found["threshold_low"].attrs["units"] == "m/s" and found["attractor_amplitude"].attrs["units"] == "m"
    locus = set1.locus("friction.coefficient", [1.0, 1.5])
    assert locus["crossing_frequency"].attrs["units"] == "Hz"
