#!/usr/bin/env python3
"""Solves scenes with meshes with more and with fewer subdomains than the program takes by itself.

    scripts/subdomains.py FETIFETI [--rounds 3] [--factors 2,1,0.7,0.5] SCENE...

A factor multiplies the number of subdomains in each body. The runs of a round come in a random order; shown are medians
of set-up, solve and their sum in seconds.
"""

import argparse
import random
import statistics
import tempfile
from pathlib import Path

from choices import bodies, solve, with_subdomains


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--factors", default="2,1,0.7,0.5")
    arguments = parser.parse_args()
    random.seed(1)
    print("| scene | factor | subdomains | iterations | MB | set-up | solve | sum |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for scene in arguments.scenes:
            counts = bodies(arguments.program, scene)
            factors = [float(f) for f in arguments.factors.split(",")]
            files = [(f, with_subdomains(scene, counts, f, folder)) for f in factors]
            runs = {f: [] for f in factors}
            for _ in range(arguments.rounds):
                random.shuffle(files)
                for factor, file in files:
                    done = solve(arguments.program, file, [])
                    if done is not None:
                        runs[factor].append(done[1])
            for factor, reports in runs.items():
                if not reports:
                    print(f"| {scene.stem} | {factor} | no solution | | | | | |", flush=True)
                    continue
                last = reports[-1]
                phases = [[r["seconds"][phase] for r in reports] for phase in ("setup", "solve")]
                phases.append([a + b for a, b in zip(*phases)])
                seconds = " | ".join(f"{statistics.median(p):.3f}" for p in phases)
                print(
                    f"| {scene.stem} | {factor} | {last['subdomains']} | {last['iterations']['total']} "
                    f"| {last['memory_mb']:.0f} | {seconds} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
