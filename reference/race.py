"""Estimand beside GSL, Python's vegas and scipy's cubature: the time to come within an error of a known integral.

    race.py INTEGRAND DIMS   measure one integrand with all programs, in one run
    race.py all              measure all of them
    race.py table            write docs/race.md from what was measured

Measurements are kept in target/race. Needs requirements-race.txt; GSL (gcc and libgsl-dev) is left out, and said to be so, where
it is missing. Everything runs on one thread.

Errors are root mean square relative errors over runs with different seeds, at counts of evaluations that grow fourfold; the time
at which they pass a bound is interpolated between two counts, on logarithmic axes. Past the last count it is extrapolated with
the slope 1/2 of independent points, and marked with a tilde.
"""

import glob
import json
import math
import os
import shutil
import subprocess
import sys
import time

import gvar
import numpy
import scipy
import scipy.integrate
import vegas

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
OUT = os.path.join(ROOT, "target", "race")
PROGRAM = os.path.join(ROOT, "target", "release", "examples", "race")
GSL = os.path.join(OUT, "gsl")

GENZ = ("oscillatory", "product-peak", "corner-peak", "gaussian", "continuous", "discontinuous")
RACES = [(name, d) for d in (5, 10) for name in GENZ] + [("peak", 4)]
SMOOTH = [(name, d) for name in GENZ[:4] for d in (2, 3, 5)]
BOUNDS = (1e-3, 1e-5)
RUNS = 16
ENOUGH = 5e-6


def integral(name, d):
    """The closed forms of Genz' families and of the peak."""
    a, u = {"product-peak": 5, "gaussian": 5, "continuous": 2, "discontinuous": 2}.get(name, 1), 0.5
    if name == "oscillatory":
        return math.cos(2 * math.pi * u + d * a / 2) * (math.sin(a / 2) / (a / 2)) ** d
    if name == "product-peak":
        return (a * (math.atan(a * (1 - u)) + math.atan(a * u))) ** d
    if name == "corner-peak":
        return math.prod(1 / (1 + k * a) for k in range(1, d + 1))
    if name == "gaussian":
        return (math.sqrt(math.pi) / (2 * a) * (math.erf(a * (1 - u)) + math.erf(a * u))) ** d
    if name == "continuous":
        return ((2 - math.exp(-a * u) - math.exp(-a * (1 - u))) / a) ** d
    if name == "discontinuous":
        return (math.expm1(a * u) / a) ** min(d, 2) * (math.expm1(a) / a) ** max(d - 2, 0)
    width = 0.01
    return (width * math.sqrt(2 * math.pi) * math.erf(0.5 / (width * math.sqrt(2)))) ** d


def batch(name, x):
    """The integrands at the rows of x."""
    if name == "oscillatory":
        return numpy.cos(math.pi + x.sum(axis=-1))
    if name == "product-peak":
        return 1 / numpy.prod(0.04 + (x - 0.5) ** 2, axis=-1)
    if name == "corner-peak":
        return (1 + x.sum(axis=-1)) ** (-x.shape[-1] - 1)
    if name == "gaussian":
        return numpy.exp(-25 * ((x - 0.5) ** 2).sum(axis=-1))
    if name == "continuous":
        return numpy.exp(-2 * abs(x - 0.5).sum(axis=-1))
    if name == "discontinuous":
        inside = (x[..., 0] < 0.5) & (x[..., 1] < 0.5)
        return numpy.where(inside, numpy.exp(2 * x.sum(axis=-1)), 0.0)
    return numpy.exp(-5000 * ((x - 0.5) ** 2).sum(axis=-1))


def grow(method, run, most):
    """Rows of one method; `run` gives seconds and relative errors of all runs at a count."""
    rows, count = [], 1024
    while count <= most:
        seconds, errors = run(count)
        error = math.sqrt(sum(e * e for e in errors) / len(errors))
        rows.append({"method": method, "count": count, "seconds": seconds / len(errors), "error": error})
        if error < ENOUGH:
            break
        count *= 4
    return rows


def estimand(name, d, *more):
    command = [PROGRAM, name, "--dims", str(d), "--runs", str(RUNS), *more, "--json", "-"]
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    out = subprocess.run(command, env=environment, capture_output=True, check=True)
    rows = json.loads(out.stdout)["rows"]
    return [dict(row, method="estimand " + row["method"]) for row in rows]


def gsl(name, d, method, most):
    truth = integral(name, d)

    def run(count):
        command = [GSL, name, str(d), method, str(count), str(RUNS)]
        out = subprocess.run(command, capture_output=True, check=True, text=True).stdout.split()
        return float(out[0]), [float(x) / truth - 1 for x in out[1:]]

    return grow("GSL " + method, run, most)


def python_vegas(name, d, most):
    truth = integral(name, d)

    @vegas.lbatchintegrand
    def integrand(x):
        return batch(name, numpy.asarray(x))

    def run(count):
        errors = []
        start = time.perf_counter()
        for seed in range(RUNS):
            gvar.ranseed(seed)
            integrator = vegas.Integrator(d * [[0, 1]])
            # As its manual does it: ten iterations to train, as many to estimate.
            integrator(integrand, nitn=10, neval=count // 20)
            errors.append(integrator(integrand, nitn=10, neval=count // 20).mean / truth - 1)
        return time.perf_counter() - start, errors

    return grow("Python vegas", run, most)


def cubature(name, d):
    """scipy's adaptive cubature at falling tolerances."""
    truth, rows = integral(name, d), []
    for tolerance in (1e-3, 1e-6, 1e-9):
        begin = time.perf_counter()
        result = scipy.integrate.cubature(
            lambda x: batch(name, x), d * [0], d * [1], rule="genz-malik", rtol=tolerance, atol=0,
            max_subdivisions=2000,
        )
        seconds = time.perf_counter() - begin
        error = abs(float(result.estimate) / truth - 1)
        rows.append({"tolerance": tolerance, "seconds": seconds, "error": error, "status": result.status})
        if result.status != "converged" or seconds > 1:
            break
    return rows


def measure(name, d):
    rows, load = [], os.getloadavg()[0]
    if (name, d) in RACES:
        rows += estimand(name, d, "--enough", str(ENOUGH))
        if shutil.which("gcc") and build_gsl():
            rows += gsl(name, d, "plain", 1 << 20) + gsl(name, d, "vegas", 1 << 20)
        rows += python_vegas(name, d, 1 << 20)
    found = {"integrand": name, "dims": d, "load": load, "rows": rows}
    if (name, d) in SMOOTH:
        found["cubature"] = cubature(name, d)
        sets = ("--method", "sobol", "--method", "lattice")
        found["ours"] = estimand(name, d, *sets, "--enough", "1e-10", "--count", str(1 << 22))
    with open(os.path.join(OUT, f"{name}-{d}.json"), "w") as file:
        json.dump(found, file, indent=1)


def build_gsl():
    source = os.path.join(ROOT, "reference", "race.c")
    command = ["gcc", "-O3", "-march=native", source, "-o", GSL, "-lgsl", "-lgslcblas", "-lm"]
    return subprocess.run(command, capture_output=True).returncode == 0


def seconds_to(rows, bound):
    """When the error passes the bound; negative if that is extrapolated."""
    before = None
    for row in rows:
        if row["error"] <= bound:
            if before is None or before["error"] <= row["error"]:
                return row["seconds"]
            part = math.log(before["error"] / bound) / math.log(before["error"] / row["error"])
            return before["seconds"] * (row["seconds"] / before["seconds"]) ** part
        before = row
    return -before["seconds"] * (before["error"] / bound) ** 2


def shown(seconds):
    if seconds is None:
        return ""
    return ("~" if seconds < 0 else "") + f"{1e3 * abs(seconds):.3g}"


def best(times):
    """The method with the least time."""
    return min(times.items(), key=lambda item: abs(item[1]))


def race_table(found):
    peers = ("GSL plain", "GSL vegas", "Python vegas")
    yield "| integrand | d | error | estimand | by | plain | vegas | " + " | ".join(peers) + " | best / best peer |"
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for name, d in RACES:
        if (name, d) not in found:
            continue
        methods = {}
        for row in found[name, d]["rows"]:
            methods.setdefault(row["method"], []).append(row)
        for bound in BOUNDS:
            times = {method: seconds_to(rows, bound) for method, rows in methods.items()}
            winner, ours = best({m: t for m, t in times.items() if m.startswith("estimand")})
            _, theirs = best({m: t for m, t in times.items() if m in peers})
            cells = [shown(times.get(m)) for m in ("estimand plain", "estimand vegas", *peers)]
            yield (
                f"| {name} | {d} | {bound:.0e} | {shown(ours)} | {winner.split()[1]} | "
                + " | ".join(cells)
                + f" | {abs(ours) / abs(theirs):.2g} |"
            )


def cubature_table(found):
    yield "| integrand | d | cubature: ms | its error | estimand: ms | its error | by |"
    yield "|---|---|---|---|---|---|---|"
    for name, d in SMOOTH:
        if (name, d) not in found:
            continue
        row = found[name, d]["cubature"][-1]
        ours = found[name, d]["ours"]
        in_time = [other for other in ours if other["seconds"] <= row["seconds"]] or ours[:1]
        other = min(in_time, key=lambda other: other["error"])
        yield (
            f"| {name} | {d} | {1e3 * row['seconds']:.3g} | {row['error']:.0e} "
            f"| {1e3 * other['seconds']:.3g} | {other['error']:.0e} | {other['method'].split()[1]} |"
        )


def table():
    found = {}
    for path in glob.glob(os.path.join(OUT, "*.json")):
        with open(path) as file:
            one = json.load(file)
        found[one["integrand"], one["dims"]] = one
    with open("/proc/cpuinfo") as file:
        model = next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    loads = [one["load"] for one in found.values()]
    left_out = "" if os.path.exists(GSL) else " GSL was not there and is left out."
    lines = [
        "# Beside other programs",
        "",
        "Written by `reference/race.py`; how it measures is described there. Milliseconds on one thread of",
        f"a virtual machine ({model}) to a root mean square relative error, over {RUNS} runs: the errors are uncertain by a",
        f"fifth, the times by two fifths. {min(loads):.1f} to {max(loads):.1f} other jobs ran on its {os.cpu_count()} cores. A tilde marks",
        "times that are extrapolated: orders of magnitude, not measurements. "
        f"numpy {numpy.__version__}, scipy {scipy.__version__}, vegas {vegas.__version__}.{left_out}",
        "",
        "`by` names our best method: `plain`, `vegas`, `sobol` (eight scrambled Sobol' sets), `lattice` (eight shifted and folded",
        "lattices), `mapped` (Sobol' under a map that VEGAS learned). The integrands are those of `examples/integrate.rs` with their",
        "usual parameters; those of GSL and ours are compiled, those of Python are numpy's, in batches.",
        "",
        *race_table(found),
        "",
        "## Where cubature wins",
        "",
        "scipy's `cubature` (Genz and Malik's rule, to a relative tolerance of 1e-9, or as far as it came in some seconds), and",
        "the least error that we reach in its time with at most 2^22 evaluations.",
        "",
        *cubature_table(found),
        "",
    ]
    with open(os.path.join(ROOT, "docs", "race.md"), "w") as file:
        file.write("\n".join(lines))
    print("\n".join(lines))


def main(arguments):
    os.makedirs(OUT, exist_ok=True)
    if arguments == ["table"]:
        table()
    elif arguments == ["all"]:
        for name, d in dict.fromkeys(RACES + SMOOTH):
            print(name, d, flush=True)
            measure(name, d)
        table()
    elif len(arguments) == 2 and arguments[0] in (*GENZ, "peak"):
        measure(arguments[0], int(arguments[1]))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
