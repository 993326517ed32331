#!/usr/bin/env python3
"""Errors of nodal pressures against Hertz's curve where the meshes of both sides differ.

    scripts/pressures.py [PROGRAM] [--space]

A parabolic cylinder (in space: a paraboloid) is pressed on a block of the same material. Meshes are made here, with
edges of given lengths at the contact; the scenes let either side carry the multipliers. Printed is a table: the largest
error and the root mean square over the nodes inside 0.9 of the contact zone, both over the largest pressure, for the
raw pressures of the finer and the coarser side, and for the smoothed ones of the finer side.
"""
import csv, itertools, math, subprocess, sys, tempfile
from pathlib import Path

RADIUS, SIZE, YOUNG, POISSON = 50.0, 10.0, 210e3, 0.3
MODULUS = YOUNG / (2 * (1 - POISSON**2))


def places(h, growth):
    """From 0 to SIZE, with first edges h; the last one is `growth` times as long."""
    n = 4
    while True:
        cubic = (SIZE - h * n) / n**3
        if cubic < 0 or 3 * cubic * n * n / h < growth:
            return [h * s + cubic * s**3 for s in range(n + 1)]
        n += 1


def middles(x):
    return [0.5 * (x[k // 2] + x[(k + 1) // 2]) for k in range(2 * len(x) - 1)]


def write_body(out, name, first, h, order, up, dim, growth):
    """Nodes, cells, the surface C_name at the contact, F_name far from it, and node sets of the planes of symmetry."""
    edges = places(h, growth)
    x = edges if order == 1 else middles(edges)
    n, cells, o = len(x), len(edges) - 1, order
    number = lambda place: first + 1 + sum(k * n**d for d, k in enumerate(place))
    kept = lambda place: order == 1 or sum(k % 2 for k in place) < 2
    out.append("*NODE")
    for place in itertools.product(range(n), repeat=dim):
        if kept(place):
            at = [x[k] for k in place]
            curved = sum(v * v for v in at[:-1]) / (2 * RADIUS) * (1 - at[-1] / SIZE)
            at[-1] = at[-1] + curved if up else -at[-1]
            out.append(", ".join(map(str, [number(place)] + at + [0.0] * (3 - dim))))
    kinds = {(2, 1): "CPE4", (2, 2): "CPE8", (3, 1): "C3D8", (3, 2): "C3D20"}
    out.append(f"*ELEMENT, TYPE={kinds[dim, order]}, ELSET={name}")
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = ring if dim == 2 else [(*c, 0) for c in ring] + [(*c, 1) for c in ring]
    if not up:
        # A mirror image: the other way round.
        corners = [(a, 1 - b) for a, b in ring] if dim == 2 else [(*c, 1) for c in ring] + [(*c, 0) for c in ring]
        if dim == 2:
            corners = [corners[k] for k in (0, 1, 2, 3)]
    pairs = [(k, (k + 1) % 4) for k in range(4)]
    if dim == 3:
        pairs += [(k + 4, (k + 1) % 4 + 4) for k in range(4)] + [(k, k + 4) for k in range(4)]
    for e, cell in enumerate(itertools.product(range(cells), repeat=dim)):
        at = [[o * (c + a) for c, a in zip(cell, corner)] for corner in corners]
        nodes = [number(p) for p in at]
        if order == 2:
            nodes += [number([(s + t) // 2 for s, t in zip(at[a], at[b])]) for a, b in pairs]
        text = ", ".join(map(str, [first + 1 + e] + nodes))
        words = text.split(", ")
        lines = [", ".join(words[k : k + 15]) for k in range(0, len(words), 15)]
        out.append(",\n".join(lines))
    near = {2: ("S3", "S1"), 3: ("S2", "S1")}[dim][up]
    far = {2: ("S1", "S3"), 3: ("S1", "S2")}[dim][up]
    for group, layer, side in (("C", 0, near), ("F", cells - 1, far)):
        out.append(f"*SURFACE, NAME={group}_{name}, TYPE=ELEMENT")
        for e, cell in enumerate(itertools.product(range(cells), repeat=dim)):
            if cell[-1] == layer:
                out.append(f"{first + 1 + e}, {side}")
    for d in range(dim):
        out.append(f"*NSET, NSET={name}_{'XYZ'[d]}")
        wanted = n - 1 if d == dim - 1 else 0
        for place in itertools.product(range(n), repeat=dim):
            if kept(place) and place[d] == wanted:
                out.append(f"{number(place)},")


def hertz(dim, load):
    if dim == 2:
        force = 2 * load * SIZE
        a = math.sqrt(4 * force * RADIUS / (math.pi * MODULUS))
        return a, 2 * force / (math.pi * a)
    force = 4 * load * SIZE**2
    a = (0.75 * force * RADIUS / MODULUS) ** (1 / 3)
    return a, 1.5 * force / (math.pi * a * a)


def errors(path, column, dim, load):
    a, largest = hertz(dim, load)
    found = []
    for row in csv.DictReader(open(path)):
        r = math.hypot(*(float(row[k]) for k in "xy"[: dim - 1]))
        if r < 0.9 * a and row.get(column):
            found.append(abs(float(row[column]) - largest * math.sqrt(1 - (r / a) ** 2)) / largest)
    if not found:
        return "–"
    rms = math.sqrt(sum(e * e for e in found) / len(found))
    return f"{100 * max(found):.1f} / {100 * rms:.1f}"


def run(program, directory, order, up, low, dim, load):
    out = []
    growth = 7
    write_body(out, "UP", 0, up, order, True, dim, growth)
    write_body(out, "LOW", 1_000_000, low, order, False, dim, growth)
    mesh = Path(directory, "hertz.inp")
    mesh.write_text("\n".join(out) + "\n")
    held = lambda name, far: ", ".join(
        f"{name}_{'XYZ'[d]} = {{ {'xyz'[d]} = 0 }}" for d in range(dim) if far or d < dim - 1
    )
    line = []
    for first, second in (("UP", "LOW"), ("LOW", "UP")):
        scene = Path(directory, "hertz.toml")
        scene.write_text(
            f'title = "hertz"\ndimension = {dim}\nphysics = "elasticity"\n[mesh]\nfile = "hertz.inp"\n'
            f'[[body]]\nname = "UP"\nyoung = {YOUNG}\npoisson = {POISSON}\ndirichlet = {{ {held("UP", False)} }}\n'
            f"pressure = {{ F_UP = {load} }}\n"
            f'[[body]]\nname = "LOW"\nyoung = {YOUNG}\npoisson = {POISSON}\ndirichlet = {{ {held("LOW", True)} }}\n'
            f'[[contact]]\nsurfaces = ["C_{first}", "C_{second}"]\n'
        )
        command = [program, "solve", str(scene), "--out", directory, "--quiet", "-fetifeti_ksp_rtol", "1e-9"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
        path = Path(directory, "interfaces.csv")
        columns = ["pressure"] + (["pressure_smoothed"] if (up < low) == (first == "UP") and up != low else [])
        named = path.read_text().split("\n", 1)[0].split(",")
        line.append([errors(path, c, dim, load) for c in columns if c in named])
    finer, coarser = (line[0], line[1]) if up <= low else (line[1], line[0])
    smoothed = finer[1] if len(finer) > 1 else "–"
    print(f"| {'plane' if dim == 2 else 'space'}, order {order} | {up:g} : {low:g} | {finer[0]} | {coarser[0]} "
          f"| {smoothed} |", flush=True)


def main():
    program = next((a for a in sys.argv[1:] if not a.startswith("-")), "target/release/fetifeti")
    dims = [(3, 40.0)] if "--space" in sys.argv else [(2, 250.0)]
    print("| mesh | edges up : low | finer side | coarser side | finer side, smoothed |")
    print("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as directory:
        for dim, load in dims:
            for order in (1, 2):
                h = order * 0.1 if dim == 2 else (0.2, 0.3)[order - 1]
                ratios = ((1, 1), (1, 1.25), (1, 1.5), (1, 2), (1, 3), (1, 4), (0.5, 4), (2, 1), (3, 1), (4, 1))
                if dim == 3:
                    ratios = ((1, 1), (1, 2), (1, 3), (2, 1), (3, 1))[: 5 if order == 1 else 2]
                for up, low in ratios:
                    run(program, directory, order, h * up, h * low, dim, load)


if __name__ == "__main__":
    main()
