"""A sector of a roller bearing: wedges of first order, lengths in millimetres.

Nodes of raceway and roller lie on common rays from the axis of the bearing. Rollers have no common nodes, so that each
part of the group `rollers` becomes a body of its own.
"""
import math

import gmsh

BORE, INNER, OUTER, OUTSIDE = 25.0, 31.0, 41.0, 47.0  # radii
PITCH, ROLLER = 36.0, 5.0
PLACES, HALF, THICKNESS, LAYERS = (-36, -18, 0, 18, 36), 50, 1.0, 1  # degrees from the lowest point

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geo = gmsh.model.geo


def at(radius, degrees, size):
    angle = math.radians(degrees - 90)
    return geo.addPoint(radius * math.cos(angle), radius * math.sin(angle), 0, size)


def polygon(points):
    lines = [geo.addLine(a, b) for a, b in zip(points, points[1:])]
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    return lines


OFFSETS = [0.1 * k + 0.025 * k * k for k in range(10)]  # degrees: fine near the line of contact
OFFSETS = [-a for a in reversed(OFFSETS[1:])] + OFFSETS
RACE = {float(a) for a in range(-HALF, HALF + 1, 2) if all(abs(a - place) >= 3.2 for place in PLACES)}
RACE = sorted(RACE | {place + offset for place in PLACES for offset in OFFSETS})


def ring(raceway, back, name):
    race = [at(raceway, a, 0.5) for a in RACE]
    ends = [at(back, a, 2.0) for a in (-HALF, HALF)]
    centre = geo.addPoint(0, 0, 0)
    front = polygon(race)
    a, b = geo.addLine(race[-1], ends[1]), geo.addLine(ends[0], race[0])
    arc = geo.addCircleArc(ends[1], centre, ends[0])
    return geo.addPlaneSurface([geo.addCurveLoop(front + [a, arc, b])]), front, [arc]


def roller(place):
    points = []
    for sign, order in ((1, 1), (-1, -1)):  # the side of the outer ring, then that of the inner one
        for offset in OFFSETS[::order]:
            cosine = math.cos(math.radians(offset))
            radius = PITCH * cosine + sign * math.sqrt(ROLLER**2 - PITCH**2 * (1 - cosine**2))
            points.append(at(radius, place + offset, 0.5))
    centre, n = at(PITCH, place, 1), len(OFFSETS)
    outer, inner = polygon(points[:n]), polygon(points[n:])
    flanks = []
    for a, b, side in ((n - 1, n, 1), (2 * n - 1, 0, -1)):
        angle = math.radians(place - 90)
        x = PITCH * math.cos(angle) - side * ROLLER * math.sin(angle)
        y = PITCH * math.sin(angle) + side * ROLLER * math.cos(angle)
        middle = geo.addPoint(x, y, 0, 1)
        flanks.append([geo.addCircleArc(points[a], centre, middle), geo.addCircleArc(middle, centre, points[b])])
    surface = geo.addPlaneSurface([geo.addCurveLoop(outer + flanks[0] + inner + flanks[1])])
    return surface, outer, inner, flanks[0] + flanks[1]


def extruded(surface, lines_of):
    """The volume over a surface, its two ends, and for every group the faces over its lines."""
    made = geo.extrude([(2, surface)], 0, 0, THICKNESS, numElements=[LAYERS], recombine=True)
    geo.synchronize()
    of = {}
    for dim, face in made[2:]:
        for _, line in gmsh.model.getBoundary([(2, face)], oriented=False):
            of.setdefault(line, face)
    return made[1][1], [surface, made[0][1]], [[of[line] for line in lines] for lines in lines_of]


cells = {"inner": [], "outer": [], "rollers": []}
names = ("bore", "seat", "inner_race", "outer_race", "roller_inner", "roller_outer", "cage", "middle")
faces = {name: [] for name in names}
for name, raceway, back, race_name, back_name in (
    ("inner", INNER, BORE, "inner_race", "bore"),
    ("outer", OUTER, OUTSIDE, "outer_race", "seat"),
):
    surface, race, arc = ring(raceway, back, name)
    volume, ends, (race, arc) = extruded(surface, (race, arc))
    cells[name].append(volume)
    faces["middle"] += ends[:1]
    faces[race_name] += race
    faces[back_name] += arc
for place in PLACES:
    surface, *lines = roller(place)
    volume, ends, (outer, inner, flanks) = extruded(surface, lines)
    cells["rollers"].append(volume)
    faces["middle"] += ends[:1]
    faces["roller_outer"] += outer
    faces["roller_inner"] += inner
    faces["cage"] += flanks
for name, volumes in cells.items():
    gmsh.model.addPhysicalGroup(3, volumes, name=name)
for name, tags in faces.items():
    gmsh.model.addPhysicalGroup(2, tags, name=name)
gmsh.option.setNumber("Mesh.MeshSizeMax", 2.0)
gmsh.model.mesh.generate(3)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)  # half as long as 4.1
gmsh.write("roller_bearing.msh")
