"""What decides a web, its base weight and its throughput."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.process import Process

__all__ = ["BASE_WEIGHT", "OF_PROCESS", "PARAMETERS", "Settings"]

OF_PROCESS = ("noise", "sigma1", "sigma2", "speed_ratio", "relaxation_length")
PARAMETERS = (*OF_PROCESS[:4], "spacing", "titer", "relaxation_length")
# log titer = log (base weight) + log v + log d, as the signs of these logarithms.
BASE_WEIGHT = {"speed_ratio": 1.0, "spacing": 1.0, "titer": -1.0}
# Of grams per second in kilograms per hour.
_PER_HOUR = 3.6


@dataclass(frozen=True)
class Settings:
    """A process with its spinning positions and the titer of its fibres, in SI units.

    Attributes
    ----------
    process : Process
    spacing : float
        Distance d of the spinning positions in metres.
    titer : float
        Mass of the fibre in grams per metre.
    """

    process: Process
    spacing: float
    titer: float

    @property
    def base_weight(self) -> float:
        """titer/(v d) in g/m²."""
        return self.titer / (abs(self.process.speed_ratio) * self.spacing)

    @property
    def throughput(self) -> float:
        """Base weight times belt speed, titer U/d, in kg/h per metre of width."""
        return _PER_HOUR * self.titer * self.process.spinning_speed / self.spacing

    @property
    def values(self) -> Array:
        """The numbers of `PARAMETERS`, the belt speed without its sign.

        The relaxation length of a basic fibre is zero.
        """
        process = self.process
        numbers = [getattr(process, name) for name in OF_PROCESS[:4]]
        length = process.relaxation_length or 0.0
        return np.abs([*numbers, self.spacing, self.titer, length])

    def changed(self, names: tuple[str, ...], values: Array) -> Settings:
        """With other numbers for some parameters; the belt keeps its direction."""
        given = dict(zip(names, map(float, values), strict=True))
        if "speed_ratio" in given and self.process.speed_ratio < 0:
            given["speed_ratio"] *= -1.0
        own = {name: given.pop(name) for name in OF_PROCESS if name in given}
        with warnings.catch_warnings():
            # Of the industrial ranges the bounds have been told.
            warnings.simplefilter("ignore", UserWarning)
            process = replace(self.process, **own)
        return replace(self, process=process, **given)
