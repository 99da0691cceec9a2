"""Eigenvalues, loci and equilibria against closed forms and against matrices that NumPy solves."""

import amontons
import numpy as np
import pytest

OSCILLATOR = """
[[mass]]
name = "m"
mass = 2.0
locked = ["y"]
[[spring]]
name = "k"
between = ["m", "ground"]
direction = "x"
stiffness = 800.0
[damping]
alpha = 3.0
[[initial]]
mass = "m"
x = 0.01
[integrator]
method = "event-driven"
step = 1e-3
[experiment]
stop_time = 1.0
output_interval = 0.01
"""


def of_set1(friction):
    """Eigenvalues of Set 1 in uniform sliding with Im λ > 0, from its masses and springs."""
    m1, m2, beta, angle = 0.3, 0.7, 3e-5, 0.5
    k1, k2, k3, k4, k5, k6 = 55e3, 60e3, 22e3, 60e3, 300e3, 250e3
    stiffness = np.zeros((8, 8))  # x and y of m1, x and y of m2, of both modules

    def spring(k, one, other=None):
        places = [one] if other is None else [one, other]
        signs = np.array([1.0, -1.0])[: len(places)]
        stiffness[np.ix_(places, places)] += k * np.outer(signs, signs)

    for m in (0, 4):
        spring(k4, m)
        spring(k3, m + 1)
        spring(k6, m, m + 2)
        spring(k5, m + 1, m + 3)
        spring(k1, m, 4 - m)
        spring(k2, m + 1, 5 - m)
    mass = np.diag([m1, m1, m2, m2] * 2)
    tangent = np.array([np.cos(angle), np.sin(angle)])
    normal = np.array([-np.sin(angle), np.cos(angle)])
    # m2 moves along the tangent, and what is orthogonal to N (n + µ t) has no contact force.
    motion, forces = np.zeros((8, 6)), np.zeros((8, 6))
    for module in (0, 1):
        m, q = 4 * module, 3 * module
        for matrix, along in ((motion, tangent), (forces, tangent - friction * normal)):
            matrix[m, q] = matrix[m + 1, q + 1] = 1.0
            matrix[m + 2 : m + 4, q + 2] = along
    mass, stiffness = forces.T @ mass @ motion, forces.T @ stiffness @ motion
    inverse = np.linalg.inv(mass)
    lower = np.hstack([-inverse @ stiffness, -beta * inverse @ stiffness])
    values = np.linalg.eigvals(np.vstack([np.hstack([np.zeros((6, 6)), np.eye(6)]), lower]))
    return np.sort_complex(values[values.imag > 0])


@pytest.mark.parametrize("friction", [0.0, 0.5, 1.5, 1.96])
def test_eigenvalues_of_set1_are_those_of_its_matrices(set1, friction):
    expected = of_set1(friction)
    for found in (
        set1.eigenvalues(friction=friction),
        set1.with_values({"friction.coefficient": friction}).eigenvalues(),
        set1.modes(friction=friction)[0],
        set1.states(friction=friction)["Sl-Sl"],
    ):
        # Rounding of matrices with a norm of about 1e6 1/s².
        assert np.abs(np.sort_complex(found) - expected).max() < 1e-9


def test_the_coefficient_at_which_set1_begins_to_squeal_is_that_of_its_matrices(set1):
    low, high = 1.0, 1.5
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if of_set1(middle).real.max() > 0 else (middle, high)
    values = np.linspace(1.0, 1.5, 7)
    locus = set1.locus("friction.coefficient", values)
    [value], [frequency], [grows] = (locus[f"crossing_{name}"].values for name in ("value", "frequency", "begins"))
    fastest = max(of_set1(low), key=lambda value: value.real)
    assert abs(value - low) < 1e-8 and grows
    assert frequency == pytest.approx(fastest.imag / (2 * np.pi), rel=1e-6)
    assert locus["growth_rate"].sizes == {"mode": 6, "friction.coefficient": 7}
    for place, value in enumerate(values):
        expected = np.sort(of_set1(value).real)
        assert np.abs(np.sort(locus["growth_rate"].values[:, place]) - expected).max() < 1e-9


def test_derivatives_by_friction_are_those_of_the_matrices(set1):
    found = set1.sensitivities(friction=1.5)
    place = list(found["parameter"].values).index("friction.coefficient")
    derivatives = found["growth_rate_derivative"].values + 2j * np.pi * found["frequency_derivative"].values
    h = 1e-3
    ends = {by: of_set1(1.5 + by) for by in (h, -h, h / 2, -h / 2)}
    for mode, derivative in enumerate(derivatives[:, place]):
        now = found["growth_rate"].values[mode] + 2j * np.pi * found["frequency"].values[mode]
        at = lambda by: min(ends[by], key=lambda value: abs(value - now))
        central = [(at(step) - at(-step)) / (2 * step) for step in (h, h / 2)]
        expected = (4 * central[1] - central[0]) / 3
        assert abs(derivative - expected) < 1e-6 * abs(expected)


def test_the_modes_of_hoffmanns_model_merge_where_the_discriminant_vanishes():
    cos2, sin2 = 0.75, 0.25
    xx, yy = 31.0 * cos2, 31.0 * sin2 + 20.0
    xy = (11.0 - 20.0) * np.sqrt(cos2 * sin2)
    surface = 0.01
    mu = np.polynomial.Polynomial([0.0, 1.0])
    # Of s² a + s b + c, the determinant of s M + K without the normal force: s is the square of λ.
    a = 1.0 + surface
    b = yy + a * xx - xy * surface * mu
    c = xx * yy - xy * (xy + 20.0 * mu)
    roots = (b**2 - 4.0 * a * c).roots()
    critical = min(root.real for root in roots if abs(root.imag) < 1e-12 and root.real > 0)
    locus = amontons.Scene.builtin("hoffmann").locus("friction.coefficient", np.linspace(0.2, 0.3, 5))
    [merging] = locus["merging_value"].values
    assert merging == pytest.approx(critical, abs=1e-6)
    assert critical == pytest.approx(0.2559, abs=5e-5)


def test_one_mass_on_a_spring_has_the_eigenvalue_and_motion_of_the_textbook():
    scene = amontons.Scene.from_toml(OSCILLATOR)
    decay, omega = 1.5, np.sqrt(400.0 - 1.5**2)
    [value] = scene.eigenvalues()
    assert abs(value - complex(-decay, omega)) < 1e-12 * omega
    run = scene.simulate(outputs=["mass.m.x"])
    t = run["time"].values
    expected = 0.01 * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    assert np.abs(run["mass.m.x"].values - expected).max() < 1e-14


def test_a_mode_shape_satisfies_its_equation(set1):
    values, shapes = set1.modes()
    assert shapes.shape == (6, 8)
    assert np.abs(np.abs(shapes).max(axis=1) - 1.0).max() < 1e-15
    # x4 is the displacement along the normal, which sliding keeps at zero.
    assert np.abs(shapes[:, [3, 7]]).max() == 0.0


def test_the_friction_force_in_equilibrium_is_mu_times_the_normal_force(set1):
    found = set1.equilibrium()
    assert list(found["displacement"]) == set1.displacement_names
    for contact in set1.contact_names:
        assert found["friction_force"][contact] == pytest.approx(1.96 * found["normal_force"][contact], rel=1e-15)


def test_the_verdict_and_a_sweep_agree_with_the_matrices(set1):
    values = [1.0, 1.18, 1.19, 1.96]
    found = amontons.sweep(set1, {"friction.coefficient": values})
    for value, rate, frequency in zip(values, found["growth_rate"].values, found["frequency"].values):
        fastest = max(of_set1(value), key=lambda value: value.real)
        assert rate == pytest.approx(fastest.real, abs=1e-9)
        assert frequency == pytest.approx(fastest.imag / (2 * np.pi), rel=1e-12)
    verdicts = amontons.sweep(set1, {"friction.coefficient": values}, of="verdict")["verdict"].values
    assert [verdict == "unstable" for verdict in verdicts] == [False, False, True, True]


def test_candidates_begin_to_grow_where_uniform_sliding_is_stable(set1):
    found = set1.candidates(0.5, 1.5)
    [(first, last)] = found["stable"]
    assert first == 0.5 and of_set1(last - 1e-6).real.max() < 0 < of_set1(last + 1e-6).real.max()


def test_scenes_of_the_same_values_are_equal_and_have_one_hash(set1):
    one = set1.with_values({"friction.coefficient": 0.9})
    other = amontons.Scene.builtin("set1").with_values({"friction.coefficient": 0.9})
    assert one == other and hash(one) == hash(other) and one.hash == other.hash
    assert one != set1 and one.hash != set1.hash and len({one, other, set1}) == 2
    assert set1["friction.coefficient"] == 1.96 and one["friction.coefficient"] == 0.9
    assert set1.with_integrator(step=5e-7).hash != set1.hash
    assert set1 != "set1"
