#!/usr/bin/env python3
"""How C3D8R and C3D8I differ from CalculiX's where cells are no parallelepipeds: a table.

    scripts/distorted_cells.py [FETIFETI]

needs `ccx` (Debian: calculix-ccx). A beam of 6 x 2 x 2 cells is bent and stretched at one end; its inner nodes, those
of its surface along it, are moved by a part of an edge. A second mesh has cells as they lie beside a round hole:
their edges along the beam lean by turns; a third is one cell whose end is smaller and turned. Printed are the
displacement of the end by both programs, and the difference. The last rows are the patch test: all outer nodes have
the displacements of a constant strain, and what is printed is the largest distance of an inner node from it, beside
the largest displacement.
"""

import os
import subprocess
import sys
import tempfile

CELLS = (6, 2, 2)
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def number(i, j, k):
    return 1 + i + 7 * (j + 3 * k)


def nodes(shape, part):
    """All nodes by their numbers; the ends of the beam stay plane."""
    out = {}
    for k in range(3):
        for j in range(3):
            for i in range(7):
                place = [float(i), float(j), float(k)]
                if 0 < i < 6:
                    if shape == "moved":
                        for d in range(3):
                            wobble = ((number(i, j, k) ** 2 * 7 + d * 13 + 3) % 17 - 8) / 8
                            outer = d > 0 and place[d] in (0.0, 2.0)
                            place[d] += 0.0 if outer else part * wobble
                    else:
                        place[0] += part * (1 if i % 2 else -1) * (j - 1)
                out[number(i, j, k)] = place
    return out


def beam():
    cells = [(i, j, k) for k in range(CELLS[2]) for j in range(CELLS[1]) for i in range(CELLS[0])]
    return [[number(i + a, j + b, k + d) for a, b, d in CORNERS] for i, j, k in cells]


def single(taper):
    """One cube of length 1 whose end x = 1 has shrunk to a part of itself, towards an edge, and is turned by it."""
    out = {}
    for c, (x, y, z) in enumerate(CORNERS):
        size = 1 - taper * x
        out[c + 1] = [float(x), y * size + 0.5 * taper * x * z, z * size]
    return out


def deck(element, points, given, loads, cells=None):
    lines = ["*NODE, NSET=ALL"] + [f"{n}, {x:.9f}, {y:.9f}, {z:.9f}" for n, (x, y, z) in points.items()]
    lines += [f"*ELEMENT, TYPE={element}, ELSET=BEAM"]
    for c, cell in enumerate(cells or beam()):
        lines.append(f"{c + 1}, " + ", ".join(str(n) for n in cell))
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*SOLID SECTION, ELSET=BEAM, MATERIAL=M"]
    lines += ["*STEP", "*STATIC", "*BOUNDARY"] + [f"{n}, {d}, {d}, {v:.12g}" for n, d, v in given]
    lines += ["*CLOAD"] * bool(loads) + [f"{n}, {d}, {v:.12g}" for n, d, v in loads]
    return "\n".join(lines + ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""])


def solved(program, text):
    """The displacements that a program prints, by node."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "beam.inp"), "w") as file:
            file.write(text)
        if program == "ccx":
            command, table = ["ccx", "beam"], "beam.dat"
        else:
            command = [program, "solve", "beam.inp", "--out", "o", "--quiet", "-fetifeti_ksp_rtol", "1e-10"]
            table = os.path.join("o", "beam.dat")
        subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        with open(os.path.join(folder, table)) as file:
            rows = [line.split() for line in file]
    return {int(r[0]): [float(x) for x in r[1:]] for r in rows if len(r) == 4 and r[0].isdigit()}


def linear(point):
    x, y, z = point
    return [1e-3 * x + 4e-4 * y, -5e-4 * y + 2e-4 * z, 3e-4 * z + 1e-4 * x]


def main():
    ours = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else "fetifeti"
    ends = [number(6, j, k) for k in range(3) for j in range(3)]
    held = [(number(0, j, k), d, 0.0) for k in range(3) for j in range(3) for d in (1, 2, 3)]
    shapes = [("moved", p) for p in (0.0, 0.1, 0.2, 0.3)] + [("leaning", p) for p in (0.1, 0.2, 0.3)]
    print("| cells | load | element | ours | CalculiX | difference |\n|---|---|---|---|---|---|")
    for shape, part in shapes:
        points = nodes(shape, part)
        for load, d in (("bent", 3), ("stretched", 1)):
            for element in ("C3D8", "C3D8R", "C3D8I"):
                text = deck(element, points, held, [(n, d, 0.1) for n in ends])
                found = [solved(p, text) for p in (ours, "ccx")]
                mean = [sum(u[n][d - 1] for n in ends) / len(ends) for u in found]
                away = f"{100 * (mean[0] / mean[1] - 1):+.2f} %"
                print(f"| {shape} by {part} | {load} | {element} | {mean[0]:.6g} | {mean[1]:.6g} | {away} |")
    for taper in (0.2, 0.5, 0.7):
        points, end = single(taper), [2, 3, 6, 7]
        clamped = [(n, d, 0.0) for n in (1, 4, 5, 8) for d in (1, 2, 3)]
        for element in ("C3D8", "C3D8R", "C3D8I"):
            text = deck(element, points, clamped, [(n, 3, 0.1) for n in end], [list(range(1, 9))])
            found = [solved(p, text) for p in (ours, "ccx")]
            mean = [sum(u[n][2] for n in end) / 4 for u in found]
            away = f"{100 * (mean[0] / mean[1] - 1):+.2f} %"
            print(f"| one, its end less by {taper} | bent | {element} | {mean[0]:.6g} | {mean[1]:.6g} | {away} |")
    for shape, part in shapes[1:]:
        points = nodes(shape, part)
        outer = [n for n, p in points.items() if n != 0]
        inner = {number(i, 1, 1) for i in range(1, 6)}
        given = [(n, d + 1, linear(points[n])[d]) for n in outer if n not in inner for d in range(3)]
        largest = max(abs(v) for _, _, v in given)
        for element in ("C3D8", "C3D8R", "C3D8I"):
            text = deck(element, points, given, [])
            away = []
            for program in (ours, "ccx"):
                u = solved(program, text)
                worst = max(abs(u[n][d] - linear(points[n])[d]) for n in inner for d in range(3))
                away.append(f"{100 * worst / largest:.3f} %")
            print(f"| {shape} by {part} | patch test | {element} | {away[0]} | {away[1]} | |")


if __name__ == "__main__":
    main()
