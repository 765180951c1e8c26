"""Discrepancies by other programs than the crate: values for its tests, and times beside its own.

    pip install -r reference/requirements-scipy.txt
    python reference/discrepancy.py values > reference/discrepancy.json
    python reference/discrepancy.py tables

`values` prints small sets of points, whose coordinates are whole multiples of 1/1024, with their squared L2
discrepancies: in exact rational arithmetic from the definitions as double sums, and by scipy where it has them.
`tables` builds the crate's program, runs its benches, and writes all tables of benches/DISCREPANCY.md anew; with
names of tables after it, those alone: machine, speed, large, point_sets, star, l2, division. Each takes minutes at most,
on a machine that does nothing else.
"""

import glob
import json
import os
import subprocess
import sys
import tempfile
import time
from fractions import Fraction as F
from math import log, prod

import numpy
import scipy
from scipy.stats import qmc

HALF = F(1, 2)


def centred_pair(x, y):
    return 1 + (abs(x - HALF) + abs(y - HALF) - abs(x - y)) / 2


def mixture_pair(x, y):
    t = abs(x - y)
    return F(15, 8) - abs(x - HALF) / 4 - abs(y - HALF) / 4 - F(3, 4) * t + t * t / 2


# For every kind: the mean of the kernel, its integral over one coordinate, the kernel. From the papers that the crate's
# documentation names.
KINDS = {
    "l2-star": (F(1, 3), lambda x: (1 - x * x) / 2, lambda x, y: 1 - max(x, y)),
    "centred": (
        F(13, 12),
        lambda x: 1 + abs(x - HALF) / 2 - abs(x - HALF) ** 2 / 2,
        centred_pair,
    ),
    "wrap-around": (
        F(4, 3),
        lambda x: F(4, 3),
        lambda x, y: F(3, 2) - abs(x - y) * (1 - abs(x - y)),
    ),
    "mixture": (
        F(19, 12),
        lambda x: F(5, 3) - abs(x - HALF) / 4 - abs(x - HALF) ** 2 / 4,
        mixture_pair,
    ),
    "symmetric": (F(4, 3), lambda x: 1 + 2 * x - 2 * x * x, lambda x, y: 2 - 2 * abs(x - y)),
    "extreme": (F(1, 12), lambda x: x * (1 - x) / 2, lambda x, y: min(x, y) - x * y),
}
# Kernels that are 1 plus the kernel of one dimension alone.
ALL_PROJECTIONS = {"centred", "wrap-around", "mixture", "symmetric"}
SCIPY = {"l2-star": "L2-star", "centred": "CD", "wrap-around": "WD", "mixture": "MD"}


def squared(kind, points, weights=None):
    """The square of a discrepancy in rational arithmetic."""
    mean, single, pair = KINDS[kind]
    n, d = len(points), len(points[0])
    if weights is None:
        change = [lambda k: k] * d
    elif kind in ALL_PROJECTIONS:
        change = [lambda k, w=w: 1 + w * (k - 1) for w in weights]
    else:
        change = [lambda k, w=w: 1 + w * k for w in weights]
    means = prod(change[k](mean) for k in range(d))
    singles = sum(prod(change[k](single(x[k])) for k in range(d)) for x in points)
    pairs = sum(
        prod(change[k](pair(x[k], y[k])) for k in range(d)) for x in points for y in points
    )
    return means - 2 * singles / n + pairs / n**2


def values():
    sets = []
    state = 1
    for d in range(1, 7):
        for n in (1, 5, 24):
            points = []
            for _ in range(n):
                row = []
                for _ in range(d):
                    # The generator of Park and Miller (1988).
                    state = state * 48271 % 2147483647
                    row.append(F(state % 1025, 1024))
                points.append(row)
            rows = [[float(x) for x in row] for row in points]
            dyadic = [F(3, 2 ** (k + 1)) for k in range(d)]
            sets.append(
                {
                    "dimensions": d,
                    "points": rows,
                    "squared": {kind: float(squared(kind, points)) for kind in KINDS},
                    "weights": [float(w) for w in dyadic],
                    "weighted": {kind: float(squared(kind, points, dyadic)) for kind in KINDS},
                    "scipy": {
                        kind: qmc.discrepancy(numpy.array(rows), method=method)
                        ** (2 if kind == "l2-star" else 1)
                        for kind, method in SCIPY.items()
                    },
                }
            )
    json.dump({"scipy": scipy.__version__, "sets": sets}, sys.stdout, indent=1)
    print()


ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
PROGRAM = os.path.join(ROOT, "target", "release", "examples", "discrepancy")


def ours(arguments, threads):
    environment = dict(os.environ, RAYON_NUM_THREADS=str(threads))
    out = subprocess.run(
        [PROGRAM, *arguments, "--json", "-"], env=environment, capture_output=True, check=True
    )
    return json.loads(out.stdout)


def speed(repeats=5):
    """Times beside scipy's, in turns: a table."""
    points = numpy.random.default_rng(1).random((10_000, 8))
    yield "| | threads | scipy | estimand | ratio | relative difference |"
    yield "|---|---|---|---|---|---|"
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        for row in points:
            file.write(",".join(repr(float(x)) for x in row) + "\n")
        file.flush()
        for kind, method in SCIPY.items():
            for threads in (1, 2):
                theirs, mine = [], []
                for _ in range(repeats):
                    start = time.perf_counter()
                    value = qmc.discrepancy(points, method=method, workers=threads)
                    theirs.append(time.perf_counter() - start)
                    answer = ours(["--file", file.name, "--metric", kind, "--squared"], threads)
                    mine.append(answer["seconds"])
                if kind == "l2-star":
                    value = value**2
                difference = abs(value / answer["value"] - 1)
                theirs, mine = 1e3 * min(theirs), 1e3 * min(mine)
                yield (
                    f"| {kind} | {threads} | {theirs:.0f} | {mine:.0f} | {mine / theirs:.3f} "
                    f"| {difference:.0e} |"
                )


def large():
    """Times of large sets of Halton's points, with two threads: a table."""
    yield "| | n | d | seconds | to reach |"
    yield "|---|---|---|---|---|"
    for metric, count, dimensions, target in (
        ("l2-star", 10**6, 2, 2),
        ("l2-star", 10**6, 4, 60),
        ("star", 10**5, 2, 2),
        ("star", 2000, 3, 2),
        ("star", 200, 5, 10),
        ("star", 100, 7, 20),
    ):
        seconds = exact_seconds("halton", metric, count, dimensions, 3 if target < 60 else 1, 2)
        yield f"| {metric} | {count} | {dimensions} | {seconds:.2f} | {target} |"


def exact_seconds(name, metric, count, dimensions, repeats, threads):
    arguments = [name, "--metric", metric, "--count", str(count), "--dims", str(dimensions)]
    arguments += ["--kind", "exact", "--budget", "1000"]
    return min(ours(arguments, threads)["seconds"] for _ in range(repeats))


def slope(times):
    """The power of the count that fits the times."""
    xs, ys = [log(n) for n, _ in times], [log(t) for _, t in times]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((a - x) * (b - y) for a, b in zip(xs, ys)) / sum((a - x) ** 2 for a in xs)


def point_sets():
    """Times of the exact star discrepancy of several sets, the counts doubling, one thread: a table."""
    yield "| | d | n: ms | growth | 1 + d/2 |"
    yield "|---|---|---|---|---|"
    for dimensions, counts in ((3, (125, 250, 500, 1000)), (5, (25, 50, 100, 200))):
        for name in ("independent", "halton", "sobol", "lattice"):
            times = [
                (n, 1e3 * exact_seconds(name, "star", n, dimensions, 3, 1)) for n in counts
            ]
            shown = ", ".join(f"{n}: {t:.3g}" for n, t in times)
            power = 1 + dimensions / 2
            yield f"| {name} | {dimensions} | {shown} | n^{slope(times):.2f} | {power} |"


def growth(prefix, infix):
    """Runs the benches whose group has such a name, and fits the least times that criterion keeps: a table."""
    bench = ["cargo", "bench", "--all-features", "--bench", "discrepancy", "--"]
    subprocess.run([*bench, f"^{prefix}.*{infix}"], cwd=ROOT, check=True)
    root = os.path.join(ROOT, "target", "criterion")
    groups = {}
    for path in glob.glob(os.path.join(root, "*", "*", "new", "benchmark.json")):
        with open(path) as file:
            benchmark = json.load(file)
        group = benchmark["group_id"]
        if not (group.startswith(prefix) and infix in group):
            continue
        with open(path.replace("benchmark.json", "sample.json")) as file:
            sample = json.load(file)
        least = min(t / i for t, i in zip(sample["times"], sample["iters"])) / 1e6
        groups.setdefault(group, []).append((int(benchmark["value_str"]), least))
    yield "| | n: ms | growth |"
    yield "|---|---|---|"
    for name, times in sorted(groups.items()):
        times.sort()
        shown = ", ".join(f"{n}: {t:.3g}" for n, t in times)
        yield f"| {name} | {shown} | n^{slope(times):.2f} |"


def star():
    return growth("Star::exact", "")


def l2():
    return growth("L2::", "d = 8")


def division():
    return growth("L2::Star", "by division")


def machine():
    """Where and with what the tables were measured."""
    with open("/proc/cpuinfo") as file:
        model = next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    load = os.getloadavg()[0]
    yield f"{os.cpu_count()} cores of {model}; a load of {load:.1f} in the minute before; scipy {scipy.__version__}."


TABLES = {f.__name__: f for f in (machine, speed, large, point_sets, star, l2, division)}


def tables(names):
    """Measures, and writes what it finds into the file of the tables."""
    features = ["--release", "--all-features", "--example", "discrepancy"]
    subprocess.run(["cargo", "build", *features], cwd=ROOT, check=True)
    path = os.path.join(ROOT, "benches", "DISCREPANCY.md")
    for name in names:
        measured = "\n".join(TABLES[name]())
        with open(path) as file:
            text = file.read()
        begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
        before, rest = text.split(begin)
        _, after = rest.split(end)
        with open(path, "w") as file:
            file.write(before + begin + measured + "\n" + end + after)
        print(measured, flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["values"]:
        values()
    elif sys.argv[1:2] == ["tables"] and set(sys.argv[2:]) <= set(TABLES):
        tables(sys.argv[2:] or list(TABLES))
    else:
        sys.exit(__doc__)
