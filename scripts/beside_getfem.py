#!/usr/bin/python3
"""Solves a Hertz problem of `fetifeti study benchmarks` with GetFEM on the same mesh, and compares the answers.

    fetifeti study benchmarks hertz-cylinder --out out
    scripts/beside_getfem.py out/hertz_cylinder_order1_1.toml [--program target/release/fetifeti]

GetFEM (Debian package python3-getfem) takes its own contact brick for meshes that do not match: nodes of one body
against faces of the other, an augmented Lagrangian, Newton's method; ours are mortar rows, so that answers differ by
what vanishes with the mesh size. Compared are displacements at nodes of both bodies, the force, and the largest force
at a node. Seconds of GetFEM are those of its assembly and Newton's method; ours are those of set-up and solve, and of
the whole process.
"""

import argparse
import contextlib
import json
import os
import re
import struct
import subprocess
import tempfile
import time

import getfem as gf
import numpy as np


def read_mesh(path):
    """Points, and for each group its cells, of a binary file of Gmsh 2.2 as the program writes it."""
    data = open(path, "rb").read()
    names = {}
    start = data.index(b"$PhysicalNames\n") + len(b"$PhysicalNames\n")
    for line in data[start : data.index(b"$EndPhysicalNames")].decode().splitlines()[1:]:
        _, tag, name = line.split(maxsplit=2)
        names[int(tag)] = name.strip('"')
    start = data.index(b"$Nodes\n") + len(b"$Nodes\n")
    end = data.index(b"\n", start)
    n, at = int(data[start:end]), end + 1
    points = np.array([struct.unpack_from("<3d", data, at + 28 * k + 4) for k in range(n)])
    start = data.index(b"$Elements\n", at + 28 * n) + len(b"$Elements\n")
    end = data.index(b"\n", start)
    n, at = int(data[start:end]), end + 1
    nodes_of = {1: 2, 2: 3, 8: 3, 9: 6}
    groups, done = {}, 0
    while done < n:
        kind, count, tags = struct.unpack_from("<3i", data, at)
        at += 12
        size = 1 + tags + nodes_of[kind]
        for _ in range(count):
            row = struct.unpack_from(f"<{size}i", data, at)
            groups.setdefault(names.get(row[1]), []).append([v - 1 for v in row[1 + tags :]])
            at += 4 * size
        done += count
    return points[:, :2], groups


def value(text, key, body=None):
    """The number of a key in a scene, after the name of a body."""
    part = text[text.index(f'name = "{body}"') :] if body else text
    return float(re.search(rf"{key} = ([-+.\deE]+)", part).group(1))


@contextlib.contextmanager
def silence():
    """Without what GetFEM's libraries print."""
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)


class Body:
    """A body as GetFEM sees it."""

    def __init__(self, points, groups, name, young, poisson):
        self.name = name
        self.lame = (young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson)))
        self.mesh = gf.Mesh("empty", 2)
        used = sorted({n for cell in groups[name] for n in cell})
        self.nodes = used
        place = {n: k for k, n in enumerate(used)}
        self.mesh.add_point(points[used].T)
        transformation = gf.GeoTrans("GT_PK(2,1)")
        corners = np.array([[points[n] for n in cell] for cell in groups[name]])
        self.mesh.add_convex(transformation, corners.transpose(2, 1, 0))
        self.points = points[used]
        assert self.mesh.nbpts() == len(place)

    def region(self, number, edges, points):
        """The faces of cells that are these edges."""
        wanted = {frozenset(self.mesh.pid_from_coords(points[edge].T).tolist()) for edge in edges}
        outer = self.mesh.outer_faces()
        faces = [
            f for f in outer.T if frozenset(self.mesh.pid_in_faces(np.array([[f[0]], [f[1]]])).tolist()) in wanted
        ]
        assert len(faces) == len(edges), (self.name, number, len(faces), len(edges))
        self.mesh.set_region(number, np.array(faces).T)


def getfem(points, groups, text):
    """Displacements at the nodes of both bodies, the force, the largest force at a node, and seconds."""
    carrier = re.search(r'surfaces = \["(\w+)_contact"', text).group(1)
    names = (carrier, "lower" if carrier == "upper" else "upper")
    bodies = [Body(points, groups, name, value(text, "young", name), value(text, "poisson", name)) for name in names]
    clock = time.time()
    model = gf.Model("real")
    for body in bodies:
        body.region(1, groups[f"{body.name}_contact"], points)
        body.region(2, groups[f"{body.name}_axis"], points)
        body.region(3, groups["load" if body.name == "upper" else "foot"], points)
        body.fem = gf.MeshFem(body.mesh, 2)
        body.fem.set_fem(gf.Fem("FEM_PK(2,1)"))
        body.im = gf.MeshIm(body.mesh, gf.Integ("IM_TRIANGLE(6)"))
        model.add_fem_variable(body.name, body.fem)
        model.add_initialized_data(f"l{body.name}", body.lame[0])
        model.add_initialized_data(f"m{body.name}", body.lame[1])
        model.add_isotropic_linearized_elasticity_brick(body.im, body.name, f"l{body.name}", f"m{body.name}")
        model.add_normal_Dirichlet_condition_with_multipliers(body.im, body.name, 1, 2)
    upper, lower = sorted(bodies, key=lambda body: body.name, reverse=True)
    model.add_normal_Dirichlet_condition_with_multipliers(lower.im, "lower", 1, 3)
    model.add_initialized_data("load", [0.0, -value(text, "load")])
    model.add_source_term_brick(upper.im, "upper", "load", 3)
    # The nodes of the body that carries our multipliers against the faces of the other one.
    model.add_initialized_data("r", value(text, "young", "lower"))
    model.add_nodal_contact_between_nonmatching_meshes_brick(
        bodies[0].im, bodies[1].im, names[0], names[1], "p", "r", 1, 1, True, False, 1
    )
    with silence():
        model.solve("max_iter", 200, "max_res", 1e-11, "lsolver", "mumps")
    seconds = time.time() - clock
    found = {}
    for body in bodies:
        u = model.variable(body.name).reshape(-1, 2)
        at = body.fem.basic_dof_nodes()[:, ::2].T
        found[body.name] = {tuple(np.round(p, 9)): v for p, v in zip(at, u)}
    forces = -model.variable("p")
    return found, 2 * forces.sum(), forces.max(), seconds


def ours(program, scene, text, nodes):
    """The same of our program, by probes at nodes."""
    with tempfile.TemporaryDirectory() as work:
        mesh = re.search(r'file = "(.*)"', text).group(1)
        path = os.path.abspath(os.path.join(os.path.dirname(scene), mesh))
        text = text.replace(f'"{mesh}"', f'"{path}"')
        for k, (body, p) in enumerate(nodes):
            text += f'\n[[probe]]\nname = "{k}"\npoint = [{p[0]!r}, {p[1]!r}]\nbody = "{body}"\n'
        probed = os.path.join(work, "scene.toml")
        with open(probed, "w", encoding="utf-8") as file:
            file.write(text)
        report = os.path.join(work, "report.json")
        clock = time.time()
        subprocess.run([program, "solve", probed, "--quiet", "--json", report], check=True)
        seconds = time.time() - clock
        with open(report, encoding="utf-8") as file:
            return json.load(file), seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("--program", default="target/release/fetifeti")
    args = parser.parse_args()
    with open(args.scene, encoding="utf-8") as file:
        text = file.read()
    mesh = re.search(r'file = "(.*)"', text).group(1)
    points, groups = read_mesh(os.path.join(os.path.dirname(args.scene), mesh))
    theirs, force, peak, seconds = getfem(points, groups, text)
    rng = np.random.default_rng(1)
    nodes = []
    for body in ("upper", "lower"):
        used = sorted({n for cell in groups[body] for n in cell})
        chosen = rng.choice(used, size=min(200, len(used)), replace=False)
        nodes += [(body, points[n].tolist()) for n in sorted(chosen)]
    report, whole = ours(args.program, args.scene, text, nodes)
    largest = max(np.abs(v).max() for found in theirs.values() for v in found.values())
    away = []
    for (body, p), probe in zip(nodes, report["probes"]):
        u = np.array(probe["u"][:2])
        away.append(np.abs(u - theirs[body][tuple(np.round(p, 9))]).max() / largest)
    contact = report["contact"]["interfaces"][0]
    took = report["seconds"]
    print("| | GetFEM | ours | difference |\n|---|---|---|---|")
    print(f"| unknowns | {report['dofs']} | {report['dofs']} | |")
    print(f"| displacements at {len(nodes)} nodes | | | {max(away):.1e} of the largest |")
    mine = abs(2 * contact["resultant"][1])
    print(f"| force | {force:.6g} | {mine:.6g} | {mine / force - 1:.1e} |")
    mine = contact["max_multiplier"]
    print(f"| largest force at a node | {peak:.6g} | {mine:.6g} | {mine / peak - 1:.1e} |")
    print(f"| seconds | {seconds:.2f} | {took['setup'] + took['solve']:.2f} ({whole:.2f} the process) | |")


if __name__ == "__main__":
    main()
