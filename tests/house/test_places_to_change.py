"""What is added with a class and a row in a table works everywhere else at once."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

ADDED = '''
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fpsolve.density.schemes import known
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.evolution import series
from fpsolve.model.potentials import dictionaries
from fpsolve.model.potentials.potential import Potential


@dataclass(frozen=True)
class Bowl(Potential):
    """B = c |xi|^2: the file of a new potential."""

    curvature: float = 0.5
    kind: ClassVar[str] = "bowl"

    def value(self, xi1, xi2):
        return self.curvature * (np.square(xi1) + np.square(xi2))

    def gradient(self, xi1, xi2):
        pair = 2 * self.curvature * xi1, 2 * self.curvature * xi2
        return tuple(np.broadcast_arrays(*pair))

    @property
    def formula(self):
        return f"{self.curvature:g} |xi|^2"

    latex = r"c |\\xi|^2"


class Counted(DriftKick):
    """Tells the length of its last steps: the file of a new scheme."""

    name = "counted"

    def start(self, p0):
        state = super().start(p0)
        state.report["way"] = 0.0
        return state

    def advance(self, state, s, ds, n_steps=1):
        super().advance(state, s, ds, n_steps)
        state.report["way"] = ds * n_steps


# A row for each.
dictionaries.KINDS["bowl"] = Bowl
known.SCHEMES["counted"] = Counted
series.SERIES["peak"] = series.Series(
    "peak", "largest value of p", lambda record: float(record.p.max())
)
'''
CONFIGURATION = """
[model]
noise = 1.0

[potential]
kind = "bowl"
curvature = 0.5

[grid]
half_width = 5.0
shape = [16, 16, 8]

[initial]
kind = "gaussian"
mean = [1.0, 0.0]
variance = 1.0

[scheme]
kind = "counted"

[run]
s_end = 0.5
ds = 0.25

[output]
name = "bowl"
figures = false
"""
RUN = ADDED + textwrap.dedent("""
    import fpsolve as fp
    from fpsolve.cli import app
    from typer.testing import CliRunner

    done = CliRunner().invoke(app, ["run", "bowl.toml", "--out", "."])
    assert done.exit_code == 0, done.output
    solution = fp.load("bowl.nc")
    assert type(solution.model.potential) is Bowl
    assert solution.scheme["name"] == "counted"
    again = fp.rerun("bowl.nc")
    assert fp.compare(again, "bowl.nc").equal
    assert list(solution.way) == [0.0, 0.25, 0.25]
    assert "largest value of p" in str(solution.to_xarray()["peak"].attrs)
    np.savez("found.npz", final=solution.final, peak=solution.peak)
""")
OURS = textwrap.dedent("""
    import numpy as np
    import fpsolve as fp

    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
    grid = fp.PhaseSpaceGrid(5.0, (16, 16, 8))
    p0 = fp.initial.gaussian(grid, (1.0, 0.0), variance=1.0)
    ours = fp.solve(fp.drift_kick(model, grid), p0, (0.0, 0.5), 0.25)
    np.savez("ours.npz", final=ours.final)
""")


def python(folder, code):
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("added")
    (folder / "bowl.toml").write_text(CONFIGURATION)
    python(folder, RUN + OURS)
    return np.load(folder / "found.npz"), np.load(folder / "ours.npz")


@pytest.mark.processes
def test_a_potential_a_scheme_and_a_series_are_configured_saved_and_run_again(found):
    added, ours = found
    # The same equation with the same steps; e^{-B} in other words: rounding.
    assert np.abs(added["final"] - ours["final"]).max() < 1e-14
    assert added["peak"][-1] == added["final"].max()
