#!/usr/bin/env python3
"""Options of PETSc's solvers on a scene, in turns: the table of docs/studies.md, "Options of the peers".

    scripts/peer_options.py PROGRAM SCENE PEER [ROUNDS [RANKS [packed]]] < OPTIONS

PROGRAM is the built fetifeti, PEER a name for --with. Each line of OPTIONS is one set, as a user writes it behind the
prefix of the peer (`pc_gamg_threshold 0.01`); options of no prefix keep their dash, and an empty line is what the
program takes by itself. Every round runs all sets, each in processes of its own. Printed are medians: iterations,
condition number by CG, seconds of set-up and solve, CPU seconds of both on all ranks, megabytes. CPU seconds are those
of the run less those of one that does nothing with the matrix but products; they change less with what else the machine
does than seconds.
"""
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile

LIMIT = 300

NOTHING = "ksp_type preonly pc_type none"


def run(program, job, ranks, options, file):
    """One run: the record that the program leaves, or the first message of an error; and CPU seconds."""
    file.write_text(json.dumps(job))
    record = file.with_suffix(".json")
    record.unlink(missing_ok=True)
    before = os.times()
    command = ["mpirun", "-n", str(ranks), program, "baseline", str(file), *options]
    environment = dict(os.environ, MPIEXEC_TIMEOUT=str(LIMIT), OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    done = subprocess.run(command, env=environment, capture_output=True, text=True, errors="replace")
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    if record.exists():
        return json.loads(record.read_text()), cpu
    errors = [line for line in done.stderr.splitlines() if "rror" in line]
    return (errors or ["no result"])[0][:150], cpu


def options_of(line, peer):
    """The options of a set with the prefix of the peer."""
    words = shlex.split(line)
    prefixed = [f"-{peer}_{word}" if k % 2 == 0 else word for k, word in enumerate(words)]
    return [word.replace(f"-{peer}_-", "-") for word in prefixed]


def main():
    program, scene, peer = sys.argv[1:4]
    rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 3
    ranks = int(sys.argv[5]) if len(sys.argv) > 5 else 2
    packed = "packed" in sys.argv[6:]
    sets = [line.strip() for line in sys.stdin.read().splitlines()]
    results = {line: [] for line in [NOTHING, *sets]}
    with tempfile.TemporaryDirectory() as home:
        file = pathlib.Path(home) / "run.job"
        task = dict(name=peer, rescue=False, separate=packed, active=[], solution=f"{home}/u")
        job = dict(scene=os.path.abspath(scene), rtol=1e-6, inner=0.1, again=False, task=dict(Baseline=task))
        for _ in range(rounds):
            for line in results:
                results[line].append(run(program, job, ranks, options_of(line, peer), file))
                failed = isinstance(results[line][-1][0], str)
                print(scene, line, results[line][-1][0] if failed else "", file=sys.stderr, flush=True)
    base = statistics.median(cpu for _, cpu in results[NOTHING])
    print(f"| {pathlib.Path(scene).stem}, {peer}: options | iterations | κ | set-up | solve | total | CPU | MB |")
    print("|---|---|---|---|---|---|---|---|")
    for line in sets:
        runs = [r for r in results[line] if not isinstance(r[0], str)]
        name = f"`{line}`" if line else "as they are"
        if not runs:
            print(f"| {name} | {results[line][0][0]} |", flush=True)
            continue
        first = runs[0][0]
        median = lambda of: statistics.median(map(of, runs))
        kappa = first.get("kappa")
        row = [
            "" if first.get("iterations") is None else str(first["iterations"]),
            "" if kappa is None else f"{kappa:.1f}",
            f"{median(lambda r: r[0]['setup']):.2f}",
            f"{median(lambda r: r[0]['solve']):.2f}",
            f"{median(lambda r: r[0]['setup'] + r[0]['solve']):.2f}",
            f"{max(0.0, median(lambda r: r[1]) - base):.2f}",
            f"{median(lambda r: r[0]['memory'] / 1e6):.0f}",
        ]
        message = f" {first['message']}" if first.get("message") else ""
        print(f"| {name}{message} | {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
