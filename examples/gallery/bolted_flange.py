"""A quarter of a flanged joint with four bolts: hexahedra of second order, lengths in millimetres."""
import math

import gmsh

BORE, PIPE, FLANGE, BOLTS = 50.0, 60.0, 110.0, 85.0  # radii of the pipe, the flange and the circle of bolts
CORE, SHANK, HOLE, HEAD = 4.0, 8.0, 9.0, 14.0
ARC = 2  # cells on a quarter of the hole
THICK, HEIGHT, NECK = 20.0, 10.0, 40.0  # of a flange, of the head of a bolt, of the pipe beyond the flange

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ


def quarter(inner, outer):
    big, small = (occ.addDisk(0, 0, 0, r, r) for r in (outer, inner))
    ring = occ.cut([(2, big)], [(2, small)])[0]
    return occ.intersect(ring, [(2, occ.addRectangle(0, 0, 0, 2 * outer, 2 * outer))])[0]


axis = BOLTS / math.sqrt(2)
center = (axis, axis, -THICK - NECK)
discs = [(2, occ.addDisk(axis, axis, 0, r, r)) for r in (HEAD, HOLE, SHANK)]
plates = quarter(BORE, PIPE) + quarter(PIPE, FLANGE)
# The bolt and the rings around it are blocks: free meshes of thin rings fold, those of small discs have flat corners.
corners, cuts = [], []
for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1)):
    ends = [occ.addPoint(axis + r * dx, axis + r * dy, 0) for r in (CORE, HEAD)]
    corners.append(ends[0])
    cuts.append((1, occ.addLine(*ends)))
cuts += [(1, occ.addLine(corners[k - 1], corners[k])) for k in range(4)]
plane = [face for face in occ.fragment(plates, discs + cuts)[0] if face[0] == 2]
occ.translate(plane, 0, 0, -THICK - NECK)
levels = [-THICK - NECK, -THICK - HEIGHT, -THICK, 0, THICK, THICK + HEIGHT, THICK + NECK]
layers = [2, 1, 2, 2, 1, 2]
floor = [tag for _, tag in plane]
occ.synchronize()
blocks = {"core": 2 * CORE**2, "shank": math.pi / 4 * SHANK**2 - CORE**2 / 2}
for name, r, inner in (("clearance", HOLE, SHANK), ("ring", HEAD, HOLE)):
    blocks[name] = math.pi / 4 * (r**2 - inner**2)
for tag in floor:
    if any(abs(occ.getMass(2, tag) / area - 1) < 1e-6 for area in blocks.values()):
        for _, line in gmsh.model.getBoundary([(2, tag)], oriented=False):
            xy = [gmsh.model.getValue(0, end, []) for _, end in gmsh.model.getBoundary([(1, line)])]
            across = abs(math.dist(xy[0], center) - math.dist(xy[1], center)) > 1e-6
            gmsh.model.mesh.setTransfiniteCurve(line, 2 if across else 1 + ARC)
        gmsh.model.mesh.setTransfiniteSurface(tag)
for low, high, count in zip(levels, levels[1:], layers):
    made = occ.extrude([(2, tag) for tag in floor], 0, 0, high - low, numElements=[count], recombine=True)
    floor = [made[k - 1][1] for k, (dim, _) in enumerate(made) if dim == 3]
occ.synchronize()


def zone(tag):
    """The part of the plane in which a volume lies, and its middle height."""
    x, y, z = occ.getCenterOfMass(3, tag)
    faces = gmsh.model.getBoundary([(3, tag)], oriented=False)
    low = min(faces, key=lambda face: occ.getCenterOfMass(*face)[2])
    area = occ.getMass(*low)
    kinds = {
        "pipe": math.pi / 4 * (PIPE**2 - BORE**2),
        **blocks,
    }
    name = next((name for name, size in kinds.items() if abs(area / size - 1) < 1e-6), "plate")
    return name, z


cells = {"upper": [], "lower": [], "bolt": []}
for _, tag in gmsh.model.getEntities(3):
    where, z = zone(tag)
    bolt = where in ("core", "shank") and abs(z) < THICK + HEIGHT
    bolt |= where in ("clearance", "ring") and THICK < abs(z) < THICK + HEIGHT
    flange = where == "pipe" or where in ("plate", "ring") and abs(z) < THICK
    if bolt:
        cells["bolt"].append(tag)
    elif flange:
        cells["upper" if z > 0 else "lower"].append(tag)

sides = {}
for name, tags in cells.items():
    sides[name] = {tag for _, tag in gmsh.model.getBoundary([(3, v) for v in tags], oriented=False)}
radius = lambda c: math.hypot(c[0], c[1])
groups = {name: [] for name in ("joint", "under_head", "under_nut", "foot", "end", "cut_x", "cut_y", "bore")}
for tag in sorted(set().union(*sides.values())):
    box = gmsh.model.getBoundingBox(2, tag)
    flat = lambda k, value: abs(box[k] - value) < 1e-3 and abs(box[k + 3] - value) < 1e-3
    shared = [name for name in sides if tag in sides[name]]
    if flat(2, 0) and shared == ["upper", "lower"]:
        groups["joint"].append(tag)
    elif flat(2, THICK) and len(shared) == 2:
        groups["under_head"].append(tag)
    elif flat(2, -THICK) and len(shared) == 2:
        groups["under_nut"].append(tag)
    elif flat(2, levels[0]):
        groups["foot"].append(tag)
    elif flat(2, levels[-1]):
        groups["end"].append(tag)
    elif flat(0, 0):
        groups["cut_x"].append(tag)
    elif flat(1, 0):
        groups["cut_y"].append(tag)
    elif max(abs(box[3] - BORE), abs(box[4] - BORE)) < 1e-3:
        groups["bore"].append(tag)
for name, tags in cells.items():
    gmsh.model.addPhysicalGroup(3, tags, name=name)
for name, tags in groups.items():
    assert tags, name
    gmsh.model.addPhysicalGroup(2, tags, name=name)
gmsh.option.setNumber("Mesh.MeshSizeMax", 12)
gmsh.option.setNumber("Mesh.MeshSizeMin", 5)
gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 10)
gmsh.option.setNumber("Mesh.RecombineAll", 1)
gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 3)  # quadrilaterals only
gmsh.option.setNumber("Mesh.Algorithm", 8)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(2)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("bolted_flange.msh")
