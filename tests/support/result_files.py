"""One small result of every kind that a report can be written about, and its file."""

import atexit
import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve._support.netcdf import write_dataset
from fpsolve.grids.initial import gaussian
from fpsolve.pages.page import html_page, section_of
from fpsolve.paths import GaussianLaw
from fpsolve.studies import compare
from fpsolve.studies.energy_tables import tables_dataset
from fpsolve.studies.limits.large_noise_dataset import large_noise_dataset
from fpsolve.studies.limits.small_noise_dataset import small_noise_dataset
from fpsolve.studies.rates.dataset import rates_dataset
from fpsolve.studies.sweeps.sweep import Case

POTENTIAL = fp.QuadraticPotential()
MODEL = fp.LayDownModel(POTENTIAL, noise=1.0)
START = GaussianLaw((1.0, 0.0), 0.25, 0.5, 2.0)
NOISES = np.array([1.0, 2.0])
VERSIONS = {"versions": {"python": "3.11.0", "fpsolve": "0.1.0"}}
CONFIGURATION = """\
[process]
sigma1 = 0.01
sigma2 = 0.01
noise = 10.0
speed_ratio = 0.0
spinning_speed = 50.0

[initial]
kind = "gaussian"
mean = [1.5, 0.0]
variance = 1.0
"""


@cache
def solution():
    """A run that a configuration in SI units describes, with a suggested step."""
    found = relaxing_solution()
    found.provenance.update(
        configuration=CONFIGURATION, suggested={"ds": "error law C ds²"}
    )
    return found


@cache
def paths():
    return fp.sample_paths(
        fp.LayDownModel(POTENTIAL, 1.0, fp.MovingBelt(0.1)), 60, 4.0, 0.1,
        seed=7, initial=START, save_at=[0.0, 1.0, 4.0],
    )  # fmt: skip


@cache
def cross_check():
    grid = fp.PhaseSpaceGrid(5.0, (20, 20, 12))
    p0 = gaussian(grid, (0.5, 0.0), variance=1.0)
    scheme = fp.drift_kick(MODEL, grid)
    density = fp.solve(scheme, p0, (0.0, 1.0), 0.25, extrapolate=True)
    law = fp.paths.DensityLaw(grid, p0)
    return compare(
        density, fp.sample_paths(MODEL, 2000, 1.0, 0.25, seed=3, initial=law)
    )


@cache
def rates():
    """A study in which one case failed and one was never computed."""
    cases = [
        Case({"part": "gap", "noise": 1.0},
             values(gap=0.36, gap_error=1e-7) | {"gap_sector": "M = ±1"},
             "finished", seconds=1.5),
        Case({"part": "gap", "noise": 2.0}, {}, "failed", "MemoryError: <no room>"),
        Case({"part": "relaxation", "noise": 1.0},
             values(inverse_decay_rate=5.2, inverse_decay_rate_error=0.02,
                    entropy_rate=0.72, entropy_rate_error=0.002)
             | {"slowest_class": "M = 1"}, "finished",
             seconds=2.5),
        Case({"part": "relaxation", "noise": 2.0}, {}, "pending"),
        *(Case({"part": "variance", "noise": noise},
               values(asymptotic_variance=[1.9, 1.5, 0.8, 0.0, 6.25],
                      asymptotic_variance_error=[1e-3] * 5), "finished")
          for noise in NOISES),
    ]  # fmt: skip
    functions = ["position", "square", "core", "direction", "circulation"]
    about = {"p0": START, "quick": True, "settings": {"run": 0.1, "gap": 1e-6},
             "functions": functions}  # fmt: skip
    return rates_dataset(POTENTIAL, NOISES, cases, about)


@cache
def spectrum():
    return fp.spectrum(MODEL, 3, tolerance=1e-4)


@cache
def energy():
    return tables_dataset(fp.EnergyProcess(POTENTIAL, 0.5), 4, 3)


@cache
def large_noise():
    cases = [
        Case({"part": "gap", "noise": noise},
             values(gap=0.1 / noise**4, gap_error=1e-4, next_term=0.01 / noise**8,
                    next_term_error=1e-3), "finished", seconds=1.0)
        for noise in NOISES
    ]  # fmt: skip
    about = {
        "slow_length": 1.25, "belt_speed_scale": 0.5, "fixed_speed": 0.3, "quick": 1,
        "p0": json.dumps(START.to_dict()),
    }  # fmt: skip
    return large_noise_dataset(POTENTIAL, NOISES, ["gap"], cases, about)


@cache
def small_noise():
    cases = [
        Case({"noise": noise}, values(distance=0.1 * noise**2, distance_error=1e-3,
             paths_distance=0.1, paths_distance_by_chance=0.01), "finished")
        for noise in (0.2, 0.4)
    ]  # fmt: skip
    options = {"slow_length": 1.0, "ds": 0.05, "law": START}
    return small_noise_dataset(
        POTENTIAL, np.array([0.0]), np.array([0.2, 0.4]), cases, options
    )


def values(**numbers):
    return {name: np.asarray(number, float) for name, number in numbers.items()}


# Name of the file: what is in it, and the title of its section.
KINDS = {
    "laydown.nc": (solution, "Density of a run"),
    "fibres.nc": (paths, "Sampled paths"),
    "laydown-check.nc": (cross_check, "Density against paths"),
    "rate-quadratic.nc": (rates, "Rate of convergence against noise"),
    "spectrum.nc": (spectrum, "Eigenvalues of the generator"),
    "energy.nc": (energy, "Energy process of little noise"),
    "large-noise-quadratic.nc": (large_noise, "Limit of much noise"),
    "small-noise-quadratic.nc": (small_noise, "Limit of little noise"),
}


@cache
def result_file(name):
    """The file of that name, written as its command does; the same for all tests."""
    result, path = KINDS[name][0](), folder() / name
    return result.save(path) if hasattr(result, "save") else write_dataset(result, path)


@cache
def section(name):
    """The section about the file of that name, with its figures drawn."""
    return section_of(result_file(name))


@cache
def page_file(*names):
    """The page about the files of these names, as `fpsolve.report` writes it."""
    path = folder() / f"{'+'.join(names)}.html"
    path.write_text(html_page([section(name) for name in names]), encoding="utf-8")
    return path


@cache
def folder():
    """A folder that goes when Python ends."""
    kept = TemporaryDirectory()
    atexit.register(kept.cleanup)
    return Path(kept.name)
