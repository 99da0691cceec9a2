#!/usr/bin/env python3
"""Writes a small disc brake as decks for CalculiX, and tables of the nodes that rub.

    decks.py [--speed OMEGA] [DIRECTORY]

disc.inp and pad.inp store stiffness and mass matrices (NAME.sti, NAME.mas, NAME.dof) when `ccx NAME` runs them;
disc_modes.inp and pad_modes.inp find eigenfrequencies of the same meshes (NAME.dat). disc_contacts.txt and
pad_contacts.txt list the nodes of the two faces that rub, pad_back.txt the nodes of the backing plate where the caliper
guides the pad (its corners) and where the piston presses. pairs.csv has one line for each pad node: the disc node below it, the normal, the direction in
which the disc moves there, and how fast (m/s) at OMEGA (rad/s, 5 by default).

Units of the decks are N, mm, t and s. The disc turns about z, against the clock as seen from above. Its upper face is
the plane z = 0, and the pad lies on it around the y axis. The number of a node tells its place:
1000 (layer + 1) + 10 (place along the circle) + (place along the radius), layers from below.
"""

import argparse
import math
import pathlib

STEP = 10                                     # degrees from node to node along the circle
IRON = ("IRON", 1.2e5, 0.26, 7.2e-9)          # name, N/mm^2, 1, t/mm^3: the disc
STEEL = ("STEEL", 2.1e5, 0.30, 7.85e-9)       # the backing plate
LINING = ("LINING", 1.0e3, 0.25, 2.5e-9)      # what rubs on the disc


class Part:
    """A sector of a ring, or a whole one, of hexahedra."""

    def __init__(self, name, angles, radii, heights, materials, clamped=None):
        self.name = name
        self.angles = angles        # degrees / STEP of each node along the circle
        self.radii = radii          # mm
        self.heights = heights      # mm, from below
        self.materials = materials  # of each layer of elements, from below
        self.clamped = clamped      # place along the radius that is held, or None
        self.closed = len(angles) * STEP == 360

    def number(self, layer, angle, radius):
        return 1000 * (layer + 1) + 10 * (angle % len(self.angles)) + radius

    def nodes(self):
        for layer, z in enumerate(self.heights):
            for angle, steps in enumerate(self.angles):
                for radius, r in enumerate(self.radii):
                    turned = math.radians(STEP * steps)
                    yield self.number(layer, angle, radius), (r * math.cos(turned), r * math.sin(turned), z)

    def elements(self, layer):
        """Eight nodes of each element of a layer: the lower face against the clock, then the upper one."""
        for angle in range(len(self.angles) - (0 if self.closed else 1)):
            for radius in range(len(self.radii) - 1):
                around = [(angle, radius), (angle, radius + 1), (angle + 1, radius + 1), (angle + 1, radius)]
                yield [self.number(layer + up, *place) for up in (0, 1) for place in around]

    def face(self, layer, radii):
        """Nodes of a layer at these places along the radius."""
        return [self.number(layer, angle, radius) for angle in range(len(self.angles)) for radius in radii]

    def model(self):
        """The deck without its step."""
        lines = ["*NODE, NSET=ALL"]
        lines += [f"{number}, {x:.9g}, {y:.9g}, {z:.9g}" for number, (x, y, z) in self.nodes()]
        element = 0
        for layer, material in enumerate(self.materials):
            lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=LAYER{layer + 1}")
            for corners in self.elements(layer):
                element += 1
                lines.append(", ".join(map(str, [element, *corners])))
        for name, young, poisson, density in dict.fromkeys(self.materials):
            lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young:g}, {poisson:g}", "*DENSITY", f"{density:g}"]
        for layer, material in enumerate(self.materials):
            lines.append(f"*SOLID SECTION, ELSET=LAYER{layer + 1}, MATERIAL={material[0]}")
        if self.clamped is not None:
            lines.append("*BOUNDARY")
            held = [node for layer in range(len(self.heights)) for node in self.face(layer, [self.clamped])]
            lines += [f"{node}, 1, 3" for node in held]
        return lines


DISC = Part("disc", list(range(36)), [60, 72, 84, 96, 108, 120], [-12, -6, 0], [IRON, IRON], clamped=0)
PAD = Part("pad", list(range(6, 13)), [84, 96, 108, 120], [0, 6, 12, 18], [LINING, LINING, STEEL])
# The pad's places along circle and radius, counted on the disc.
FIRST_ANGLE, FIRST_RADIUS = 6, 2


def pairs(speed):
    """Pad node, disc node below it, normal, direction in which the disc moves, and its velocity in m/s."""
    yield "node,on,nx,ny,nz,tx,ty,tz,velocity"
    for angle, steps in enumerate(PAD.angles):
        turned = math.radians(STEP * steps)
        for radius, r in enumerate(PAD.radii):
            on = DISC.number(len(DISC.heights) - 1, angle + FIRST_ANGLE, radius + FIRST_RADIUS)
            tangent = f"{-math.sin(turned):.15g},{math.cos(turned):.15g},0"
            yield f"{PAD.number(0, angle, radius)},{on},0,0,1,{tangent},{speed * r / 1000:.9g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--speed", type=float, default=5.0, help="of the disc, rad/s")
    parser.add_argument("directory", type=pathlib.Path, nargs="?", default=pathlib.Path("."))
    given = parser.parse_args()
    given.directory.mkdir(parents=True, exist_ok=True)

    def write(name, lines):
        (given.directory / name).write_text("\n".join([*lines, ""]))

    for part in (DISC, PAD):
        matrices = ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"]
        write(f"{part.name}.inp", [*part.model(), *matrices])
        write(f"{part.name}_modes.inp", [*part.model(), "*STEP", "*FREQUENCY", "20", "*END STEP"])
    below = [line.split(",")[1] for line in pairs(given.speed)][1:]
    write("disc_contacts.txt", below)
    write("pad_contacts.txt", map(str, PAD.face(0, range(4))))
    # On the back of the backing plate: its corners, where the caliper guides it, and where the piston presses.
    back = len(PAD.heights) - 1
    corners = [PAD.number(back, angle, radius) for angle in (0, 6) for radius in (0, 3)]
    piston = [PAD.number(back, angle, radius) for angle in (2, 3, 4) for radius in (1, 2)]
    write("pad_back.txt", map(str, corners + piston))
    write("pairs.csv", pairs(given.speed))


if __name__ == "__main__":
    main()
