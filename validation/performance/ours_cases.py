"""What of our grid schemes is run at which noise: schemes, cells, steps, levels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

Shape = tuple[int, int, int]


@dataclass(frozen=True)
class Case:
    """One setting of one of our schemes.

    Attributes
    ----------
    scheme : str
        Name of the function in `fpsolve` that builds it.
    shape : tuple of int
    ds : float
        With `extrapolate` the longest of the steps.
    options : dict
        Keyword arguments of the scheme.
    extrapolate : bool or int
        Levels of extrapolation; True are two.
    """

    scheme: str
    shape: Shape
    ds: float
    options: dict[str, Any] = field(default_factory=dict)
    extrapolate: bool | int = False

    @property
    def trigonometric(self) -> bool:
        """Whether it translates the trigonometric interpolant."""
        return self.options.get("translation") == "fourier"

    @property
    def label(self) -> str:
        """Scheme and options, as printed."""
        order = self.options.get("interpolation_order")
        words = [name for name, value in self.options.items() if value is True]
        words += ["Fourier"] if self.trigonometric else []
        words += [f"order {order}"] if order else []
        words += ["extrapolated"] if self.extrapolate is True else []
        words += [f"{self.extrapolate} levels"] if self.extrapolate > 1 else []
        return self.scheme + (f" ({', '.join(words)})" if words else "")


def case(scheme: str, shape: Shape, ds: float, **options: Any) -> Case:
    """Build a Case; `extrapolate` is the run's, the rest the scheme's options."""
    extrapolate = options.pop("extrapolate", False)
    return Case(scheme, shape, ds, options, extrapolate)


def square(n: int, n_alpha: int) -> Shape:
    """A shape with as many cells along ξ₁ as along ξ₂."""
    return (n, n, n_alpha)


def fourier(shape: Shape, n_steps: int, levels: int) -> Case:
    """Fourier translations; `n_steps` of the longest step to s = 1."""
    return case(
        "drift_kick", shape, 1 / n_steps, translation="fourier", extrapolate=levels
    )


def balanced_fourier(shape: Shape, n_steps: int, levels: int) -> Case:
    """The same in the balanced form, whose steps err less where noise is large."""
    return case(
        "drift_kick", shape, 1 / n_steps,
        balanced=True, translation="fourier", extrapolate=levels,
    )  # fmt: skip


def sharp(n: int, n_alpha: int, n_steps: int) -> Case:
    """The most accurate translations of local polynomials, extrapolated."""
    return case("drift_kick", square(n, n_alpha), 1 / n_steps, **SHARP)


RICHARDSON = {"extrapolate": True}
SHARP = {"balanced": True, "interpolation_order": 16, "extrapolate": True}

SMALL = (
    case("semi_lagrangian", (32, 32, 16), 1 / 4),
    case("semi_lagrangian", (48, 48, 32), 1 / 4),
    case("semi_lagrangian", (64, 64, 32), 1 / 8),
    case("semi_lagrangian", (64, 64, 32), 1 / 4, **RICHARDSON),
    case("semi_lagrangian", (64, 64, 32), 1 / 4, interpolation_order=6, **RICHARDSON),
    case("drift_kick", (24, 24, 16), 1 / 2),
    case("drift_kick", (32, 32, 16), 1 / 3),
    case("drift_kick", (32, 32, 16), 1 / 4),
    case("drift_kick", (40, 40, 24), 1 / 4),
    case("drift_kick", (64, 64, 32), 1 / 8),
    case("drift_kick", (32, 32, 16), 1 / 4, positive=True),
    case("drift_kick", (64, 64, 32), 1 / 8, positive=True),
    case("drift_kick", (32, 32, 16), 1 / 4, balanced=True),
    case("drift_kick", (64, 64, 32), 1 / 8, balanced=True),
    case("drift_kick", (64, 64, 32), 1 / 4, **RICHARDSON),
    case("drift_kick", (64, 64, 32), 1 / 4, balanced=True, **RICHARDSON),
)
# Little noise needs angles, much noise needs steps.
SHARPEST = {
    0.1: (sharp(64, 64, 8), sharp(96, 96, 12)),
    0.3: (
        sharp(48, 24, 4), sharp(48, 32, 6), sharp(64, 48, 8), sharp(80, 48, 12),
        sharp(96, 64, 16), sharp(128, 96, 32),
    ),
    1.0: (
        sharp(40, 16, 4), sharp(44, 16, 4), sharp(48, 24, 6), sharp(64, 32, 8),
        sharp(80, 32, 16), sharp(96, 48, 32),
    ),
    3.0: (
        sharp(40, 16, 8), sharp(44, 16, 12), sharp(48, 16, 16), sharp(64, 24, 24),
        sharp(80, 24, 48), sharp(96, 32, 96),
    ),
    10.0: (
        case("drift_kick", (24, 24, 8), 1 / 16, interpolation_order=16),
        case("drift_kick", (24, 24, 8), 1 / 32, balanced=True),
        case("drift_kick", (24, 24, 8), 1 / 40, balanced=True, translation="fourier"),
        sharp(24, 8, 12),
        sharp(40, 16, 32), sharp(48, 16, 64), sharp(64, 16, 96),
    ),
}  # fmt: skip


# The best of more than thirty at each noise, and cubes.
FOURIER = {
    0.1: (
        fourier((36, 36, 40), 2, 2), fourier((44, 44, 56), 2, 2),
        fourier((52, 52, 64), 2, 2), fourier((52, 52, 64), 2, 3),
        fourier((60, 60, 80), 2, 3), fourier((68, 68, 96), 2, 3),
        fourier((68, 68, 96), 2, 4), fourier((68, 80, 104), 2, 4),
        fourier((80, 80, 112), 2, 4), fourier((80, 96, 128), 2, 4),
        fourier((80, 96, 128), 2, 5), fourier((92, 112, 144), 2, 5),
        fourier((92, 112, 144), 3, 5), fourier((104, 128, 160), 3, 5),
        fourier((116, 144, 184), 4, 5),
    ),
    0.3: (
        fourier((32, 32, 32), 2, 2), fourier((40, 40, 40), 2, 2),
        fourier((40, 40, 40), 2, 3), fourier((48, 48, 48), 2, 3),
        fourier((48, 48, 48), 2, 4), fourier((56, 56, 56), 2, 4),
        fourier((64, 64, 64), 2, 4), fourier((64, 64, 64), 2, 5),
        fourier((72, 72, 72), 2, 5), fourier((72, 72, 72), 3, 5),
        fourier((76, 76, 80), 3, 5), fourier((80, 88, 88), 4, 6),
    ),
    1.0: (
        balanced_fourier((28, 28, 16), 3, 2), balanced_fourier((28, 28, 16), 4, 2),
        balanced_fourier((36, 36, 16), 4, 2), balanced_fourier((32, 32, 16), 3, 3),
        fourier((28, 28, 16), 2, 2), fourier((32, 32, 16), 2, 2),
        fourier((32, 32, 16), 2, 3), fourier((36, 36, 16), 2, 3),
        fourier((40, 40, 24), 2, 3), fourier((40, 40, 24), 2, 4),
        fourier((44, 44, 24), 2, 4), fourier((48, 48, 24), 3, 4),
        fourier((48, 48, 24), 2, 5), fourier((48, 48, 24), 3, 5),
        fourier((52, 52, 28), 3, 5), fourier((56, 56, 32), 3, 5),
        fourier((56, 56, 32), 4, 5), fourier((56, 56, 32), 4, 6),
    ),
    3.0: (
        balanced_fourier((28, 28, 8), 3, 3), balanced_fourier((28, 28, 12), 4, 3),
        balanced_fourier((28, 28, 12), 6, 3), balanced_fourier((32, 32, 12), 4, 4),
        balanced_fourier((36, 36, 16), 4, 4), balanced_fourier((40, 40, 16), 6, 4),
        fourier((28, 28, 16), 4, 2), fourier((32, 32, 8), 4, 3),
        fourier((32, 32, 12), 4, 3), fourier((32, 32, 16), 4, 3),
        fourier((32, 32, 16), 6, 3), fourier((36, 36, 16), 6, 3),
        fourier((40, 40, 12), 4, 4), fourier((40, 40, 16), 6, 4),
        fourier((40, 40, 16), 8, 4), fourier((44, 44, 16), 8, 5),
        fourier((48, 48, 16), 8, 5), fourier((48, 48, 16), 8, 6),
        fourier((52, 52, 24), 8, 6), fourier((52, 52, 20), 12, 6),
    ),
    10.0: (
        balanced_fourier((24, 24, 8), 12, 2), balanced_fourier((24, 24, 8), 20, 2),
        balanced_fourier((24, 24, 8), 12, 3), balanced_fourier((28, 28, 8), 16, 3),
        balanced_fourier((32, 32, 8), 16, 3), balanced_fourier((36, 36, 12), 20, 3),
        fourier((32, 32, 8), 20, 2), fourier((32, 32, 8), 20, 3),
        fourier((36, 36, 8), 20, 3), fourier((36, 36, 12), 20, 3),
        fourier((36, 36, 12), 24, 3), fourier((40, 40, 16), 24, 3),
        fourier((40, 40, 16), 32, 3), fourier((44, 44, 16), 24, 4),
        fourier((40, 40, 16), 32, 4), fourier((44, 44, 16), 32, 4),
        fourier((48, 48, 16), 32, 5), fourier((48, 48, 16), 48, 5),
        fourier((52, 52, 16), 48, 5), fourier((52, 52, 16), 64, 6),
    ),
}  # fmt: skip


def cubes() -> tuple[Case, ...]:
    """The grids that every solver is asked for, and finer ones."""
    sizes = (32, 64, 96, 128)
    plain = [case("drift_kick", (n, n, n), 1 / 8) for n in sizes]
    sharpest = [sharp(n, n, 16) for n in sizes]
    slow = [case("semi_lagrangian", (n, n, n), 1 / 8) for n in sizes]
    # Long steps, whose errors are still those of the peers on these cells.
    long = [case("semi_lagrangian", (64, 64, 64), 1 / 4)]
    return (*slow, *long, *plain, *sharpest)


QUICK_CASES = (
    case("semi_lagrangian", (16, 16, 16), 1 / 4),
    case("drift_kick", (16, 16, 16), 1 / 4),
    case("drift_kick", (24, 24, 16), 1 / 4, positive=True),
    case("drift_kick", (24, 24, 16), 1 / 4, balanced=True),
    case("drift_kick", (32, 32, 16), 1 / 4, **SHARP),
    fourier((24, 24, 16), 2, 2),
)


def cases(noise: float) -> tuple[Case, ...]:
    """Every case at one noise."""
    return (*SMALL, *SHARPEST[noise], *FOURIER[noise], *cubes())
