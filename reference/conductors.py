"""Prints the optical constants of conductors as Mitsuba's RGB variants have them.

    python3 conductors.py > ../src/mitsuba/bsdf/conductors.txt

A line holds the name, the index of refraction in red, green and blue, and the
extinction coefficient likewise. They are what Mitsuba's plugin `conductor` has
for its `material`, from measured spectra that come with Mitsuba (`data/ior`),
which it integrates against the colour matching functions of the CIE.
"""

from pathlib import Path

import mitsuba

mitsuba.set_variant("scalar_rgb")
mitsuba.set_log_level(mitsuba.LogLevel.Error)

folder = Path(mitsuba.__file__).parent / "data" / "ior"
print(f"# Mitsuba {mitsuba.__version__}, variant scalar_rgb; see reference/conductors.py")
for file in sorted(folder.glob("*.eta.spd")):
    name = file.name.removesuffix(".eta.spd")
    if not (folder / f"{name}.k.spd").exists():
        continue
    conductor = mitsuba.load_dict({"type": "conductor", "material": name})
    values = mitsuba.traverse(conductor)
    triples = (values["eta.value"], values["k.value"])
    print(name, *(f"{float(value):.6g}" for triple in triples for value in triple))
