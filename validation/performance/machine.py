"""What the machine can do: measured copy bandwidth and DGEMM rate, per CPU second.

python validation/performance/machine.py
"""

from __future__ import annotations

import os
import platform
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from timing import measure

DENSITY_VALUES = 64**3  # a density of the benchmark, 2 MiB: lives in a cache
LARGE_VALUES = 2**25  # 256 MiB: far beyond any cache
BYTES_PER_COPIED_VALUE = 16  # read once, written once; write-allocate not counted
MATRIX = 512


@dataclass(frozen=True)
class Machine:
    """Measured limits that kernels are compared with.

    Attributes
    ----------
    copy_density, copy_large : float
        Bytes per second of `out[:] = p` on 64³ values and on 2²⁵ values, both
        directions counted.
    dgemm : float
        Floating-point operations per second of a product of two 512 x 512 matrices.
    processor : str
    n_cpus : int
    """

    copy_density: float
    copy_large: float
    dgemm: float
    processor: str
    n_cpus: int

    def to_dict(self) -> dict[str, float | str | int]:
        """Return plain values, for JSON."""
        return asdict(self)

    def __str__(self) -> str:
        """Return one line for the report."""
        return (
            f"{self.processor}, {self.n_cpus} CPUs: copy {self.copy_density / 1e9:.1f} "
            f"GB/s (64³) and {self.copy_large / 1e9:.1f} GB/s (256 MiB), "
            f"DGEMM {self.dgemm / 1e9:.1f} GFlop/s, per CPU second"
        )


def copy_bandwidth(n_values: int) -> float:
    """Bytes per CPU second of a copy of `n_values` float64."""
    source, out = np.ones(n_values), np.empty(n_values)
    copy = measure(lambda: np.copyto(out, source))
    return BYTES_PER_COPIED_VALUE * n_values / copy.cpu


def dgemm_rate(n: int = MATRIX) -> float:
    """Floating-point operations per CPU second of an n x n matrix product."""
    a, b = np.random.default_rng(1).random((2, n, n))
    out = np.empty((n, n))
    product = measure(lambda: np.matmul(a, b, out=out))
    return 2 * n**3 / product.cpu


def processor_name() -> str:
    """Name of the processor as the operating system gives it."""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def measure_machine(*, quick: bool = False) -> Machine:
    """Measure this machine; `quick` uses a smaller large array."""
    return Machine(
        copy_density=copy_bandwidth(DENSITY_VALUES),
        copy_large=copy_bandwidth(LARGE_VALUES // 8 if quick else LARGE_VALUES),
        dgemm=dgemm_rate(),
        processor=processor_name(),
        n_cpus=os.cpu_count() or 1,
    )


if __name__ == "__main__":
    print(measure_machine())
