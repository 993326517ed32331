"""The stem of an artificial hip in a femur: tetrahedra of second order, lengths in millimetres. Both share nodes."""
import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
# The shaft of the bone, wider towards the hip, and what remains of its head.
bone = [(3, occ.addCylinder(0, 0, -160, 0, 0, 90, 14)), (3, occ.addCone(0, 0, -70, 0, 0, 70, 14, 24))]
bone += [(3, occ.addSphere(-14, 0, -14, 17))]
bone, _ = occ.fuse(bone[:1], bone[1:])
above = occ.addBox(-100, -100, 0, 200, 200, 100)
bone, _ = occ.cut(bone, [(3, above)])
# The stem, a neck and the ball.
stem = [(3, occ.addCone(0, 0, -110, 0, 0, 114, 5, 10)), (3, occ.addCone(0, 0, 0, 30, 0, 36, 8, 6.5))]
stem += [(3, occ.addSphere(30, 0, 36, 14))]
stem, _ = occ.fuse(stem[:1], stem[1:])
out, parts = occ.fragment(bone, stem)
stem = [tag for _, tag in parts[1]]
bone = [tag for _, tag in parts[0] if tag not in stem]
occ.synchronize()
faces = gmsh.model.getEntities(2)
ball = [t for _, t in faces if gmsh.model.getType(2, t) == "Sphere" and occ.getCenterOfMass(2, t)[0] > 15]
distal = [t for _, t in faces if abs(occ.getCenterOfMass(2, t)[2] + 160) < 1e-6]
assert ball and distal, (ball, distal)
gmsh.model.addPhysicalGroup(3, bone, name="bone")
gmsh.model.addPhysicalGroup(3, stem, name="stem")
gmsh.model.addPhysicalGroup(2, ball, name="ball")
gmsh.model.addPhysicalGroup(2, distal, name="distal")
gmsh.option.setNumber("Mesh.MeshSizeMax", 9)
gmsh.option.setNumber("Mesh.MeshSizeMin", 5)
gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 10)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.optimize("Netgen")
gmsh.model.mesh.setOrder(2)
gmsh.model.mesh.optimize("HighOrder")
gmsh.option.setNumber("Mesh.Binary", 1)
gmsh.write("hip_stem.msh")
