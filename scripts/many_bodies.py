#!/usr/bin/env python3
"""Scenes of many bodies: a wall of bricks, a dry-stone wall, an arch, or a box of spheres.

    scripts/many_bodies.py wall COURSES BRICKS OUT      OUT/wall.toml, OUT/wall_bricks.txt, OUT/wall_halves.txt
    scripts/many_bodies.py drystone COURSES STONES OUT  OUT/drystone.toml, OUT/drystone_stones.txt and _halves.txt
    scripts/many_bodies.py arch VOUSSOIRS PERCENT OUT   OUT/arch.toml, OUT/arch_stones.txt
    scripts/many_bodies.py spheres ROW LAYERS OUT       OUT/spheres.toml, OUT/spheres.txt, OUT/spheres.msh

The wall is in the plane: COURSES of BRICKS bricks of 2 x 1 in running bond, with half bricks at the ends of every
second course, and a window in a frame of four bodies that are tied. It is pressed from the left and held at the right.
FRICTION=0.6 in the environment gives it friction.

The dry-stone wall is of such courses, without a window; friction alone holds it. The arch is a semicircle, PERCENT of
its radius thick.

The spheres have radius 1 and stand in layers of ROW x ROW and of one less each way, in the hollows of the layer below.
4 4 makes 50 spheres, 10 11 makes 1,005.
"""

import os
import sys
from pathlib import Path

WALL = """# A wall of {count} bricks with a window, under its own weight and pressed from the left. {says}. Written \
by `scripts/many_bodies.py wall {courses} {bricks}`.

title = "a wall of {count} bricks with a window"
physics = "elasticity"

[[body]]
name = "brick"
size = [2, 1]
elements = [4, 2]
young = 1e4
poisson = 0.2
load = [0, -1]                # stays downwards, however a brick is turned
instances = "wall_bricks.txt"      # a line for each brick: x y

[[body.only]]                 # the lowest course stands on the ground
y = [0, 0]
dirichlet = {{ bottom = {{ y = 0 }} }}

[[body.only]]                 # wind from the left
x = [0, 0]
pressure = {{ left = 0.5 }}

[[body.only]]                 # a buttress at the right end
x = [{last}, {last}]
dirichlet = {{ right = {{ x = 0 }} }}

[[body.only]]
x = [{last}, {last}]
y = [0, 0]
dirichlet = {{ right = {{ x = 0 }}, bottom = {{ y = 0 }} }}

[[body]]
name = "half"
size = [1, 1]
elements = [2, 2]
young = 1e4
poisson = 0.2
load = [0, -1]
instances = "wall_halves.txt"

[[body.only]]
x = [0, 0]
pressure = {{ left = 0.5 }}

[[body.only]]
x = [{last_half}, {last_half}]
dirichlet = {{ right = {{ x = 0 }} }}
{frame}
{contact}
{ties}[options]
fetifeti_ksp_rtol = 1e-8
# Of many bodies few are stiff: the cheap weight does as well as M^-1.
fetifeti_projector = "diagonal"
"""

PART = """
[[body]]                      # the frame of the window
name = "{name}"
origin = [{x}, {y}]
size = [{w}, {h}]
elements = [{nx}, {ny}]
young = 1e6
poisson = 0.2
load = [0, -1]
"""

SMOOTH = """Contact is without
# friction: bed joints pass weight only, head joints wind only. The buttress and the frame of the window hold the
# courses"""

ROUGH = """Contact is
# with friction"""

# Widest and highest window. A window as large as a third of any wall would have a lintel that bends by more than its
# own height, and bricks that turn far: nothing for small displacements.
WIDEST = 12


def bond(courses, parts):
    """The places of whole and of half bricks in the parts of each course."""
    whole, halves = [], []
    for y in range(courses):
        for x, last in parts(y):
            # The joints of even courses are at even x.
            if (x + y) % 2 == 1:
                halves.append((x, y))
                x += 1
            while x + 2 <= last:
                whole.append((x, y))
                x += 2
            if x < last:
                halves.append((x, y))
    return whole, halves


def table(out, name, places):
    Path(out, name).write_text("# x y of the lower left corner\n" + "".join(f"{x} {y}\n" for x, y in places))


def wall(courses, bricks, out):
    width = 2 * bricks
    # The window with its frame of one unit all round: a third of the width or WIDEST, from a third of the height, in
    # whole bricks of courses with half bricks at the ends.
    low = courses // 3 // 2 * 2 + 1
    high = low + min(WIDEST, max(4, courses // 3 // 2 * 2))
    left = 2 * (bricks // 3) + 1
    right = left + min(WIDEST, 2 * max(2, bricks // 3))
    whole, halves = bond(courses, lambda y: [(0, left), (right, width)] if low <= y < high else [(0, width)])
    w, h = right - left, high - low
    parts = [
        ("sill", left, low, w, 1),
        ("lintel", left, high - 1, w, 1),
        ("jamb_left", left, low + 1, 1, h - 2),
        ("jamb_right", right - 1, low + 1, 1, h - 2),
    ]
    frame = "".join(
        PART.format(name=n, x=x, y=y, w=w, h=h, nx=2 * w, ny=2 * h) for n, x, y, w, h in parts
    )
    ties = "".join(
        f'[[tie]]\nbodies = ["{a}", "{b}"]\n\n'
        for a in ["sill", "lintel"]
        for b in ["jamb_left", "jamb_right"]
    )
    count = len(whole) + len(halves)
    friction = os.environ.get("FRICTION")
    rough = f'[[contact]]\nbodies = "all"\nfriction = {friction}\n'
    text = WALL.format(
        count=count,
        courses=courses,
        bricks=bricks,
        last=width - 2,
        last_half=width - 1,
        frame=frame,
        ties=ties,
        says=ROUGH if friction else SMOOTH,
        contact=rough if friction else '[interface]\ndefault = "contact"\n',
    )
    Path(out, "wall.toml").write_text(text)
    table(out, "wall_bricks.txt", whole)
    table(out, "wall_halves.txt", halves)
    return f"{count} bricks and a frame of {len(parts)}"


DRYSTONE = """\
# A dry-stone wall of {count} stones on the ground, under its own weight and a tenth of it sideways, as in an
# earthquake. Nothing but friction holds it: without, every course slides. Written by
# `scripts/many_bodies.py drystone {courses} {stones}`.

title = "a dry-stone wall of {count} stones"
physics = "elasticity"
{parts}
[[contact]]
bodies = "all"
friction = 0.6

[[obstacle]]
body = "all"
side = "bottom"
plane = {{ point = [0, 0], normal = [0, 1] }}
distance = 0.1                # the ground, for the lowest course
friction = 0.6

[options]
fetifeti_ksp_rtol = 1e-8
"""

STONES = """
[[body]]
name = "{name}"
size = [{width}, 1]
elements = [{nx}, 2]
young = 1e4
poisson = 0.2
load = [0.1, -1]
instances = "drystone_{table}.txt"
"""


def drystone(courses, stones, out):
    whole, halves = bond(courses, lambda y: [(0, 2 * stones)])
    kinds = [("stone", "stones", 2, whole), ("half", "halves", 1, halves)]
    parts = "".join(STONES.format(name=n, table=t, width=w, nx=2 * w) for n, t, w, _ in kinds)
    count = len(whole) + len(halves)
    text = DRYSTONE.format(count=count, courses=courses, stones=stones, parts=parts)
    Path(out, "drystone.toml").write_text(text)
    for _, name, _, places in kinds:
        table(out, f"drystone_{name}.txt", places)
    return f"{count} stones"


ARCH = """\
# A semicircular arch of {count} voussoirs, {percent} % of its radius thick, under its own weight: friction passes on
# what the thrust has along the joints. Written by `scripts/many_bodies.py arch {count} {percent}`.

title = "an arch of {count} voussoirs"
physics = "elasticity"

[[body]]
name = "voussoir"
shape = {{ annulus = {{ inner = {inner}, outer = {outer}, from = {low}, to = {high} }} }}
elements = [4, 2]
young = 1e6
poisson = 0.2
load = [0, -1]
instances = "arch_stones.txt"

[[contact]]
bodies = "all"
friction = 0.6

{grounds}[options]
fetifeti_ksp_rtol = 1e-8
"""

GROUND = """[[obstacle]]
body = "voussoir[{k}]"
side = "{side}"
plane = {{ point = [0, 0], normal = [0, 1] }}
friction = 0.6

"""


def arch(count, percent, out):
    half, thick = 90 / count, percent / 10  # of a radius of 10
    grounds = "".join(GROUND.format(k=k, side=side) for k, side in [(0, "bottom"), (count - 1, "top")])
    text = ARCH.format(
        count=count,
        percent=percent,
        inner=10 - thick / 2,
        outer=10 + thick / 2,
        low=-half,
        high=half,
        grounds=grounds,
    )
    Path(out, "arch.toml").write_text(text)
    lines = "".join(f"0 0 {(2 * k + 1) * half:.15g}\n" for k in range(count))
    Path(out, "arch_stones.txt").write_text("# x y and angle, from the right springing on\n" + lines)
    return f"{count} voussoirs"


SPHERES = """# {count} spheres in a box, in contact without friction, under their own weight: layers of {row} x {row}
# spheres and of {less} x {less} in their hollows. One mesh serves all. Written by
# `scripts/many_bodies.py spheres {row} {layers}`.

title = "{count} spheres in a box"
dimension = 3
physics = "elasticity"

[mesh]
file = "spheres.msh"          # a ball of tetrahedra of radius 1

[[body]]
name = "sphere"
subdomains = 1
young = 1000
load = [0, -1, 0]
# A sphere without friction spins freely: a soft bed holds it.
spring = {{ all = 0.1 }}
instances = "spheres.txt"     # a line for each sphere: x y z, axis and angle

[contact]
auto = true
distance = 0.1                # surfaces farther apart do not meet

{walls}[options]
fetifeti_ksp_rtol = 1e-6
"""

BOX = """[[obstacle]]
body = "all"
side = "all"
plane = {{ point = {point}, normal = {normal} }}
distance = 0.1

"""


def ball(levels, shells):
    """Nodes and tetrahedra of a ball of radius 1: an octahedron whose faces are divided, in shells. The octahedron is
    turned by 45 degrees about y: the directions in which spheres of the packing touch are nodes."""
    h = 0.5**0.5
    points = [(0, 1, 0), (0, -1, 0), (h, 0, h), (h, 0, -h), (-h, 0, -h), (-h, 0, h)]
    faces = [(pole, 2 + k, 2 + (k + 1) % 4) for pole in [0, 1] for k in range(4)]
    for _ in range(levels):
        middle, finer = {}, []

        def between(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                middle[key] = len(points)
                points.append(unit(tuple(p + q for p, q in zip(points[i], points[j]))))
            return middle[key]

        for i, j, k in faces:
            a, b, c = between(i, j), between(j, k), between(k, i)
            finer += [(i, a, c), (j, b, a), (k, c, b), (a, b, c)]
        faces = finer
    n = len(points)
    nodes = [(0.0, 0.0, 0.0)]
    for s in range(1, shells + 1):
        nodes += [tuple(v * s / shells for v in p) for p in points]
    cells = []
    for face in faces:
        # Prisms are cut in the order of their nodes: neighbours cut their common side alike.
        i, j, k = sorted(face)
        cells.append((0, 1 + i, 1 + j, 1 + k))
        for s in range(shells - 1):
            low, high = [1 + s * n + v for v in (i, j, k)], [1 + (s + 1) * n + v for v in (i, j, k)]
            cells += [tuple(low[: m + 1] + high[m:]) for m in range(3)]
    outside = [tuple(1 + (shells - 1) * n + v for v in face) for face in faces]
    return nodes, [positive(nodes, cell) for cell in cells], outside


def unit(p):
    length = sum(v * v for v in p) ** 0.5
    return tuple(v / length for v in p)


def positive(nodes, cell):
    a, b, c, d = (nodes[k] for k in cell)
    u, v, w = (tuple(q - p for p, q in zip(a, other)) for other in (b, c, d))
    det = (
        u[0] * (v[1] * w[2] - v[2] * w[1])
        - u[1] * (v[0] * w[2] - v[2] * w[0])
        + u[2] * (v[0] * w[1] - v[1] * w[0])
    )
    return cell if det > 0 else (cell[1], cell[0]) + cell[2:]


def spheres(row, layers, out):
    nodes, cells, outside = ball(2, 2)
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '3 1 "sphere"', '2 2 "surface"']
    lines += ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{k} {x:.15g} {y:.15g} {z:.15g}" for k, (x, y, z) in enumerate(nodes, 1)]
    lines += ["$EndNodes", "$Elements", str(len(cells) + len(outside))]
    kinds = [(4, 1, cell) for cell in cells] + [(2, 2, face) for face in outside]
    for k, (kind, group, cell) in enumerate(kinds, 1):
        lines.append(f"{k} {kind} 2 {group} {group} " + " ".join(str(v + 1) for v in cell))
    Path(out, "spheres.msh").write_text("\n".join(lines + ["$EndElements"]) + "\n")
    places = []
    for layer in range(layers):
        odd, height = layer % 2, 1 + layer * 2**0.5
        for j in range(row - odd):
            for i in range(row - odd):
                turn = " 0 1 0 90" if (i + j) % 2 else ""
                places.append(f"{1 + odd + 2 * i} {height:.15g} {1 + odd + 2 * j}{turn}\n")
    Path(out, "spheres.txt").write_text("# x y z of the centre, axis and angle\n" + "".join(places))
    width = 2 * row
    walls = [([0, 0, 0], [0, 1, 0]), ([0, 0, 0], [1, 0, 0]), ([0, 0, 0], [0, 0, 1])]
    walls += [([width, 0, 0], [-1, 0, 0]), ([0, 0, width], [0, 0, -1])]
    text = SPHERES.format(
        count=len(places),
        row=row,
        less=row - 1,
        layers=layers,
        walls="".join(BOX.format(point=p, normal=n) for p, n in walls),
    )
    Path(out, "spheres.toml").write_text(text)
    return f"{len(places)} spheres of {len(nodes)} nodes"


KINDS = {"wall": wall, "drystone": drystone, "arch": arch, "spheres": spheres}


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in KINDS:
        sys.exit(__doc__)
    kind, first, second, out = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    Path(out).mkdir(parents=True, exist_ok=True)
    done = KINDS[kind](first, second, out)
    print(f"{out}/{kind}.toml: {done}")


if __name__ == "__main__":
    main()
