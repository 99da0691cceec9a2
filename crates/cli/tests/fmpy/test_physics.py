"""What the paper says of its two sets of parameters, seen through FMPy.

Eigenvalues are printed there as growth rate ± frequency, both in Hz: a mode goes with
exp(2π · growth · t).
"""

import numpy as np
import pytest
from conftest import INTEGRATOR

INTERVAL = 2e-4
# Table 2, both contacts sliding: the one mode that grows.
GROWTH, FREQUENCY = 2.68, 219.4
# Bands about the two frequencies at which Set 1 squeals, and all that is no drift, Hz.
FIRST, SECOND, ALL = (207.0, 232.0), (155.0, 182.0), (60.0, 2000.0)


@pytest.fixture
def run(instance):
    def run(scene, stop, values=None):
        names = [f"module[{i}].x{j}" for i in (1, 2) for j in (1, 2)]
        names += ["contact[1].state", "contact[2].state", "statistics.state_changes"]
        times = [INTERVAL * i for i in range(1, round(stop / INTERVAL) + 1)]
        values = dict(values or {})
        if INTEGRATOR == "event-driven":
            # Its step does not decide how accurate it is.
            values["integrator.step"] = INTERVAL
        return instance(scene).initialize(values).advance(times, names)

    return run


def between(table, start, end):
    return table.part((table.times >= start) & (table.times < end))


def swing(column):
    """Root mean square about the mean."""
    return np.std(column)


def spectrum(column):
    window = np.hanning(len(column))
    return np.fft.rfftfreq(len(column), INTERVAL), np.abs(np.fft.rfft(window * column))


def band(table, low, high):
    """Size of the part of a motion between two frequencies, Hz, and the frequency at which it is
    largest: between two lines of the spectrum, by the parabola through three logarithms."""
    column = table["module[1].x2"]
    frequencies, size = spectrum(column - column.mean())
    inside = (frequencies >= low) & (frequencies < high)
    top = np.argmax(size * inside)
    left, middle, right = np.log(size[top - 1 : top + 2])
    peak = (top + (left - right) / (2 * (left - 2 * middle + right))) * frequencies[1]
    return np.sqrt((size[inside] ** 2).sum()), peak


def growth_and_frequency(column):
    """Of one mode alone, from x(t+1) + x(t−1) · exp(2 s d) = 2 exp(s d) cos(w d) x(t), in Hz."""
    after, now, before = column[2:], column[1:-1], column[:-2]
    (a, b), *_ = np.linalg.lstsq(np.stack([now, before], axis=1), after, rcond=None)
    growth = np.log(-b) / 2
    angle = np.arccos(a / (2 * np.exp(growth)))
    return growth / INTERVAL / (2 * np.pi), angle / INTERVAL / (2 * np.pi)


def test_set1_squeals_from_a_whisper_as_table_2_says(run):
    """The least perturbation grows with the eigenvalue of uniform sliding."""
    table = between(run("set1", 0.75), 0.35, 0.75)
    assert table["statistics.state_changes"][-1] == 0
    assert set(table["contact[1].state"]) == set(table["contact[2].state"]) == {1.0}
    for name in ("module[1].x1", "module[1].x2", "module[2].x2"):
        growth, frequency = growth_and_frequency(table[name])
        # Half of the last digit printed, and a little for steps of first order.
        assert growth == pytest.approx(GROWTH, abs=0.006), name
        assert frequency == pytest.approx(FREQUENCY, abs=0.06), name


def test_set1_reaches_an_orbit_that_a_second_mode_leaves(run):
    """Fig. 4: growth ends on an orbit near the first frequency, on which a mode near 167 to
    170 Hz grows in turn until it rules."""
    table = run("set1", 6.0)
    changes = table["statistics.state_changes"]
    first = table.times[np.argmax(changes > 0)]
    # From 1e-7 m/s to the slider's 0.025 m/s at 2π · 2.68 1/s takes 0.74 s; the mode gets but a
    # part of the perturbation.
    assert 0.74 < first < 1.0

    orbit = [between(table, start, start + 0.25) for start in (1.25, 1.5, 1.75, 2.0)]
    sizes = [swing(part["module[1].x2"]) for part in orbit]
    # Growing on, it would be 66 times as large in each of these windows as in the one before.
    assert max(sizes) < 1.005 * min(sizes)
    for part in orbit:
        assert band(part, *ALL)[1] == pytest.approx(FREQUENCY, abs=1.5)
        assert set(part["contact[1].state"]) == {1.0, 3.0}
        assert np.ptp(part["statistics.state_changes"]) > 200

    growing = [band(between(table, t, t + 0.5), *SECOND) for t in (1.5, 2.0, 2.5, 3.0, 3.5)]
    sizes, frequencies = zip(*growing)
    ratios = np.divide(sizes[1:], sizes[:-1])
    # Exponential growth: the same factor every half second.
    assert ratios.min() > 2.5 and ratios.max() < 1.03 * ratios.min(), ratios
    assert all(167.0 < frequency < 170.0 for frequency in frequencies), frequencies

    end = between(table, 5.0, 6.0)
    assert 166.5 < band(end, *ALL)[1] < 170.0
    assert band(end, *SECOND)[0] > 3.0 * band(end, *FIRST)[0]
    halves = [swing(between(table, t, t + 0.5)["module[1].x2"]) for t in (5.0, 5.5)]
    assert halves[1] == pytest.approx(halves[0], rel=0.02)


def test_set2_forgets_a_small_perturbation(run):
    """Every mode of uniform sliding decays; the slowest, in which both modules move alike, with
    −0.18 Hz. Alike means that k1 and k2 are not strained, so it is in Table 2 as in Table 3."""
    table = run("set2", 2.5, {"initial.module[1].v2": 1e-4})
    assert table["statistics.state_changes"][-1] == 0
    start, end = between(table, 0.0, 0.25), between(table, 2.25, 2.5)
    for name in ("module[1].x2", "module[2].x2"):
        assert swing(end[name]) < 0.05 * swing(start[name])
    both = between(table, 1.5, 2.5)
    growth, frequency = growth_and_frequency(both["module[1].x1"] + both["module[2].x1"])
    assert growth == pytest.approx(slowest_common_mode().real, abs=0.005)
    assert frequency == pytest.approx(slowest_common_mode().imag, abs=0.05)


def slowest_common_mode():
    """Both modules of either set moving alike and sliding, from the springs to ground alone."""
    mu, beta, angle = 1.96, 3e-5, 0.5
    (m1, m2), (k3, k4, k5, k6) = (0.3, 0.7), (22e3, 60e3, 300e3, 250e3)
    c, s = np.cos(angle), np.sin(angle)
    # Elongations of k3 … k6 by x1 … x4.
    springs = np.array([[0, 1, 0, 0], [1, 0, 0, 0], [0, 1, -s, -c], [1, 0, -c, s]])
    stiffness = springs.T @ np.diag([k3, k4, k5, k6]) @ springs
    # With x4 = 0 the slider pushes with N = K4 x along x4, and so drags with µ N along x3.
    stiffness[2] -= mu * stiffness[3]
    inner = np.diag([1 / m1, 1 / m1, 1 / m2]) @ stiffness[:3, :3]
    flow = np.block([[np.zeros((3, 3)), np.eye(3)], [-inner, -beta * inner]])
    eigenvalues = np.linalg.eigvals(flow) / (2 * np.pi)
    oscillating = eigenvalues[eigenvalues.imag > 0]
    assert (oscillating.real < 0).all()
    return max(oscillating, key=lambda eigenvalue: eigenvalue.real)


def test_set2_squeals_after_its_own_large_perturbation(run):
    """Fig. 5: stable as it is, it is driven to a cycle on which the contacts stick and slide."""
    table = run("set2", 3.0)
    last, before = between(table, 2.75, 3.0), between(table, 2.5, 2.75)
    size = swing(last["module[1].x2"])
    assert size == pytest.approx(swing(before["module[1].x2"]), rel=0.005)
    # If it decayed, the slowest mode would be down to exp(−2π · 0.18 · 2.75) = 5 % by now.
    assert size > swing(between(table, 0.0, 0.25)["module[1].x2"])
    assert 166.5 < band(last, *ALL)[1] < 170.0
    for contact in (1, 2):
        assert set(last[f"contact[{contact}].state"]) == {1.0, 3.0}
    assert np.ptp(last["statistics.state_changes"]) > 100
