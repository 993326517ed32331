#!/usr/bin/env python3
"""A wave spring: flat rings whose height waves, stacked crest on crest and pressed between rigid plates.

    scripts/wave_spring.py RINGS AROUND OUT      OUT/wave_spring.toml, OUT/wave_spring.msh

Each ring has AROUND cells around, 2 across and 2 through its thickness, and waves as A cos 3 phi; its neighbours are
turned by half a wave, so that crests meet. Nodes of neighbours lie above each other. Nothing but contact holds a ring.
7 96 makes 18,144 unknowns.
"""

import math
import sys
from pathlib import Path

INNER, OUTER, THICK, HIGH, WAVES = 10.0, 12.0, 0.5, 0.6, 3
ACROSS, THROUGH = 2, 2
PRESSED = 0.1  # of the height of each wave from trough to crest

SCENE = """# A wave spring of {rings} rings, pressed by {way:.3f} mm between rigid plates. Pascal, metres. Written by
# `scripts/wave_spring.py {rings} {around}`.
title = "wave spring of {rings} rings"
dimension = 3
physics = "elasticity"

[mesh]
file = "wave_spring.msh"
scale = 1e-3
"""

BODY = """
[[body]]
name = "ring{k}"
young = 210e9
poisson = 0.3
"""

CONTACT = """
[[contact]]
surfaces = ["top{k}", "bottom{next}"]
"""

PLATES = """
[[obstacle]]
body = "ring1"
side = "bottom1"
plane = {{ point = [0, 0, {low:.9e}], normal = [0, 0, 1] }}

[[obstacle]]
body = "ring{rings}"
side = "top{rings}"
plane = {{ point = [0, 0, {high:.9e}], normal = [0, 0, -1] }}
"""


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    rings, around, out = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    out.mkdir(parents=True, exist_ok=True)
    pitch = THICK + 2 * HIGH
    nodes, cells = [], []  # cells: (kind, group, nodes)
    per = around * (ACROSS + 1) * (THROUGH + 1)

    def at(k, a, r, t):
        return k * per + ((a % around) * (ACROSS + 1) + r) * (THROUGH + 1) + t + 1

    for k in range(rings):
        sign = 1 if k % 2 == 0 else -1
        for a in range(around):
            phi = 2 * math.pi * a / around
            for r in range(ACROSS + 1):
                radius = INNER + (OUTER - INNER) * r / ACROSS
                for t in range(THROUGH + 1):
                    z = k * pitch + sign * HIGH * math.cos(WAVES * phi) + THICK * t / THROUGH
                    nodes.append((radius * math.cos(phi), radius * math.sin(phi), z))
        for a in range(around):
            for r in range(ACROSS):
                for t in range(THROUGH):
                    low = [at(k, a, r, t), at(k, a, r + 1, t), at(k, a + 1, r + 1, t), at(k, a + 1, r, t)]
                    cells.append((5, 3 * k + 1, low + [n + 1 for n in low]))
                for t, group in ((0, 3 * k + 2), (THROUGH, 3 * k + 3)):
                    quad = [at(k, a, r, t), at(k, a, r + 1, t), at(k, a + 1, r + 1, t), at(k, a + 1, r, t)]
                    cells.append((3, group, quad))
    with open(out / "wave_spring.msh", "w") as f:
        f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n" % (3 * rings))
        for k in range(rings):
            f.write('3 %d "ring%d"\n2 %d "bottom%d"\n2 %d "top%d"\n'
                    % (3 * k + 1, k + 1, 3 * k + 2, k + 1, 3 * k + 3, k + 1))
        f.write("$EndPhysicalNames\n$Nodes\n%d\n" % len(nodes))
        for i, p in enumerate(nodes):
            f.write("%d %.10g %.10g %.10g\n" % (i + 1, *p))
        f.write("$EndNodes\n$Elements\n%d\n" % len(cells))
        for i, (kind, group, ids) in enumerate(cells):
            f.write("%d %d 2 %d %d %s\n" % (i + 1, kind, group, group, " ".join(map(str, ids))))
        f.write("$EndElements\n")
    way = PRESSED * 2 * HIGH * (rings + 1)
    text = SCENE.format(rings=rings, around=around, way=way)
    text += "".join(BODY.format(k=k + 1) for k in range(rings))
    text += "".join(CONTACT.format(k=k + 1, next=k + 2) for k in range(rings - 1))
    low, high = -HIGH, (rings - 1) * pitch + THICK + HIGH - way
    text += PLATES.format(rings=rings, low=1e-3 * low, high=1e-3 * high)
    (out / "wave_spring.toml").write_text(text)


main()
