#!/usr/bin/env python3
"""Writes the matrices of one small structure, tets.inp, with programs that are not Amontons.

    make_fe.py

CalculiX (ccx) stores the stiffness and the mass matrix: tets.sti, tets.mas, tets.dof; and as a substructure of the nodes of the
set KEPT: tets_substructure.mtx. The nodes of the set FIXED, which it holds, lie between them and node 1, so that the stiffness
of the substructure is the block of the whole one. pyNastran writes DMIG in fields of 8 characters, and OUTPUT4
as text; pyYeti writes DMIG in fields of 16 characters, and the other kinds of OUTPUT4, but for that of single
precision, which SciPy writes as Fortran records. Needs numpy, pandas, scipy, pyNastran
and pyyeti.
"""

import itertools
import pathlib
import shutil
import subprocess
import tempfile

import numpy
import pandas
import pyyeti.nastran.bulk
import pyyeti.nastran.op4
import scipy.io
import scipy.sparse
from pyNastran.bdf.bdf import BDF
from pyNastran.op4.op4 import OP4

HERE = pathlib.Path(__file__).parent

STORE = """*STEP
*FREQUENCY, SOLVER=MATRIXSTORAGE
1
*END STEP
"""

SUBSTRUCTURE = """*BOUNDARY
FIXED, 1, 3
*STEP
*SUBSTRUCTURE GENERATE
*RETAINED NODAL DOFS, SORTED=NO
KEPT, 1, 3
*SUBSTRUCTURE MATRIX OUTPUT, STIFFNESS=YES, OUTPUT FILE=USER DEFINED, FILE NAME=tets_substructure
*END STEP
"""


def run(step, names):
    """Runs CalculiX with the structure and this step, and keeps the files of these names."""
    with tempfile.TemporaryDirectory() as directory:
        directory = pathlib.Path(directory)
        (directory / "tets.inp").write_text((HERE / "tets.inp").read_text() + step)
        subprocess.run(["ccx", "tets"], cwd=directory, check=True, stdout=subprocess.DEVNULL)
        for name in names:
            shutil.copy(directory / name, HERE / name)


def stored(name):
    """A matrix that CalculiX has stored."""
    row, column, value = numpy.loadtxt(HERE / name, unpack=True)
    row, column = row.astype(int) - 1, column.astype(int) - 1
    upper = scipy.sparse.coo_matrix((value, (row, column))).toarray()
    return upper + upper.T - numpy.diag(upper.diagonal())


def small_dmig(name, freedoms, key, matrix):
    """Writes a matrix as DMIG: of each column the entries on and below the diagonal that are not zero, one in a card."""
    columns, rows, values = [], [], []
    for j in range(len(freedoms)):
        for i in range(j, len(freedoms)):
            if matrix[i, j] != 0:
                columns.append(freedoms[j])
                rows.append(freedoms[i])
                values.append(matrix[i, j])
    deck = BDF(debug=False)
    deck.add_dmig(key, 6, 1, 0, 0, None, columns, rows, values)
    deck.write_bdf(str(HERE / name), size=8)


def large_dmig(name, freedoms, matrices):
    """Writes matrices as DMIG, a card for each column; and after them the first two columns of the first as a rectangular
    one of the name PAX."""
    index = pandas.MultiIndex.from_tuples(freedoms)
    frames = {key: pandas.DataFrame(matrix, index=index, columns=index) for key, matrix in matrices.items()}
    first = next(iter(matrices.values()))
    frames["PAX"] = pandas.DataFrame(first[:, :2], index=index, columns=[1, 2])
    pyyeti.nastran.bulk.wtdmig(str(HERE / name), frames)


def abaqus(freedoms, matrix):
    """Writes the lower triangle of a matrix in the two layouts of *MATRIX OUTPUT of Abaqus, which is not at hand."""
    nodes, numbers = [], []
    for column, row in itertools.combinations_with_replacement(range(len(freedoms)), 2):
        value = matrix[row, column]
        if value != 0:
            labels = [f"{node},{direction}" for node, direction in (freedoms[row], freedoms[column])]
            nodes.append(f"{labels[0]}, {labels[1]}, {value:22.15e}\n")
            numbers.append(f"{row + 1},{column + 1}, {value:22.15e}\n")
    (HERE / "tets_nodes.mtx").write_text("".join(nodes))
    (HERE / "tets_numbers.mtx").write_text("".join(numbers))


def single(path, name, matrix):
    """Writes OUTPUT4 of single precision with dense columns as Fortran records of big-endian words."""
    count = len(matrix)
    with scipy.io.FortranFile(path, "w", header_dtype=">u4") as file:
        header = numpy.array([count, count, 6, 1], ">i4").tobytes() + f"{name:8}".encode()
        file.write_record(numpy.frombuffer(header, "u1"))
        for column, values in enumerate(matrix.T, 1):
            head = numpy.array([column, 1, count], ">i4").tobytes()
            file.write_record(numpy.frombuffer(head + values.astype(">f4").tobytes(), "u1"))
        end = numpy.array([count + 1, 1, 1], ">i4").tobytes() + numpy.array([1], ">f4").tobytes()
        file.write_record(numpy.frombuffer(end, "u1"))


def main():
    run(STORE, ["tets.sti", "tets.mas", "tets.dof"])
    run(SUBSTRUCTURE, ["tets_substructure.mtx"])
    freedoms = [tuple(map(int, line.split("."))) for line in (HERE / "tets.dof").read_text().split()]
    stiffness, mass = stored("tets.sti"), stored("tets.mas")
    both = {"KAAX": stiffness, "MAAX": mass}
    abaqus(freedoms, mass)
    small_dmig("tets_small.bdf", freedoms, "MAAX", mass)
    large_dmig("tets_large.pch", freedoms, both)

    OP4(debug=False).write_op4(str(HERE / "tets_text.op4"), {"KAAX": (6, stiffness)}, is_binary=False)

    def write(file, names, **options):
        matrices = [both[name] for name in names]
        path = str(HERE / f"tets_{file}.op4")
        pyyeti.nastran.op4.write(path, names, matrices, forms=[6] * len(names), **options)

    write("text_strings", ["KAAX"], binary=False, digits=9, sparse="nonbigmat")
    write("text_bigmat", ["KAAX"], binary=False, digits=9, sparse="bigmat")
    write("dense", ["MAAX"], binary=True, endian="<", sparse="dense")
    single(HERE / "tets_single.op4", "MAAX", mass)
    write("strings", list(both), binary=True, endian="<", sparse="nonbigmat")
    write("bigmat", ["KAAX"], binary=True, endian=">", sparse="bigmat")


if __name__ == "__main__":
    main()
