"""The sections of a configuration file."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

from pydantic import field_validator, model_validator

from fpsolve._support.checks import check_tolerance, shown
from fpsolve.cli.config.sections import Section, one_of, section
from fpsolve.density.levels import MOST_LEVELS
from fpsolve.density.schemes.known import SCHEMES
from fpsolve.evolution.schedule import make_schedule, step_dividing
from fpsolve.grids import initial
from fpsolve.grids.dictionaries import make_grid
from fpsolve.model.curves.dictionaries import KINDS as CURVES
from fpsolve.model.potentials.dictionaries import KINDS as POTENTIALS
from fpsolve.model.process import Process
from fpsolve.model.reading import make_model

__all__ = [
    "AUTOMATIC",
    "VARIANCE",
    "CurveSection",
    "GridSection",
    "InitialSection",
    "ModelSection",
    "OutputSection",
    "PotentialSection",
    "ProcessSection",
    "RunSection",
    "SchemeSection",
    "SpanSection",
]

_Numbers = tuple[float, ...]
_Matrix = tuple[tuple[float, float], tuple[float, float]]
# One of an isotropic law, those along both axes, or a covariance matrix.
VARIANCE = {"variance": float | tuple[float, float] | _Matrix}
# Types that a file may hold where the annotation of a curve says less.
_IN_A_FILE = {
    "tabulated_curve": {"s": _Numbers, "gamma1": _Numbers, "gamma2": _Numbers}
}

if TYPE_CHECKING:
    # The sections are made when this module is loaded; checkers know what they share.
    PotentialSection: TypeAlias = Section
    CurveSection: TypeAlias = Section
    InitialSection: TypeAlias = Section
    SchemeSection: TypeAlias = Section
    ModelSection: TypeAlias = Section
    GridSection: TypeAlias = Section
    ProcessSection: TypeAlias = Section
else:
    PotentialSection = one_of(*(section(POTENTIALS[kind], kind) for kind in POTENTIALS))
    CurveSection = one_of(
        *(section(CURVES[kind], kind, _IN_A_FILE.get(kind)) for kind in CURVES)
    )
    InitialSection = one_of(
        section(initial.gaussian, "gaussian", VARIANCE),
        section(initial.equilibrium, "equilibrium"),
    )
    SchemeSection = one_of(*(section(SCHEMES[name], name) for name in SCHEMES))
    ModelSection = section(make_model)
    GridSection = section(make_grid)
    ProcessSection = section(Process)


# The number of levels that the tolerance asks for.
AUTOMATIC = "auto"


class SpanSection(Section):
    """How far to go from s = 0, in which steps, and where to keep what is found."""

    s_end: float
    ds: float | None = None
    save_at: _Numbers | None = None
    save_every: float | None = None

    @model_validator(mode="after")
    def _check_schedule(self) -> SpanSection:
        if self.save_at is not None and self.save_every is not None:
            raise ValueError(
                "`save_at` and `save_every` must not both be given; remove one of them."
            )
        if self.save_every is not None and not 0 < self.save_every < math.inf:
            raise ValueError(f"`save_every` must be positive, got {self.save_every:g}.")
        if self.ds is None:
            self._make_schedule(self.s_end, None)
        else:
            self.check_schedule(self.ds)
        return self

    def check_schedule(self, ds: float) -> None:
        """Raise ValueError unless steps of ds fit the end and the saving points."""
        self._make_schedule(ds, self.saves())

    def saves(self) -> tuple[float, ...]:
        """Return the arclengths at which the state is kept."""
        if self.save_every is None:
            return (self.s_end,) if self.save_at is None else self.save_at
        n_saves = math.floor(self.s_end / self.save_every + 1e-9) + 1
        saves = {k * self.save_every for k in range(n_saves)} | {self.s_end}
        return tuple(sorted(saves))

    def _make_schedule(self, ds: float, saves: _Numbers | None) -> None:
        # No step is recorded, however many there are.
        make_schedule((0.0, self.s_end), ds, saves, record_every=sys.maxsize)


class RunSection(SpanSection):
    """How far to run and what to keep; see `fpsolve.solve`.

    `tolerance` is the L1 error at which a grid or a step that is not given aims. With
    `extrapolate = "auto"` it is what the step may leave, and decides about levels.
    """

    record_every: int = 1
    extrapolate: bool | int | str = False
    tolerance: float = 1e-2
    mass_tolerance: float | None = None
    boundary_tolerance: float | None = None
    negative_tolerance: float | None = None
    entropy_tolerance: float | None = None
    circulation_tolerance: float | None = None

    def _make_schedule(self, ds: float, saves: _Numbers | None) -> None:
        make_schedule((0.0, self.s_end), ds, saves, self.record_every)

    @field_validator("extrapolate", mode="before")
    @classmethod
    def _check_extrapolate(cls, value: object) -> object:
        levels = isinstance(value, int) and 2 <= value <= MOST_LEVELS
        if not (isinstance(value, bool) or levels or value == AUTOMATIC):
            raise ValueError(
                f"`extrapolate` must be true or false, from 2 to {MOST_LEVELS} levels, "
                f'or "{AUTOMATIC}", got {shown(value)}.'
            )
        return value

    @model_validator(mode="after")
    def _check_tolerances(self) -> RunSection:
        for name, value in self.tolerances().items():
            check_tolerance(name, value)
        return self

    def tolerances(self) -> dict[str, float]:
        """Return the tolerances of `fpsolve.solve` that are given, by their names."""
        return {
            name: value
            for name, value in self
            if name.endswith("_tolerance") and value is not None
        }

    def step(self, suggested: float) -> float:
        """Return the largest step, suggested or below, that meets all saving points.

        When none down to a tenth does, the span alone is divided.
        """
        step = step_dividing([*self.saves(), self.s_end], suggested, 10)
        if step is None:
            step = self.s_end / math.ceil(self.s_end / suggested - 1e-9)
        return step


class OutputSection(Section):
    """Names and kinds of the files written."""

    name: str = "result"
    format: Literal["netcdf", "zarr"] = "netcdf"
    figures: bool = True

    suffixes: ClassVar[dict[str, str]] = {"netcdf": ".nc", "zarr": ".zarr"}

    @model_validator(mode="after")
    def _check_name(self) -> OutputSection:
        if not self.name or set(self.name) & set("/\\\0") or self.name[0] == ".":
            raise ValueError(
                f"`name` must be the name of a file without folders, got {self.name!r}."
            )
        return self

    @property
    def file_name(self) -> str:
        """Name of the result file."""
        return self.name + self.suffixes[self.format]
