#!/usr/bin/env python3
"""Solves the Maros-Meszaros problems of up to 420 variables and compares the optima with the published ones.

FOLDER is `data` in a checkout of github.com/qpsolvers/maros_meszaros_qpbenchmark. Needs numpy, scipy and cargo.
The optima are those of Maros and Meszaros, "A repository of convex quadratic programming problems", Optimization
Methods and Software 11, 1999. VALUES is not convex and must be rejected.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io

WORKSPACE = pathlib.Path(__file__).resolve().parents[3]
INFINITE = 9e19
RIGHT = 1e-6
OPTIMA = {
    "CVXQP1_S": 1.15907181e4, "CVXQP2_S": 8.12094048e3, "CVXQP3_S": 1.19434322e4, "DPKLO1": 3.70096217e-1,
    "DUAL1": 3.50129662e-2, "DUAL2": 3.37336761e-2, "DUAL3": 1.35755839e-1, "DUAL4": 7.46090842e-1,
    "DUALC1": 6.15525083e3, "DUALC2": 3.55130769e3, "DUALC5": 4.27232327e2, "DUALC8": 1.83093588e4,
    "GENHS28": 9.27173692e-1, "HS118": 6.64820452e2, "HS21": -9.996e1, "HS268": 0, "HS35": 1.11111111e-1,
    "HS35MOD": 2.5e-1, "HS51": 0, "HS52": 5.32664756, "HS53": 4.09302326, "HS76": -4.68181818,
    "KSIP": 5.75797941e-1, "LOTSCHD": 2.39841590e3, "PRIMAL1": -3.50129646e-2, "PRIMALC1": -6.15525083e3,
    "PRIMALC2": -3.55130769e3, "PRIMALC5": -4.27232327e2, "QADLITTL": 4.80318859e5, "QAFIRO": -1.59078179,
    "QBEACONF": 1.64712062e5, "QBORE3D": 3.10020080e3, "QBRANDY": 2.83751149e4, "QCAPRI": 6.67932933e7,
    "QE226": 2.12653433e2, "QGROW7": -4.27987139e7, "QISRAEL": 2.53478378e7, "QPCBLEND": -7.84254092e-3,
    "QPCBOEI1": 1.15039140e7, "QPCBOEI2": 8.17196225e6, "QPTEST": 4.371875, "QRECIPE": -2.66616e2,
    "QSC205": -5.81395518e-3, "QSCAGR7": 2.68659486e7, "QSCORPIO": 1.88050955e3, "QSHARE1B": 7.20078318e5,
    "QSHARE2B": 1.17036917e4, "S268": 0, "TAME": 0, "ZECEVIC2": -4.125,
}
REFUSED = {"VALUES"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="the folder of .mat files")
    parser.add_argument("--most", type=int, default=420, help="most variables")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = [write(path, pathlib.Path(folder), options.most) for path in sorted(options.folder.glob("*.mat"))]
        command = ["cargo", "run", "--release", "--package", "ahqp-core", "--example", "quadratic_programs", "--"]
        done = subprocess.run(command + [f for f in files if f], cwd=WORKSPACE, check=True, stdout=subprocess.PIPE)
    wrong = sum(not judge(*line.split(maxsplit=2)) for line in done.stdout.decode().splitlines())
    sys.exit(f"{wrong} wrong" if wrong else None)


def write(path, folder, most):
    """The problem as numbers; None if it is too large. The last n rows of its matrix are the variables."""
    data = scipy.io.loadmat(path)
    matrix = data["A"]
    n, m = matrix.shape[1], matrix.shape[0] - matrix.shape[1]
    if n > most:
        return None
    parts = [data["r"], data["P"].toarray(), data["q"], matrix.toarray()[:m], bounds(data["l"]), bounds(data["u"])]
    to = folder / f"{path.stem}.bin"
    numbers = np.concatenate([np.ravel(part).astype("<f8") for part in parts])
    to.write_bytes(np.array([n, m], "<u8").tobytes() + numbers.tobytes())
    return to


def bounds(numbers):
    numbers = numbers.ravel().astype(float)
    numbers[numbers > INFINITE] = np.inf
    numbers[numbers < -INFINITE] = -np.inf
    return numbers


def judge(name, end, what):
    """Prints the result of a problem; returns whether it is right."""
    if end == "refused":
        right = name in REFUSED
        print(f"{name:10} refused {'as it should be' if right else 'WRONG'}: {what}")
        return right
    value, iterations, seconds = map(float, what.split())
    if name not in OPTIMA:
        print(f"{name:10} {value:16.9e} has no published optimum here")
        return name not in REFUSED
    optimum = OPTIMA[name]
    error = abs(value - optimum) / max(abs(optimum), 1e-3)
    print(f"{name:10} {value:16.9e} off by {error:.1e} {iterations:6.0f} iterations {1e3 * seconds:8.1f} ms"
          + ("" if error < RIGHT else " WRONG"))
    return error < RIGHT


if __name__ == "__main__":
    main()
