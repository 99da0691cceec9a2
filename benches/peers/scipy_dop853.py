"""SciPy's solve_ivp with DOP853 and events, on the problem of a JSON file (src/scenes.rs says what is in it).

Between events the motion is linear in z = (x, v), so each contact state has its z' = A z + b, made once;
contact forces and event functions are linear as well. Prints one line of JSON a setting. Times are those
of the loop alone, Python's own part of it included: solve_ivp is Python, and calls the right-hand side
twelve times and each event function once a step or more.
"""

import json
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

SLIDE, REVERSE_SLIDE, STICK, DETACHED = range(4)
SIZES = 1e-4, 1e-1  # typical displacement (m) and velocity (m/s)
# An event function starts this far on its good side: m/s of slip, m of a gap, N.
SLIP_OFFSET, GAP_OFFSET, FORCE_OFFSET = 1e-14, 1e-17, 1e-10
MOST_CHANGES = 16


class Motion:
    def __init__(self, problem):
        self.mass = np.array(problem["mass"])
        self.dofs = len(self.mass)
        stiffness = np.array(problem["stiffness"])
        damping = problem["alpha"] * np.diag(self.mass) + problem["beta"] * stiffness
        # F - K x - C v as rows over (z, 1).
        self.force = np.hstack((-stiffness, -damping, np.array(problem["force"])[:, None]))
        self.normal, self.tangent = problem["normal"], problem["tangent"]
        self.mu, self.v = problem["friction"], problem["slider_velocity"]
        self.states = [SLIDE] * len(self.normal)
        self.linear = {}
        self.events = self.touch_downs = 0

    def linear_motion(self):
        """Right-hand side and event functions of the present states, these also as matrix and vector."""
        key = tuple(self.states)
        if key not in self.linear:
            self.linear[key] = self.make_linear()
        return self.linear[key]

    def make_linear(self):
        n = self.dofs
        force = self.force.copy()
        for c, state in enumerate(self.states):
            normal, tangent = self.normal[c], self.tangent[c]
            if state == DETACHED:
                continue
            if state == STICK:
                force[tangent] = 0.0
            else:
                sign = 1.0 if state == SLIDE else -1.0
                force[tangent] -= sign * self.mu * self.force[normal]
            force[normal] = 0.0
        acceleration = force / self.mass[:, None]
        a = np.vstack((np.eye(n, 2 * n, n), acceleration[:, : 2 * n]))
        b = np.concatenate((np.zeros(n), acceleration[:, 2 * n]))
        rows, constants = zip(*(row for c in range(len(self.states)) for row in self.event_rows(c)))
        events = [self.event(row, constant) for row, constant in zip(rows, constants)]
        return (lambda _, z: a @ z + b), events, np.array(rows), np.array(constants)

    @staticmethod
    def event(row, constant):
        def function(_, z):
            return row @ z + constant

        function.terminal, function.direction = True, -1.0
        return function

    def event_rows(self, c):
        """Two linear functions that are positive as long as the state lasts."""
        n = self.dofs
        normal, tangent = self.normal[c], self.tangent[c]
        pressure, drag = -self.force[normal], -self.force[tangent]
        state = self.states[c]
        if state == DETACHED:
            gap = np.zeros(2 * n)
            gap[normal] = 1.0
            return [(gap, GAP_OFFSET), (np.zeros(2 * n), 1.0)]
        if state == STICK:
            pair = [self.mu * pressure - drag, self.mu * pressure + drag]
            return [(row[:-1], row[-1] + FORCE_OFFSET) for row in pair]
        sign = 1.0 if state == SLIDE else -1.0
        slip = np.zeros(2 * n)
        slip[n + tangent] = -sign
        return [(slip, sign * self.v + SLIP_OFFSET), (pressure[:-1], pressure[-1] + FORCE_OFFSET)]

    def change(self, index, z):
        """Event `index` has been reached: the states, and the velocities where a gap closes."""
        for _ in range(MOST_CHANGES):
            self.change_contact(*divmod(index, 2), z)
            _, _, rows, constants = self.linear_motion()
            behind = np.flatnonzero(rows @ z + constants < 0.0)
            if not behind.size:
                return
            index = int(behind[0])
        raise RuntimeError("the contacts change their states again and again at one instant")

    def change_contact(self, c, which, z):
        before = self.states[c]
        if before == DETACHED:
            after = self.touch_down(c, z)
        elif before == STICK:
            after = REVERSE_SLIDE if which else SLIDE
        elif which:
            after = DETACHED
        else:
            z[self.dofs + self.tangent[c]] = self.v
            after = self.held(c, z)
        self.states[c] = after
        self.events += after != before
        self.touch_downs += after != before == DETACHED

    def contact_forces(self, c, z):
        """N, and T of a contact that sticks."""
        rows = self.force[[self.normal[c], self.tangent[c]]]
        return -(rows[:, :-1] @ z + rows[:, -1])

    def held(self, c, z):
        """The state of a closed contact without slip."""
        pressure, drag = self.contact_forces(c, z)
        if pressure < 0.0:
            return DETACHED
        if abs(drag) <= self.mu * pressure:
            return STICK
        return SLIDE if drag > 0.0 else REVERSE_SLIDE

    def touch_down(self, c, z):
        """A perfectly inelastic impact, with a tangential impulse of up to mu times the normal one."""
        normal, tangent = self.normal[c], self.tangent[c]
        speed, along = self.dofs + normal, self.dofs + tangent
        limit = self.mu * self.mass[normal] * abs(z[speed])
        z[normal] = z[speed] = 0.0
        stop = self.mass[tangent] * (self.v - z[along])
        if abs(stop) <= limit:
            z[along] = self.v
            return self.held(c, z)
        z[along] += np.clip(stop, -limit, limit) / self.mass[tangent]
        if self.contact_forces(c, z)[0] < 0.0:
            return DETACHED
        return SLIDE if stop > 0.0 else REVERSE_SLIDE


def run(problem, rows, options):
    motion = Motion(problem)
    n = motion.dofs
    z = np.array(problem["displacement"] + problem["velocity"])
    times = 1e-3 * np.arange(1, rows + 1)
    now, pieces, done = 0.0, [], 0
    stamps = [time.perf_counter()]
    while True:
        rates, events, _, _ = motion.linear_motion()
        span = now, times[-1]
        found = solve_ivp(rates, span, z, "DOP853", times[done:], events=events, **options)
        if len(found.t):
            pieces.append(found.y[:n].T)
            done += len(found.t)
        stamps.append(time.perf_counter())
        if found.status != 1:
            break
        index = next(i for i, at in enumerate(found.t_events) if len(at))
        now, z = found.t_events[index][0], found.y_events[index][0].copy()
        motion.change(index, z)
    return np.concatenate(pieces), motion, np.diff(stamps)


def settings(dofs, quick):
    """Names and options. Long steps miss events that come and go within one."""
    yield "default: rtol 1e-3, atol 1e-6", {}
    tuned = [(digits, np.inf) for digits in range(4, 13, 4 if quick else 2)]
    for digits, longest in [*tuned, (6, 2e-4), (12, 2e-4), (12, 1e-4)]:
        rtol = 10.0**-digits
        atol = np.repeat([rtol * size for size in SIZES], dofs)
        name = "" if longest == np.inf else f", max_step {longest:.0e}"
        yield f"rtol 1e-{digits}{name}", {"rtol": rtol, "atol": atol, "max_step": longest}


def main():
    path, rows, quick = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "quick"
    with open(path) as file:
        problem = json.load(file)
    for setting, options in settings(len(problem["mass"]), quick):
        x, motion, slices = run(problem, rows, options)  # Warms up.
        turns = 2 if quick or slices.sum() > 0.8 else 5
        answer = {
            "setting": setting,
            "displacements": x.ravel().tolist(),
            "events": int(motion.events),
            "touch_downs": int(motion.touch_downs),
            "slices": np.min([run(problem, rows, options)[2] for _ in range(turns)], axis=0).tolist(),
            "turns": turns,
        }
        print(json.dumps(answer), flush=True)


main()
