"""Random combinations of the public API and of command lines, each judged.

Every case draws a call, makes it in a worker process, and compares what comes back
with an independent value: an exact law, a closed form, a second method, or the same
problem reflected, turned or scaled. Claims: nothing is wrong without a word, and no
call ends in a traceback, a hang, a crash, or a file that is neither whole nor gone.

    python validation/reliability/attack.py                   # all of it
    python validation/reliability/attack.py --seed 7 --times 3
    python validation/reliability/attack.py --only junk:12    # one case, here
"""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

# Before numpy and numba are imported, here and in the workers.
os.environ["MPLBACKEND"] = "Agg"
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
sys.path.insert(0, str(Path(__file__).parents[1]))

from attacks.verdicts import FINDINGS, VERDICTS, Record
from attacks.worker import Worker, load_families, one_case
from reporting import Report

SEED = 15


def drawn(quick: bool, times: int, only: str | None) -> list[tuple[str, int]]:
    """The cases to run."""
    families = load_families()
    if only:
        name, _, numbers = only.partition(":")
        first, _, last = numbers.partition("-")
        if not numbers:
            return [(name, k) for k in range(times * families[name][1])]
        return [(name, k) for k in range(int(first), int(last or first) + 1)]
    return [
        (name, number)
        for name, (_, full, few) in families.items()
        for number in (few if quick else range(full * times))
    ]


def run_all(cases: list[tuple[str, int]], seed: int, here: bool) -> list[Record]:
    """Judge every case, and tell findings as they come."""
    worker, records = Worker(seed), []
    for family, number in cases:
        make = partial(one_case, seed) if here else worker.run
        record = make(family, number)
        records.append(record)
        if record.found or len(cases) == 1:
            print(record, flush=True)
    worker.close()
    return records


def rows_of(records: list[Record]) -> list[dict[str, Any]]:
    """Counts by family, and altogether."""
    rows = []
    names = list(dict.fromkeys(record.family for record in records))
    for name in [*names, "all"]:
        ours = [one for one in records if name in (one.family, "all")]
        counts = Counter(one.verdict for one in ours)
        compared = sum(one.n_compared for one in ours)
        seconds = sum(one.seconds for one in ours)
        rows.append(
            {"family": name, "tried": len(ours), "compared": compared,
             **{verdict: counts[verdict] for verdict in VERDICTS},
             "CPU seconds": round(seconds, 1)}
        )  # fmt: skip
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a few of every family")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--times", type=int, default=1, help="so many times as many")
    parser.add_argument("--only", help="a family, or FAMILY:NUMBER, or FAMILY:FROM-TO")
    parser.add_argument("--here", action="store_true", help="in this process")
    parser.add_argument("--refused", action="store_true", help="print refusals too")
    options = parser.parse_args()
    report = Report("attack", options.quick)
    cases = drawn(options.quick, options.times, options.only)
    records = run_all(cases, options.seed, options.here)
    if options.refused:
        for record in records:
            if record.verdict == "refused":
                print(record)
    report.table(rows_of(records))
    report.rows += [vars(one) for one in records if one.found]
    for verdict in FINDINGS:
        found = sum(one.verdict == verdict for one in records)
        report.check(f"cases that end {verdict}", found, "<=", 0)
    if options.only is None:
        report.finish()


if __name__ == "__main__":
    main()
