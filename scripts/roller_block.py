#!/usr/bin/env python3
"""The block of NAFEMS' roller alone, in CalculiX: how far it gives way under Hertz's pressure, in small and in large
displacements.

    scripts/roller_block.py

The pressure stays where it is, and vertical. Half the block, 4-node elements with a/8 at the contact; `ccx` is needed.
"""

import math
import pathlib
import subprocess
import tempfile

HALF_WIDTH, LOAD = 6.21, 35e3


def graded(length, uniform):
    """From 0 to `length`: so many edges of a/8, then longer and longer ones."""
    edge = HALF_WIDTH / 8
    points = [edge * k for k in range(uniform + 1)]
    while points[-1] < length:
        edge *= 1.15
        points.append(points[-1] + edge)
    start = points[uniform]
    scale = (length - start) / (points[-1] - start)
    return [x if x <= start else start + (x - start) * scale for x in points]


def deck(across, down, step):
    n = len(across)
    number = lambda i, j: 1 + i + j * n
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{number(i, j)}, {x}, {-y}, 0" for j, y in enumerate(down) for i, x in enumerate(across)]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BLOCK"]
    cells = [(i, j) for j in range(len(down) - 1) for i in range(n - 1)]
    for k, (i, j) in enumerate(cells):
        corners = [number(i, j + 1), number(i + 1, j + 1), number(i + 1, j), number(i, j)]
        lines.append(", ".join(map(str, [k + 1, *corners])))
    lines += ["*MATERIAL, NAME=ALUMINIUM", "*ELASTIC", "70000, 0.3"]
    lines += ["*SOLID SECTION, ELSET=BLOCK, MATERIAL=ALUMINIUM", "1."]
    lines += ["*BOUNDARY", *(f"{number(0, j)}, 1, 1" for j in range(len(down)))]
    lines += [f"{number(i, len(down) - 1)}, 1, 2" for i in range(n)]
    lines += ["*NSET, NSET=B", "1", step, "*STATIC", "0.2, 1", "*CLOAD"]
    forces = [0.0] * n
    points = 20000
    for k in range(points):
        x = (k + 0.5) / points * HALF_WIDTH
        force = 2 * LOAD / (math.pi * points) * math.sqrt(1 - (x / HALF_WIDTH) ** 2)
        i = max(i for i in range(n) if across[i] <= x)
        t = (x - across[i]) / (across[i + 1] - across[i])
        forces[i] += force * (1 - t)
        forces[i + 1] += force * t
    lines += [f"{number(i, 0)}, 2, {-force}" for i, force in enumerate(forces) if force > 0]
    return "\n".join([*lines, "*NODE PRINT, NSET=B", "U", "*END STEP", ""])


def main():
    across, down = graded(100, 12), graded(200, 8)
    for name, step in [("small displacements", "*STEP"), ("large displacements", "*STEP, NLGEOM")]:
        with tempfile.TemporaryDirectory() as place:
            (pathlib.Path(place) / "block.inp").write_text(deck(across, down, step))
            subprocess.run(["ccx", "-i", "block"], cwd=place, check=True, capture_output=True)
            printed = (pathlib.Path(place) / "block.dat").read_text().split()
        print(f"{name}: u_y of B = {float(printed[-2]):.4f} mm")


if __name__ == "__main__":
    main()
