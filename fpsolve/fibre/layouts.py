"""How motions of a fibre, and fibres that were laid down, are stored: in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.labels import check_complete, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import STATUS
from fpsolve.fibre.ends import Belt
from fpsolve.fibre.fed_chain import FedChain
from fpsolve.fibre.string import String

__all__ = ["LAY_DOWN", "MOTION", "Quantity"]

_NODES = ("saved", "node", "axis")
# What the end of a run consists of, and over what.
_OF_LAST = {
    "r": ("last_node", "axis"), "v": ("last_node", "axis"),
    "tension": ("last_edge",), "laid": ("last_node",),
    "on_belt": ("last_node", "coordinate"),
}  # fmt: skip


@dataclass(frozen=True)
class Quantity(Variable):
    """A field of numbers with a unit.

    Attributes
    ----------
    units : str
    """

    units: str = "1"

    def write(self, result: Any) -> Stored:
        """One, with its long name and its unit."""
        return {
            name: (dims, values, {**about, "units": self.units})
            for name, (dims, values, about) in super().write(result).items()
        }


class _Shapes(Part):
    """Positions and velocities of all nodes where they were saved."""

    needed = ("r", "v")

    def write(self, result: Any) -> Stored:
        return {
            "r": (_NODES, result.r, {"long_name": "positions", "units": "m"}),
            "v": (_NODES, result.v, {"long_name": "velocities", "units": "m s-1"}),
        }

    def read(self, source: Source) -> dict[str, Any]:
        shape = (source.fields["saved"].size, source.fields["string"].n_edges + 1, 3)
        for name in self.needed:
            check_dimensions(source.dataset, name, _NODES)
            check_counts("string", shape, source.dataset[name].shape, f"`{name}`")
        return {name: source.dataset[name].values for name in self.needed}


class _InTheAir(Part):
    """Positions of what was in the air, whose nodes come and go."""

    needed = ("r", "n_nodes")

    def write(self, result: Any) -> Stored:
        words = "positions in the air, one time after the other"
        counts = np.array([len(one) for one in result.r])
        return {
            "r": (("node", "axis"), np.concatenate(result.r),
                  {"long_name": words, "units": "m"}),
            "n_nodes": ("saved", counts,
                        {"long_name": "number of nodes in the air", "units": "1"}),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        check_dimensions(dataset, "r", ("node", "axis"))
        check_dimensions(dataset, "n_nodes", ("saved",))
        counts, r = dataset["n_nodes"].values, dataset["r"].values
        check_counts("n_nodes", int(counts.sum()), len(r), "`r`")
        check_counts("saved", source.fields["saved"].size, counts.size, "`n_nodes`")
        return {"r": tuple(np.split(r, np.cumsum(counts)[:-1]))}


class _Landed(Part):
    """Nodes on the belt and since when; left out without any, as files must have it."""

    _over = ("landed", "component")

    def write(self, result: Any) -> Stored:
        if not len(result.landed):
            return {}
        place = {"long_name": "nodes on the belt, in its frame", "units": "m"}
        since = {"long_name": "since when a node lies", "units": "s"}
        return {
            "landed": (self._over, result.landed, place),
            "landing_times": (self._over[:1], result.landing_times, since),
        }

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        if "landed" not in dataset:
            return {"landed": np.empty((0, 2)), "landing_times": np.empty(0)}
        check_complete(dataset, "landing_times")
        check_dimensions(dataset, "landed", self._over)
        check_dimensions(dataset, "landing_times", self._over[:1])
        names = ("landed", "landing_times")
        return {name: dataset[name].values for name in names}


class _Last(Part):
    """The end of the run, from which it goes on."""

    needed = (*(f"last_{name}" for name in _OF_LAST), "newest")

    def write(self, result: Any) -> Stored:
        last, stored = result.last, {"newest": result.last.newest}
        for name, dims in _OF_LAST.items():
            # Files have no truth values; 2 is what lies and slides.
            values = np.asarray(getattr(last, name))
            if name == "laid":
                values = values.astype(np.int8) + last.sliding
            about = {"long_name": f"{name.replace('_', ' ')} at the end of the run"}
            stored[f"last_{name}"] = (dims, values, about)
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        found = {}
        for name, dims in _OF_LAST.items():
            check_dimensions(source.dataset, f"last_{name}", dims)
            found[name] = source.dataset[f"last_{name}"].values
        n = found["tension"].size + 1
        check_counts("last_tension", n, found["laid"].size, "`last_laid`")
        found["sliding"] = found["laid"] == 2
        found["laid"] = found["laid"].astype(bool)
        return {"last": FedChain(**found, newest=int(source.about["newest"]))}


_STRING = Attribute(
    "string", write_as=lambda string: to_json(string.to_dict()),
    read_as=String.from_dict,
)  # fmt: skip
_BELT = Attribute(
    "belt", optional=True,
    write_as=lambda belt: to_json(belt.to_dict()),
    read_as=lambda about: Belt(**about),
)  # fmt: skip
_TIMES = Quantity("t", ("t",), "time at the end of a step", increasing=True, units="s")
_SAVED = Quantity("saved", ("saved",), "times that were kept", increasing=True,
                  units="s")  # fmt: skip
_SERIES = (
    Quantity("kinetic", ("t",), "energy of motion", units="J"),
    Quantity("largest_tension", ("t",), "largest tension of an edge", units="N"),
    Quantity("stretched", ("t",), "largest relative deviation of an edge"),
    Quantity("iterations", ("t",), "iterations of Newton's method"),
)
_ERROR = Quantity("position_error", (), "bound of the error of the last positions",
                  kind=float, units="m")  # fmt: skip

MOTION = Layout(
    "Motion of a fibre",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    _STRING,
    _TIMES,
    *_SERIES,
    Quantity("potential", ("t",), "energy of bending and weight", units="J"),
    Quantity("end_tension", ("t", "end"), "tension at both ends", units="N"),
    _SAVED,
    _Shapes(),
    _ERROR,
    Quantity("end_tension_error", ("end",), "bounds of the errors of the last ones",
             units="N"),
)  # fmt: skip
LAY_DOWN = Layout(
    "Fibre laid down on a belt",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    _STRING,
    _BELT,
    _TIMES,
    *_SERIES,
    Quantity("nozzle_tension", ("t",), "tension where the fibre leaves the nozzle",
             units="N"),
    Quantity("free_length", ("t",), "length of fibre that does not lie", units="m"),
    Quantity("rejected", ("t",), "steps that were taken in halves"),
    _Landed(),
    _SAVED,
    _InTheAir(),
    _Last(),
    _ERROR,
    STATUS,
)  # fmt: skip
