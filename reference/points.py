"""Writes the golden points in points/ that tests/exact.rs compares with, by independent programs.

    python -m venv venv && venv/bin/pip install -r reference/requirements-points.txt
    venv/bin/python reference/points.py

Every file is one line of column numbers (the dimensions, counted from 0), then one line for each point:
its index, and its coordinates with 17 significant digits.
"""

import pathlib

import numpy as np
import openturns
import qmcpy
import scipy.stats.qmc

FOLDER = pathlib.Path(__file__).parent / "points"


def write(name, program, dimensions, indices, points):
    FOLDER.mkdir(exist_ok=True)
    with open(FOLDER / f"{name}.csv", "w", encoding="ascii") as out:
        print(f"# {program}", file=out)
        print("index," + ",".join(map(str, dimensions)), file=out)
        for index, point in zip(indices, points, strict=True):
            print(f"{index}," + ",".join(f"{u:.17g}" for u in point), file=out)


def version(package):
    return f"{package.__name__} {package.__version__}"


def main():
    few, chosen = range(64), [0, 1, 2, 3, 7, 20, 100, 500, 1023]

    halton = scipy.stats.qmc.Halton(1024, scramble=False)
    sample = halton.random(1000)
    indices = [*few, *range(990, 1000)]
    write("halton", f"scipy {scipy.__version__}", chosen, indices, sample[indices][:, chosen])

    # In Gray-code order; the index is that of natural order.
    sobol = scipy.stats.qmc.Sobol(1024, scramble=False, bits=64)
    sample = sobol.random(1024)
    places = [*few, *range(1000, 1024)]
    indices = [place ^ (place >> 1) for place in places]
    write("sobol", f"scipy {scipy.__version__}", chosen, indices, sample[places][:, chosen])

    sobol = qmcpy.DigitalNetB2(chosen[-1] + 1, randomize="FALSE", order="RADICAL INVERSE")
    sample = sobol.gen_samples(1024)
    write("sobol-natural", f"qmcpy {qmcpy.__version__}", chosen, places, sample[places][:, chosen])

    lattice = qmcpy.Lattice(chosen[-1] + 1, randomize="FALSE", order="LINEAR")
    sample = lattice.gen_samples(1024)
    write("lattice-1024", f"qmcpy {qmcpy.__version__}", chosen, places, sample[places][:, chosen])

    # Without the origin, which is left out there.
    for dimensions in [2, 3, 5, 7, 11]:
        sample = np.array(openturns.FaureSequence(dimensions).generate(600))
        indices = [*range(1, 40), 343, 599]
        points = sample[[index - 1 for index in indices]]
        write(f"faure-{dimensions}", version(openturns), range(dimensions), indices, points)


if __name__ == "__main__":
    main()
