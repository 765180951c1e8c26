"""Compares this crate with Mitsuba 3 on scenes made by chance.

    pip install -r requirements.txt
    cargo build --release --all-features --example render
    python3 by_chance.py FIRST [LAST] [--spp N] [--batches B] [--keep FOLDER] [--options=OPTIONS]

A number gives a scene: a camera, a film, an integrator, a floor, one to six bodies of any shape under any material, lamps, and what is
around, with most of what the reader of scene files knows: not `volpath`, `ptracer`, `moment`, attributes of meshes, or scenes in several
files. Both programs render it several times with other seeds; from the spread come the standard errors. `z`
is the largest difference over its error, of mean colours, of tiles of 8 x 8 pixels, and of the tile that nine tenths of the others are
below. Errors are known from a few batches, and bright paths are rare: a tile alone that is far off means little, an `off` of a few percent with a
`z` of ten much. What is known to differ (README.md) is not made. The exit code is 0 if all agree, 1 if a scene differs or is refused, 2 if
something is missing; Ctrl-C ends with what was found so far, and with 130.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from render import Failure, at_least, load_mitsuba, np

HERE = Path(__file__).resolve().parent
ASSETS = HERE / "scenes" / "assets"
PROGRAM = HERE.parent / "target/release/examples/render"

# Of mean colours, of the worst tile, of the tile that nine tenths are below.
LIMITS = (5.0, 12.0, 3.5)


class Chance:
    """Draws the elements of a scene."""

    def __init__(self, seed: int):
        self.random = random.Random(seed)
        self.groups = 0
        self.has_surroundings = False
        self.has_masks = False
        self.has_round_bodies = False
        self.areas = 0
        self.has_round_areas = False
        # Mitsuba 3.9.1 has bumps on mirrored bodies black.
        self.mirrors = self.has(0.5)
        self.in_bumps = False

    def number(self, low: float, high: float) -> float:
        return round(self.random.uniform(low, high), 3)

    def numbers(self, *ranges: tuple[float, float]) -> str:
        return ", ".join(str(self.number(*ends)) for ends in ranges)

    def one(self, *of: str) -> str:
        return self.random.choice(of)

    def has(self, probability: float) -> bool:
        return self.random.random() < probability

    def perhaps(self, probability: float, text) -> str:
        return text() if self.has(probability) else ""

    def float(self, name: str, low: float, high: float) -> str:
        return f'<float name="{name}" value="{self.number(low, high)}"/>'

    def flag(self, name: str, probability: float, value: str = "true") -> str:
        return self.perhaps(probability, lambda: f'<boolean name="{name}" value="{value}"/>')

    # Colours and textures.

    def color(self, name: str, low: float = 0.05, high: float = 0.9) -> str:
        ends = (low, high)
        if self.has(0.6):
            return f'<rgb name="{name}" value="{self.numbers(ends, ends, ends)}"/>'
        if self.has(0.4):
            return f'<spectrum name="{name}" value="{self.number(*ends)}"/>'
        nodes = ", ".join(f"{wave}:{self.number(*ends)}" for wave in (400, 500, 600, 700))
        return f'<spectrum name="{name}" value="{nodes}"/>'

    def to_uv(self) -> str:
        scale = lambda: f'<scale x="{self.number(0.5, 5)}" y="{self.number(0.5, 5)}"/>'
        turn = lambda: f'<rotate z="1" angle="{self.number(0, 360)}"/>'
        move = lambda: f'<translate x="{self.number(-1, 1)}" y="{self.number(-1, 1)}"/>'
        steps = self.perhaps(0.7, scale) + self.perhaps(0.3, turn) + self.perhaps(0.4, move)
        return f'<transform name="to_uv">{steps}</transform>'

    def bitmap(self, name: str, files: tuple[str, ...], raw: bool, moved: float) -> str:
        content = f'<string name="filename" value="{ASSETS}/{self.one(*files)}"/>'
        content += '<boolean name="raw" value="true"/>' if raw else ""
        content += self.perhaps(0.4, lambda: f'<string name="filter_type" value="{self.one("nearest", "bilinear")}"/>')
        content += self.perhaps(0.5, lambda: f'<string name="wrap_mode" value="{self.one("repeat", "mirror", "clamp")}"/>')
        return f'<texture type="bitmap" name="{name}">{content}{self.perhaps(moved, self.to_uv)}</texture>'

    def texture(self, name: str, raw: bool | None = None, moved: float = 0.7) -> str:
        if self.has(0.4) and moved > 0:
            colors = self.color("color0") + self.color("color1")
            return f'<texture type="checkerboard" name="{name}">{colors}{self.perhaps(moved, self.to_uv)}</texture>'
        files = ("picture.png", "heights.png", "normals.png")
        return self.bitmap(name, files, self.has(0.3) if raw is None else raw, moved)

    def reflectance(self, name: str) -> str:
        return self.texture(name) if self.has(0.35) else self.color(name)

    def weight(self, name: str) -> str:
        return self.texture(name, raw=True) if self.has(0.35) else self.float(name, 0.1, 0.9)

    # Materials.

    def roughness(self) -> str:
        content = self.perhaps(0.5, lambda: f'<string name="distribution" value="{self.one("beckmann", "ggx")}"/>')
        content += self.flag("sample_visible", 0.2, "false")
        # Mitsuba 3.9.1 turns the axes of what is under a bump map.
        kind = self.random.random() * (0.7 if self.in_bumps else 1.0)
        if kind < 0.55:
            return content + self.float("alpha", 0.08, 0.7)
        if kind < 0.7:
            return content + self.texture("alpha", raw=True)
        return content + self.float("alpha_u", 0.08, 0.7) + self.float("alpha_v", 0.08, 0.7)

    def indices(self) -> str:
        inside = self.float("int_ior", 1.05, 2.4)
        if self.has(0.3):
            inside = f'<string name="int_ior" value="{self.one("water", "diamond", "bk7", "acrylic glass")}"/>'
        return self.perhaps(0.7, lambda: inside) + self.perhaps(0.15, lambda: self.float("ext_ior", 1.0, 1.6))

    def metal(self) -> str:
        content = ""
        if self.has(0.5):
            content = f'<string name="material" value="{self.one("Au", "Cu", "Al", "Ag", "none", "W", "Cr")}"/>'
        elif self.has(0.6):
            content = self.color("eta", 0.1, 2) + self.color("k", 0.5, 4)
        return content + self.perhaps(0.3, lambda: self.reflectance("specular_reflectance"))

    def glass(self) -> str:
        tints = (self.perhaps(0.3, lambda name=name: self.reflectance(name))
                 for name in ("specular_reflectance", "specular_transmittance"))
        return self.indices() + "".join(tints)

    def plastic(self) -> str:
        content = self.indices() + self.perhaps(0.7, lambda: self.reflectance("diffuse_reflectance"))
        return content + self.perhaps(0.3, lambda: self.color("specular_reflectance")) + self.flag("nonlinear", 0.4)

    def bsdf(self, depth: int = 0, sides: bool = True, smooth: bool = True, clear: bool = True) -> str:
        """With `sides` it may be told apart by sides, with `smooth` have single directions, with `clear` let light through."""
        inner = lambda **rules: self.bsdf(depth + 1, **{"sides": sides, "smooth": smooth, "clear": clear} | rules)
        laws = {
            "diffuse": lambda: self.perhaps(0.9, lambda: self.reflectance("reflectance")),
            "roughplastic": lambda: self.plastic() + self.float("alpha", 0.08, 0.6),
            "roughconductor": lambda: self.metal() + self.roughness(),
        }
        if smooth:
            laws |= {"plastic": self.plastic, "conductor": self.metal}
        if clear:
            laws |= {"roughdielectric": lambda: self.glass() + self.roughness()}
        if clear and smooth:
            laws |= {"dielectric": self.glass, "thindielectric": self.glass, "null": lambda: ""}
        if sides:
            laws["twosided"] = lambda: (inner(sides=False, clear=False)
                                        + self.perhaps(0.3, lambda: inner(sides=False, clear=False)))
        if depth < 2:
            # Mitsuba 3.9.1 has mixtures wrong with single directions, and where one of both laws may draw nothing.
            opaque = lambda: self.bsdf(2, sides=False, smooth=False, clear=False)
            laws["blendbsdf"] = lambda: self.weight("weight") + opaque() + opaque()
            if clear and self.has_surroundings:
                laws["mask"] = lambda: self.mask(inner)
            if not self.in_bumps:
                laws["normalmap"] = lambda: self.bitmap("normalmap", ("normals.png",), True, 0.5) + inner(sides=False, smooth=False)
                if not self.mirrors:
                    laws["bumpmap"] = lambda: self.bumps(lambda: inner(sides=False, smooth=False))
        kind = self.one(*laws)
        return f'<bsdf type="{kind}">{laws[kind]()}</bsdf>'

    def mask(self, inner) -> str:
        self.has_masks = True
        return self.weight("opacity") + inner()

    def bumps(self, inner) -> str:
        self.in_bumps = True
        # Mitsuba 3.9.1 has slopes of pictures that are not square wrong where they are turned.
        file, moved = self.random.choice([("heights.png", 0.5), ("picture.png", 0)])
        content = self.bitmap("height", (file,), True, moved) + self.float("scale", 0.05, 0.6) + inner()
        self.in_bumps = False
        return content

    # Shapes.

    def place(self, rigid: bool) -> str:
        steps = ""
        if self.has(0.5):
            steps = f'<scale value="{self.number(0.3, 1)}"/>'
        elif not rigid:
            sign = lambda: -1 if self.mirrors and self.has(0.25) else 1
            steps = "<scale " + " ".join(f'{axis}="{sign() * self.number(0.3, 1)}"' for axis in "xyz") + "/>"
        for _ in range(self.random.randrange(3)):
            steps += f'<rotate {self.one("x", "y", "z")}="1" angle="{self.number(0, 360)}"/>'
        x, y, z = self.number(-2, 2), self.number(0.2, 2.4), self.number(-1.5, 1.5)
        return f'<transform name="to_world">{steps}<translate x="{x}" y="{y}" z="{z}"/></transform>'

    def point(self, name: str, low: float = 0.2, high: float = 2.0) -> str:
        return f'<point name="{name}" value="{self.numbers((-2, 2), (low, high), (-1.5, 1.5))}"/>'

    def shape(self, content: str) -> str:
        kind = self.one("rectangle", "cube", "sphere", "disk", "cylinder", "ply", "obj")
        rigid = kind in ("sphere", "disk", "cylinder")
        self.has_round_bodies |= rigid
        place = self.place(rigid)
        if kind == "sphere" and self.has(0.5):
            place = self.point("center") + self.float("radius", 0.3, 0.8)
        elif kind == "cylinder" and self.has(0.5):
            place = self.point("p0") + self.point("p1") + self.float("radius", 0.1, 0.5)
        elif kind in ("ply", "obj"):
            file = {"ply": "ball.ply", "obj": "sheet.obj"}[kind]
            place += f'<string name="filename" value="{ASSETS}/{file}"/>' + self.flag("face_normals", 0.3)
        return f'<shape type="{kind}">{place}{self.flag("flip_normals", 0.15)}{content}</shape>'

    def body(self) -> str:
        if self.has(0.9):
            return self.shape(self.perhaps(0.95, self.bsdf))
        self.groups += 1
        group = f"group{self.groups}"
        content = "".join(self.shape(self.bsdf()) for _ in range(self.random.randint(1, 2)))
        copies = "".join(f'<shape type="instance"><ref id="{group}"/>{self.place(rigid=True)}</shape>'
                         for _ in range(self.random.randint(1, 3)))
        return f'<shape type="shapegroup" id="{group}">{content}</shape>{copies}'

    # Lamps.

    def lamp(self) -> str:
        kind = self.one("area", "area", "area", "point", "spot", "directional", "projector")
        weight = self.perhaps(0.1, lambda: self.float("sampling_weight", 0.3, 3))
        aim = f'<lookat origin="{self.numbers((-2, 2), (2.5, 4), (0, 3))}" target="0, 0.5, 0" up="0, 0, 1"/>'
        aim = f'<transform name="to_world">{aim}</transform>'
        if kind == "area":
            self.areas += 1
            return self.area(weight)
        if kind == "point":
            content = self.point("position", 2, 4) + self.color("intensity", 2, 20)
        elif kind == "spot":
            content = aim + self.color("intensity", 5, 40) + self.float("cutoff_angle", 15, 50)
            content += self.perhaps(0.5, lambda: self.float("beam_width", 5, 14)) + self.perhaps(0.3, lambda: self.texture("texture"))
        elif kind == "projector":
            content = aim + self.texture("irradiance") + self.float("scale", 5, 30) + self.float("fov", 20, 60)
        else:
            direction = self.numbers((-1, 1), (-1, -1), (-1, 1))
            content = f'<vector name="direction" value="{direction}"/>' + self.color("irradiance", 0.3, 3)
        return f'<emitter type="{kind}">{content}{weight}</emitter>'

    def area(self, weight: str) -> str:
        # Mitsuba 3.9.1 has the density of textured spheres and cylinders wrong, and that of all that have a `to_uv`; interpolated normals are taken for true ones.
        textured = self.has(0.2)
        radiance = self.texture("radiance", moved=0) if textured else self.color("radiance", 1, 8)
        kinds = ("rectangle", "disk") if textured else ("rectangle", "sphere", "disk", "cylinder", "cube", "ply", "obj")
        kind = self.one(*kinds)
        self.has_round_areas |= kind in ("sphere", "disk", "cylinder")
        file = {"ply": "ball.ply", "obj": "sheet.obj"}.get(kind)
        mesh = f'<string name="filename" value="{ASSETS}/{file}"/><boolean name="face_normals" value="true"/>' if file else ""
        x, y, z = self.number(-2, 2), self.number(2.6, 4), self.number(-1, 2)
        place = f'<scale value="{self.number(0.3, 1)}"/><rotate x="1" angle="{self.number(60, 120)}"/><translate x="{x}" y="{y}" z="{z}"/>'
        emitter = f'<emitter type="area">{radiance}{weight}</emitter>'
        return f'<shape type="{kind}">{mesh}<transform name="to_world">{place}</transform>{emitter}</shape>'

    def surroundings(self) -> str:
        self.has_surroundings = True
        if self.has(0.5):
            return f'<emitter type="constant">{self.color("radiance", 0.1, 1)}</emitter>'
        turns = "".join(f'<rotate {axis}="1" angle="{self.number(0, 360)}"/>' for axis in (self.one("x", "y", "z"), "y"))
        content = f'<string name="filename" value="{ASSETS}/sky.exr"/>{self.float("scale", 0.3, 1)}'
        return f'<emitter type="envmap">{content}<transform name="to_world">{turns}</transform></emitter>'

    # The camera.

    def sensor(self) -> str:
        kind = self.one("perspective", "perspective", "perspective", "thinlens", "orthographic")
        look = f'<lookat origin="{self.numbers((-3, 3), (0.8, 4), (4, 7))}" target="0, 0.8, 0" up="{self.number(-0.2, 0.2)}, 1, 0"/>'
        content = ""
        if kind == "orthographic":
            look = f'<scale x="{self.number(2, 3)}" y="{self.number(2, 3)}"/>{look}'
        elif self.has(0.2):
            content = f'<string name="focal_length" value="{self.number(28, 70)}mm"/>'
        else:
            axes = ("x", "y", "diagonal", "smaller", "larger")
            content = self.float("fov", 25, 60) + self.perhaps(0.5, lambda: f'<string name="fov_axis" value="{self.one(*axes)}"/>')
        if kind == "perspective":
            content += self.perhaps(0.2, lambda: self.float("principal_point_offset_x", -0.2, 0.2))
        if kind == "thinlens":
            content += self.float("aperture_radius", 0.05, 0.3) + self.float("focus_distance", 3, 8)
        content += self.perhaps(0.15, lambda: self.float("near_clip", 0.5, 5)) + self.perhaps(0.15, lambda: self.float("far_clip", 5.5, 9))
        width, height = self.random.choice([(40, 32), (32, 40), (32, 32)])
        film = {"width": width, "height": height}
        if self.has(0.2):
            film |= {"crop_width": 24, "crop_height": 24, "crop_offset_x": 5, "crop_offset_y": 3}
        film = "".join(f'<integer name="{name}" value="{value}"/>' for name, value in film.items())
        film += '<string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>'
        film += f'<rfilter type="{self.one("box", "box", "box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos")}"/>'
        return (f'<sensor type="{kind}"><transform name="to_world">{look}</transform>{content}'
                f'<sampler type="independent"/><film type="hdrfilm">{film}</film></sensor>')

    def integrator(self) -> str:
        # With lights hidden, Mitsuba 3.9.1 loses what is gathered at a mask that the path goes on through, and misplaces what is round behind lamps.
        round_behind = self.areas > 0 and self.has_round_bodies or self.areas > 1 and self.has_round_areas
        hidden = "" if self.has_masks or round_behind else self.flag("hide_emitters", 0.3)
        if self.has(0.1):
            return f'<integrator type="direct">{hidden}</integrator>'
        depths = self.perhaps(0.9, lambda: f'<integer name="max_depth" value="{self.one("-1", "1", "2", "3", "4", "5", "8", "12")}"/>')
        depths += self.perhaps(0.5, lambda: f'<integer name="rr_depth" value="{self.one("1", "2", "3", "5", "8")}"/>')
        return f'<integrator type="path">{depths}{hidden}</integrator>'

    def scene(self) -> str:
        content = self.perhaps(0.4, self.surroundings)
        content += self.sensor()
        if self.has(0.85):
            place = f'<scale value="{self.number(3, 6)}"/><rotate x="1" angle="-90"/>'
            content += f'<shape type="rectangle"><transform name="to_world">{place}</transform>{self.bsdf(clear=False)}</shape>'
        content += "".join(self.body() for _ in range(self.random.randint(1, 6)))
        lamps = self.random.choice([0, 1, 1, 2]) if self.has_surroundings else self.random.choice([1, 1, 2, 3])
        content += "".join(self.lamp() for _ in range(lamps)) + self.integrator()
        return f'<scene version="3.0.0">{content}</scene>'.replace("><", ">\n<")


def theirs(mi, file: Path, spp: int, batches: int) -> np.ndarray:
    scene = mi.load_file(str(file))
    try:
        pictures = [np.array(mi.render(scene, spp=spp, seed=1000 + batch), dtype=np.float64) for batch in range(batches)]
    except RuntimeError as error:
        # Mitsuba makes an error of its own of what happens while it renders.
        if isinstance(error.__cause__ or error.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from error
        raise
    return np.stack(pictures)


def ours(mi, program: Path, options: list[str], file: Path, spp: int, batches: int) -> np.ndarray:
    def picture(batch: int) -> np.ndarray:
        out = file.with_suffix(".exr")
        command = [program, file, "--spp", str(spp), "--seed", str(batch + 1), "--out", out, *options]
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.strip())
        bitmap = mi.Bitmap(str(out)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
        out.unlink()
        return np.array(bitmap, dtype=np.float64)

    return np.stack([picture(batch) for batch in range(batches)])


def z(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Differences of means over batches, the first axis, over their standard errors, or 3e-4 of the picture if that is more."""
    variance = sum(runs.var(axis=0, ddof=1) / len(runs) for runs in (one, other))
    floor = np.square(3e-4 * other.mean()) + 1e-16
    return np.abs(one.mean(axis=0) - other.mean(axis=0)) / np.sqrt(np.maximum(variance, floor))


def tiles(pictures: np.ndarray) -> np.ndarray:
    batches, height, width, channels = pictures.shape
    return pictures.reshape(batches, height // 8, 8, width // 8, 8, channels).mean(axis=(2, 4))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=at_least(0), help="the number of the first scene")
    parser.add_argument("last", type=at_least(1), nargs="?", help="the number after the last scene (default: the next)")
    parser.add_argument("--spp", type=at_least(1), default=128, help="samples per pixel and batch (default: %(default)s)")
    parser.add_argument("--batches", type=at_least(2), default=8, help="pictures by each program (default: %(default)s)")
    parser.add_argument("--program", type=Path, default=PROGRAM, help="the program render (default: that of this folder)")
    parser.add_argument("--keep", type=Path, help="a folder for the scenes that differ")
    parser.add_argument("--options", type=str.split, default=[], help="of the program render, as --options='--reuse 4'")
    arguments = parser.parse_args()
    last = arguments.first + 1 if arguments.last is None else arguments.last
    if last <= arguments.first:
        parser.error(f"no scene is before {last} from {arguments.first} on")
    try:
        return compare(arguments, range(arguments.first, last))
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2


def compare(arguments: argparse.Namespace, numbers: range) -> int:
    mi = load_mitsuba("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    if not arguments.program.is_file():
        raise Failure(f"there is no program {arguments.program}; build it by: cargo build --release --all-features --example render")
    verdicts = []
    try:
        for number in numbers:
            verdicts.append(judge(mi, arguments, number))
    except KeyboardInterrupt:
        print(file=sys.stderr)
    count = Counter(verdicts)
    print(f"{count['agrees']} agree, {count['differs']} differ, {count['refused']} refused")
    if len(verdicts) < len(numbers):
        return 130
    return 0 if count["agrees"] == len(verdicts) else 1


def judge(mi, arguments: argparse.Namespace, number: int) -> str:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"scene_{number}.xml"
        text = Chance(number).scene()
        file.write_text(text)
        try:
            reference = theirs(mi, file, arguments.spp, arguments.batches)
            pictures = ours(mi, arguments.program, arguments.options, file, arguments.spp, arguments.batches)
        except RuntimeError as error:
            verdict, figures = "refused", str(error)
        else:
            off = pictures.mean(axis=(0, 1, 2)) / np.maximum(reference.mean(axis=(0, 1, 2)), 1e-12) - 1
            worst = z(tiles(pictures), tiles(reference)).ravel()
            found = (z(pictures.mean(axis=(1, 2)), reference.mean(axis=(1, 2))).max(), worst.max(), np.quantile(worst, 0.9))
            verdict = "agrees" if all(value <= limit for value, limit in zip(found, LIMITS)) else "differs"
            figures = f"z {', '.join(f'{value:.1f}' for value in found)}, off by {off}"
        print(f"{number} {verdict}: {figures}", flush=True)
        if verdict != "agrees" and arguments.keep:
            arguments.keep.mkdir(parents=True, exist_ok=True)
            (arguments.keep / file.name).write_text(text)
    return verdict


if __name__ == "__main__":
    sys.exit(main())
