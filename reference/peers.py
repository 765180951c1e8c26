"""Measures scipy, vegas and Mitsuba on the integrals and pictures of examples/report, which calls this script.

Reads one task as JSON from the standard input and writes one answer as JSON to the standard output:

    {"task": "versions"}                  -> names and versions of what can be imported
    {"task": "integral", "family": ...}   -> a list of runs
    {"task": "picture", "scene": ...}     -> a list of runs
"""

import importlib
import json
import os
import sys
import time
from pathlib import Path

SCENES = Path(__file__).resolve().parent / "scenes"


def available(name):
    """The module, or None if it cannot be imported."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def versions():
    modules = {name: available(name) for name in ["scipy", "vegas", "mitsuba"]}
    return [f"{name} {module.__version__}" for name, module in modules.items() if module]


def timed(job, shortest):
    """The result of a job and the seconds of one run, repeated until they can be measured."""
    start, runs = time.perf_counter(), 0
    while True:
        result = job()
        runs += 1
        seconds = time.perf_counter() - start
        if seconds >= shortest:
            return result, seconds / runs


def integrand(task):
    """The integrand on an array of points, a row each; as examples/common/integrands.rs has it."""
    import numpy as np

    a, u, width = task["a"], task["u"], task["width"]
    families = {
        "oscillatory": lambda x: np.cos(2 * np.pi * u + a * x.sum(axis=1)),
        "gaussian": lambda x: np.exp(-a * a * ((x - u) ** 2).sum(axis=1)),
        "continuous": lambda x: np.exp(-a * np.abs(x - u).sum(axis=1)),
        "discontinuous": lambda x: np.where(
            (x[:, :2] < u).all(axis=1), np.exp(a * x.sum(axis=1)), 0.0),
        "peak": lambda x: np.exp(-0.5 / (width * width) * ((x - u) ** 2).sum(axis=1)),
    }
    return families[task["family"]]


def integral(task):
    f, dims, truth = integrand(task), task["dims"], task["truth"]
    first, last = task["powers"]
    runs = []

    def measure(method, count, estimate):
        estimate(task["seed"])
        for k in range(task["seeds"]):
            (mean, error, evaluations), seconds = timed(
                lambda k=k: estimate(task["seed"] + k), task["shortest"])
            runs.append({
                "method": method, "count": count, "evaluations": int(evaluations), "seconds": seconds,
                "squared_error": float((mean - truth) ** 2),
                "squared_claim": None if error is None else float(error**2),
                "covered": None if error is None else float(abs(mean - truth) <= 1.96 * error),
            })

    if available("scipy"):
        from scipy.stats import qmc

        for power in range(first, last):
            def sobol(seed, power=power):
                points = qmc.Sobol(dims, scramble=True, rng=seed).random_base2(power)
                return f(points).mean(), None, 1 << power
            measure("scipy Sobol'", 1 << power, sobol)
    if available("vegas"):
        import numpy as np
        import vegas

        batch = vegas.lbatchintegrand(f)
        for power in range(max(first, 9), last):
            def adapt(seed, power=power):
                vegas.ran_array_generator = np.random.default_rng(seed).random
                integrator = vegas.Integrator([[0, 1]] * dims)
                each = (1 << power) // 10
                integrator(batch, nitn=5, neval=each)
                result = integrator(batch, nitn=5, neval=each)
                return result.mean, result.sdev, 10 * each
            measure("vegas (Lepage)", 1 << power, adapt)
    return runs


def load_mitsuba():
    """Mitsuba in the fastest variant that this machine can run."""
    import mitsuba

    for variant in ["llvm_ad_rgb", "scalar_rgb"]:
        try:
            mitsuba.set_variant(variant)
            mitsuba.set_log_level(mitsuba.LogLevel.Error)
            return mitsuba, variant
        except ImportError:
            continue
    raise SystemExit("Mitsuba has no variant that this machine can run")


def picture(task):
    if not available("mitsuba"):
        return []
    import numpy as np

    mitsuba, variant = load_mitsuba()
    if variant.startswith("llvm"):
        import drjit
        drjit.set_thread_count(task["threads"])
    reference = np.array(mitsuba.Bitmap(task["reference"]), dtype=np.float64)
    size = task["size"]
    settings = {"size": size, "spp": 1}
    if task["depth"]:
        settings["max_depth"] = task["depth"]
    runs = []
    scene = mitsuba.load_file(str(SCENES / task["scene"]), **settings)
    samplers = {f"Mitsuba 3, {variant[:variant.index('_')]}": scene.sensors()[0]}
    for spp in task["spp"]:
        for name, sensor in samplers.items():
            render = lambda seed: np.array(  # noqa: E731
                mitsuba.render(scene, sensor=sensor, spp=spp, seed=seed), dtype=np.float64)
            render(0)
            for k in range(task["seeds"]):
                # Far from the seeds of the references.
                seed = 1_000_000 + 1000 * task["seed"] + k
                image, seconds = timed(lambda seed=seed: render(seed), 1e-3)
                runs.append({
                    "method": name, "count": spp, "evaluations": spp * size * size, "seconds": seconds,
                    "squared_error": float(((image - reference) ** 2).mean()),
                    "squared_claim": None, "covered": None,
                })
    return runs


def main():
    task = json.load(sys.stdin)
    # Programs of other languages are given as many threads as ours: one for integrals.
    if task["task"] == "integral":
        os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    answer = {"versions": lambda _: versions(), "integral": integral, "picture": picture}[task["task"]](task)
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
