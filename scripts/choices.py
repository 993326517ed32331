#!/usr/bin/env python3
"""Compares what the program chooses by itself with the best of all choices, scene by scene.

    scripts/choices.py FETIFETI [--rounds 3] [--options "..."] SCENE...

Every scene is solved with the defaults and with each combination of preconditioner, primal constraints and kinds of
averages below, and with half and twice as many subdomains where the scene has a mesh. The runs of a round come in a
random order. Shown are medians of set-up and solve in seconds, the quotient of the default and the best, and what the
best was. A run that does not converge does not count. The choice of the default is not run a second time.
"""

import argparse
import itertools
import json
import random
import re
import statistics
import subprocess
import tempfile
from pathlib import Path

PRECONDITIONERS = ["dirichlet", "coarse_corrected"]
PRIMAL = ["vertices", "vertices,edges", "vertices,faces", "vertices,edges,faces"]
AVERAGES = ["components", "motions"]


def variants(report):
    """(name, options) of all choices but that of the default, whose report this is."""
    scalar = report["components"] == 1
    for pc, primal, averages in itertools.product(PRECONDITIONERS, PRIMAL, AVERAGES):
        if report["dimension"] == 2 and "faces" in primal:
            continue
        if averages == "motions" and (scalar or primal == "vertices"):
            continue
        if (pc, primal, averages) == (report["preconditioner"], "vertices,edges", "components"):
            continue
        options = ["-fetifeti_pc_type", pc, "-fetifeti_primal", primal, "-fetifeti_averages", averages]
        if pc == "coarse_corrected":
            # As the default has it.
            options += ["-fetifeti_lifting", "vertices"]
        yield f"{pc}, {primal}, {averages}", options


def solve(program, scene, options):
    """(seconds of set-up and solve, report), or None if there was no solution."""
    done = subprocess.run(
        [program, "solve", str(scene), "--json", "-", *options], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        return None
    report = json.loads(done.stdout)
    seconds = report["seconds"]
    return seconds["setup"] + seconds["solve"], report


def bodies(program, scene):
    """(name, number of subdomains) of each body."""
    done = subprocess.run([program, "plan", str(scene), "--json", "-"], capture_output=True, text=True, check=True)
    return [(body["name"], body["subdomains"]) for body in json.loads(done.stdout)["bodies"]]


def with_subdomains(scene, counts, factor, folder):
    """A copy of a scene with a mesh, with so many times as many subdomains in each body."""
    text = re.sub(r"^subdomains\s*=.*\n", "", scene.read_text(), flags=re.M)
    resolved = lambda m: f'{m[1]}"{(scene.parent / m[2]).resolve()}"'
    text = re.sub(r"^(file\s*=\s*)\"([^\"]*)\"", resolved, text, flags=re.M)
    for name, count in counts:
        number = max(1, round(count * factor))
        text = text.replace(f'\nname = "{name}"', f'\nsubdomains = {number}\nname = "{name}"', 1)
    out = Path(folder) / f"{scene.stem}-{factor}.toml"
    out.write_text(text)
    return out


def choices(program, scene, more, folder):
    """All (name, scene, options), the default first, and the report of the default."""
    first = solve(program, scene, more)
    if first is None:
        return None
    report = first[1]
    out = [("default", scene, more)]
    out += [(name, scene, [*more, *options]) for name, options in variants(report)]
    if "[mesh]" in scene.read_text():
        counts = bodies(program, scene)
        for factor in (0.5, 2.0):
            out.append((f"{factor} times the subdomains", with_subdomains(scene, counts, factor, folder), more))
    return out, report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--options", default="", help="options of all runs")
    parser.add_argument("--all", action="store_true", help="show every choice")
    arguments = parser.parse_args()
    more = arguments.options.split()
    random.seed(1)
    print("| scene | unknowns | default | its seconds | best | its seconds | quotient |")
    print("|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for scene in arguments.scenes:
            found = choices(arguments.program, scene, more, folder)
            if found is None:
                print(f"| {scene.stem} | | no solution | | | | |", flush=True)
                continue
            todo, report = found
            seconds = {name: [] for name, _, _ in todo}
            for _ in range(arguments.rounds):
                random.shuffle(todo)
                for name, file, options in todo:
                    done = solve(arguments.program, file, options)
                    if done is not None:
                        seconds[name].append(done[0])
            complete = {name: s for name, s in seconds.items() if len(s) == arguments.rounds}
            medians = {name: statistics.median(s) for name, s in complete.items()}
            own = medians["default"]
            best = min(medians, key=medians.get)
            first = f"| {scene.stem} | {report['dofs']:,} | {report['preconditioner']} | {own:.3f} "
            print(f"{first}| {best} | {medians[best]:.3f} | {own / medians[best]:.2f} |", flush=True)
            if arguments.all:
                for name in sorted(medians, key=medians.get):
                    print(f"    {medians[name]:8.3f}  {name}", flush=True)


if __name__ == "__main__":
    main()
