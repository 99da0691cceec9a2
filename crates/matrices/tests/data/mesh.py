#!/usr/bin/env python3
"""Writes decks for CalculiX of a free steel block of hexahedra.

    mesh.py --cells NX NY NZ [--elements C3D8] [--modes N] DIRECTORY

block.inp stores the stiffness and the mass matrix (block.sti, block.mas, block.dof); modes.inp finds the lowest
eigenfrequencies of the same block (modes.dat), of which six are those of a rigid body. Run each with `ccx NAME`, the name
without .inp. Lengths are in m, forces in N, densities in kg/m^3. Nodes are numbered from 1, along x first, then y, then z.
"""

import argparse
import pathlib

LENGTHS = (0.20, 0.11, 0.03)
YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7850.0


def nodes(cells):
    """Number and place of each node."""
    nx, ny, nz = cells
    number = 0
    for k in range(nz + 1):
        for j in range(ny + 1):
            for i in range(nx + 1):
                number += 1
                place = (LENGTHS[0] * i / nx, LENGTHS[1] * j / ny, LENGTHS[2] * k / nz)
                yield number, place


def elements(cells):
    """Number and eight nodes of each element: the lower face against the clock, then the upper one."""
    nx, ny, nz = cells
    number = 0
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                number += 1
                lower = 1 + i + (nx + 1) * (j + (ny + 1) * k)
                face = [lower, lower + 1, lower + nx + 2, lower + nx + 1]
                yield number, face + [node + (nx + 1) * (ny + 1) for node in face]


def model(cells, kind):
    """The deck without its step."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in nodes(cells)]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=BLOCK")
    lines += [", ".join(map(str, [n, *corners])) for n, corners in elements(cells)]
    # The lower face carries contact, and an upper corner can be driven.
    layer = (cells[0] + 1) * (cells[1] + 1)
    lines += ["*NSET, NSET=LOWER, GENERATE", f"1, {layer}, 1"]
    lines += ["*NSET, NSET=UPPER, GENERATE", f"{layer * cells[2] + 1}, {layer * (cells[2] + 1)}, 1"]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{YOUNG}, {POISSON}", "*DENSITY", f"{DENSITY}"]
    lines += ["*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL"]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, nargs=3, required=True, metavar=("NX", "NY", "NZ"))
    parser.add_argument("--elements", default="C3D8", choices=["C3D8", "C3D8I", "C3D8R"])
    parser.add_argument("--modes", type=int, default=30)
    parser.add_argument("directory", type=pathlib.Path)
    given = parser.parse_args()
    given.directory.mkdir(parents=True, exist_ok=True)
    deck = model(given.cells, given.elements)
    steps = {
        "block.inp": ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"],
        "modes.inp": ["*STEP", "*FREQUENCY", f"{given.modes}", "*END STEP"],
    }
    for name, step in steps.items():
        (given.directory / name).write_text("\n".join([*deck, *step, ""]))


if __name__ == "__main__":
    main()
