"""Siconos: Moreau-Jean's time stepping with theta = 1/2 and its frictional contact solvers, on the problem of
a JSON file (src/scenes.rs says what is in it). Wants Debian's python3-siconos, so Debian's Python.

Springs and dampers are K and C of a linear Lagrangian system: implicit, not explicit forces. The slider is
one more body, without springs and of a mass beside which contact forces are nothing, so that contacts see
slip velocities. Prints one line of JSON a setting. Times are those of the loop alone, two calls from Python
a step included.
"""

import json
import sys
import time

import numpy as np
import siconos.kernel as sk
import siconos.numerics as sn

SLIDER_MASS = 1e25  # kg
SOLVERS = ("NSGS", sn.SICONOS_FRICTION_2D_NSGS), ("Lemke", sn.SICONOS_FRICTION_2D_LEMKE)


def simulation(problem, step, solver):
    mass = np.array(problem["mass"])
    n = len(mass)
    stiffness = np.array(problem["stiffness"])
    system = sk.LagrangianLinearTIDS(
        np.append(problem["displacement"], 0.0),
        np.append(problem["velocity"], problem["slider_velocity"]),
        np.diag(np.append(mass, SLIDER_MASS)),
        np.pad(stiffness, (0, 1)),
        np.pad(problem["alpha"] * np.diag(mass) + problem["beta"] * stiffness, (0, 1)),
    )
    system.setFExtPtr(np.append(problem["force"], 0.0))
    model = sk.NonSmoothDynamicalSystem(0.0, 2.0)
    model.insertDynamicalSystem(system)
    interactions = []
    for normal, tangent in zip(problem["normal"], problem["tangent"]):
        rows = np.zeros((2, n + 1))
        rows[0, normal] = rows[1, tangent] = 1.0
        rows[1, n] = -1.0
        law = sk.NewtonImpactFrictionNSL(0.0, 0.0, problem["friction"], 2)
        interaction = sk.Interaction(law, sk.LagrangianLinearTIR(rows))
        model.link(interaction, system)
        interactions.append(interaction)
    friction = sk.FrictionContact(2, solver)
    stepping = sk.TimeStepping(
        model, sk.TimeDiscretisation(0.0, step), sk.MoreauJeanOSI(0.5), friction
    )
    return stepping, system, interactions


def state(interaction, mu):
    """Of a contact, from the impulses of the last step."""
    normal, tangential = interaction.lambda_(1)[:2]
    if normal <= 0.0:
        return "detached"
    if abs(tangential) < mu * normal * (1.0 - 1e-6):
        return "stick"
    return "slide" if tangential > 0.0 else "reverse slide"


def run(problem, rows, steps_a_row, solver, counting):
    stepping, system, interactions = simulation(problem, 1e-3 / steps_a_row, solver)
    n, mu = len(problem["mass"]), problem["friction"]
    displacements = np.empty((rows, n))
    states, events, touch_downs = ["slide"] * len(interactions), 0, 0
    stamps = [time.perf_counter()]
    for row in range(rows):
        for _ in range(steps_a_row):
            stepping.computeOneStep()
            if counting:
                for c, interaction in enumerate(interactions):
                    now = state(interaction, mu)
                    events += now != states[c]
                    touch_downs += now != states[c] == "detached"
                    states[c] = now
            stepping.nextStep()
        displacements[row] = system.q()[:n]
        stamps.append(time.perf_counter())
    return displacements, events, touch_downs, np.diff(stamps)


def main():
    path, rows, quick = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "quick"
    with open(path) as file:
        problem = json.load(file)
    for steps_a_row in (10, 32, 100) if quick else (10, 32, 100, 320, 1000):
        # What takes long is run once, without counts, by the solver that comes by itself.
        slow = steps_a_row > 100
        for name, solver in SOLVERS[:1] if slow else SOLVERS:
            setting = problem, rows, steps_a_row, solver
            # The first one warms up and counts.
            displacements, events, touch_downs, slices = run(*setting, not slow)
            turns = 1 if slow else 2
            if not slow:
                slices = np.min([run(*setting, False)[3] for _ in range(turns)], axis=0)
            answer = {
                "setting": f"{name}, h = {1e-3 / steps_a_row:.1e} s",
                "displacements": displacements.ravel().tolist(),
                "events": None if slow else int(events),
                "touch_downs": None if slow else int(touch_downs),
                "slices": slices.tolist(),
                "turns": turns,
            }
            print(json.dumps(answer), flush=True)


main()
