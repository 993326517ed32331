#!/usr/bin/env python3
"""Makes the table of docs/meshes.md: condition numbers of one mesh in a regular partition, in ours and in one of METIS.

    cargo build --example partitions
    scripts/partitions.py [target/debug/examples/partitions] [PETSC OPTIONS]

METIS is the package pymetis of PyPI, or gpmetis of the Debian package metis where pymetis is missing. Its parts are
asked to be connected (METIS_OPTION_CONTIG), as subdomains have to be.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

CASES = [("poisson", 8), ("poisson", 16), ("plane", 8), ("plane", 16), ("tetrahedra", 3), ("tetrahedra", 4),
         ("hexahedra", 3), ("hexahedra", 4)]
PARTS = 64


def metis(graph, scratch):
    """The part of every cell of a graph in METIS's format."""
    try:
        import pymetis
    except ImportError:
        file = Path(scratch) / "graph"
        file.write_text(graph)
        subprocess.run(["gpmetis", "-contig", str(file), str(PARTS)], check=True, stdout=subprocess.DEVNULL)
        return (Path(scratch) / f"graph.part.{PARTS}").read_text()
    lines = graph.splitlines()[1:]
    near = [[int(word) - 1 for word in line.split()] for line in lines]
    # From eight parts on this is what METIS itself and gpmetis take.
    options = pymetis.Options(contig=1)
    parts = pymetis.part_graph(PARTS, adjacency=near, recursive=False, options=options)[1]
    return "\n".join(map(str, parts))


def run(program, *args):
    """What the program prints, by its first word."""
    done = subprocess.run([program, *args], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, args))}: {done.stderr}")
    return done.stdout


def value(text, name):
    """The number that follows a word."""
    return next(line.split()[1] for line in text.splitlines() if line.startswith(name))


def main():
    """Prints the table."""
    args = sys.argv[1:]
    program = args.pop(0) if args and not args[0].startswith("-") else "target/debug/examples/partitions"
    print("| problem | H/h | κ regular | κ ours | κ METIS | ours / regular | METIS / regular | iterations |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for problem, n in CASES:
            parts = Path(scratch) / "parts"
            parts.write_text(metis(run(program, problem, str(n), "graph"), scratch))
            texts = [run(program, problem, str(n), which, *args) for which in ("regular", "ours", str(parts))]
            for text in texts:
                if value(text, "pieces") != str(PARTS):
                    sys.exit(f"a part is not connected:\n{text}")
            kappa = [float(value(text, "kappa")) for text in texts]
            ratios = [f"{k / kappa[0]:.2f}" for k in kappa[1:]]
            steps = ", ".join(value(text, "iterations") for text in texts)
            cells = [problem, str(n), *[f"{k:.2f}" for k in kappa], *ratios, steps]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
