"""What decides the result of a run, as a dictionary, and what differs between two."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.grids import PhaseSpaceGrid
from fpsolve.models import LayDownModel
from fpsolve.schemes import DriftKick, SemiLagrangian

if TYPE_CHECKING:
    from fpsolve.solve import Scheme

__all__ = ["RunDescription", "digest_of", "run_arguments"]

Array = NDArray[np.float64]

_SCHEMES: tuple[type[Any], ...] = (DriftKick, SemiLagrangian)
# Where an object lies in memory is not what it is.
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")
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


def digest_of(values: Array | None) -> str | None:
    """Return the SHA-256 of shape and bits; None for None."""
    if values is None:
        return None
    values = np.ascontiguousarray(values, dtype=np.float64)
    found = hashlib.sha256(str(values.shape).encode())
    found.update(values.data)
    return found.hexdigest()


@dataclass(frozen=True)
class RunDescription:
    """Everything that decides the bits of a result but versions and machine.

    Attributes
    ----------
    model : dict
        A potential of user code is described by its values on the grid.
    grid : dict
    scheme : dict
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
        kind = type(scheme)
        return cls(
            _plain(_describe_model(scheme.model, scheme.grid)),
            _plain(scheme.grid.to_dict()),
            _plain(
                {
                    "kind": scheme.name,
                    "class": f"{kind.__module__}.{kind.__qualname__}",
                    "order": scheme.order,
                    **scheme.options,
                }
            ),
            _plain(dict(arguments)),
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
        return tuple(found)

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
        for kind in _SCHEMES:
            if home == f"{kind.__module__}.{kind.__qualname__}":
                model = LayDownModel.from_dict(self.model)
                built: Scheme = kind(
                    model, PhaseSpaceGrid.from_dict(self.grid), **options
                )
                return built
        raise ValueError(
            f"`scheme` must be one of fpsolve to be built again, got {name} ({home})"
        )


def _describe_model(model: LayDownModel, grid: PhaseSpaceGrid) -> dict[str, Any]:
    description = model.to_dict()
    if not type(model.potential).__module__.startswith("fpsolve.") or (
        description["potential"].get("kind") == "callable"
    ):
        # Names of functions say little about what they compute.
        plane = grid.plane()
        values = [model.potential.value(*plane), *model.potential.gradient(*plane)]
        shape = grid.shape[:2]
        stacked = np.array([np.broadcast_to(part, shape) for part in values])
        description["potential"]["values"] = digest_of(stacked)
    return description


def _plain(value: Any) -> Any:
    """Return the value as it comes back from JSON."""
    text = json.dumps(value, default=_without_address, ensure_ascii=False)
    return json.loads(_ADDRESS.sub("", text))


def _without_address(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    return value.tolist() if isinstance(value, np.ndarray) else repr(value)


def _compare(name: str, old: Any, new: Any) -> Iterator[str]:
    """Yield a line for every leaf that differs."""
    tables = isinstance(old, dict) and isinstance(new, dict)
    if tables and old.get("kind") == new.get("kind"):
        for key in {**old, **new}:
            path = f"{name}.{key}" if name else key
            yield from _compare(path, old.get(key), new.get(key))
    elif old != new:
        before, after = _text(old), _text(new)
        if max(len(before), len(after)) > _LONGEST or "values" in name.split("."):
            yield f"`{name.removesuffix('.values')}` holds other values"
        else:
            yield f"`{name}` was {before}, is {after}"


def _text(value: Any) -> str:
    if not isinstance(value, dict):
        return "not given" if value is None else repr(value)
    own = {key: entry for key, entry in value.items() if key not in ("class", "order")}
    kind = own.pop("kind", "")
    text = f"{kind}({', '.join(f'{key}={entry!r}' for key, entry in own.items())})"
    return text if len(text) <= _LONGEST else str(kind)
