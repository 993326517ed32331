#!/usr/bin/env python3
"""Writes a scene with copies of one part, turned and mirrored, and its mesh in Gmsh's format 2.2.

    scripts/copies.py DIRECTORY [CELLS [PAIRS [SUBDOMAINS]]]

The part is a bent block of 6 CELLS³ tetrahedra in SUBDOMAINS subdomains. It stands on its foot, with pressure on its
top. A pair is the part and its mirror image, tied along the plane side between them; the k-th pair is turned by 37° k
about an oblique axis. docs/meshes.md has figures of it.
"""

import itertools
import math
import sys
from pathlib import Path


def rotation(degrees, axis=(1, 2, -0.7)):
    """The rotation about an axis, as rows."""
    size = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / size for a in axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    d = 1 - c
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d]]


def part(n):
    """The nodes, the tetrahedra, and the triangles of foot, top and joint."""
    node = lambda i, j, k: (k * (n + 1) + j) * (n + 1) + i
    points = [(x * (1 + 0.2 * math.sin(1.3 * y + 0.7 * z)), y + 0.15 * math.sin(2 * x + z),
               z + 0.1 * x * y + 0.12 * math.cos(2 * y + x))
              for z, y, x in itertools.product([k / n for k in range(n + 1)], repeat=3)]
    cells = []
    for low in itertools.product(range(n), repeat=3):
        for number, order in enumerate(itertools.permutations(range(3))):
            at = list(low)
            cell = [node(*at)]
            for axis in order:
                at[axis] += 1
                cell.append(node(*at))
            if number in (1, 2, 5):  # odd permutations
                cell[1], cell[2] = cell[2], cell[1]
            cells.append(cell)

    def side(at):
        corners = ([at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1)]
                   for a, b in itertools.product(range(n), repeat=2))
        return [t for p, q, r, s in corners for t in ([p, q, r], [p, r, s])]

    sides = {"foot": side(lambda a, b: node(a, b, 0)), "top": side(lambda a, b: node(a, b, n)),
             "joint": side(lambda a, b: node(0, a, b))}
    return points, cells, sides


def main(out, n=16, pairs=4, subdomains=12):
    points, cells, sides = part(n)
    nodes, elements, groups, scene = [], [], [], []
    for k, side in itertools.product(range(pairs), "ab"):
        name, first, turn = f"p{k}{side}", len(nodes) + 1, rotation(37 * k)
        for x, y, z in points:
            p = (-x if side == "b" else x, y, z)
            nodes.append([sum(a * b for a, b in zip(row, p)) + k * t for row, t in zip(turn, (4, 0.3, -0.2))])

        def group(kind, dim, title, members):
            groups.append(f'{dim} {len(groups) + 1} "{title}"')
            tag = len(groups)
            elements.extend(f"{kind} 2 {tag} {tag} {' '.join(str(first + v) for v in cell)}" for cell in members)

        for what, members in sides.items():
            group(2, 2, f"{what}_{name}", members)
        group(4, 3, name, [[a, c, b, d] for a, b, c, d in cells] if side == "b" else cells)
        scene.append(f'[[body]]\nname = "{name}"\nyoung = 10\npoisson = 0.3\nsubdomains = {subdomains}\n'
                     f"dirichlet = {{ foot_{name} = 0 }}\n"
                     f"pressure = {{ top_{name} = {0.1 + 0.02 * len(scene):.2f} }}\n")
    scene += [f'[[tie]]\nsurfaces = ["joint_p{k}a", "joint_p{k}b"]\n' for k in range(pairs)]
    numbered = lambda lines: f"{len(lines)}\n" + "".join(f"{k} {line}\n" for k, line in enumerate(lines, 1))
    Path(out).mkdir(parents=True, exist_ok=True)
    names = "\n".join(groups)
    (Path(out) / "copies.msh").write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n{names}\n$EndPhysicalNames\n"
        f"$Nodes\n{numbered([' '.join(map(repr, p)) for p in nodes])}$EndNodes\n"
        f"$Elements\n{numbered(elements)}$EndElements\n")
    (Path(out) / "copies.toml").write_text(
        'title = "Copies of a part"\ndimension = 3\nphysics = "elasticity"\n[mesh]\nfile = "copies.msh"\n'
        + "".join(scene))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], *map(int, sys.argv[2:]))
