"""Writes the images and meshes of the reference scenes: small, and made here.

    python3 assets.py        # into scenes/assets
"""

import math
from pathlib import Path

import mitsuba
import numpy as np

mitsuba.set_variant("scalar_rgb")
FOLDER = Path(__file__).resolve().parent / "scenes" / "assets"


def write(name, pixels, srgb=True):
    bitmap = mitsuba.Bitmap(np.ascontiguousarray(pixels))
    bitmap.set_srgb_gamma(srgb)
    bitmap.write(str(FOLDER / name))


def grid(width, height):
    y, x = np.mgrid[0:height, 0:width]
    return (x + 0.5) / width, (y + 0.5) / height


def bytes_of(values):
    return np.clip(np.round(values * 255), 0, 255).astype(np.uint8)


def images():
    # A picture in colours, without any symmetry.
    u, v = grid(12, 8)
    color = np.stack([0.2 + 0.7 * u, 0.9 - 0.8 * v, 0.3 + 0.5 * np.sin(9 * u * v) ** 2], axis=-1)
    color[1:3, 2:4] = [0.95, 0.9, 0.1]
    write("picture.png", bytes_of(color))
    # Heights in grey: ridges.
    u, v = grid(32, 32)
    heights = 0.5 + 0.25 * np.sin(2 * np.pi * 2 * u) + 0.25 * np.sin(2 * np.pi * 3 * v)
    write("heights.png", bytes_of(heights)[..., None], srgb=False)
    # Normals: the same ridges, tilted.
    slope_u = 0.5 * np.cos(2 * np.pi * 2 * u)
    slope_v = 0.4 * np.cos(2 * np.pi * 3 * v)
    normal = np.stack([-slope_u, -slope_v, np.ones_like(u)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    write("normals.png", bytes_of(0.5 + 0.5 * normal), srgb=False)
    # A sky: blue above, brown below, a warm sun of a few pixels.
    u, v = grid(32, 16)
    sky = np.where(v[..., None] < 0.5, [0.3, 0.5, 0.9], [0.25, 0.2, 0.15]) * (1.2 - v[..., None])
    sky[4:6, 6:8] = [60.0, 50.0, 30.0]
    write("sky.exr", sky.astype(np.float32))


def sphere(subdivisions):
    """A sphere of triangles: an octahedron, divided."""
    corners = [np.array(c, float) for c in
               [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)]]
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    known = {}

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in known:
            point = corners[a] + corners[b]
            known[key] = len(corners)
            corners.append(point / np.linalg.norm(point))
        return known[key]

    for _ in range(subdivisions):
        divided = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = divided
    return np.array(corners, np.float32), np.array(faces, np.int32)


def meshes():
    corners, faces = sphere(2)
    header = "ply\nformat binary_big_endian 1.0\n" \
        f"element vertex {len(corners)}\n" + \
        "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) + \
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    # The normals are those of an ellipsoid, so that they are not the geometry's.
    normals = corners * np.array([1.0, 0.6, 1.0], np.float32)
    vertices = np.hstack([corners, normals]).astype(">f4").tobytes()
    records = b"".join(b"\x03" + face.astype(">i4").tobytes() for face in faces)
    (FOLDER / "ball.ply").write_bytes(header.encode() + vertices + records)
    # A wavy sheet with texture coordinates and no normals, of quadrilaterals.
    count = 8
    lines = ["# a wavy sheet"]
    for j in range(count + 1):
        for i in range(count + 1):
            u, v = i / count, j / count
            height = 0.15 * math.sin(2 * math.pi * u) * math.cos(math.pi * v)
            lines.append(f"v {2 * u - 1:.5f} {2 * v - 1:.5f} {height:.5f}")
            lines.append(f"vt {u:.5f} {v:.5f}")
    for j in range(count):
        for i in range(count):
            a = j * (count + 1) + i + 1
            corners = [a, a + 1, a + count + 2, a + count + 1]
            lines.append("f " + " ".join(f"{c}/{c}" for c in corners))
    (FOLDER / "sheet.obj").write_text("\n".join(lines) + "\n")


FOLDER.mkdir(parents=True, exist_ok=True)
images()
meshes()
