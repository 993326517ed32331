#!/usr/bin/env python3
"""Makes the table "Beside the solvers of PETSc" of docs/embedding.md: the plug-in, PCBDDC, GAMG and BoomerAMG on the
same subdomains, in turns.

    scripts/yardstick.py LIBRARY [--rounds 5] [--ranks 2] [--case WORD] [--rtol 1e-8] [--quick]

LIBRARY is the full path of libfetifeti.so; PETSc is the one that pkg-config finds, which must be that of the library.
METIS's header is Debian's libmetis-dev. PCBDDC has many good choices: those of PCBDDC below run once, and the fastest
that reaches the tolerance runs in the rounds. Before PETSc 3.21 PCBDDC takes one subdomain for each rank, so it gets
the sum of the rank's subdomains, and this library gets them by its C API. Shown are medians; seconds are wall-clock
seconds, and ± is half of the range of the total. --quick takes small problems, to try the script.
"""

import argparse
import os
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Name, options of tests/plugin/yardstick.c.
CASES = [
    ("elastic cube of 24³ × 6 tetrahedra, 216 boxes", "-elastic -n 24,24,24 -box 6,6,6"),
    ("elastic cube of 40³ × 6 tetrahedra, 512 boxes", "-elastic -n 40,40,40 -box 8,8,8"),
    ("Poisson, 1,024² squares, 256 boxes of 64²", "-n 1024,1024 -box 16,16"),
    ("the same, nothing equal", "-n 1024,1024 -box 16,16 -shake 0.5 -vary 1"),
    ("elastic, 32³ × 6 moved tetrahedra, 128 parts of METIS", "-elastic -n 32,32,32 -shake 0.3 -vary 1 -metis 128"),
    ("the same in 32 parts", "-elastic -n 32,32,32 -shake 0.3 -vary 1 -metis 32"),
    ("the same in 16 parts", "-elastic -n 32,32,32 -shake 0.3 -vary 1 -metis 16"),
]
SMALL = [
    ("elastic cube of 8³ × 6 tetrahedra, 8 boxes", "-elastic -n 8,8,8 -box 2,2,2"),
    ("Poisson, 64² squares, 16 boxes", "-n 64,64 -box 4,4"),
    ("elastic, 8³ × 6 moved tetrahedra, 4 parts of METIS", "-elastic -n 8,8,8 -shake 0.3 -vary 1 -metis 4"),
]

# What PCBDDC has to offer. Vertices and edges are its default. It picks vertices that hold the subdomains itself where
# each rank has one; where a rank has several, the program names them, or averages become unknowns (a change of basis,
# which fills the matrices of large subdomains: it comes last, so that it is broken off soon).
SCALED = "-pc_is_use_stiffness_scaling"
BASIS = "-pc_bddc_use_change_of_basis"
PRIMAL = {
    "scalar": ["", "-pc_bddc_use_faces"],
    "elastic": ["-corners", "-corners -pc_bddc_use_faces -pc_bddc_use_edges 0", "-corners -pc_bddc_use_faces", BASIS],
}
DELUXE = "-pc_bddc_use_deluxe_scaling"


def local(package, kind):
    """The options by which PCBDDC solves its local problems with a package."""
    sides = ("dirichlet", "neumann")
    return " ".join(f"-pc_bddc_{s}_pc_type {kind} -pc_bddc_{s}_pc_factor_mat_solver_type {package}" for s in sides)


def petsc(*asked):
    """What pkg-config says about PETSc."""
    return subprocess.run(["pkg-config", *asked, "PETSc"], check=True, capture_output=True, text=True).stdout.strip()


class Runs:
    """The program, built in a folder of its own, and how it is started."""

    def __init__(self, library, ranks, rtol, folder):
        self.ranks, self.rtol, self.folder = ranks, rtol, Path(folder)
        for name in ("libfetifeti.so", "libfetifeti.so.0"):
            (self.folder / name).symlink_to(library.resolve())
        config = shlex.split(petsc("--cflags", "--libs"))
        subprocess.run(
            ["mpicc", "-O2", "-DWITH_METIS", ROOT / "tests/plugin/yardstick.c", "-o", self.folder / "yardstick",
             "-Wno-unused-function", f"-I{ROOT}/wrappers", *config, f"-L{folder}", "-lfetifeti",
             f"-Wl,-rpath,{folder}", "-lmetis", "-lm"], check=True)
        self.version = petsc("--modversion")
        self.separate = tuple(map(int, self.version.split(".")[:2])) >= (3, 21)
        header = Path(petsc("--variable=includedir")) / "petscconf.h"
        text = header.read_text() if header.exists() else ""
        self.has = {p for p in ("HYPRE", "SUITESPARSE", "MUMPS") if re.search(rf"#define PETSC_HAVE_{p} ", text)}

    def run(self, case, method, limit=3600):
        """One run of at most `limit` seconds: what the program prints, or the reason why it prints nothing."""
        command = ["mpirun", "-n", str(self.ranks), self.folder / "yardstick", *shlex.split(case), *shlex.split(method)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"reason": f"more than {limit:.0f} s"}
        line = next((l for l in done.stdout.splitlines() if l.startswith("unknowns ")), None)
        if line is None:
            errors = [l.split("ERROR: ")[1] for l in (done.stderr + done.stdout).splitlines() if "ERROR: " in l]
            errors = [e for e in errors if not e.startswith("---")]
            return {"reason": errors[0] if errors else f"exit code {done.returncode}"}
        words = line.split()
        values = dict(zip(words[::2], words[1::2]))
        reason = values.pop("reason")
        numbers = {name: float(value) for name, value in values.items()}
        return {"reason": reason, "total": numbers["setup"] + numbers["solve"], **numbers}

    def good(self, result):
        """Whether a run has reached the tolerance, with a margin for a residual that was computed by recursion."""
        return "residual" in result and result["residual"] <= 3 * self.rtol

    def ours(self):
        """How this library gets the problem, and its tolerance."""
        if self.separate:
            return f"-operator matis -ksp_type fetifeti -ksp_rtol {self.rtol}"
        # The C API's tolerance is that of the jumps between subdomains.
        return f"-operator capi -fetifeti_ksp_rtol {self.rtol / 10}"

    def bddc(self, case):
        """All choices of PCBDDC for a case."""
        operator = "matis" if self.separate else "merged"
        base = f"-operator {operator} -pc_type bddc -ksp_rtol {self.rtol}"
        if "MUMPS" in self.has:  # PETSc's own factor of the coarse problem takes ten times as long
            base += " -pc_bddc_coarse_pc_type cholesky -pc_bddc_coarse_pc_factor_mat_solver_type mumps"
        solver = local("cholmod", "cholesky") if "SUITESPARSE" in self.has else ""
        kind = "elastic" if "-elastic" in case else "scalar"
        for primal in PRIMAL[kind]:
            yield f"{base} {SCALED} {primal} {solver}"
        if "MUMPS" in self.has:
            yield f"{base} {SCALED} {PRIMAL[kind][1]} {local('mumps', 'cholesky')}"
            yield f"{base} {DELUXE} {PRIMAL[kind][1]} {solver}"
        if kind == "elastic":
            yield f"{base} {SCALED} {PRIMAL[kind][2]} {solver} -motions 0"

    def others(self, case):
        """The multigrid methods on the assembled matrix."""
        base = f"-operator aij -ksp_rtol {self.rtol}"
        yield "GAMG", f"{base} -pc_type gamg"
        if "HYPRE" in self.has:
            # hypre's advice for problems in space; 0.25 is its default.
            space = re.search(r"-n \d+,\d+,\d+", case)
            more = " -pc_hypre_boomeramg_strong_threshold 0.5" if space else ""
            yield "BoomerAMG", f"{base} -pc_type hypre{more}"


def best_bddc(runs, case):
    """The fastest choice of PCBDDC, and how many of them reached the tolerance; slow ones are broken off."""
    choices = list(runs.bddc(case))
    results, limit = [], 600
    for choice in choices:
        result = runs.run(case, choice, limit)
        results.append((result, choice))
        if runs.good(result):
            limit = min(limit, 10 + 3 * result["total"])
        seconds = f"{result['total']:.2f} s, {result['iterations']:.0f}" if runs.good(result) else result["reason"]
        print(f"    {seconds}: {choice}", file=sys.stderr)
    right = [(result["total"], choice) for result, choice in results if runs.good(result)]
    return (min(right)[1] if right else None), len(right), len(choices)


def row(case, name, results):
    """A row of the table from the results of the rounds."""
    bad = next((r["reason"] for r in results if "residual" not in r), None)
    if bad:
        return f"| {case} | {name} | {bad} | | | | | | |"
    median = {k: statistics.median(r[k] for r in results) for k in results[0] if k != "reason"}
    totals = [r["total"] for r in results]
    kappa = f"{median['kappa']:.1f}" if median["kappa"] else ""
    return (f"| {case} | {name} | {median['iterations']:.0f} | {kappa} | {median['setup']:.2f} | {median['solve']:.2f} "
            f"| {median['total']:.2f} ± {(max(totals) - min(totals)) / 2:.2f} | {median['megabytes']:,.0f} "
            f"| {median['residual']:.0e} |")


def main():
    """The table, on standard output, and the options below it; progress on standard error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--rtol", type=float, default=1e-8)
    parser.add_argument("--case", default="")
    parser.add_argument("--quick", action="store_true")
    args = parser.parse_args()
    if not args.library.exists():
        sys.exit(f"{args.library}: there is no such library; expected the full path of libfetifeti.so")
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(args.library, args.ranks, args.rtol, folder)
        print(f"PETSc {runs.version}, {args.ranks} ranks, ‖b − A u‖ ≤ {args.rtol:g} ‖b‖, medians of {args.rounds}\n")
        print("| case | method | iterations | κ | set-up, s | solve, s | total, s | MB | residual |")
        print("|---|---|---|---|---|---|---|---|---|")
        options = []
        for case, flags in SMALL if args.quick else CASES:
            if args.case not in case:
                continue
            print(f"{case} ...", file=sys.stderr)
            bddc, right, all_of = best_bddc(runs, flags)
            methods = [("FETI-FETI", runs.ours())]
            if bddc:
                methods.append((f"PCBDDC, best of {all_of}", bddc))
            methods += runs.others(flags)
            results = {name: [] for name, _ in methods}
            for _ in range(args.rounds):
                for name, method in methods:
                    results[name].append(runs.run(flags, method))
            for name, method in methods:
                print(row(case, name, results[name]), flush=True)
                options.append((case, name, f"{flags} {method}"))
            if not bddc:
                print(f"| {case} | PCBDDC | none of {all_of} choices reaches the tolerance | | | | | | |", flush=True)
            else:
                print(f"    PCBDDC: {right} of {all_of} choices reach the tolerance", file=sys.stderr)
        print("\nOptions of `yardstick`, built from `tests/plugin/yardstick.c`:\n")
        for case, name, method in options:
            print(f"- {case}, {name}: `{' '.join(method.split())}`")


if __name__ == "__main__":
    main()
