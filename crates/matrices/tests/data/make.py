"""Writes the files of this folder with NumPy, SciPy and h5py: pip install numpy scipy h5py; python make.py

One model in all formats: a chain of six nodes, each with two displacements. K is its symmetric stiffness, A the same with
follower forces, not symmetric. All values have up to twelve digits, so each format gives the same doubles. K.txt and A.txt
hold what the tests expect: row, column (from 0) and value of each entry.

Harwell-Boeing files of Ansys and MATLAB files of version 7.3 are written here by their layout, for want of the programs.
"""

import struct
from pathlib import Path

import h5py
import numpy as np
import scipy.io
import scipy.sparse

HERE = Path(__file__).parent
NODES = 6
LABELS = ("UX", "UY")


def rounded(matrix):
    return np.vectorize(lambda value: float(f"{value:.12g}"))(matrix)


def model():
    n = len(LABELS) * NODES
    stiffness = np.zeros((n, n))
    for node in range(NODES - 1):
        # A spring between neighbours, in the direction (cos, sin).
        angle = 0.3 + 0.25 * node
        direction = np.array([np.cos(angle), np.sin(angle)])
        block = 1e6 * (1 + node / 7) * np.outer(direction, direction)
        at = slice(2 * node, 2 * node + 4)
        stiffness[at, at] += np.block([[block, -block], [-block, block]])
    stiffness[:2, :2] += 1e5 / 3 * np.eye(2)
    stiffness = rounded(stiffness)
    follower = np.zeros((n, n))
    for node in range(1, NODES, 2):
        follower[2 * node, 2 * node + 1] = -0.4e5 / (node + 2)
        follower[2 * node - 2, 2 * node + 1] = 1.0 / (node + 2) ** 5
    return stiffness, rounded(stiffness + follower)


def expected(name, matrix):
    matrix = scipy.sparse.csc_matrix(matrix).tocoo()
    lines = (f"{i} {j} {float(v)!r}\n" for i, j, v in zip(matrix.row, matrix.col, matrix.data))
    (HERE / name).write_text("".join(lines))


def fortran(value):
    """A number as Fortran writes it with D25.15: 0.481688458219953D+10."""
    mantissa, exponent = f"{value:.14e}".split("e")
    digits = mantissa.replace(".", "").replace("-", "")
    sign = "-" if value < 0 else ""
    return f"{sign}0.{digits}D{int(exponent) + 1:+03d}".rjust(25)


def ansys(stem, matrix):
    """HBMAT, ASCII, with a right-hand side and a mapping file: the lower triangle by columns, a number in each line."""
    lower = scipy.sparse.csc_matrix(np.tril(matrix))
    lower.sort_indices()
    n, entries = lower.shape[0], lower.nnz
    counts = (n + 1, entries, entries, n)
    lines = ["Stiffness matrix from ANSYS FULL file dumped into Harwell-Boeing format".ljust(80)]
    lines.append("".join(f"{count:14d}" for count in (sum(counts), *counts)))
    lines.append("RSA".ljust(14) + f"{n:14d}{n:14d}{entries:14d}{0:14d}")
    lines.append("(I14)".ljust(16) * 2 + "(d25.15)".ljust(20) * 2)
    lines.append("F".ljust(14) + f"{1:14d}{n:14d}")
    lines += [f"{pointer + 1:14d}" for pointer in lower.indptr]
    lines += [f"{row + 1:14d}" for row in lower.indices]
    lines += [fortran(value) for value in lower.data]
    lines += [fortran(0.0)] * n
    (HERE / f"{stem}.matrix").write_text("\n".join(lines) + "\n")

    lines = ["    Matrix Eqn          Node    DOF     "]
    for row in range(n):
        label = LABELS[row % 2]
        lines.append(f"{row + 1:14d}{10 * (row // 2 + 1):14d}    {label:4}")
    (HERE / f"{stem}.mapping").write_text("\n".join(lines) + "\n")


def version_7_3(name, matrices):
    with h5py.File(HERE / name, "w", userblock_size=512) as file:
        for key, matrix in matrices.items():
            if scipy.sparse.issparse(matrix):
                group = file.create_group(key)
                group.attrs["MATLAB_class"] = np.bytes_("double")
                group.attrs["MATLAB_sparse"] = np.uint64(matrix.shape[0])
                # K as after `save -nocompression`.
                options = {} if key == "K" else {"chunks": True, "maxshape": (None,), "compression": 3}
                group.create_dataset("data", data=matrix.data, **options)
                group.create_dataset("ir", data=matrix.indices.astype(np.uint64), **options)
                group.create_dataset("jc", data=matrix.indptr.astype(np.uint64), **options)
            else:
                dataset = file.create_dataset(key, data=np.asarray(matrix).T)
                dataset.attrs["MATLAB_class"] = np.bytes_("double")
        text = file.create_dataset("title", data=np.array([[ord(c)] for c in "chain"], dtype=np.uint16))
        text.attrs["MATLAB_class"] = np.bytes_("char")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x200) + b"IM"
    path = HERE / name
    content = path.read_bytes()
    path.write_bytes(head.ljust(512, b"\0") + content[512:])


def big_endian(name, key, matrix):
    """A MATLAB file of level 5 from a machine with the other byte order; SciPy reads it, but does not write it."""

    def element(kind, data):
        return struct.pack(">II", kind, len(data)) + data + bytes(-len(data) % 8)

    data = matrix.astype(">f8").tobytes(order="F")
    body = element(6, struct.pack(">II", 6, 0)) + element(5, struct.pack(">ii", *matrix.shape))
    body += struct.pack(">HH", len(key), 1) + key.encode().ljust(4, b"\0") + element(9, data)
    head = b"MATLAB 5.0 MAT-file".ljust(116) + bytes(8) + struct.pack(">H", 0x100) + b"MI"
    path = HERE / name
    path.write_bytes(head + element(14, body))
    assert (scipy.io.loadmat(path)[key] == matrix).all()


def main():
    k, a = model()
    assert (k == k.T).all() and (a != a.T).any()
    expected("K.txt", k)
    expected("A.txt", a)
    sparse_k, sparse_a = scipy.sparse.csc_matrix(k), scipy.sparse.csc_matrix(a)

    scipy.io.mmwrite(HERE / "K.mtx", sparse_k, symmetry="symmetric", precision=17)
    scipy.io.mmwrite(HERE / "A.mtx", sparse_a, symmetry="general", precision=17)
    scipy.io.mmwrite(HERE / "A_array.mtx", a, symmetry="general", precision=17)
    scipy.io.mmwrite(HERE / "K_array.mtx", k, symmetry="symmetric", precision=17)

    scipy.io.hb_write(HERE / "A.rua", sparse_a)
    ansys("K", k)

    np.save(HERE / "A.npy", a)
    np.save(HERE / "A_fortran.npy", np.asfortranarray(a.astype(">f8")))
    for layout in ("csc", "csr", "coo", "bsr"):
        scipy.sparse.save_npz(HERE / f"A_{layout}.npz", sparse_a.asformat(layout))
    np.savez_compressed(HERE / "dense.npz", A=a, K=k)

    variables = {"A": sparse_a, "K": sparse_k, "D": a, "title": "chain", "Z": 1j * k[:2, :2], "cell": np.array([k, "x"], dtype=object)}
    scipy.io.savemat(HERE / "v7.mat", variables, do_compression=True)
    scipy.io.savemat(HERE / "v6.mat", {"A": sparse_a, "n": np.int8(12)})
    with open(HERE / "v6.mat", "ab") as file:
        # Without a name, as MATLAB writes data of its own: flags (uint8), dimensions, name, value.
        file.write(struct.pack("<16I", 14, 56, 6, 8, 9, 0, 5, 8, 1, 1, 1, 0, 2 | 1 << 16, 7, 0, 0))
    for name in ("v6.mat", "v7.mat"):
        # The heading without the time.
        content = (HERE / name).read_bytes()
        (HERE / name).write_bytes(b"MATLAB 5.0 MAT-file".ljust(116) + content[116:])
    big_endian("big_endian.mat", "A", a)
    version_7_3("v73.mat", {"A": sparse_a, "K": sparse_k, "D": a})


main()
