"""Renders scenes with this crate and with Mitsuba 3, in turn, and compares rate and error.

    pip install -r requirements.txt
    cargo build --release --all-features --example render
    DRJIT_LIBLLVM_PATH=... python3 compare_mitsuba.py [-D name=value]... [--ours=OPTIONS]... [--spp N]... [--runs R] SCENE.xml...

Mitsuba runs its fastest variant for processors, `llvm_ad_rgb`, with each of `SAMPLERS`; the scene's own sampler is
replaced. The first render compiles: its time, loading included, is `cold`, and counts for nothing else. Then for every number of
samples the programs take turns, `R` times, each time with another seed. Rates and times are medians, with the extremes
behind them; ours are of rendering alone, as Mitsuba's are, and loading is told apart.

The error is that of the pixels' means over seeds, from the differences of all pairs of runs: `mse x spp` is the mean over pixels and
channels of the squared difference, halved, times the samples. It sees noise and no bias; so `apart` is the difference of
the mean colours of both programs in standard errors, to be below about 3. An efficiency is 1 / (mse x seconds). Ours is rendered
once for each of `--ours`, options of the program; without any with those of `OURS`. Pixels that reuse paths err alike: the error is theirs,
not that of means over several pixels. The last line is ours over that of Mitsuba's better sampler at the same number of samples.
"""

import argparse
import itertools
import json
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
mi.set_log_level(mi.LogLevel.Error)

PINNED = "3.9.1"
# `ldsampler` is left out: it is slightly biased in this version.
SAMPLERS = ["independent", "multijitter"]

# As the program is by itself, with blue noise; with points for less noise, as it takes for the others; more samples where they differ more; paths
# reused by neighbours; both.
OURS = ["", "--points rescrambled", "--adaptive", "--reuse 8", "--reuse 16 --adaptive"]


def included(file: Path) -> str:
    """The text of a scene with that of the files it includes in their places."""

    def content(match: re.Match[str]) -> str:
        text = included(file.parent / match.group(1))
        return re.sub(r"<\?xml.*?\?>|</?scene\b[^>]*>", "", text, flags=re.DOTALL)

    return re.sub(r'<include\s+filename="([^"$]+)"\s*/>', content, file.read_text())


class Mitsuba:
    """A scene with one of Mitsuba's samplers."""

    def __init__(self, file: Path, sampler: str, values: dict[str, str]):
        self.name = f"mitsuba {sampler}"
        text, count = re.subn(r'<sampler\s+type="\w+"', f'<sampler type="{sampler}"', included(file))
        if count == 0:
            raise SystemExit(f"{file}: no sampler to replace")
        start = time.perf_counter()
        # Beside the scene, for the files that it names.
        with tempfile.NamedTemporaryFile("w", suffix=".xml", dir=file.parent) as copy:
            copy.write(text)
            copy.flush()
            self.scene = mi.load_file(copy.name, **values)
        self.load = time.perf_counter() - start
        self.render(16, 0)
        self.cold = time.perf_counter() - start

    def render(self, spp: int, seed: int) -> tuple[float, np.ndarray]:
        start = time.perf_counter()
        image = np.array(mi.render(self.scene, spp=spp, seed=seed), dtype=np.float64)
        return time.perf_counter() - start, image


class Ours:
    """The same scene in the program `render`."""

    def __init__(self, file: Path, program: Path, options: str, values: dict[str, str]):
        self.name = f"ours {options}".strip()
        self.command = [program, file, *options.split(), "--json", "-"]
        for name, value in values.items():
            self.command += ["-D", f"{name}={value}"]
        self.load = self.cold = 0.0

    def render(self, spp: int, seed: int) -> tuple[float, np.ndarray]:
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder) / "picture.exr"
            arguments = ["--spp", str(spp), "--seed", str(seed + 1), "--out", picture]
            start = time.perf_counter()
            run = subprocess.run([*self.command, *arguments], capture_output=True, text=True, check=False)
            whole = time.perf_counter() - start
            if run.returncode != 0:
                raise SystemExit(run.stderr.strip())
            seconds = json.loads(run.stdout)["seconds"]
            self.load = self.cold = whole - seconds
            return seconds, np.array(mi.Bitmap(str(picture)), dtype=np.float64)


def spread(values: list[float], digits: int) -> str:
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"{middle:.{digits}f} ({low:.{digits}f}-{high:.{digits}f})"


def error(images: list[np.ndarray]) -> float:
    """The mean squared error of one image, from the differences of all pairs."""
    pairs = itertools.combinations(images, 2)
    return float(np.mean([np.mean((a - b) ** 2) / 2 for a, b in pairs]))


def apart(ours: list[np.ndarray], theirs: list[np.ndarray]) -> float:
    """The largest difference of the mean colours in standard errors."""
    means = [np.array([image.mean((0, 1)) for image in images]) for images in (ours, theirs)]
    variance = sum(m.var(0, ddof=1) / len(m) for m in means)
    return float(np.max(np.abs(means[0].mean(0) - means[1].mean(0)) / np.sqrt(variance)))


def compare(file: Path, options: argparse.Namespace) -> None:
    values = dict(options.values)
    ours = [Ours(file, options.program, kind, values) for kind in options.ours]
    programs = [*ours, *(Mitsuba(file, sampler, values) for sampler in SAMPLERS)]
    print(f"\n{file.name}")
    print(f"{'':28} {'spp':>5} {'M paths/s':>22} {'seconds':>22} {'rmse':>9} {'mse x spp':>10} {'efficiency':>11} {'apart':>6}")
    for spp in options.spp:
        times = {program.name: [] for program in programs}
        images = {program.name: [] for program in programs}
        for seed, program in itertools.product(range(options.runs), programs):
            seconds, image = program.render(spp, seed)
            times[program.name].append(seconds)
            images[program.name].append(image)
        efficiencies = []
        for program in programs:
            seconds, pictures = times[program.name], images[program.name]
            paths = pictures[0].shape[0] * pictures[0].shape[1] * spp
            mse = error(pictures)
            efficiencies.append(1 / (mse * statistics.median(seconds)))
            rates = spread([paths / s * 1e-6 for s in seconds], 2)
            distance = "" if program is programs[0] else f"{apart(images[programs[0].name], pictures):.1f}"
            print(
                f"{program.name:28} {spp:5} {rates:>22} {spread(seconds, 3):>22} {mse**0.5:9.5f} {mse * spp:10.5f}"
                f" {efficiencies[-1]:11.3g} {distance:>6}"
            )
        best = max(efficiencies[len(ours) :])
        ratios = ", ".join(f"{efficiency / best:.2f}" for efficiency in efficiencies[: len(ours)])
        print(f"{'ratio of efficiency':28} {spp:5} {ratios}")
    for program in programs:
        print(f"{program.name:28} loaded in {program.load:.2f} s, cold {program.cold:.2f} s")


def assignment(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise argparse.ArgumentTypeError(f"{text} is no name=value")
    return name, value


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=Path, metavar="SCENE.xml")
    parser.add_argument("-D", dest="values", type=assignment, action="append", default=[], metavar="NAME=VALUE",
                        help="gives a parameter of the scenes a value")
    parser.add_argument("--ours", action="append", metavar="OPTIONS", help="options of the program `render`, as in --ours=--adaptive")
    parser.add_argument("--spp", type=int, action="append")
    parser.add_argument("--runs", type=int, default=5)
    program = Path(__file__).parent.parent / "target/release/examples/render"
    parser.add_argument("--program", type=Path, default=program)
    options = parser.parse_args()
    options.spp = options.spp or [16, 64, 256]
    options.ours = options.ours or OURS
    if options.runs < 3:
        parser.error("--runs must be at least 3: errors come from pairs")
    if mi.__version__ != PINNED:
        parser.error(f"Mitsuba {PINNED} is wanted, this is {mi.__version__}")
    for scene in options.scenes:
        compare(scene, options)


if __name__ == "__main__":
    main()
