"""Writes the scenes that `compare_mitsuba.py` compares on: too large to be kept, so they are made here.

    python3 speed.py FOLDER        # target/speed, say; below a second

- `cornell_box.xml`: that of Mitsuba's function `cornell_box()`: 18 rectangles, one light, diffuse on the outer sides.
- `knot.xml`: a tube of 70 000 triangles, knotted, in the same room; with `-D face_normals=true` its faces are flat.
- `sky.xml`: a ground, a cube and three spheres, diffuse, rough metal and glass, under a picture of a sky with a sun.
- `million.xml`: the tube of 10^6 triangles, for the time to load.
- `hall_5.xml`, `hall_20.xml`, `hall_100.xml` and `cube_5.xml` and so on: as many lamps below the ceiling of a hall eight times as long as
  wide and high, or of a cube, over eight boxes.

Parameters (`-D`): `size`, `spp`, `filter`, `max_depth`.
"""

import sys
from pathlib import Path

import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")

HEAD = """<scene version="3.0.0">
    <default name="size" value="256"/>
    <default name="spp" value="64"/>
    <default name="max_depth" value="8"/>
    <default name="filter" value="box"/>
    <default name="face_normals" value="false"/>
    <integrator type="path">
        <integer name="max_depth" value="$max_depth"/>
        <integer name="rr_depth" value="5"/>
    </integrator>
    <sensor type="perspective">
        <string name="fov_axis" value="smaller"/>
        <float name="fov" value="39.3077"/>
        <transform name="to_world"><lookat {view} up="0, 1, 0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="$size"/>
            <integer name="height" value="$size"/>
            <string name="pixel_format" value="rgb"/>
            <string name="component_format" value="float32"/>
            <rfilter type="$filter"/>
        </film>
    </sensor>
"""

INSIDE = HEAD.format(view='origin="0, 0, 3.9" target="0, 0, 0"')
OUTSIDE = HEAD.format(view='origin="0.5, 2.4, 6" target="0, 0.5, 0"')

ROOM = """    <bsdf type="diffuse" id="white"><rgb name="reflectance" value="0.885809, 0.698859, 0.666422"/></bsdf>
    <bsdf type="diffuse" id="green"><rgb name="reflectance" value="0.105421, 0.37798, 0.076425"/></bsdf>
    <bsdf type="diffuse" id="red"><rgb name="reflectance" value="0.570068, 0.0430135, 0.0443706"/></bsdf>
    <shape type="rectangle">
        <transform name="to_world">
            <scale x="0.23" y="0.19" z="0.19"/><rotate x="1" angle="90"/><translate y="0.99" z="0.01"/>
        </transform>
        <emitter type="area"><rgb name="radiance" value="18.387, 13.9873, 6.75357"/></emitter>
        <ref id="white"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform>
        <ref id="white"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><translate y="1"/></transform>
        <ref id="white"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><translate z="-1"/></transform>
        <ref id="white"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate y="1" angle="-90"/><translate x="1"/></transform>
        <ref id="green"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate y="1" angle="90"/><translate x="-1"/></transform>
        <ref id="red"/>
    </shape>
"""

BOXES = """    <shape type="cube">
        <transform name="to_world">
            <scale value="0.3"/><rotate y="1" angle="-17"/><translate x="0.335" y="-0.7" z="0.38"/>
        </transform>
        <ref id="white"/>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale x="0.3" y="0.61" z="0.3"/><rotate y="1" angle="18.25"/><translate x="-0.33" y="-0.4" z="-0.28"/>
        </transform>
        <ref id="white"/>
    </shape>
"""

KNOT = """    <shape type="ply">
        <string name="filename" value="{file}"/>
        <boolean name="face_normals" value="$face_normals"/>
        <transform name="to_world"><scale value="0.25"/><rotate x="1" angle="-60"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.65, 0.5"/></bsdf>
    </shape>
"""

SKY = """    <emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.55, 0.5"/></bsdf>
    </shape>
    <shape type="cube">
        <transform name="to_world">
            <scale value="0.5"/><rotate y="1" angle="30"/><translate x="-1.4" y="0.5" z="-1"/>
        </transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.15, 0.3, 0.7"/></bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" value="-1.3, 0.6, 0.5"/><float name="radius" value="0.6"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.45, 0.1"/></bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" value="0, 0.6, 0"/><float name="radius" value="0.6"/>
        <bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.2"/></bsdf>
    </shape>
    <shape type="sphere">
        <point name="center" value="1.3, 0.6, 0.3"/><float name="radius" value="0.6"/>
        <bsdf type="dielectric"/>
    </shape>
"""


def knot(file: Path, along: int, around: int) -> None:
    """A (2, 3) torus knot with a tube of `2 * along * around` triangles, as binary PLY."""
    t = np.arange(along)[:, None] * (2 * np.pi / along)
    centre = np.stack([(2 + np.cos(3 * t)) * np.cos(2 * t), (2 + np.cos(3 * t)) * np.sin(2 * t), np.sin(3 * t)], -1)
    tangent = np.roll(centre, -1, 0) - np.roll(centre, 1, 0)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    first = np.cross(tangent, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second = np.cross(tangent, first)
    angle = np.arange(around)[None, :, None] * (2 * np.pi / around)
    radius = 0.45 * (1 + 0.1 * np.cos(9 * angle + 40 * t[..., None]))
    points = centre + radius * (np.cos(angle) * first + np.sin(angle) * second)
    row, column = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a, b = row * around + column, row * around + (column + 1) % around
    c, d = ((row + 1) % along) * around + (column + 1) % around, ((row + 1) % along) * around + column
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=-1).reshape(-1, 3)
    records = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    records["count"], records["corners"] = 3, faces
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {along * around}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    file.write_bytes(header.encode() + points.astype("<f4").tobytes() + records.tobytes())


def sky(file: Path) -> None:
    """A blue dome above a brown ground, with a sun four degrees wide."""
    height, width = 256, 512
    y, x = (np.mgrid[0:height, 0:width] + 0.5) / [[[height]], [[width]]]
    up = np.cos(np.pi * y)[..., None]
    pixels = np.where(up > 0, np.array([0.25, 0.45, 0.9]) * (1.2 - 0.7 * up), [0.2, 0.16, 0.12])
    distance = np.hypot((x - 0.3) * 2 * np.sin(np.pi * 0.25), y - 0.25) * 180
    pixels[distance < 2] = [90.0, 80.0, 60.0]
    mitsuba.Bitmap(pixels.astype(np.float32)).write(str(file))


def lamps(size: tuple[float, float, float], count: int) -> str:
    """A room of that size from its middle, with lamps of unequal radiance at random places, seen from one end."""
    x, y, z = size
    view = f'origin="{-0.98 * x}, 0, 0" target="{x}, {-0.2 * y}, {0.05 * z}"'
    cube = '    <shape type="cube"><transform name="to_world">{}</transform>{}<ref id="white"/></shape>\n'
    lamp = """    <shape type="rectangle">
        <transform name="to_world"><scale value="0.1"/><rotate x="1" angle="90"/><translate {place}/></transform>
        <emitter type="area"><rgb name="radiance" value="{radiance:.4f}"/></emitter>
    </shape>
"""
    text = HEAD.format(view=view).replace("39.3077", "70")
    text += '    <bsdf type="diffuse" id="white"><rgb name="reflectance" value="0.6"/></bsdf>\n'
    walls = f'<scale x="{x}" y="{y}" z="{z}"/>'
    text += cube.format(walls, '<boolean name="flip_normals" value="true"/>')
    for box in range(8):
        place = f'x="{(-0.9 + 0.225 * box) * x}" y="{-0.9 * y}" z="{(0.5 - box % 2) * z}"'
        text += cube.format(f'<scale value="{0.05 * y}"/><translate {place}/>', "")
    random = np.random.default_rng(count)
    for along, across, radiance in random.random((count, 3)):
        place = f'x="{(2 * along - 1) * 0.95 * x:.4f}" y="{0.98 * y}" z="{(2 * across - 1) * 0.9 * z:.4f}"'
        text += lamp.format(place=place, radiance=5 + 20 * radiance)
    return text


def main() -> None:
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    scenes = {
        "cornell_box": INSIDE + ROOM + BOXES,
        "knot": INSIDE + ROOM + KNOT.format(file="knot.ply"),
        "sky": OUTSIDE + SKY,
        "million": INSIDE + ROOM + KNOT.format(file="million.ply"),
    }
    for count in (5, 20, 100):
        scenes[f"hall_{count}"] = lamps((8, 1, 1), count)
        scenes[f"cube_{count}"] = lamps((2, 2, 2), count)
    for name, text in scenes.items():
        (folder / f"{name}.xml").write_text(text + "</scene>\n")
    knot(folder / "knot.ply", 700, 50)
    knot(folder / "million.ply", 5000, 100)
    sky(folder / "sky.exr")


if __name__ == "__main__":
    main()
