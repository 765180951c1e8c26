#!/usr/bin/env python3
"""Reference images by Mitsuba 3, and a check that they can be reproduced.

    python3 render.py render [NAME ...]     render the references again
    python3 render.py check [NAME ...]      test them against a fresh, short run

A reference is the mean of many independent batches. Beside every mean lies the
standard error of that mean, pixel by pixel, so that another renderer of the
same scene can be tested for more than a likeness.
"""

import argparse
import datetime
import json
import math
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

try:
    import numpy as np
except ImportError:
    np = None

HERE = Path(__file__).resolve().parent
SCENES = HERE / "scenes"
IMAGES = HERE / "images"

# The probability that `check` fails although nothing is wrong, per reference.
FALSE_ALARM = 1e-3

# Pixels that no path can vary must agree up to rounding in single precision.
CONSTANT_TOLERANCE = 1e-5

TILE = 8


class Failure(Exception):
    """An error to be reported without a traceback."""


@dataclass(frozen=True)
class Reference:
    """How a reference is rendered, and how briefly it is checked."""

    scene: str
    size: int
    batches: int
    spp: int
    first_seed: int
    check_batches: int
    check_spp: int
    overrides: dict = field(default_factory=dict)
    variant: str = "llvm_ad_rgb"


REFERENCES = {
    "cornell_box": Reference(
        scene="cornell_box.xml", size=256, batches=128, spp=256, first_seed=1,
        check_batches=32, check_spp=2),
    "cornell_box_depth_8": Reference(
        scene="cornell_box.xml", size=128, batches=128, spp=256, first_seed=1001,
        check_batches=32, check_spp=6, overrides={"max_depth": 8}),
    "cornell_box_specular": Reference(
        scene="cornell_box_specular.xml", size=128, batches=128, spp=512, first_seed=2001,
        check_batches=32, check_spp=6),
    "furnace": Reference(
        scene="furnace.xml", size=64, batches=128, spp=128, first_seed=3001,
        check_batches=32, check_spp=16),
    "environment": Reference(
        scene="environment.xml", size=128, batches=128, spp=256, first_seed=4001,
        check_batches=32, check_spp=16),
    # One for each family of features.
    **{name: Reference(
        scene=f"{name}.xml", size=64, batches=128, spp=64, first_seed=10_001 + 1000 * number,
        check_batches=32, check_spp=16)
       for number, name in enumerate((
           "textures", "sky", "rough_metals", "rough_glass", "plastics", "holes", "meshes",
           "instances", "small_lights", "relief", "shapes", "lens", "parallel", "clipped"))},
}


def load_mitsuba(variant):
    """Imports Mitsuba in the given variant."""
    if np is None:
        raise Failure(
            f"NumPy cannot be imported; install it by: pip install -r {HERE.name}/requirements.txt")
    try:
        import mitsuba
    except ImportError as error:
        raise Failure(
            f"Mitsuba cannot be imported ({error}); "
            f"install it by: pip install -r {HERE.name}/requirements.txt") from error
    if variant not in mitsuba.variants():
        raise Failure(
            f"this Mitsuba has no variant {variant!r}; it has {', '.join(mitsuba.variants())}")
    try:
        mitsuba.set_variant(variant)
    except ImportError as error:
        raise Failure(f"variant {variant!r} cannot be used: {error}") from error
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba


def select(names):
    """The references asked for: all of them if none is named."""
    unknown = [name for name in names if name not in REFERENCES]
    if unknown:
        raise Failure(
            f"unknown reference {', '.join(unknown)}; there are {', '.join(REFERENCES)}")
    return list(dict.fromkeys(names)) or list(REFERENCES)


class Moments:
    """Mean and variance of a stream of arrays, by Welford's recurrence."""

    def __init__(self):
        self.count = 0
        self.mean = 0.0
        self.squares = 0.0

    def add(self, value):
        self.count += 1
        delta = value - self.mean
        self.mean = self.mean + delta / self.count
        self.squares = self.squares + delta * (value - self.mean)

    def variance_of_mean(self):
        return self.squares / (self.count * (self.count - 1))


def tiles(image):
    """Means over tiles of TILE x TILE pixels."""
    height, width, channels = image.shape
    return image.reshape(
        height // TILE, TILE, width // TILE, TILE, channels).mean(axis=(1, 3))


def tile_variances(variance):
    """Variances of the tile means of independent pixels."""
    return tiles(variance) / (TILE * TILE)


def batches(mitsuba, reference, seeds, spp):
    """Renders one image per seed."""
    path = SCENES / reference.scene
    if not path.is_file():
        raise Failure(f"the scene {path} is missing")
    scene = mitsuba.load_file(
        str(path), size=reference.size, spp=spp, **reference.overrides)
    for seed in seeds:
        image = np.array(mitsuba.render(scene, spp=spp, seed=seed), dtype=np.float64)
        shape = (reference.size, reference.size, 3)
        if image.shape != shape:
            raise Failure(f"Mitsuba returned an image of shape {image.shape}, not {shape}")
        if not np.isfinite(image).all():
            raise Failure(f"seed {seed} gave pixels that are not finite")
        yield image


def show_progress(done, total, start):
    if sys.stderr.isatty():
        elapsed = time.monotonic() - start
        end = "\n" if done == total else ""
        print(f"\r  {done}/{total} batches, {elapsed:.0f} s", end=end, file=sys.stderr, flush=True)


def write_exr(mitsuba, path, image):
    mitsuba.Bitmap(np.ascontiguousarray(image, dtype=np.float32)).write(str(path))


def read_exr(mitsuba, path, size):
    if not path.is_file():
        raise Failure(f"the image {path} is missing; render it first")
    image = np.array(mitsuba.Bitmap(str(path)), dtype=np.float64)
    if image.shape != (size, size, 3):
        raise Failure(f"{path} has shape {image.shape}, not {(size, size, 3)}")
    return image


def render(options):
    """Renders references and writes images and provenance."""
    output = Path(options.output)
    output.mkdir(parents=True, exist_ok=True)
    names = select(options.names)
    for name in names:
        reference = REFERENCES[name]
        count = options.batches or reference.batches
        spp = options.spp or reference.spp
        variant = options.variant or reference.variant
        mitsuba = load_mitsuba(variant)
        seeds = range(reference.first_seed, reference.first_seed + count)
        print(f"{name}: {reference.size} x {reference.size}, "
              f"{count} batches of {spp} samples per pixel, {variant}", flush=True)
        start = time.monotonic()
        moments = Moments()
        for image in batches(mitsuba, reference, seeds, spp):
            moments.add(image)
            show_progress(moments.count, count, start)
        variance = moments.variance_of_mean()
        write_exr(mitsuba, output / f"{name}.exr", moments.mean)
        write_exr(mitsuba, output / f"{name}_std_error.exr", np.sqrt(variance))
        mean = moments.mean.mean(axis=(0, 1))
        error = np.sqrt(variance.sum(axis=(0, 1))) / reference.size**2
        provenance = {
            "renderer": f"mitsuba {mitsuba.__version__}",
            "variant": variant,
            "scene": f"scenes/{reference.scene}",
            "overrides": {"size": reference.size, **reference.overrides},
            "width": reference.size,
            "height": reference.size,
            "sampler": "independent",
            "seeds": {"first": seeds[0], "last": seeds[-1]},
            "batches": count,
            "samples_per_pixel_per_batch": spp,
            "samples_per_pixel": count * spp,
            "mean_rgb": [round(float(x), 8) for x in mean],
            "std_error_of_mean_rgb": [float(f"{x:.3e}") for x in error],
            "command": f"python3 render.py render {name}"
                       + (f" --batches {options.batches}" if options.batches else "")
                       + (f" --spp {options.spp}" if options.spp else "")
                       + (f" --variant {options.variant}" if options.variant else ""),
            "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
        }
        (output / f"{name}.json").write_text(json.dumps(provenance, indent=2) + "\n")
        print(f"  mean {mean[0]:.6f} {mean[1]:.6f} {mean[2]:.6f}, "
              f"its standard error {error[0]:.1e} {error[1]:.1e} {error[2]:.1e}, "
              f"{time.monotonic() - start:.0f} s", flush=True)
    return 0


def beta_fraction(a, b, x):
    """The continued fraction of the incomplete beta function (Lentz's method)."""
    tiny = 1e-300
    c, d = 1.0, 1.0 - (a + b) * x / (a + 1.0)
    d = 1.0 / (d if abs(d) > tiny else tiny)
    result = d
    for m in range(1, 500):
        for term in (
                m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1.0 + term * d
            d = 1.0 / (d if abs(d) > tiny else tiny)
            c = 1.0 + term / c
            c = c if abs(c) > tiny else tiny
            result *= c * d
        if abs(c * d - 1.0) < 1e-14:
            break
    return result


def student_two_sided(t, dof):
    """P(|T| > t) for Student's t with `dof` degrees of freedom."""
    a, b, x = dof / 2.0, 0.5, dof / (dof + t * t)
    front = math.exp(
        math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b)
        + a * math.log(x) + b * math.log1p(-x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * beta_fraction(a, b, x) / a
    return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b


def student_quantile(probability, dof):
    """The t beyond which lies the given two-sided probability."""
    low, high = 1e-6, 1e6
    for _ in range(200):
        middle = math.sqrt(low * high)
        if student_two_sided(middle, dof) > probability:
            low = middle
        else:
            high = middle
    return high


def compare(mean, variance, reference_mean, reference_variance, ratio, dof, probability):
    """Welch's test for every entry of two arrays of means.

    `ratio` is the sample count of the reference over that of the short run. A
    short run may have missed the rare bright paths altogether, and its own
    variance with them; the variance that the reference predicts for it then
    stands in. Where it met too many of them, its own variance is the larger
    one. Both guards only widen the error, so the false alarm rate is a bound;
    so do the degrees of freedom, taken from the smaller number of batches.
    """
    difference = mean - reference_mean
    scale = np.abs(reference_mean)
    constant = np.sqrt(reference_variance) <= 1e-6 * scale
    error = np.sqrt(reference_variance + np.maximum(variance, ratio * reference_variance))
    z = np.where(constant, 0.0, difference / np.where(constant, 1.0, error))
    wrong = constant & (np.abs(difference) > CONSTANT_TOLERANCE * scale)
    tests = int(np.count_nonzero(~constant))
    # Sidak: each of n tests at this level, all together at `probability`.
    each = -math.expm1(math.log1p(-probability) / max(tests, 1))
    limit = student_quantile(each, dof)
    worst = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    return {
        "tests": tests,
        "constant": int(np.count_nonzero(constant)),
        "limit": limit,
        "worst": float(z[worst]),
        "where": tuple(int(i) for i in worst),
        "rms": float(np.sqrt(np.mean(z[~constant] ** 2))) if tests else 0.0,
        "beyond": int(np.count_nonzero(np.abs(z) > limit)),
        "wrong_constants": int(np.count_nonzero(wrong)),
    }


def provenance_of(images, name):
    path = images / f"{name}.json"
    if not path.is_file():
        raise Failure(f"the provenance {path} is missing; render the reference first")
    try:
        return json.loads(path.read_text())
    except json.JSONDecodeError as error:
        raise Failure(f"{path} is no JSON: {error}") from error


def check(options):
    """Renders briefly with other seeds and tests against the stored images."""
    images = Path(options.images)
    names = select(options.names)
    mitsuba = load_mitsuba(options.variant)
    passed = True
    # Sidak again: three families of tests (pixels, tiles, image).
    probability = -math.expm1(math.log1p(-FALSE_ALARM) / 3)
    for name in names:
        reference = REFERENCES[name]
        provenance = provenance_of(images, name)
        if provenance["width"] != reference.size or provenance["height"] != reference.size:
            raise Failure(f"the stored {name} has another size than this script's")
        if any(provenance["overrides"].get(key) != value
               for key, value in reference.overrides.items()):
            raise Failure(f"the stored {name} has other overrides than this script's")
        stored = read_exr(mitsuba, images / f"{name}.exr", reference.size)
        stored_variance = read_exr(
            mitsuba, images / f"{name}_std_error.exr", reference.size) ** 2
        count = options.batches or reference.check_batches
        spp = options.spp or reference.check_spp
        start = time.monotonic()
        seeds = range(options.seed, options.seed + count)
        pixel, tile, whole = Moments(), Moments(), Moments()
        for image in batches(mitsuba, reference, seeds, spp):
            pixel.add(image)
            tile.add(tiles(image))
            whole.add(image.mean(axis=(0, 1)))
            show_progress(pixel.count, count, start)
        ratio = provenance["samples_per_pixel"] / (count * spp)
        dof = min(count, provenance["batches"]) - 1
        levels = {
            "pixels": (pixel, stored, stored_variance),
            f"{TILE} x {TILE} tiles": (tile, tiles(stored), tile_variances(stored_variance)),
            "image": (whole, stored.mean(axis=(0, 1)),
                      stored_variance.sum(axis=(0, 1)) / reference.size**4),
        }
        print(f"{name}: {count} x {spp} samples per pixel ({options.variant}) against "
              f"{provenance['batches']} x {provenance['samples_per_pixel_per_batch']} "
              f"({provenance['renderer']}, {provenance['variant']})")
        fine = True
        for level, (moments, mean, variance) in levels.items():
            result = compare(moments.mean, moments.variance_of_mean(), mean, variance,
                             ratio, dof, probability)
            line = (f"  {level:<12} {result['tests']:>7} tests  rms z {result['rms']:5.2f}  "
                    f"worst z {result['worst']:+6.2f} at {result['where']}  "
                    f"limit {result['limit']:.2f}")
            if result["constant"]:
                line += f"  constants {result['constant']}"
            if result["beyond"]:
                line += f"  BEYOND THE LIMIT: {result['beyond']}"
            if result["wrong_constants"]:
                line += f"  WRONG CONSTANTS: {result['wrong_constants']}"
            fine = fine and not result["beyond"] and not result["wrong_constants"]
            print(line)
        relative = whole.mean / stored.mean(axis=(0, 1)) - 1
        print(f"  {'PASSED' if fine else 'FAILED'}: image mean off by "
              f"{relative[0]:+.3%} {relative[1]:+.3%} {relative[2]:+.3%}, "
              f"{time.monotonic() - start:.1f} s", flush=True)
        passed = passed and fine
    print("all passed" if passed else "at least one reference FAILED")
    return 0 if passed else 1


def at_least(minimum):
    """An argparse type: an integer of at least `minimum`."""
    def convert(text):
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is no integer") from None
        if value < minimum:
            raise argparse.ArgumentTypeError(f"{value} is less than {minimum}")
        return value
    return convert


def parser():
    known = "references: " + ", ".join(REFERENCES)
    main = argparse.ArgumentParser(
        description="Render Mitsuba 3 reference images, or check that they can be reproduced.",
        epilog=known)
    commands = main.add_subparsers(dest="command", required=True)

    command = commands.add_parser(
        "render", epilog=known, help="render references and write images and provenance",
        description="Render references as independent batches; write NAME.exr (the mean), "
                    "NAME_std_error.exr (its standard error, from the variance between "
                    "batches) and NAME.json (provenance). All of them take about half an "
                    "hour on two cores.")
    command.add_argument("names", nargs="*", metavar="NAME", help="reference (default: all)")
    command.add_argument("--batches", type=at_least(64), metavar="N",
                         help="independent batches, at least 64 (default: per reference)")
    command.add_argument("--spp", type=at_least(1), metavar="N",
                         help="samples per pixel and batch (default: per reference)")
    command.add_argument("--variant", help="Mitsuba variant (default: llvm_ad_rgb, which needs "
                                           "the LLVM library; scalar_rgb needs nothing)")
    command.add_argument("--output", default=str(IMAGES), metavar="DIR",
                         help="folder for the images (default: images beside this script)")
    command.set_defaults(run=render)

    command = commands.add_parser(
        "check", epilog=known, help="test the stored references against a fresh, short run",
        description="Render references briefly with other seeds and test pixels, tiles and "
                    "the whole image against the stored ones. The exit code is 0 if all "
                    "agree, 1 if not, 2 if something is missing; a false alarm has "
                    f"probability {FALSE_ALARM:g} at most per reference and seed.")
    command.add_argument("names", nargs="*", metavar="NAME", help="reference (default: all)")
    command.add_argument("--batches", type=at_least(8), metavar="N",
                         help="independent batches, at least 8 (default: per reference)")
    command.add_argument("--spp", type=at_least(1), metavar="N",
                         help="samples per pixel and batch (default: per reference)")
    command.add_argument("--variant", default="scalar_rgb",
                         help="Mitsuba variant (default: %(default)s, which needs no LLVM)")
    command.add_argument("--seed", type=at_least(0), default=50_000, metavar="N",
                         help="first seed (default: %(default)s, none of the references')")
    command.add_argument("--images", default=str(IMAGES), metavar="DIR",
                         help="folder of the images (default: images beside this script)")
    command.set_defaults(run=check)
    return main


def main():
    options = parser().parse_args()
    try:
        return options.run(options)
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
