"""Run every validation script; `--quick` is what continuous integration runs."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
SCRIPTS = (
    "error_laws.py",
    "entropy_identity.py",
    "path_bias.py",
    "path_marginals.py",
    "ergodic_averages.py",
    "spectral_reference.py",
    "decay_rate_is_the_gap.py",
    "rate_asymptotes.py",
    "large_noise_limit.py",
    "small_noise_limit.py",
    "performance/run.py",
    "performance/paths.py",
    "performance/reduced.py",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    arguments = ["--quick"] if parser.parse_args().quick else []
    failed = []
    for script in SCRIPTS:
        print(f"== {script}", flush=True)
        command = [sys.executable, str(HERE / script), *arguments]
        if subprocess.run(command, check=False).returncode:
            failed.append(script)
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
