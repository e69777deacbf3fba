"""The noise that pulls at a fibre whose nodes come out of a nozzle and are laid."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.edge_turns import EdgeTurns
from fpsolve.fibre.fed_chain import FedChain
from fpsolve.fibre.random_force import Noise, StochasticForce, noise_force
from fpsolve.fibre.string import String

__all__ = ["FedDraws"]

# Noises that are drawn in a step, for more nodes than that in the air.
MOST_NOISES = 4096


@dataclass(eq=False)
class FedDraws:
    """Forces on the nodes of a `FedChain`: √h A(r⁰, v⁰) times the noise.

    Nodes are numbered from the end of the fibre, and each keeps its noise for as long
    as it is there. There are as many noises as nodes of the run, or `MOST_NOISES`,
    which follow each other; so many nodes in the air at once are refused.

    Attributes
    ----------
    law : StochasticForce
    string : String
    air : AirFlow or None
    dt : float
        Of a whole step.
    seed : int
    n_nodes : int
        Of the whole run.
    pieces : int
    turns : EdgeTurns or None
        What judges the strength of the noise, once in every step.
    """

    law: StochasticForce
    string: String
    air: AirFlow | None
    dt: float
    seed: int
    n_nodes: int
    pieces: int = 1
    turns: EdgeTurns | None = None
    noise: Noise = field(init=False, repr=False)
    _mean: Array = field(init=False, repr=False)
    _judged: bool = field(default=False, init=False, repr=False)

    def __post_init__(self) -> None:
        size, time = min(self.n_nodes, MOST_NOISES), self.law.correlation_time
        self.noise = Noise(size, time, self.dt, self.seed, self.pieces)

    def draw(self, number: int) -> None:
        """Noise of the step of this number; to be asked for 1, 2, … in turn."""
        self._mean, self._judged = self.noise.mean(number), False

    def force(self, chain: FedChain, masses: Array, t: float) -> Array:
        """On every node, in N, shape (n, 3), throughout the step or a part of it.

        Raises
        ------
        ValueError
            If more nodes are in the air than there are noises.
        NoiseStrengthError
            If the noise is too strong for the steps.
        """
        size = self.noise.size
        if not masses.size <= size:
            raise ValueError(
                f"`string` must have at most {size} nodes in the air, got "
                f"{masses.size} at t = {t:g} s; take longer edges or lower the nozzle."
            )
        numbers = chain.newest - np.arange(masses.size)
        lengths = masses / self.string.line_density
        amplitudes = self.law.amplitudes(self.string, self.air, chain.r, chain.v, t)
        if self.turns is not None and not self._judged:
            self._judged = True
            self.turns.check(amplitudes, chain.r, chain.v, t, ~chain.laid)
        return noise_force(lengths, amplitudes, self._mean[numbers % size])
