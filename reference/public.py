"""Judges this crate's renders of Mitsuba's own public test scenes.

    git clone https://github.com/mitsuba-renderer/mitsuba-data DATA
    python3 public.py DATA/tests/scenes [NAME ...]

Every scene with an RGB reference is rendered by the program `render` and
compared as Mitsuba's own `test_renders.py` does it: with the reference's
variances, for as many samples as give two million paths, at a significance of
1 % over all pixels (Sidak), of which 0.25 % may fail. Beyond that the means of
both images are compared, which sees what is wrong everywhere by a little: `z`
is their difference over its standard error, and about normally distributed.
"""

import argparse
import json
import math
import subprocess
import sys
from pathlib import Path

import mitsuba as mi
import numpy as np
from scipy.special import erfc

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)

BUDGET = 2_000_000
SIGNIFICANCE = 0.01
FRACTION = 0.9975


def xyz(file: Path) -> np.ndarray:
    bitmap = mi.Bitmap(str(file))
    return np.array(bitmap.convert(mi.Bitmap.PixelFormat.XYZ, mi.Struct.Type.Float32, False), dtype=np.float64)


def judge(program: Path, scene: Path, points: str) -> str:
    stem = scene.stem.rsplit("_", 1)[0]
    reference = scene.parent / "refs" / f"{stem}_ref_rgb.exr"
    variance = scene.parent / "refs" / f"{stem}_ref_rgb_var.exr"
    if not (reference.exists() and variance.exists()):
        return "no reference"
    truth, spread = xyz(reference), np.maximum(xyz(variance), 1e-4)
    pixels = truth.shape[0] * truth.shape[1]
    spp = BUDGET // pixels
    picture = Path("/tmp") / f"{stem}.exr"
    command = [program, scene, "--spp", str(spp), "--points", points, "--out", picture, "--json", "-"]
    if "$spp" in scene.read_text():
        command += ["-D", f"spp={spp}"]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode != 0:
        return run.stderr.strip().removeprefix("error: ")
    figures = json.loads(run.stdout)
    ours = xyz(picture)
    if ours.shape != truth.shape:
        return f"has the shape {ours.shape} instead of {truth.shape}"
    p_values = erfc(np.abs(ours - truth) * np.sqrt(spp / spread) / math.sqrt(2))
    limit = 1 - (1 - SIGNIFICANCE) ** (1 / pixels)
    passing = np.count_nonzero(p_values > limit) / p_values.size
    # The reference's own error is not known; it has at least as many samples as ours in most scenes.
    error = np.sqrt(xyz(variance).sum(axis=(0, 1)) / spp) / pixels
    z = (ours - truth).mean(axis=(0, 1)) / np.maximum(error, 1e-12)
    off = ours.mean() / truth.mean() - 1
    verdict = "agrees" if passing >= FRACTION else "DIFFERS"
    return (
        f"{verdict}: {100 * passing:.3f} % of the pixels, smallest p {p_values.min():.1e}, mean off by {100 * off:+.3f} %, "
        f"z {np.abs(z).max():.1f}, {figures['seconds']:.1f} s"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--points", default="independent")
    parser.add_argument("--program", type=Path, default=Path(__file__).parent.parent / "target/release/examples/render")
    arguments = parser.parse_args()
    differs = False
    for scene in sorted(arguments.folder.glob("*/*.xml")):
        if arguments.names and not any(name in str(scene) for name in arguments.names):
            continue
        result = judge(arguments.program, scene, arguments.points)
        differs |= result.startswith("DIFFERS")
        print(f"{scene.parent.name}/{scene.stem}: {result}", flush=True)
    return int(differs)


if __name__ == "__main__":
    sys.exit(main())
