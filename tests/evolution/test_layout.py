"""A kind of result is a class and its layout; the axes are those of its grid."""

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
import pytest

from fpsolve.evolution.evolution import Evolution
from fpsolve.evolution.layout import Attribute, Layout, Variable
from fpsolve.evolution.parts import SAVED, STATUS, STEP, OnGrid, Recorded
from fpsolve.evolution.saved import restored


@dataclass(frozen=True)
class Curvatures:
    """Cells of a curvature κ: an axis that no grid of the package has."""

    n: int

    axes: ClassVar[tuple[str, ...]] = ("kappa",)

    @property
    def shape(self):
        return (self.n,)

    @property
    def kappa(self):
        return np.arange(self.n) + 0.5

    def to_dict(self):
        return {"n": self.n}

    @classmethod
    def from_dict(cls, parameters):
        return cls(**parameters)


@dataclass(frozen=True, eq=False)
class Toy(Evolution):
    """H falls like e^{-2s}, by a scheme that makes no error."""

    kind: ClassVar[str] = "toy"
    layout: ClassVar[Layout] = Layout(
        "Toy", SAVED, OnGrid(Curvatures.from_dict, "density of κ"), Recorded(),
        STEP, STATUS,
        Variable("peak", (), "largest value", kind=float, optional=True),
        Variable("mean", ("s",), "mean of p", values=lambda toy: toy.densities.mean(1)),
        Attribute("method", optional=True),
    )  # fmt: skip

    grid: Any
    series: dict
    saved_s: Any
    densities: Any
    ds: float
    errors: dict | None = None
    status: str = "finished"
    peak: float | None = None
    method: str | None = None
    call: Any = None
    provenance: dict = field(default_factory=dict)

    def _of_step(self, above, window):
        return 0.0


def toy(**changes):
    s = np.arange(9) / 8
    series = {"s": s, "relative_entropy": np.exp(-2 * s)}
    errors = {"relative_entropy": 1e-9 * s, "density_l1": np.zeros(2)}
    densities = np.arange(10.0).reshape(2, 5)
    return Toy(Curvatures(5), series, s[[0, -1]], densities, 0.125, errors, **changes)


@pytest.mark.parametrize("changes", [{}, {"peak": 9.0, "method": "exact"}])
def test_what_is_written_is_read_on_any_axes(changes):
    dataset = toy(**changes).to_xarray()
    assert dataset["density"].dims == ("s", "kappa")
    back = restored(Toy, dataset)
    assert back.grid == Curvatures(5)
    assert (back.peak, back.method) == (changes.get("peak"), changes.get("method"))
    assert back.to_xarray().identical(dataset)


def test_series_are_attributes_and_densities_are_found_by_their_arclength():
    found = toy()
    assert found.relative_entropy is found.series["relative_entropy"]
    assert "relative_entropy" in dir(found)
    np.testing.assert_array_equal(found.final, found.density(1.0))
    with pytest.raises(AttributeError, match="Toy has no attribute 'colour'; its"):
        found.colour  # noqa: B018


def test_the_rate_is_fitted_with_the_errors_of_the_run_or_of_its_step():
    # Without errors the toy knows its step to make none; what is left is rounding of
    # the nine logarithms, 1e-16 over a span of one.
    for one in (toy(), replace(toy(), errors=None)):
        assert one.entropy_rate().rate == pytest.approx(2.0, abs=1e-6)
    assert toy().entropy_rate().step_error > 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda one: one.drop_vars("s_step"), "`s_step` is missing in it"),
        (lambda one: one.isel(kappa=slice(3)), r"the shape \(2, 5\) of `s` and `grid`"),
        (lambda one: one.assign(kappa=one["kappa"] + 1), "`kappa` must be the cell"),
        (lambda one: one.isel(s=[1, 0]), "`s` must be finite and increase"),
        (lambda one: one.assign(peak=("s", [1.0, 2.0])), "`peak` must hold numbers"),
        (lambda one: one.assign(peak_error=("kappa", np.ones(5))),
         "`peak_error` must be a series over s or s_step, got one over kappa"),
        (lambda one: one.assign_attrs(status="tired"), "`status` must be one of"),
        (lambda one: one.assign_attrs(ds=0.0), "`ds` must be positive, got 0"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        restored(Toy, change(toy().to_xarray()))
