"""With checkpoints, saved densities do not stay in memory, nor does writing them.

Claims: the largest memory of a process that saves many densities, and writes them to
netCDF, grows by their size, and no more, without checkpoints, and by less than a tenth
of it with.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from reporting import Report

# Prints the largest resident memory in bytes, after a run that saves n densities.
CODE = """
import resource, sys
import numpy as np
import fpsolve as fp
n_saved, shape = int(sys.argv[1]), int(sys.argv[2])
folder, name = sys.argv[3:]
model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
grid = fp.PhaseSpaceGrid(6.0, (shape, shape, shape))
p0 = fp.initial.gaussian(grid, variance=0.5)
checkpoint = None if name == "memory" else fp.Checkpoint(f"{folder}/{name}", 10)
solution = fp.solve(
    fp.drift_kick(model, grid), p0, (0.0, n_saved / 16), 1 / 16,
    save_at=np.arange(1, n_saved + 1) / 16, checkpoint=checkpoint,
)
solution.save(f"{folder}/{name}.nc")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


def peak(n_saved: int, n: int, name: str) -> int:
    """Largest memory of a process in bytes."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", CODE, str(n_saved), str(n), folder, name]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    return int(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller densities")
    quick = parser.parse_args().quick
    report = Report("memory_of_saved_densities", quick)
    n, few, many = (40, 10, 410) if quick else (64, 10, 210)
    size = 8 * n**3
    rows = []
    # Compiling takes more memory than the run, wherever it has not been done.
    peak(few, n, "memory")
    for name in ("memory", "checkpoint"):
        low, high = peak(few, n, name), peak(many, n, name)
        rows.append(
            {"kept in": name, f"MiB, {few} saved": low / 2**20,
             f"MiB, {many} saved": high / 2**20,
             "growth / size": (high - low) / (size * (many - few))}
        )  # fmt: skip
    report.table(rows)
    in_memory, on_disk = (row["growth / size"] for row in rows)
    report.check("growth over size, in memory, at least", in_memory, ">", 0.9)
    report.check("growth over size, in memory, at most", in_memory, "<", 1.1)
    report.check("growth over size, with checkpoints", on_disk, "<", 0.1)
    report.finish()


if __name__ == "__main__":
    main()
