"""A wall of bricks with an opening under a lintel: quadrilaterals and triangles of first order, lengths in millimetres.

Bricks have no common nodes, so that each part of the group `bricks` becomes a body of its own.
"""
import gmsh

LENGTH, HEIGHT, COURSES, COLUMNS = 240.0, 80.0, 10, 8
OPENING = (3 * LENGTH, 5 * LENGTH, 5)  # from x, to x, courses high
LINTEL = (2 * LENGTH, 6 * LENGTH)

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geo = gmsh.model.geo
sides = {"base": [], "top": [], "left": [], "right": [], "reveal": []}
groups = {"bricks": [], "lintel": []}


def brick(x0, x1, course, name):
    y0, y1 = course * HEIGHT, (course + 1) * HEIGHT
    points = [geo.addPoint(x, y, 0) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    lines = [geo.addLine(points[k], points[(k + 1) % 4]) for k in range(4)]
    for line, length in zip(lines, (x1 - x0, HEIGHT) * 2):
        geo.mesh.setTransfiniteCurve(line, round(length / 20) + 1)
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.mesh.setTransfiniteSurface(surface)
    if name == "bricks":
        geo.mesh.setRecombine(2, surface)
    groups[name].append(surface)
    for side, line, there in (
        ("base", lines[0], course == 0),
        ("top", lines[2], course == COURSES - 1),
        ("left", lines[3], x0 == 0),
        ("right", lines[1], x1 == COLUMNS * LENGTH),
        ("reveal", lines[1], course < OPENING[2] and x1 == OPENING[0]),
        ("reveal", lines[3], course < OPENING[2] and x0 == OPENING[1]),
    ):
        if there:
            sides[side].append(line)


for course in range(COURSES):
    shift = LENGTH / 2 * (course % 2)
    holes = []
    if course < OPENING[2]:
        holes = [OPENING[:2]]
    if course == OPENING[2]:
        holes = [LINTEL]
        brick(*LINTEL, course, "lintel")
    cuts = {0.0, COLUMNS * LENGTH} | {shift + k * LENGTH for k in range(COLUMNS)} | {x for hole in holes for x in hole}
    cuts = sorted(cuts)
    for x0, x1 in zip(cuts, cuts[1:]):
        if not any(a <= x0 and x1 <= b for a, b in holes):
            brick(x0, x1, course, "bricks")

geo.synchronize()
for name, surfaces in groups.items():
    gmsh.model.addPhysicalGroup(2, surfaces, name=name)
for name, lines in sides.items():
    gmsh.model.addPhysicalGroup(1, lines, name=name)
gmsh.model.mesh.generate(2)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("wall_lintel.msh")
