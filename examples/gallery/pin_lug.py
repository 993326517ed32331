"""A pin in a lug: quadrilaterals of second order, lengths in millimetres. Nodes of pin and hole lie at equal angles."""
import math

import gmsh

PIN, HOLE, BORE, WIDTH, LENGTH = 20.0, 20.05, 8.0, 45.0, 130.0
ARCS, PER_ARC = 8, 8

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
geo = gmsh.model.geo
centre = geo.addPoint(0, 0, 0)


def circle(radius):
    angles = [2 * math.pi * k / ARCS for k in range(ARCS)]
    points = [geo.addPoint(radius * math.cos(a), radius * math.sin(a), 0) for a in angles]
    arcs = [geo.addCircleArc(points[k], centre, points[(k + 1) % ARCS]) for k in range(ARCS)]
    for arc in arcs:
        geo.mesh.setTransfiniteCurve(arc, PER_ARC + 1)
    return points, arcs


def ring(inner, outer, layers, ratio):
    spokes = [geo.addLine(a, b) for a, b in zip(inner[0], outer[0])]
    surfaces = []
    for spoke in spokes:
        geo.mesh.setTransfiniteCurve(spoke, layers + 1, "Progression", ratio)
    for k in range(ARCS):
        loop = geo.addCurveLoop([spokes[k], outer[1][k], -spokes[(k + 1) % ARCS], -inner[1][k]])
        surface = geo.addPlaneSurface([loop])
        geo.mesh.setTransfiniteSurface(surface)
        geo.mesh.setRecombine(2, surface)
        surfaces.append(surface)
    return surfaces


bore, pin, hole, middle = circle(BORE), circle(PIN), circle(HOLE), circle(30.0)
pin_cells = ring(bore, pin, 5, 0.8)
lug_cells = ring(hole, middle, 5, 1.2)
# The eye is round on the left and goes over into a shank on the right.
far = [geo.addPoint(x, y, 0, 7.0) for x, y in ((0, -WIDTH), (LENGTH, -WIDTH), (LENGTH, WIDTH), (0, WIDTH), (-WIDTH, 0))]
edges = [geo.addLine(far[0], far[1]), geo.addLine(far[1], far[2]), geo.addLine(far[2], far[3])]
edges += [geo.addCircleArc(far[3], centre, far[4]), geo.addCircleArc(far[4], centre, far[0])]
rest = geo.addPlaneSurface([geo.addCurveLoop(edges), geo.addCurveLoop(middle[1])])
geo.mesh.setRecombine(2, rest)
geo.synchronize()
gmsh.option.setNumber("Mesh.MeshSizeMax", 7)
gmsh.option.setNumber("Mesh.Algorithm", 8)
gmsh.model.addPhysicalGroup(2, pin_cells, name="pin")
gmsh.model.addPhysicalGroup(2, lug_cells + [rest], name="lug")
gmsh.model.addPhysicalGroup(1, bore[1], name="bore")
gmsh.model.addPhysicalGroup(1, pin[1], name="pin_outside")
gmsh.model.addPhysicalGroup(1, hole[1], name="hole_inside")
gmsh.model.addPhysicalGroup(1, [edges[1]], name="end")
gmsh.model.mesh.generate(2)
gmsh.model.mesh.setOrder(2)
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("pin_lug.msh")
