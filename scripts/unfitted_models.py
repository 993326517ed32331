#!/usr/bin/env python3
"""Writes three models that were used for fitting nothing, meshes by Gmsh: an angle with a rib on a plate, all tied; a
pin of second order in a slotted disc, in contact; balls in a block that conduct heat a hundred times as well.

    scripts/unfitted_models.py FOLDER [--size 1.0]

Then, for each of FOLDER/angle.toml, pin.toml and balls.toml: `scripts/choices.py fetifeti FOLDER/angle.toml` or
`fetifeti compare FOLDER/angle.toml --rounds 3 --with gamg,hypre`. A size of 2 has cells twice as long.
"""

import argparse
from pathlib import Path

import gmsh


def group(dim, tags, name):
    """A physical group."""
    gmsh.model.addPhysicalGroup(dim, tags, name=name)


def inside(dim, box):
    """The entities whose boxes lie within this one, which begins and ends with three coordinates."""
    e = 1e-6
    low, high = [c - e for c in box[:3]], [c + e for c in box[3:]]
    return [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*low, *high, dim)]


def angle(size):
    """Bodies share the nodes of their faces: these are tied."""
    occ = gmsh.model.occ
    plate = occ.addBox(0, 0, 0, 120, 80, 15)
    holes = [(3, occ.addCylinder(x, y, 0, 0, 0, 15, 7)) for x in (90, 105) for y in (20, 60)]
    occ.cut([(3, plate)], holes)
    wall = occ.addBox(10, 10, 15, 12, 60, 90)
    bore = occ.addCylinder(10, 40, 75, 12, 0, 0, 18)
    occ.cut([(3, wall)], [(3, bore)])
    corners = [occ.addPoint(22, 34, 15), occ.addPoint(70, 34, 15), occ.addPoint(22, 34, 48)]
    lines = [occ.addLine(corners[k - 1], corners[k]) for k in range(3)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    occ.extrude([(2, face)], 0, 12, 0)
    volumes = gmsh.model.occ.getEntities(3)
    occ.fragment(volumes[:1], volumes[1:])
    occ.synchronize()
    group(3, inside(3, (0, 0, 0, 120, 80, 15)), "plate")
    group(3, inside(3, (10, 10, 15, 22, 70, 105)), "wall")
    group(3, inside(3, (22, 34, 15, 70, 46, 48)), "rib")
    for k, (x, y) in enumerate(((90, 20), (90, 60), (105, 20), (105, 60))):
        group(2, inside(2, (x - 7, y - 7, 0, x + 7, y + 7, 15)), f"screw{k}")
    group(2, inside(2, (10, 22, 57, 22, 58, 93)), "bore")
    return 3, 1, 1.6 * size


ANGLE = """
[[body]]
name = "plate"
young = 210e9
poisson = 0.3
dirichlet = { screw0 = 0, screw1 = 0, screw2 = 0, screw3 = 0 }

[[body]]
name = "wall"
young = 70e9
poisson = 0.33
traction = { bore = [2e6, 0, -1e6] }

[[body]]
name = "rib"
young = 70e9
poisson = 0.33

[[tie]]
bodies = ["plate", "wall"]

[[tie]]
bodies = ["plate", "rib"]

[[tie]]
bodies = ["wall", "rib"]
"""


def pin(size):
    """The pin has its own nodes on the rim."""
    occ = gmsh.model.occ
    disc, hole = occ.addDisk(0, 0, 0, 50, 50), occ.addDisk(0, 0, 0, 20, 20)
    slot = occ.addRectangle(0, -3, 0, 60, 6)
    occ.cut([(2, disc)], [(2, hole), (2, slot)])
    disc = gmsh.model.occ.getEntities(2)[0][1]
    ball = occ.addDisk(0, 0, 0, 19.99, 19.99)
    occ.synchronize()
    group(2, [disc], "disc")
    group(2, [ball], "pin")
    edges = [tag for _, tag in gmsh.model.getBoundary([(2, disc)], oriented=False)]
    radius = {tag: gmsh.model.occ.getBoundingBox(1, tag)[0] for tag in edges}
    group(1, [tag for tag in edges if radius[tag] < -40], "outside")
    group(1, [tag for tag in edges if -25 < radius[tag] < -15], "seat")
    group(1, [tag for _, tag in gmsh.model.getBoundary([(2, ball)], oriented=False)], "rim")
    return 2, 2, 0.6 * size


PIN = """
[[body]]
name = "disc"
young = 210e9
poisson = 0.3
dirichlet = { outside = 0 }

[[body]]
name = "pin"
young = 210e9
poisson = 0.3
load = [1e9, -3e9]

[[contact]]
surfaces = ["rim", "seat"]
"""


def balls(size):
    """Six balls and the block around them share nodes."""
    occ = gmsh.model.occ
    block = occ.addBox(0, 0, 0, 60, 40, 20)
    centres = [(x, y, 10) for x in (10, 30, 50) for y in (10, 30)]
    spheres = [(3, occ.addSphere(*c, 6 + k % 3)) for k, c in enumerate(centres)]
    occ.fragment([(3, block)], spheres)
    occ.synchronize()
    parts = [inside(3, tuple(x - 9 for x in c) + tuple(x + 9 for x in c)) for c in centres]
    parts = [tag for part in parts for tag in part]
    group(3, parts, "ball")
    group(3, [tag for _, tag in gmsh.model.getEntities(3) if tag not in parts], "block")
    group(2, inside(2, (0, 0, 0, 0, 40, 20)), "cold")
    group(2, inside(2, (60, 0, 0, 60, 40, 20)), "warm")
    return 3, 2, 1.2 * size


BALLS = """
[[body]]
name = "block"
rho = 1
dirichlet = { cold = 0 }
flux = { warm = 1 }

[[body]]
name = "ball"
rho = 100
""" + "".join(f'\n[[tie]]\nbodies = ["block", "ball.{k}"]\n' for k in range(1, 7))


def write(folder, name, model, bodies, physics, scale, size):
    """The mesh and the scene."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    dimension, order, length = model(size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", length)
    gmsh.option.setNumber("Mesh.MeshSizeMax", length)
    gmsh.model.mesh.generate(dimension)
    gmsh.option.setNumber("Mesh.SecondOrderLinear", 1)
    gmsh.model.mesh.setOrder(order)
    gmsh.write(str(folder / f"{name}.msh"))
    gmsh.finalize()
    head = f'dimension = {dimension}\nphysics = "{physics}"\n\n[mesh]\nfile = "{name}.msh"\nscale = {scale}\n'
    (folder / f"{name}.toml").write_text(head + bodies)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", type=float, default=1.0, help="cells longer by this factor")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    write(arguments.folder, "angle", angle, ANGLE, "elasticity", 1e-3, arguments.size)
    write(arguments.folder, "pin", pin, PIN, "elasticity", 1e-3, arguments.size)
    write(arguments.folder, "balls", balls, BALLS, "scalar", 1, arguments.size)


if __name__ == "__main__":
    main()
