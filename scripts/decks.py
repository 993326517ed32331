#!/usr/bin/env python3
"""Solves the decks of Debian's package calculix-ccx-test and compares them with CalculiX's own results.

    scripts/decks.py [--program target/release/fetifeti] [--decks DIR] [--only NAME ...] > table.md

The decks and their reference results (*.dat.ref) are read where the package installs them, compressed or not. Each deck
gets one line: solved, with the largest difference of a displacement or force relative to the largest of its table, or
refused, with the reason. Decks that crash or do not end within the time limit are named as such.
"""

import argparse
import collections
import glob
import gzip
import os
import re
import subprocess
import sys
import tempfile

DECKS = "/usr/share/doc/calculix-ccx-test/examples/test"
TITLE = re.compile(r"\s*(displacements \(vx,vy,vz\)|(total )?forces? \(fx,fy,fz\)) for set (\S+) and time\s+(\S+)")
LIMIT = 300


def unpack(source, target):
    """Copies all files of a directory; those of gzip are unpacked."""
    for path in glob.glob(os.path.join(source, "*")):
        name = os.path.basename(path)
        opener = gzip.open if name.endswith(".gz") else open
        with opener(path, "rb") as file, open(os.path.join(target, name.removesuffix(".gz")), "wb") as out:
            out.write(file.read())


def tables(path):
    """The tables of displacements and forces of a .dat file: a dictionary of vectors by node for each."""
    found, current = [], None
    with open(path, errors="replace") as file:
        for line in file:
            title = TITLE.match(line)
            if title:
                current, total = {}, title.group(2)
                found.append(current)
                continue
            words = line.split()
            if current is None or not words:
                continue
            if total:
                words.insert(0, "0")
            try:
                current[int(words[0])] = [float(word) for word in words[1:4]]
            except ValueError:
                current = None
    return found


def difference(ours, theirs):
    """The largest difference relative to the largest number of each table, and the number of vectors."""
    worst, nodes = 0.0, 0
    for a, b in zip(ours, theirs):
        size = max((abs(x) for vector in b.values() for x in vector), default=0.0)
        for node in a.keys() & b.keys():
            nodes += 1
            away = max(abs(x - y) for x, y in zip(a[node], b[node]))
            worst = max(worst, away / size if size > 0 else away)
    return worst, nodes


def run(program, deck, out):
    """The outcome of one deck: a word, and what is known of it."""
    name = os.path.splitext(os.path.basename(deck))[0]
    try:
        command = [program, "solve", deck, "--out", out, "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return "no end", f"not done after {LIMIT} s"
    message = (done.stderr.strip().splitlines() or [""])[-1]
    if done.returncode == 2:
        return "refused", re.sub(r"^Error: \S*/", "", message)
    if done.returncode != 0:
        return "failed", message
    printed, reference = os.path.join(out, f"{name}.dat"), deck.removesuffix(".inp") + ".dat.ref"
    if not (os.path.exists(printed) and os.path.exists(reference)):
        return "solved", "prints no displacements or forces"
    worst, nodes = difference(tables(printed), tables(reference))
    return "solved", f"{worst:.1e} of {nodes} vectors" if nodes else "prints no displacements or forces"


def keyword(reason):
    """The keyword of a refusal, or the reason itself."""
    if "matching nodes were expected" in reason:
        return "sides that do not match"
    found = re.search(r"line \d+: (\*[A-Z][A-Z \-]*)", reason)
    return found.group(1).strip() if found else re.sub(r".*?: ", "", reason)[:60]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/fetifeti")
    parser.add_argument("--decks", default=DECKS)
    parser.add_argument("--only", nargs="*")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as work:
        unpack(args.decks, work)
        decks = sorted(glob.glob(os.path.join(work, "*.inp")))
        for deck in decks:
            name = os.path.splitext(os.path.basename(deck))[0]
            if args.only and name not in args.only:
                continue
            rows.append((name, *run(args.program, deck, os.path.join(work, "out", name))))
            print(*rows[-1], sep="\t", file=sys.stderr, flush=True)
    counts = collections.Counter(outcome for _, outcome, _ in rows)
    print(f"{len(rows)} decks: " + ", ".join(f"{n} {what}" for what, n in counts.most_common()) + ".\n")
    print("| deck | difference from CalculiX |\n|---|---|")
    for name, outcome, detail in rows:
        if outcome != "refused":
            print(f"| `{name}` | {detail if outcome == 'solved' else outcome + ': ' + detail} |")
    print("\n| refused by | decks |\n|---|---|")
    reasons = collections.Counter(keyword(detail) for _, outcome, detail in rows if outcome == "refused")
    for reason, n in reasons.most_common():
        print(f"| {reason} | {n} |")
    return 0 if counts["failed"] + counts["no end"] == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
