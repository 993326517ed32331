#!/usr/bin/env python3
"""Writes tests/data/calculix_elements.txt: nodal forces of one distorted cell of each kind, by CalculiX.

    scripts/calculix_elements.py [FOLDER]

needs `ccx` (Debian: calculix-ccx). For each element a deck of one cell is written to FOLDER and run with
`*FREQUENCY, SOLVER=MATRIXSTORAGE`, which stores the stiffness K. The file gets, for each, one line
`NAME SHAPE THICKNESS`, one line per node with its coordinates, and a line of K u for displacements u that are small
whole numbers. What the cell has for itself (incompatible modes; in plane stress the displacements across the plane) is
eliminated from K before.
"""

import os
import subprocess
import sys
import tempfile

YOUNG, POISSON = 1000.0, 0.3
HEX = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
WEDGE = [(0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
WEDGE_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
RING3, RING4 = [(0, 1), (1, 2), (2, 0)], [(0, 1), (1, 2), (2, 3), (3, 0)]


def with_middles(corners, edges):
    return corners + [tuple(0.5 * (p + q) for p, q in zip(corners[a], corners[b])) for a, b in edges]


def reference(name):
    """The nodes of an undistorted cell."""
    if name.startswith("C3D"):
        return {
            "4": TET, "6": WEDGE, "8": HEX,
            "10": with_middles(TET, TET_EDGES),
            "15": with_middles(WEDGE, WEDGE_EDGES),
            "20": with_middles(HEX, HEX_EDGES),
        }[name[3:].rstrip("RI")]
    corners3, corners4 = [(p[0], p[1], 0) for p in TET[:3]], [(p[0], p[1], 0) for p in HEX[:4]]
    return {
        "3": corners3, "4": corners4,
        "6": with_middles(corners3, RING3), "8": with_middles(corners4, RING4),
    }[name[3:].rstrip("R")]


def nodes(name, shape):
    """The same under an affine map, or with every node moved; axisymmetric cells lie away from the axis."""
    if shape == "affine":
        rise = 0.3 if name.startswith("C3D") else 0
        return [[x + 0.2 * y, 0.1 * x + 0.9 * y - 0.1 * z, rise * x + 1.2 * z] for x, y, z in reference(name)]
    out = []
    for a, point in enumerate(reference(name)):
        moved = []
        for d, x in enumerate(point):
            plane = d == 2 and not name.startswith("C3D")
            wobble = 0 if plane else ((a * a * 7 + a * 5 + d * 13 + 3) % 17 - 8) * 0.015
            moved.append(round(x + wobble + (3 if name.startswith("CAX") and d == 0 else 0), 6))
        out.append(moved)
    return out


def displacement(i):
    """Of degree of freedom i."""
    return (i * i * 3 + i * 7 + 5) % 11 - 5


def deck(name, shape, thickness):
    points = nodes(name, shape)
    lines = ["*NODE,NSET=ALL"]
    lines += [f"{a + 1},{x},{y},{z}" for a, (x, y, z) in enumerate(points)]
    lines += [f"*ELEMENT,TYPE={name},ELSET=CELL"]
    numbers = ["1"] + [str(a + 1) for a in range(len(points))]
    while numbers:
        head, numbers = numbers[:10], numbers[10:]
        lines.append(",".join(head) + ("," if numbers else ""))
    lines += ["*MATERIAL,NAME=M", "*ELASTIC", f"{YOUNG},{POISSON}", "*DENSITY", "1."]
    lines += ["*SOLID SECTION,ELSET=CELL,MATERIAL=M"]
    lines += [] if name.startswith("C3D") else [str(thickness)]
    lines += ["*STEP", "*FREQUENCY,SOLVER=MATRIXSTORAGE", "*NODE FILE", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def stiffness(folder, name, shape, thickness):
    """The matrix, and for each of its rows (node, direction)."""
    job = f"{name.lower()}_{shape}_{thickness}".replace(".", "_")
    for ending in ("sti", "dof"):
        if os.path.exists(os.path.join(folder, f"{job}.{ending}")):
            os.remove(os.path.join(folder, f"{job}.{ending}"))
    with open(os.path.join(folder, job + ".inp"), "w") as file:
        file.write(deck(name, shape, thickness))
    subprocess.run(["ccx", job], cwd=folder, stdout=subprocess.DEVNULL, check=True)
    with open(os.path.join(folder, job + ".dof")) as file:
        dofs = [tuple(int(n) for n in line.split(".")) for line in file]
    matrix = [[0.0] * len(dofs) for _ in dofs]
    with open(os.path.join(folder, job + ".sti")) as file:
        for line in file:
            i, j, value = line.split()
            matrix[int(i) - 1][int(j) - 1] = matrix[int(j) - 1][int(i) - 1] = float(value)
    return matrix, dofs


def forces(folder, name, shape, thickness):
    """K u, what belongs to the cell alone being eliminated."""
    matrix, dofs = stiffness(folder, name, shape, thickness)
    count, dim = len(reference(name)), 3 if name.startswith("C3D") else 2
    kept = {(a + 1, d + 1): dim * a + d for a in range(count) for d in range(dim)}
    # CalculiX numbers what it adds from count + 1.
    order = [i for i, dof in enumerate(dofs) if dof in kept]
    inner = [i for i, dof in enumerate(dofs) if dof not in kept]
    assert sorted(kept[dofs[i]] for i in order) == list(range(count * dim)), dofs
    for pivot in inner:
        for i in order + inner:
            if i != pivot and matrix[i][pivot] != 0.0:
                factor = matrix[i][pivot] / matrix[pivot][pivot]
                matrix[i] = [x - factor * y for x, y in zip(matrix[i], matrix[pivot])]
    out = [0.0] * (count * dim)
    for i in order:
        out[kept[dofs[i]]] = sum(matrix[i][j] * displacement(kept[dofs[j]]) for j in order)
    return out


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
    solid = ["C3D4", "C3D6", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D15", "C3D20", "C3D20R"]
    kinds = ["3", "4", "4R", "6", "8", "8R"]
    cases = [(name, "distorted", 1.0) for name in solid + ["CPE" + k for k in kinds] + ["CAX" + k for k in kinds]]
    cases += [("C3D8I", "affine", 1.0), ("C3D8R", "affine", 1.0), ("CPE4R", "affine", 1e6)]
    cases += [("CPS" + k, "distorted", thickness) for k in kinds for thickness in (1.0, 0.001)]
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    with open(os.path.join(root, "tests", "data", "calculix_elements.txt"), "w") as file:
        file.write("# By scripts/calculix_elements.py: element, shape, thickness; nodes; K u.\n")
        for name, shape, thickness in cases:
            file.write(f"{name} {shape} {thickness}\n")
            for point in nodes(name, shape):
                file.write(" ".join(f"{x:g}" for x in point) + "\n")
            file.write(" ".join(f"{x:.11g}" for x in forces(folder, name, shape, thickness)) + "\n")


if __name__ == "__main__":
    main()
