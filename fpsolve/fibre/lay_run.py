"""The steps of a fibre that is laid down, one after the other, and what is kept."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fpsolve._kernels.chain_series import chain_numbers
from fpsolve._support.arrays import Array
from fpsolve._support.interrupts import deferred_interrupts
from fpsolve._support.progress import ProgressCallback
from fpsolve.errors import RunError, RunInterrupted
from fpsolve.fibre.fed_chain import FedChain, FedStep
from fpsolve.fibre.fed_noise import FedDraws
from fpsolve.fibre.halving import Halving
from fpsolve.fibre.laid import LayDown
from fpsolve.fibre.lay_keeper import Keeper

__all__ = ["LayRun", "Record"]


@dataclass(eq=False)
class Record:
    """What was computed of a run until now.

    Attributes
    ----------
    t : ndarray, shape (n_steps + 1,)
    series : ndarray, shape (7, n_steps + 1)
        As `LayDown` has them, the two numbers of iterations and rejections last.
    chain : FedChain
    behind : list of ndarray, shape (n, 3)
        What was left behind, with its landing times.
    shapes, saved : list
        What was in the air, and at which steps.
    done : int
        Number of steps.
    """

    t: Array
    series: Array
    chain: FedChain
    behind: list[Array]
    shapes: list[Array]
    saved: list[int]
    done: int = 0

    @classmethod
    def first(cls, t: Array, chain: FedChain) -> Record:
        """Before any step."""
        return cls(t, np.zeros((7, t.size)), chain, [], [chain.r], [0])

    @classmethod
    def of(cls, part: LayDown, t: Array, every: int) -> Record:
        """As it was when the run was left, bit by bit."""
        done, chain = part.t.size - 1, part.last
        found = (
            part.kinetic, part.largest_tension, part.nozzle_tension, part.stretched,
            part.free_length, part.iterations, part.rejected,
        )  # fmt: skip
        series = np.zeros((7, t.size))
        series[:, : done + 1] = np.array(found)
        lying = len(part.landed) - len(chain.lying)
        landed = np.column_stack([part.landed, part.landing_times])[:lying]
        saved = np.searchsorted(t, part.saved).tolist()
        # The last shape of a part is that of its end, which may be one too many.
        kept = [k for k in saved if k % every == 0 or k == t.size - 1]
        shapes = list(part.r[: len(kept)])
        return cls(t, series, chain, [landed], shapes, kept, done)

    def result(self, step: FedStep, status: str = "finished") -> LayDown:
        """What `lay_down` returns, up to here."""
        shapes, saved = list(self.shapes), list(self.saved)
        if saved[-1] != self.done:
            shapes.append(self.chain.r)
            saved.append(self.done)
        landed = np.concatenate([*self.behind, self.chain.lying])
        kinetic, tension, nozzle, stretched, free, iterations, rejected = self.series[
            :, : self.done + 1
        ]
        counted = np.array([iterations, rejected], dtype=np.int64)
        return LayDown(
            step.string, step.belt, self.t[: self.done + 1], kinetic, tension,
            nozzle, stretched, free, counted[0], counted[1], landed[:, :2],
            landed[:, 2], self.t[saved], tuple(shapes), self.chain, status=status,
        )  # fmt: skip


@dataclass(eq=False)
class LayRun:
    """Steps one after the other, each in halves where it must be.

    Attributes
    ----------
    step : FedStep
    every : int
        How many steps lie between shapes that are kept.
    tolerance : float
    draws : FedDraws or None
    """

    step: FedStep
    every: int
    tolerance: float
    draws: FedDraws | None
    iterations: int = field(default=0, init=False)
    nozzle_tension: float = field(default=0.0, init=False)

    def result(
        self,
        record: Record,
        report: ProgressCallback,
        keeper: Keeper | None = None,
    ) -> LayDown:
        """Go on to the end; what stops it brings along what there was until then."""
        status = "interrupted"
        try:
            with deferred_interrupts() as raise_if_pressed:
                for number in self._numbers(record):
                    self._advance(record, number)
                    report(number, record.t.size - 1, float(record.t[number]))
                    raise_if_pressed()
                    if keeper is not None and keeper.due():
                        keeper.keep(record.result(self.step, status))
        except KeyboardInterrupt:
            part = record.result(self.step, status)
            if keeper is not None:
                keeper.keep(part)
            raise RunInterrupted(part) from None
        except RunError as error:
            error.solution = record.result(self.step, "failed")
            raise
        return record.result(self.step)

    def _numbers(self, record: Record) -> range:
        """Of the steps that are left; noise that remembers is drawn from the start."""
        if not record.done:
            record.series[:, 0] = *self._seen(record.chain), 0
        if self.draws is not None and self.draws.noise.correlation_time:
            for number in range(1, record.done + 1):
                self.draws.draw(number)
        return range(record.done + 1, record.t.size)

    def _advance(self, record: Record, number: int) -> None:
        """One step, and what is kept of it; all of it or nothing."""
        t, advanced = record.t, Halving(self._stepped, _apart, self.tolerance)
        self.iterations = 0
        if self.draws is not None:
            self.draws.draw(number)
        chain = advanced(record.chain, t[number - 1], t[number] - t[number - 1])
        record.series[:, number] = *self._seen(chain), advanced.rejected
        record.chain, left = self.step.trimmed(chain, t[number])
        record.behind.append(left)
        if number % self.every == 0 or number == t.size - 1:
            record.shapes.append(record.chain.r)
            record.saved.append(number)
        record.done = number

    def _stepped(self, chain: FedChain, t: float, dt: float) -> FedChain:
        """At t + dt, with what has come out."""
        force = None
        if self.draws is not None:
            masses = self.step.numbers(chain.tension.size).masses
            force = self.draws.force(chain, masses, t)
        new, iterations = self.step(chain, t, dt, force)
        self.iterations += iterations
        self.nozzle_tension = self.step.nozzle_tension(chain, new, t, dt)
        return self.step.after_feeding(new, t + dt)

    def _seen(self, chain: FedChain) -> tuple[float, ...]:
        """The series at one time."""
        masses = self.step.numbers(chain.tension.size).masses
        kinetic, largest, *others = chain_numbers(
            chain.r, chain.v, chain.tension, masses, chain.laid, self.step.string.edge
        )
        return (kinetic, largest, self.nozzle_tension, *others, self.iterations)


def _apart(before: FedChain, one: FedChain, other: FedChain) -> float:
    """Largest distance of nodes; 0 where one has landed since, which has no order."""
    landed = before.laid.sum()
    if one.laid.sum() > landed or other.laid.sum() > landed:
        return 0.0
    return float(np.linalg.norm(one.r - other.r, axis=1).max())
