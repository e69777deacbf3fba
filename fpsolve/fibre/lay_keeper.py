"""A fibre that is laid down, kept in a file until it is at its end."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

from fpsolve._support.labels import to_json
from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import restored
from fpsolve.fibre.laid import LayDown

__all__ = ["Keeper"]

# Seconds between two checkpoints.
BETWEEN = 60.0


@dataclass(eq=False)
class Keeper:
    """Where a run is kept that is not at its end, and whose it is.

    Attributes
    ----------
    path : Path
    call : Call
        Of which the run is.
    """

    path: Path
    call: Call
    _written: float = field(default_factory=time.monotonic, init=False)

    def found(self) -> LayDown | None:
        """The run that was left there.

        Raises
        ------
        ValueError
            If it is one of other arguments.
        FileFormatError
            If it is no run, or damaged.
        """
        if not self.path.exists():
            return None
        dataset = read_dataset(self.path)
        with reported_damage(self.path, Exception):
            if dataset.attrs["fpsolve_kind"] != LayDown.kind:
                raise ValueError("it holds no fibre that is laid down")
            part = restored(LayDown, dataset)
        if part.call is None or not same_call(part.call, self.call):
            raise ValueError(
                f"`checkpoint` must be of the same arguments, got `{self.path}` of "
                "others; give them, or remove the file."
            )
        return part

    def due(self) -> bool:
        """Whether the last time is long ago."""
        return time.monotonic() - self._written >= BETWEEN

    def keep(self, part: LayDown) -> None:
        """Write what there is, in the place of what was."""
        replace(part, call=self.call).save(self.path)
        self._written = time.monotonic()

    def remove(self) -> None:
        """Remove the file of a run that is at its end."""
        self.path.unlink(missing_ok=True)


def same_call(one: Call, other: Call) -> bool:
    """Whether both are of the same arguments, read from a file or not."""
    mine, its = (json.loads(to_json(call.arguments)) for call in (one, other))
    return one.function == other.function and bool(mine == its)
