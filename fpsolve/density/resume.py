"""Go on with a run from its checkpoint alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from fpsolve._support.checks import check_path
from fpsolve._support.progress import ProgressCallback
from fpsolve.density.checkpoints.checkpoint import Checkpoint
from fpsolve.density.checkpoints.manifest import read_manifest
from fpsolve.density.checkpoints.start import read_start
from fpsolve.density.schemes.dictionaries import scheme_from_dict
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.solution import Solution
from fpsolve.density.solve import solve
from fpsolve.errors import FileFormatError
from fpsolve.grids.dictionaries import grid_from_dict
from fpsolve.model.reading import model_from_dict

__all__ = ["resume"]


def resume(
    directory: str | os.PathLike[str],
    *,
    every: int | str | None = None,
    progress: bool | ProgressCallback = False,
    memory_limit: int | None = None,
) -> Solution:
    """Complete the run whose checkpoint is in a folder; bitwise as if never stopped.

    Model, grid, scheme, initial density and arguments come from the folder. A run that
    was complete gives its result at once.

    Parameters
    ----------
    directory : str or os.PathLike
        What `checkpoint` of `solve` named.
    every : int or str, optional
        Interval of further checkpoints, if it is to be another one.
    progress, memory_limit
        As for `solve`.

    Returns
    -------
    Solution

    Raises
    ------
    FileNotFoundError, FileFormatError
        If it is not a checkpoint, or damaged, or of a newer version.
    ValueError
        If potential, curve, scheme or what is observed are a user's own code, which
        no file holds: call `solve` with the same arguments then.
    CheckpointError
        If another run is writing to it, or it cannot be written.
    """
    folder = check_path("directory", directory)
    manifest = read_manifest(folder)
    arrays = read_start(folder, manifest.run)
    try:
        _check_own(manifest.run)
        scheme = _scheme(manifest.run["scheme"]["$scheme"])
    except ValueError as error:
        reason = str(error).rstrip(".")
        raise ValueError(
            f"`directory` must be the checkpoint of a run made of parts of fpsolve, "
            f"got `{folder}`: {reason}; call `solve` with the arguments of that run "
            "and `checkpoint` to go on."
        ) from None
    except TypeError as error:
        raise FileFormatError(folder, str(error).rstrip(".")) from None
    return solve(
        **{**manifest.run, **arrays, "scheme": scheme},
        progress=progress,
        memory_limit=memory_limit,
        checkpoint=Checkpoint(
            folder, manifest.every if every is None else every, manifest.notes
        ),
    )


def _scheme(about: Mapping[str, Any]) -> Scheme:
    """The scheme with its model and grid; ValueError if one is a user's own code."""
    model = model_from_dict(about["model"]["$model"])
    grid = grid_from_dict(about["grid"]["$grid"])
    return scheme_from_dict(about["scheme"], model, grid)


def _check_own(run: Mapping[str, Any]) -> None:
    """Raise ValueError if the run recorded numbers of the caller's own."""
    if run.get("observe"):
        names = ", ".join(map(repr, run["observe"]))
        raise ValueError(f"`observe` must not hold functions of your own, got {names}")
