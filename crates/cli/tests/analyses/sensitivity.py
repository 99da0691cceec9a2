"""Differences in numbers of 40 digits beside the derivatives that the program prints.

    python sensitivity.py SCENE.toml STATES FOUND.json SELECTED [NAME=VALUE ...]

The model is assembled here from the scene file alone, with other values of parameters where they are given. SELECTED is
"all", or names of parameters with commas between.
"""

import copy
import json
import sys
import tomllib

from mpmath import mp, mpc, mpf

mp.dps = 40
STEP = mpf(10) ** -13
BOUND = mpf(10) ** -9
# A derivative that cancels to less than this part of the largest relative one is rounding.
FLOOR = mpf(10) ** -12

scene_path, states, found_path, selected, *given = sys.argv[1:]
with open(scene_path, "rb") as file:
    SCENE = tomllib.load(file)
with open(found_path) as file:
    FOUND = json.load(file)
STATES = states.split(",")


def expanded(scene):
    """The values of a scene by the names of the program's variables."""
    values = {}
    for key in ("velocity", "angle"):
        if key in scene.get("slider", {}):
            values[f"slider.{key}"] = scene["slider"][key]
    for key, value in scene["friction"].items():
        if not isinstance(value, str):
            values[f"friction.{key}"] = value
    values["damping.alpha"] = scene.get("damping", {}).get("alpha", 0)
    values["damping.beta"] = scene.get("damping", {}).get("beta", 0)
    ring = scene.get("ring")
    if ring:
        for key in ("m1", "m2", "k1", "k2", "k3", "k4", "k5", "k6"):
            for i in range(ring["modules"]):
                own = ring[key]
                values[f"module[{i + 1}].{key}"] = own[i] if isinstance(own, list) else own
    for mass in scene.get("mass", []):
        values[f"mass.{mass['name']}.mass"] = mass["mass"]
    for spring in scene.get("spring", []):
        values[f"spring.{spring['name']}.stiffness"] = spring["stiffness"]
        if "preload" in spring:
            values[f"spring.{spring['name']}.preload"] = spring["preload"]
    for damper in scene.get("damper", []):
        values[f"damper.{damper['name']}.damping"] = damper["damping"]
    for contact in scene.get("contact", []):
        for key in ("velocity", "friction"):
            if key in contact:
                values[f"contact.{contact['name']}.{key}"] = contact[key]
    return {name: mpf(value) for name, value in values.items()}


def unit(angle):
    """The direction of an angle; quarter turns are exact, as the program says of them."""
    c, s = mp.cos(angle), mp.sin(angle)
    if abs(c) < mpf(10) ** -15:
        return mpf(0), mp.sign(s)
    if abs(s) < mpf(10) ** -15:
        return mp.sign(c), mpf(0)
    return c, s


class Model:
    """Rows of M, C, K as dictionaries, loads, and contacts (normal, tangent, surface velocity, µ)."""

    def __init__(self, values):
        self.values = values
        self.number = {}
        ring = SCENE.get("ring")
        if ring:
            for i in range(ring["modules"]):
                for key in ("x1", "x2", "x3", "x4"):
                    self.number[i, key] = len(self.number)
        for mass in SCENE.get("mass", []):
            for axis in ("x", "y"):
                if axis not in mass.get("locked", []):
                    self.number[mass["name"], axis] = len(self.number)
        self.size = len(self.number)
        self.mass = [{} for _ in range(self.size)]
        self.stiffness = [{} for _ in range(self.size)]
        self.damper = [{} for _ in range(self.size)]
        self.load = [mpf(0)] * self.size
        self.contacts = []
        (self.ring if ring else self.network)()

    def ring(self):
        get, count = self.values.__getitem__, SCENE["ring"]["modules"]
        cos, sin = unit(get("slider.angle"))
        for i in range(count):
            at = {key: self.number[i, key] for key in ("x1", "x2", "x3", "x4")}
            own = {key: get(f"module[{i + 1}].{key}") for key in ("m1", "m2", "k1", "k2", "k3", "k4", "k5", "k6")}
            for key, mass in (("x1", "m1"), ("x2", "m1"), ("x3", "m2"), ("x4", "m2")):
                add(self.mass, {at[key]: mpf(1)}, own[mass])
            if count > 1:
                other = (i + 1) % count
                add(self.stiffness, {at["x1"]: mpf(1), self.number[other, "x1"]: mpf(-1)}, own["k1"])
                add(self.stiffness, {at["x2"]: mpf(1), self.number[other, "x2"]: mpf(-1)}, own["k2"])
            add(self.stiffness, {at["x2"]: mpf(1)}, own["k3"])
            add(self.stiffness, {at["x1"]: mpf(1)}, own["k4"])
            add(self.stiffness, {at["x2"]: mpf(1), at["x3"]: -sin, at["x4"]: -cos}, own["k5"])
            add(self.stiffness, {at["x1"]: mpf(1), at["x3"]: -cos, at["x4"]: sin}, own["k6"])
            self.contact({at["x4"]: mpf(1)}, {at["x3"]: mpf(1)}, get("slider.velocity"), get("friction.coefficient"))

    def point(self, name, direction):
        if name == "ground":
            return {}
        parts = {}
        for axis, part in zip(("x", "y"), direction):
            if (name, axis) in self.number and part != 0:
                parts[self.number[name, axis]] = part
        return parts

    def between(self, ends, direction):
        first, second = (self.point(end, direction) for end in ends)
        for dof, part in second.items():
            first[dof] = first.get(dof, 0) - part
        return first

    def network(self):
        get = self.values.__getitem__
        axes = {"x": (mpf(1), mpf(0)), "y": (mpf(0), mpf(1))}
        for mass in SCENE["mass"]:
            assert "angle" not in mass
            for axis, force in zip(("x", "y"), mass.get("force", [0, 0])):
                if (mass["name"], axis) in self.number:
                    dof = self.number[mass["name"], axis]
                    add(self.mass, {dof: mpf(1)}, get(f"mass.{mass['name']}.mass"))
                    self.load[dof] += mpf(force)
        for spring in SCENE.get("spring", []):
            direction = spring["direction"]
            direction = axes[direction] if direction in axes else unit(mpf(direction))
            row, k = self.between(spring["between"], direction), get(f"spring.{spring['name']}.stiffness")
            add(self.stiffness, row, k)
            preload = self.values.get(f"spring.{spring['name']}.preload", mpf(0))
            for dof, part in row.items():
                self.load[dof] += k * preload * part
        for damper in SCENE.get("damper", []):
            row = self.between(damper["between"], axes[damper["direction"]])
            add(self.damper, row, get(f"damper.{damper['name']}.damping"))
        for contact in SCENE["contact"]:
            angle = mpf(contact["angle"]) if "angle" in contact else get("slider.angle")
            cos, sin = unit(angle)
            ends = [contact["mass"], contact.get("on", "ground")]
            name = f"contact.{contact['name']}"
            velocity = self.values.get(f"{name}.velocity", self.values.get("slider.velocity"))
            friction = self.values.get(f"{name}.friction", self.values.get("friction.coefficient"))
            self.contact(self.between(ends, (-sin, cos)), self.between(ends, (cos, sin)), velocity, friction)

    def contact(self, normal, tangent, velocity, friction):
        slope = mpf(0)
        if "stribeck_velocity" in SCENE["friction"]:
            fall = self.values["friction.static"] - friction
            decay = mp.exp(-abs(velocity) / self.values["friction.stribeck_velocity"])
            friction, slope = friction + fall * decay, -fall * decay / self.values["friction.stribeck_velocity"]
        self.contacts.append((normal, tangent, velocity, friction, slope))

    def normal_forces(self):
        """Those of the equilibrium in uniform sliding with all contacts closed."""
        rows = [dict(row) for row in self.stiffness] + [{} for _ in self.contacts]
        for i, (normal, tangent, velocity, friction, _) in enumerate(self.contacts):
            sign = mp.sign(velocity)
            for dof, part in normal.items():
                rows[self.size + i][dof] = part
                rows[dof][self.size + i] = rows[dof].get(self.size + i, 0) - part
            for dof, part in tangent.items():
                rows[dof][self.size + i] = rows[dof].get(self.size + i, 0) - sign * friction * part
        return Factors(rows).solve(self.load + [mpf(0)] * len(self.contacts))[self.size :]

    def problem(self):
        """Rows of M, C and K with the closed contacts' forces as unknowns."""
        alpha, beta = self.values["damping.alpha"], self.values["damping.beta"]
        mass, stiffness = [dict(row) for row in self.mass], [dict(row) for row in self.stiffness]
        damping = [dict(row) for row in self.damper]
        for rows, factor in ((mass, alpha), (stiffness, beta)):
            for i, row in enumerate(rows[: self.size]):
                for j, value in row.items():
                    damping[i][j] = damping[i].get(j, 0) + factor * value
        forces = None
        # The border has the size of the stiffnesses, so that pivots are well chosen.
        scale = max(abs(value) for row in stiffness for value in row.values())
        for i, state in enumerate(STATES):
            normal, tangent, _, friction, slope = self.contacts[i]
            if state == "Dt":
                continue
            held = [normal] if state != "St" else [normal, tangent]
            if state == "St":
                pressed = held
            else:
                sign = 1 if state == "Sl" else -1
                pressed = [dict(normal)]
                for dof, part in tangent.items():
                    pressed[0][dof] = pressed[0].get(dof, 0) + sign * friction * part
                if slope != 0:
                    forces = forces or self.normal_forces()
                    add(damping, tangent, forces[i] * slope)
            for row, column in zip(held, pressed):
                place = len(stiffness)
                for rows in (mass, damping, stiffness):
                    rows.append({})
                for dof, part in row.items():
                    stiffness[place][dof] = scale * part
                for dof, part in column.items():
                    stiffness[dof][place] = -scale * part
        return mass, damping, stiffness


def add(rows, row, factor):
    for i, a in row.items():
        for j, b in row.items():
            rows[i][j] = rows[i].get(j, 0) + factor * a * b


class Factors:
    """Sparse elimination with row pivoting."""

    def __init__(self, rows):
        self.steps = []
        rows = [dict(row) for row in rows]
        order = list(range(len(rows)))
        self.pivots = []
        for column in range(len(rows)):
            candidates = [(abs(rows[i].get(column, 0)), i) for i in order if rows[i].get(column, 0) != 0]
            pivot = max(candidates, key=lambda it: it[0])[1]
            order.remove(pivot)
            self.pivots.append((pivot, column))
            for i in order:
                entry = rows[i].pop(column, 0)
                if entry != 0:
                    factor = entry / rows[pivot][column]
                    self.steps.append((i, pivot, factor))
                    for j, value in rows[pivot].items():
                        if j != column:
                            rows[i][j] = rows[i].get(j, 0) - factor * value
        self.rows = rows

    def solve(self, side):
        side = list(side)
        for i, pivot, factor in self.steps:
            side[i] -= factor * side[pivot]
        found = [mpf(0)] * len(side)
        for pivot, column in reversed(self.pivots):
            row = self.rows[pivot]
            rest = side[pivot] - sum(value * found[j] for j, value in row.items() if j != column)
            found[column] = rest / row[column]
        return found


def times(rows, vector):
    return [sum((value * vector[j] for j, value in row.items()), mpf(0)) for row in rows]


class Determinant:
    """g(λ), which vanishes where λ is an eigenvalue, with g′(λ) and, on demand, g″(λ)."""

    def __init__(self, problem, b, c):
        self.problem, self.b, self.c = problem, b, c

    def __call__(self, value, second=False):
        mass, damping, stiffness = self.problem
        size = len(mass)
        rows = []
        for i in range(size):
            row = dict(stiffness[i])
            for j, entry in damping[i].items():
                row[j] = row.get(j, 0) + value * entry
            for j, entry in mass[i].items():
                row[j] = row.get(j, 0) + value**2 * entry
            row[size] = self.b[i]
            rows.append(row)
        rows.append(dict(enumerate(self.c)))
        factors = Factors(rows)
        whole = factors.solve([mpf(0)] * size + [mpf(1)])
        z, g = whole[:size], whole[size]
        slope = lambda z: [2 * value * m + d for m, d in zip(times(mass, z), times(damping, z))]
        first = factors.solve([-it for it in slope(z)] + [mpf(0)])
        if not second:
            return g, first[size]
        both = [-2 * m - 2 * s for m, s in zip(times(mass, z), slope(first[:size]))]
        return g, first[size], factors.solve(both + [mpf(0)])[size]


def eigenvalue(problem, start, shapes):
    determinant = Determinant(problem, *shapes)
    value = start
    for _ in range(60):
        g, slope = determinant(value)
        value -= g / slope
        if abs(g / slope) < mpf(10) ** -34 * abs(value):
            return value
    raise SystemExit(f"no eigenvalue was found near {mp.nstr(start, 12)}")


def shapes_at(problem, value):
    """Vectors b and c near the left and the right shape of an eigenvalue, by inverse iteration."""
    mass, damping, stiffness = problem
    size = len(mass)
    moved = value * (1 + mpf(10) ** -12)
    rows = [{} for _ in range(size)]
    for factor, part in ((1, stiffness), (moved, damping), (moved**2, mass)):
        for i, row in enumerate(part):
            for j, entry in row.items():
                rows[i][j] = rows[i].get(j, 0) + factor * entry
    columns = [{} for _ in range(size)]
    for i, row in enumerate(rows):
        for j, entry in row.items():
            columns[j][i] = entry
    found = []
    for matrix in (columns, rows):
        factors = Factors(matrix)
        vector = [mpf(1) / (i + 2) for i in range(size)]
        for _ in range(2):
            vector = factors.solve(vector)
            largest = max(abs(it) for it in vector)
            vector = [it / largest for it in vector]
        found.append([mp.conj(it) for it in vector])
    return found


VALUES = expanded(SCENE)
for assignment in given:
    name, _, number = assignment.partition("=")
    VALUES[name] = mpf(float(number))
failures, checked = [], 0


def changed(name, by):
    values = dict(VALUES)
    values[name] += by
    return values


def step_of(name):
    return STEP * (abs(VALUES[name]) if VALUES[name] != 0 else 1)


def floor_of(name, largest):
    """Below this, a derivative is rounding of zero; a parameter that is 0 has no scale of its own."""
    return FLOOR * largest / abs(VALUES[name]) if VALUES[name] != 0 else mpf(10) ** -9 * largest


def compare(what, found, exact, floor, bound=BOUND):
    global checked
    checked += 1
    if abs(found - exact) > bound * abs(exact) + floor:
        failures.append(f"{what}: {mp.nstr(found, 15)}, and {mp.nstr(exact, 15)} by differences")


def names_of(derivatives):
    wanted = derivatives if selected == "all" else selected.split(",")
    return [name for name in derivatives if name in wanted and name in VALUES]


def check_mode(mode):
    copies = mode["copies"]
    start = mpc(mode["growth_rate"], 2 * mp.pi * mpf(mode["frequency_hz"]))
    derivatives = mode["derivatives"]
    if derivatives is None:
        return
    base = Model(VALUES).problem()
    shapes = shapes_at(base, start)
    exact_start = eigenvalue(base, start, shapes) if copies == 1 else start
    relative = lambda name: max(abs(mpc(g, 2 * mp.pi * mpf(f))) for g, f in zip(*parts(derivatives[name])))
    largest = max(relative(name) * abs(VALUES[name]) for name in derivatives if name in VALUES)
    bound = BOUND
    if mode["merging"]:
        # Near a merging the rounding of the parameters themselves, 1e-16, is multiplied by one over the distance.
        bound = max(bound, mpf(4e-15) * VALUES["friction.coefficient"] / mpf(mode["merging"]["distance"]))
    for name in names_of(derivatives):
        h = step_of(name)
        floor = floor_of(name, largest)
        for growth, frequency in zip(*parts(derivatives[name])):
            found = mpc(growth, 2 * mp.pi * mpf(frequency))
            ends = []
            for sign in (1, -1):
                problem = Model(changed(name, sign * h)).problem()
                if copies == 1:
                    ends.append(eigenvalue(problem, exact_start, shapes))
                else:
                    # The copies part by the differences of their derivatives: each is found from its own place.
                    place = mean_of(base, start, shapes) + sign * h * found
                    ends.append(eigenvalue(problem, place, shapes_at(problem, place + abs(h) * 1e-3)))
            exact = (ends[0] - ends[1]) / (2 * h)
            compare(f"{mp.nstr(start, 8)} by {name}", found, exact, floor, bound)


def parts(derivative):
    return derivative["growth_rate"], derivative["frequency_hz"]


MEANS = {}


def mean_of(problem, start, shapes):
    """A double eigenvalue to all digits: g has a simple pole and zero there, so the nearest root of a moved one is used."""
    key = mp.nstr(start, 12)
    if key not in MEANS:
        mass, damping, stiffness = problem
        value = start
        # Newton's method on det = 0 of multiplicity 2, by the trace of Q⁻¹ Q′.
        for _ in range(12):
            trace = trace_of(problem, value)
            step = 2 / trace
            value -= step
            if abs(step) < mpf(10) ** -30 * abs(value):
                break
        MEANS[key] = value
    return MEANS[key]


def trace_of(problem, value):
    mass, damping, stiffness = problem
    size = len(mass)
    rows, slopes = [{} for _ in range(size)], [{} for _ in range(size)]
    for factor, slope, part in ((1, 0, stiffness), (value, 1, damping), (value**2, 2 * value, mass)):
        for i, row in enumerate(part):
            for j, entry in row.items():
                rows[i][j] = rows[i].get(j, 0) + factor * entry
                slopes[j][i] = slopes[j].get(i, 0) + slope * entry
    factors = Factors(rows)
    trace = mpf(0)
    for j in range(size):
        if slopes[j]:
            side = [mpf(0)] * size
            for i, entry in slopes[j].items():
                side[i] = entry
            trace += factors.solve(side)[j]
    return trace


def merging(values, start):
    """(λ, µ) of a double eigenvalue with one shape, by Newton's method with differences in µ."""
    value, friction = start
    shapes = None
    for _ in range(30):
        def both(at):
            problem = Model({**values, "friction.coefficient": at}).problem()
            return Determinant(problem, *shapes)(value, second=True)

        if shapes is None:
            shapes = shapes_at(Model({**values, "friction.coefficient": friction}).problem(), value)
        h = mpf(10) ** -18
        g, first, second = both(friction)
        up, down = both(friction + h), both(friction - h)
        g_mu, first_mu = (up[0] - down[0]) / (2 * h), (up[1] - down[1]) / (2 * h)
        determinant = first * first_mu - g_mu * second
        d_value = (g_mu * first - first_mu * g) / determinant
        d_friction = (second * g - first * first) / determinant
        value, friction = value + d_value, friction + d_friction
        if abs(d_friction) < mpf(10) ** -30:
            return value, friction
    raise SystemExit("no merging was found")


def check_merging(mode):
    merged = mode["merging"]
    start = (mpc(merged["growth_rate"], 2 * mp.pi * mpf(merged["frequency_hz"])), mpf(merged["friction"]))
    value, friction = merging(VALUES, start)
    distance = abs(friction - VALUES["friction.coefficient"])
    compare("µ of the merging", mpf(merged["friction"]), friction.real, mpf(0))
    compare("distance", mpf(merged["distance"]), distance, mpf(10) ** -12)
    for name in names_of(merged["derivatives"]):
        h = mpf(10) ** -12 * (abs(VALUES[name]) or 1)
        ends = [merging(changed(name, sign * h), (value, friction))[1] for sign in (1, -1)]
        exact = (ends[0] - ends[1]).real / (2 * h)
        largest = max(abs(mpf(by[0]) * VALUES[it]) for it, by in merged["derivatives"].items() if it in VALUES)
        compare(f"merging by {name}", mpf(merged["derivatives"][name][0]), exact, floor_of(name, largest))


def critical(values, start):
    """The µ with Re λ = 0, and λ there."""
    value, friction = start
    shapes = None
    for _ in range(40):
        h = mpf(10) ** -18
        at = lambda mu: Model({**values, "friction.coefficient": mu}).problem()
        shapes = shapes or shapes_at(at(friction), value)
        value = eigenvalue(at(friction), value, shapes)
        ends = [eigenvalue(at(friction + sign * h), value, shapes) for sign in (1, -1)]
        step = value.real / ((ends[0] - ends[1]).real / (2 * h))
        friction -= step
        if abs(step) < mpf(10) ** -28:
            return value, friction
    raise SystemExit("no critical µ was found")


def check_critical(one):
    start = (mpc(0, 2 * mp.pi * mpf(one["frequency_hz"])), mpf(one["friction"]))
    if one["is_merging"]:
        place = lambda values, start: [part.real if i else part for i, part in enumerate(merging(values, start))]
    else:
        place = critical
    value, friction = place(VALUES, start)
    compare("critical µ", mpf(one["friction"]), friction, mpf(0))
    derivatives = one["derivatives"]
    largest = max(abs(mpf(by[0]) * VALUES[name]) for name, by in derivatives.items() if name in VALUES)
    for name in names_of(derivatives):
        h = step_of(name)
        ends = [place(changed(name, sign * h), (value, friction))[1] for sign in (1, -1)]
        exact = (ends[0] - ends[1]) / (2 * h)
        compare(f"critical µ by {name}", mpf(derivatives[name][0]), exact, floor_of(name, largest))


for mode in FOUND["modes"]:
    check_mode(mode)
    if mode["merging"]:
        check_merging(mode)
for one in FOUND["critical"] or []:
    if one["copies"] == 1:
        check_critical(one)
if failures:
    raise SystemExit("\n".join(failures[:20]) + f"\n{len(failures)} of {checked} differ")
print(f"{checked} derivatives agree")
