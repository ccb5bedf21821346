"""An exported K, read and solved by SciPy, has the light field that etendue solves for: `python3 tests/python/matrices.py PROGRAM`."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import scipy.io
import scipy.sparse

# The residual that etendue stops at is 1e-12, amplified by at most 1 / (1 - albedo); LAPACK leaves some ulp more.
AGREEMENT = 1e-10


def run(program, *arguments):
    return json.loads(subprocess.run([program, *arguments, "--json", "--quiet"], check=True, capture_output=True).stdout)


def read(path):
    if path.suffix == ".mtx":
        return scipy.io.mmread(path)
    if path.suffix == ".npz":
        with numpy.load(path) as archive:
            if "indptr" not in archive:
                return archive["data"]
        return scipy.sparse.load_npz(path)
    # Radiance: a header, an empty line, numbers row by row with their components side by side.
    header, _, data = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split("=", 1) for line in header.decode().splitlines()[1:])
    shape = [int(fields[name]) for name in ("NROWS", "NCOLS", "NCOMP")]
    assert fields["FORMAT"] == "double" and fields["BigEndian"] == "0"
    return numpy.frombuffer(data, "<f8").reshape(shape)


def full(matrix):
    return matrix.toarray() if scipy.sparse.issparse(matrix) else numpy.asarray(matrix)


def check(program, scene, patch_size, layout):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder) / "matrices"
        exported = run(program, "export", scene, "--patch-size", patch_size, "--what", "K,T,F,S,E", "--format", layout, "--output", str(folder))
        solved = run(program, "solve", scene, "--patch-size", patch_size)
        radiance = numpy.array([bundle["radiance"] for bundle in solved["bundles"]])
        etendue = numpy.array([bundle["etendue"] for bundle in exported["bundles"]])
        n, n_bands = radiance.shape

        # A band of a matrix: of its own file, of a component, or of all.
        def matrix(letter, band):
            files = [folder / entry["file"] for entry in exported["matrices"] if entry["letter"] == letter]
            values = full(read(files[min(band, len(files) - 1)]))
            return values[:, :, min(band, values.shape[2] - 1)] if values.ndim == 3 else values

        for band in range(n_bands):
            transport, emission = matrix("K", band), matrix("E", band)
            emission = emission[:, min(band, emission.shape[1] - 1)]
            answer = numpy.linalg.solve(numpy.eye(n) - transport, emission)
            error = abs(answer - radiance[:, band]).max() / abs(answer).max()
            assert error <= AGREEMENT, (scene, layout, band, error)
            # K = S G, and T = M G is symmetric to the last bit.
            product = matrix("S", band) @ matrix("F", band)
            assert abs(product - transport).max() <= 1e-15 * abs(transport).max()
            assert abs(etendue[:, None] * matrix("F", band) - matrix("T", band)).max() <= 1e-14 * etendue.max()
        assert (matrix("T", 0) == matrix("T", 0).T).all()

        # And the way back: etendue solves the files that it wrote.
        k = sorted(entry["file"] for entry in exported["matrices"] if entry["letter"] == "K")
        e = [entry["file"] for entry in exported["matrices"] if entry["letter"] == "E"]
        if len(k) == 1:
            back = run(program, "solve", "--solver", "lu", "--matrix", str(folder / k[0]), "--emission", str(folder / e[0]))
            error = abs(numpy.array(back["radiance"]).T - radiance).max() / abs(radiance).max()
            assert error <= AGREEMENT, (scene, layout, error)
        print(f"{scene}, {layout}: {n} bundles, {n_bands} bands agree")


for scene, patch_size in [("cornell-box", "1.0"), ("two-rooms", "0.5"), ("furnace-cube", "0.25")]:
    for layout in ["mtx", "npz", "radiance"]:
        check(sys.argv[1], scene, patch_size, layout)
