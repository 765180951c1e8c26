#!/usr/bin/env python3
"""What Mitsuba 3 says of its laws of scattering and textures, as numbers.

    python3 bsdf.py write     evaluate them again and write bsdf.json
    python3 bsdf.py check     compare bsdf.json with a fresh evaluation

Every law is evaluated, by the variant scalar_rgb, for pairs of directions in
the frame of the surface: the value times the cosine, and the density with
which the law draws the second direction. Of laws that scatter to single
directions the drawn direction and its weight are noted instead, for both ends
of the coordinate that chooses between them. Textures are evaluated at texture
coordinates. Copper's index of refraction is that of Mitsuba's table.
"""

import argparse
import json
import math
import sys
from pathlib import Path

FILE = Path(__file__).resolve().parent / "bsdf.json"

# Between runs on machines that round differently.
TOLERANCE = 1e-4

RGB = lambda *value: {"type": "rgb", "value": list(value)}
COPPER = {
    "eta": {"type": "rgb", "value": [0.200438, 0.924033, 1.102212]},
    "k": {"type": "rgb", "value": [3.912949, 2.452848, 2.142188]},
}
GLASS = {"int_ior": 1.5, "ext_ior": 1.0}
TINT = {
    "specular_reflectance": RGB(0.9, 0.6, 0.3),
    "specular_transmittance": RGB(0.2, 0.5, 0.8),
}


def boards(first, second, scale):
    """A checkerboard of two colours."""
    import mitsuba as mi

    return {
        "type": "checkerboard",
        "color0": RGB(*first),
        "color1": RGB(*second),
        "to_uv": mi.ScalarTransform3f().scale([scale, scale]),
    }


def bitmap(channels, **settings):
    """A small image of fixed numbers."""
    import mitsuba as mi
    import numpy as np

    width, height = 4, 3
    count = width * height * channels
    values = (np.arange(count) * 7 % 11 / 11.0).astype(np.float32)
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(values.reshape(height, width, channels)),
        "raw": True,
        **settings,
    }


def laws():
    """The laws by name."""
    rough = lambda kind, distribution, **rest: {
        "type": kind, "distribution": distribution, **rest}
    plastic = {"int_ior": 1.49, "ext_ior": 1.0, "diffuse_reflectance": RGB(0.1, 0.4, 0.8)}
    nested = {"nested": {"type": "diffuse", "reflectance": RGB(0.2, 0.5, 0.8)}}
    result = {
        "diffuse": nested["nested"],
        "diffuse_checkerboard": {
            "type": "diffuse", "reflectance": boards((0.1, 0.2, 0.3), (0.7, 0.8, 0.9), 2.0)},
        "twosided": {"type": "twosided", **nested},
        "twosided_different": {
            "type": "twosided", "a": nested["nested"],
            "b": {"type": "diffuse", "reflectance": RGB(0.9, 0.1, 0.3)}},
        "conductor": {"type": "conductor", **COPPER},
        "dielectric": {"type": "dielectric", **GLASS, **TINT},
        "thindielectric": {"type": "thindielectric", **GLASS, **TINT},
        "null": {"type": "null"},
        "plastic": {"type": "plastic", **plastic},
        "plastic_nonlinear": {
            "type": "plastic", "nonlinear": True,
            "specular_reflectance": RGB(0.9, 0.6, 0.3), **plastic},
        "mask": {"type": "mask", "opacity": 0.3, **nested},
        "mask_checkerboard": {
            "type": "mask", "opacity": boards((0.2,) * 3, (0.9,) * 3, 2.0), **nested},
        "blendbsdf": {
            "type": "blendbsdf", "weight": 0.3, "a": nested["nested"],
            "b": rough("roughconductor", "ggx", alpha=0.3, **COPPER)},
        "normalmap": {
            "type": "normalmap", "normalmap": {
                "type": "bitmap", "raw": True, "filter_type": "nearest",
                "bitmap": normal_bitmap()},
            "nested": rough("roughconductor", "ggx", alpha_u=0.2, alpha_v=0.5, **COPPER)},
        "bumpmap": {
            "type": "bumpmap", "map": bitmap(1), "scale": 0.3,
            "nested": rough("roughconductor", "ggx", alpha=0.3, **COPPER)},
    }
    for distribution in "beckmann", "ggx":
        for alpha in 0.05, 0.3, 1.0:
            name = f"{distribution}_{alpha}"
            result["roughconductor_" + name] = rough(
                "roughconductor", distribution, alpha=alpha, **COPPER)
            result["roughdielectric_" + name] = rough(
                "roughdielectric", distribution, alpha=alpha, **GLASS, **TINT)
            result["roughplastic_" + name] = rough(
                "roughplastic", distribution, alpha=alpha, **plastic)
        result["roughconductor_anisotropic_" + distribution] = rough(
            "roughconductor", distribution, alpha_u=0.1, alpha_v=0.4, **COPPER)
        result["roughdielectric_anisotropic_" + distribution] = rough(
            "roughdielectric", distribution, alpha_u=0.5, alpha_v=0.2, **GLASS)
    result["roughplastic_nonlinear"] = rough(
        "roughplastic", "ggx", alpha=0.2, nonlinear=True, **plastic)
    return result


def normal_bitmap():
    """One normal everywhere, leaning over."""
    import mitsuba as mi
    import numpy as np

    normal = np.array([0.3, -0.4, math.sqrt(0.75)])
    return mi.Bitmap(np.tile((0.5 * (normal + 1.0)).astype(np.float32), (2, 2, 1)))


def textures():
    """The textures by name."""
    import mitsuba as mi

    turned = mi.ScalarTransform3f().translate([0.2, 0.3]).rotate(30).scale([1.5, 1.5])
    result = {"checkerboard": boards((0.1, 0.2, 0.3), (0.7, 0.8, 0.9), 1.7)}
    for channels in 1, 3:
        for filter_type in "bilinear", "nearest":
            for wrap in "repeat", "mirror", "clamp":
                result[f"bitmap_{channels}_{filter_type}_{wrap}"] = bitmap(
                    channels, filter_type=filter_type, wrap_mode=wrap)
        result[f"bitmap_{channels}_turned"] = bitmap(channels, to_uv=turned)
    return result


def direction(cosine, degrees):
    """The direction with a cosine and an azimuth."""
    sine = math.sqrt(1.0 - cosine * cosine)
    azimuth = math.radians(degrees)
    return [sine * math.cos(azimuth), sine * math.sin(azimuth), cosine]


OUT = [direction(*pair) for pair in
       [(0.95, 20.0), (0.6, 200.0), (0.15, 75.0), (-0.7, 130.0)]]
INTO = [direction(*pair) for pair in
        [(0.9, 180.0), (0.55, 30.0), (0.2, 250.0), (-0.4, 10.0), (-0.93, 300.0)]]
UV = [[0.13, 0.27], [0.61, 0.2], [0.4, 0.77], [0.83, 0.58], [1.3, -0.4], [-2.2, 3.9]]


def interaction(mi, out, uv):
    """The point of a surface seen from `out`."""
    si = mi.SurfaceInteraction3f()
    si.wi = out
    si.uv = uv
    si.n = [0, 0, 1]
    si.sh_frame = mi.Frame3f([1, 0, 0], [0, 1, 0], [0, 0, 1])
    si.dp_du = [1, 0, 0]
    si.dp_dv = [0, 1, 0]
    return si


def rounded(values):
    """What single precision knows of numbers."""
    return [float(f"{float(value):.7g}") for value in values]


def evaluate():
    """Everything, as it is written."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    context = mi.BSDFContext()
    data = {"mitsuba": mi.__version__, "variant": "scalar_rgb",
            "out": OUT, "into": INTO, "uv": UV, "laws": {}, "textures": {}}
    for name, description in laws().items():
        law = mi.load_dict(description)
        pairs, single = [], []
        delta = mi.has_flag(law.flags(), mi.BSDFFlags.Delta)
        for i, out in enumerate(OUT):
            for j, into in enumerate(INTO):
                uv = UV[(i + j) % 4]
                si = interaction(mi, out, uv)
                value, density = law.eval_pdf(context, si, into)
                pairs.append({"out": i, "into": j, "uv": (i + j) % 4,
                              "value": rounded(value), "density": rounded([density])[0]})
            for choice in (1e-4, 0.9999) if delta else ():
                uv = UV[i]
                si = interaction(mi, out, uv)
                sample, weight = law.sample(context, si, choice, [0.3, 0.6])
                if mi.has_flag(mi.BSDFFlags(sample.sampled_type), mi.BSDFFlags.Delta):
                    single.append({
                        "out": i, "uv": i, "choice": choice, "into": rounded(sample.wo),
                        "eta": rounded([sample.eta])[0], "weight": rounded(weight)})
        data["laws"][name] = {"pairs": pairs, "single": single}
    for name, description in textures().items():
        texture = mi.load_dict(description)
        rows = []
        for uv in UV:
            si = interaction(mi, OUT[0], uv)
            color = texture.eval(si)
            row = {"color": rounded(color), "number": rounded([texture.eval_1(si)])[0]}
            if name.startswith("bitmap"):
                row["slope"] = rounded(texture.eval_1_grad(si))
            rows.append(row)
        data["textures"][name] = {"mean": rounded([texture.mean()])[0], "values": rows}
    return data


def written(value, depth=0):
    """JSON with one entry of an innermost list of objects a line."""
    if isinstance(value, dict) and any(isinstance(v, (dict, list)) for v in value.values()) and depth < 4:
        rows = [f"{json.dumps(k)}: {written(v, depth + 1)}" for k, v in value.items()]
        return "{" + ",\n".join(rows) + "}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(json.dumps(v) for v in value) + "]"
    return json.dumps(value)


def differences(old, new, path=""):
    """Where two evaluations differ."""
    if isinstance(old, dict):
        if old.keys() != new.keys():
            yield f"{path}: {sorted(old.keys() ^ new.keys())} on one side only"
            return
        for key in old:
            yield from differences(old[key], new[key], f"{path}/{key}")
    elif isinstance(old, list):
        if len(old) != len(new):
            yield f"{path}: {len(old)} and {len(new)} entries"
            return
        for index, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, f"{path}/{index}")
    elif isinstance(old, float):
        if not abs(old - new) <= TOLERANCE * max(abs(old), abs(new), 1e-3):
            yield f"{path}: {old} and {new}"
    elif old != new:
        yield f"{path}: {old} and {new}"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["write", "check"])
    action = parser.parse_args().action
    try:
        data = evaluate()
    except ImportError as error:
        print(f"bsdf.py: {error}; see requirements.txt", file=sys.stderr)
        return 2
    if action == "write":
        FILE.write_text(written(data) + "\n")
        return 0
    different = list(differences(json.loads(FILE.read_text()), data))
    for line in different:
        print(line)
    print(f"{len(different)} differences")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
