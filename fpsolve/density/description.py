"""What decides the result of a run, as a dictionary, and what differs between two."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.digests import SAMPLED, digest_of, plain
from fpsolve.density.schemes.known import SCHEMES
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.evolution.call import IDENTITY
from fpsolve.evolution.schedule import Schedule, make_schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves.samples import digest_of_curve
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.samples import digest_of_potential

__all__ = [
    "CODE",
    "RunDescription",
    "describe_scheme",
    "described_scheme",
    "run_arguments",
]

Array = NDArray[np.float64]

# Keys of digests, and what these are digests of.
CODE, _STEP = "code", "first_step"
_DIGESTS = {SAMPLED: "values", CODE: "code", _STEP: "values", IDENTITY: "code"}
# A value that takes more characters is not shown.
_LONGEST = 50


def run_arguments(
    s_span: Iterable[float],
    ds: float,
    save_at: Iterable[float] | None,
    record_every: int,
    extrapolate: bool,
    **tolerances: float,
) -> dict[str, Any]:
    """Return the arguments of `solve` as JSON has them: ``solve(scheme, p0, **these)``.

    Parameters
    ----------
    s_span, ds, save_at
        As for `solve`.
    record_every, extrapolate, **tolerances
        Likewise.
    """
    return {
        "s_span": [float(s) for s in s_span],
        "ds": float(ds),
        "save_at": None if save_at is None else [float(s) for s in save_at],
        "record_every": int(record_every),
        "extrapolate": bool(extrapolate),
        **{name: float(value) for name, value in tolerances.items()},
    }


@dataclass(frozen=True)
class RunDescription:
    """Everything that decides the bits of a result but versions and machine.

    Attributes
    ----------
    model : dict
        A potential of a user's own also by what it computes on the grid, a curve by
        where it is on the steps of the run.
    grid : dict
    scheme : dict
        One of a user's own also by the code of its class, and by what its first step
        makes of `p0`.
    arguments : dict
        Those of `solve`; see `run_arguments`.
    start : dict
        SHA-256 of `p0` and of `reference`.
    """

    model: dict[str, Any]
    grid: dict[str, Any]
    scheme: dict[str, Any]
    arguments: dict[str, Any]
    start: dict[str, Any]

    @classmethod
    def of(
        cls,
        scheme: Scheme,
        p0: Array,
        reference: Array | None,
        arguments: Mapping[str, Any],
    ) -> RunDescription:
        """Return the description of ``solve(scheme, p0, **arguments)``."""
        schedule = make_schedule(arguments["s_span"], arguments["ds"])
        last = schedule.refined() if arguments["extrapolate"] else schedule
        return cls(
            plain(_describe_model(scheme.model, scheme.grid, last)),
            plain(scheme.grid.to_dict()),
            plain(_describe_scheme(scheme, p0, schedule)),
            plain(dict(arguments)),
            {"p0": digest_of(p0), "reference": digest_of(reference)},
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the description as a dictionary that JSON can hold."""
        return asdict(self)

    @classmethod
    def from_dict(cls, description: Mapping[str, Any]) -> RunDescription:
        """Return what `to_dict` described."""
        return cls(**description)

    @property
    def digest(self) -> str:
        """SHA-256 of the description."""
        text = json.dumps(self.to_dict(), sort_keys=True, ensure_ascii=False)
        return hashlib.sha256(text.encode()).hexdigest()

    def differences(self, other: RunDescription) -> tuple[str, ...]:
        """Name every argument in which `other` differs, with both values."""
        found = [
            *_compare("", self.model, other.model),
            *_compare("grid", self.grid, other.grid),
            *_compare("scheme", self.scheme, other.scheme),
            *_compare("", self.arguments, other.arguments),
        ]
        for name, digest in self.start.items():
            if other.start.get(name) != digest:
                found.append(f"`{name}` holds other values")
        # One function may differ in more than one of these.
        return tuple(dict.fromkeys(found))

    def build_scheme(self) -> Scheme:
        """Return the scheme with its model and grid.

        Raises
        ------
        ValueError
            If potential, curve or scheme are a user's own code.
        """
        options = dict(self.scheme)
        name, home = options.pop("kind"), options.pop("class")
        del options["order"]
        for kind in SCHEMES.values():
            if home == f"{kind.__module__}.{kind.__qualname__}":
                model = LayDownModel.from_dict(self.model)
                built: Scheme = kind(
                    model, PhaseSpaceGrid.from_dict(self.grid), **options
                )
                return built
        raise ValueError(
            f"`scheme` must be one of fpsolve to be built again, got {name} ({home})"
        )


def _describe_model(
    model: LayDownModel, grid: PhaseSpaceGrid, schedule: Schedule
) -> dict[str, Any]:
    """The model; a user's own parts by what they return where schemes ask them.

    Forces are asked for at the centres of cells and between them, the curve at steps
    and at halves of them.
    """
    description = model.to_dict()
    potential, curve = description["potential"], description["curve"]
    if SAMPLED in potential:
        finer = _refined(grid.xi1)[:, None], _refined(grid.xi2)[None, :]
        places = grid.plane(), finer
        potential[SAMPLED] = digest_of_potential(model.potential, *places)
    if SAMPLED in curve:
        halves = np.arange(2 * schedule.n_steps + 1, dtype=np.float64)
        stops = schedule.start + schedule.ds / 2 * halves
        curve[SAMPLED] = digest_of_curve(model.curve, stops)
    return description


def _refined(centres: Array) -> Array:
    """Faces and centres of cells, and the middle between each two of them."""
    spacing = centres[1] - centres[0]
    quarters = np.arange(4 * centres.size + 1, dtype=np.float64) / 4
    return np.asarray(centres[0] + spacing * (quarters - 0.5))


def _describe_scheme(scheme: Scheme, p0: Array, schedule: Schedule) -> dict[str, Any]:
    kind = type(scheme)
    description = {
        "kind": scheme.name,
        "class": f"{kind.__module__}.{kind.__qualname__}",
        "order": scheme.order,
        **scheme.options,
    }
    if kind in SCHEMES.values():
        return description
    own = {CODE: _code_of(kind), _STEP: _first_step(scheme, p0, schedule)}
    return {**description, **own}


def describe_scheme(scheme: Scheme) -> dict[str, Any]:
    """Return name, order and options of a scheme, ready for JSON.

    Of a user's own class, which may have inherited a name, also a digest of its code.
    """
    kind = type(scheme)
    return {
        "name": scheme.name,
        "order": scheme.order,
        "options": dict(scheme.options),
        **({} if kind in SCHEMES.values() else {CODE: _code_of(kind)}),
    }


def described_scheme(scheme: Any, arguments: Any = None) -> Any:
    """Return what a call says of a scheme; of a model in its place, the model."""
    if scheme is None or isinstance(scheme, LayDownModel):
        return scheme
    about = describe_scheme(scheme)
    return {"$scheme": {"scheme": about, "model": scheme.model, "grid": scheme.grid}}


def _code_of(kind: type[Any]) -> str | None:
    return digest_or_none(kind, sampled=False)


def _first_step(scheme: Scheme, p0: Array, schedule: Schedule) -> str | None:
    """What a scheme of unknown code does to p0; None if it fails, as the run will."""
    # A user's scheme raises whatever it likes.
    try:
        state = scheme.start(p0)
        scheme.advance(state, schedule.start, schedule.ds)
        return digest_of(scheme.density(state))
    except Exception:
        return None


def _compare(name: str, old: Any, new: Any) -> Iterator[str]:
    """Yield a line for every leaf that differs."""
    tables = isinstance(old, dict) and isinstance(new, dict)
    if tables and old.get("kind") == new.get("kind"):
        for key in {**old, **new}:
            path = f"{name}.{key}" if name else key
            yield from _compare(path, old.get(key), new.get(key))
    elif old != new:
        before, after = _text(old), _text(new)
        owner, _, last = name.rpartition(".")
        if last in _DIGESTS:
            yield f"`{owner}` holds other {_DIGESTS[last]}"
        elif max(len(before), len(after)) > _LONGEST:
            yield f"`{name}` holds other values"
        else:
            yield f"`{name}` was {before}, is {after}"


def _text(value: Any) -> str:
    if not isinstance(value, dict):
        return "not given" if value is None else repr(value)
    own = {key: entry for key, entry in value.items() if key not in ("class", "order")}
    kind = own.pop("kind", "")
    text = f"{kind}({', '.join(f'{key}={entry!r}' for key, entry in own.items())})"
    return text if len(text) <= _LONGEST else str(kind)
