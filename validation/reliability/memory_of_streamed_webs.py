"""A web that is streamed takes the memory of what lies below the nozzles.

Claims: the largest memory of a process that streams a web to a disk, over that of one
that streams the shortest, grows by less than a twentieth of the counts of the pixels
that are added (24 bytes each), here and on a client; `lay_web` takes all of them.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from reporting import Report

PIXEL, WIDTH = 0.05, 40.0
# Prints the largest resident memory in bytes, after a web of that length.
CODE = """
import resource, sys
from concurrent.futures import ThreadPoolExecutor
import fpsolve as fp
width, pixel, length = map(float, sys.argv[1:4])
folder, way = sys.argv[4:]
model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.3))
options = dict(width=width, length=length, pixel=pixel, spacing=0.5, seed=1)
if way == "lay_web":
    fp.lay_web(model, **options)
elif way == "stream_web":
    fp.stream_web(model, f"{folder}/web.zarr", tile=10.0, **options)
else:
    with ThreadPoolExecutor(1) as executor:
        path = f"{folder}/web.zarr"
        fp.stream_web(model, path, tile=10.0, client=executor, **options)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""
WAYS = ("lay_web", "stream_web", "stream_web on a client")


def peak(length: float, way: str) -> int:
    """Largest memory of a process in bytes."""
    with tempfile.TemporaryDirectory() as folder:
        sizes = [f"{size:g}" for size in (WIDTH, PIXEL, length)]
        command = [sys.executable, "-c", CODE, *sizes, folder, way]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    return int(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="shorter webs")
    quick = parser.parse_args().quick
    report = Report("memory_of_streamed_webs", quick)
    # The shortest holds all stretches that there are: the first, full ones, the last.
    lengths = (60.0, 240.0) if quick else (60.0, 300.0, 1200.0)
    # Compiling takes more memory than the web, wherever it has not been done.
    peak(lengths[0], WAYS[0])
    rows = []
    for way in WAYS:
        chosen = lengths[:2] if way == "lay_web" else lengths
        peaks = [peak(length, way) for length in chosen]
        pixels = [WIDTH / PIXEL * length / PIXEL for length in chosen]
        growth = (peaks[-1] - peaks[0]) / (24 * (pixels[-1] - pixels[0]))
        told = {f"MiB, {length:g} long": "" for length in lengths}
        told |= {f"MiB, {length:g} long": found / 2**20
                 for length, found in zip(chosen, peaks, strict=True)}  # fmt: skip
        rows.append({"way": way, **told, "growth / size of counts": growth})
    report.table(rows)
    at_once, *streamed = (row["growth / size of counts"] for row in rows)
    report.check("growth over counts, lay_web", at_once, ">", 0.9)
    for way, growth in zip(WAYS[1:], streamed, strict=True):
        report.check(f"growth over counts, {way}", growth, "<", 0.05)
    report.finish()


if __name__ == "__main__":
    main()
