"""An ensemble of fibres that are laid on a belt, here or elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from functools import partial
from typing import Any

from fpsolve._support.checks import check_integer, check_positive, shown
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.fibre.laid import LayDown
from fpsolve.fibre.laying import lay_down
from fpsolve.fibre.random_force import StochasticForce
from fpsolve.fibre.string import String

__all__ = ["lay_down_all"]

# One file, or one seed, cannot be that of many fibres.
OF_ONE = ("checkpoint", "seed")


def lay_down_all(
    string: String,
    t_end: float,
    n_steps: int,
    *,
    turbulence: StochasticForce,
    seeds: Sequence[int],
    client: Any = None,
    progress: bool | ProgressCallback = False,
    **options: Any,
) -> list[LayDown]:
    """`lay_down` for every seed: independent fibres in the same noise A·dw_{s,t}.

    Each is bit by bit that of a single call with its seed, wherever it is computed and
    whatever is beside it, and says so: `fp.rerun` repeats any of them alone.

    Parameters
    ----------
    string, t_end, n_steps, turbulence
        As for `lay_down`.
    seeds : sequence of int
        One for every fibre; no two are the same, since these would not be independent.
    client : optional
        Where to lay: a dask.distributed client, or an executor of concurrent.futures;
        anything whose ``submit(f, *args)`` gives a future. By default here, one after
        the other. What a process is given is pickled: functions for the air must be
        those of a module.
    progress : bool or callable
        A bar, or a function of (fibres done, fibres in all, t_end).
    **options
        All others of `lay_down` but `checkpoint`.

    Returns
    -------
    list of LayDown
        In the order of the seeds.

    Raises
    ------
    ValueError, TypeError
        As `lay_down`; if there are no seeds, or two are the same; if the client takes
        no work.
    RunError, RunInterrupted
        Of the first fibre, in the order of the seeds, that is not laid, with a note of
        its seed; what has not begun then is not laid. Its `solution` is that fibre.

    References
    ----------
    [KMW09]_, section 2.2.
    """
    seeds = _checked_seeds(seeds)
    t_end = check_positive("t_end", t_end)
    if not hasattr(turbulence, "amplitudes"):
        raise TypeError(
            "`turbulence` must be a `RandomForce` or a `TurbulentForce`, got "
            f"{shown(turbulence)}; without noise all fibres are the same."
        )
    for name in OF_ONE:
        if name in options:
            raise TypeError(
                f"`{name}` is of one fibre, got {shown(options[name])}; `lay_down_all` "
                "takes `seeds`, and no checkpoint."
            )
    given = {"turbulence": turbulence, **options}
    lay = partial(_laid, string, t_end, n_steps, given)
    found = []
    promised = closing(_promised(lay, seeds, client))
    with reporting(progress) as report, promised as fibres:
        for seed, wanted in zip(seeds, fibres, strict=True):
            try:
                found.append(wanted())
            except BaseException as error:
                error.add_note(f"in the fibre of seed {seed}")
                raise
            report(len(found), len(seeds), t_end)
    return found


def _laid(
    string: String, t_end: float, n_steps: int, options: dict[str, Any], seed: int
) -> LayDown:
    return lay_down(string, t_end, n_steps, seed=seed, **options)


def _checked_seeds(seeds: Any) -> list[int]:
    """As integers; ValueError unless there are some, all different."""
    try:
        listed = list(seeds)
    except TypeError:
        raise TypeError(
            f"`seeds` must be a sequence of integers, got {shown(seeds)}; range(25) "
            "is one."
        ) from None
    checked = [check_integer("seeds", seed, 0) for seed in listed]
    if not checked or len(set(checked)) < len(checked):
        raise ValueError(
            f"`seeds` must be one or more, no two the same, got {shown(checked)}."
        )
    return checked


def _promised(
    lay: Callable[[int], LayDown], seeds: list[int], client: Any
) -> Generator[Callable[[], LayDown], None, None]:
    """For every seed what gives its fibre; left early, nothing more is begun."""
    if client is None:
        yield from (partial(lay, seed) for seed in seeds)
        return
    if not hasattr(client, "submit"):
        raise TypeError(
            f"`client` must have a method submit(f, *args), got {client!r}; pass a "
            "dask.distributed client or an executor."
        )
    futures = [client.submit(lay, seed) for seed in seeds]
    try:
        yield from (future.result for future in futures)
    finally:
        for future in futures:
            future.cancel()
