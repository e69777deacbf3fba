"""Configuration files of webs that cannot be laid."""

from __future__ import annotations

from fpsolve.errors import MemoryLimitError

from .cases import Case
from .configurations import PATHS, PROCESS, RUN, added, changed, written

WEB = (
    PROCESS[: PROCESS.index(b"[grid]")]
    + b"""
[web]
width = 0.02
length = 0.04
pixel = 1e-3
spacing = 2e-3
titer = 1.5e-4
seed = 1
"""
)

WEB_FILES = [
    Case("a spacing of zero", changed(b"spacing = 2e-3", b"spacing = 0.0", WEB),
         "got 0", r"section \[web\]: `spacing` must be positive"),
    Case("a spacing below zero", changed(b"spacing = 2e-3", b"spacing = -1.0", WEB),
         "got -1", "`spacing` must be positive"),
    Case("no spacing", changed(b"spacing = 2e-3\n", b"", WEB),
         "got None", "`spacing` must be"),
    Case("a spacing in words", changed(b"spacing = 2e-3", b'spacing = "2 mm"', WEB),
         "got '2 mm'", "`spacing` must be a number"),
    Case("a unit of lengths", added(b'unit = "mm"\n', WEB),
         "`unit` is not a key", "Keys are width, length, pixel, spacing"),
    Case("a titer in dtex", changed(b"titer = 1.5e-4", b"titer = 1.5", WEB),
         "got 1.5", "dtex given instead"),
    Case("a titer of a model without units",
         added(WEB[WEB.index(b"[web]") :], PATHS[: PATHS.index(b"[paths]")]
               + b'[curve]\nkind = "moving_belt"\nspeed = 0.1\n'),
         "got 0.00015", "`titer` must be given with a Process"),
    Case("a window that is no multiple",
         changed(b"width = 0.02", b"width = 0.0205", WEB),
         "got 0.0205", "`width` must be a multiple of `pixel`"),
    Case("a pixel larger than the window",
         changed(b"pixel = 1e-3", b"pixel = 1.0", WEB),
         "got 1", "must not be larger than the window"),
    Case("a pixel of zero", changed(b"pixel = 1e-3", b"pixel = 0.0", WEB),
         "got 0", "`pixel` must be positive"),
    Case("a length that is nan", changed(b"length = 0.04", b"length = nan", WEB),
         "got nan", "`length` must be positive and finite"),
    Case("unknown positions", added(b'positions = "hexagonal"\n', WEB),
         "got 'hexagonal'", "'regular' or 'random'"),
    Case("one position in words", added(b'positions = [0.0, "far"]\n', WEB),
         r"got .*far", r"`positions"),
    Case("unknown phases", added(b'phases = "random"\n', WEB),
         "got 'random'", "'independent' or 'in phase'"),
    Case("a zone larger than the web", added(b"zones = [0.1]\n", WEB),
         "got 0.1", "the shorter side of the window, 0.02"),
    Case("a zone smaller than a pixel", added(b"zones = [1e-4]\n", WEB),
         "got 0.0001", "`zones` must lie between `pixel`"),
    Case("a picture of an unknown kind", added(b'exports = ["jpeg"]\n', WEB),
         "got 'jpeg'", "'png', 'tiff', 'vtp' or 'csv'"),
    Case("a seed of a web below zero", changed(b"seed = 1", b"seed = -1", WEB),
         "got -1", "at least 0"),
    Case("a process with a belt at rest",
         changed(b"speed_ratio = 0.1", b"speed_ratio = 0.0", WEB),
         "FixedBelt", "must have a moving belt"),
    Case("no section of a web", written(PROCESS[: PROCESS.index(b"[grid]")]),
         "got none", r"section \[web\] must be given"),
    Case("a run in the file of a web", written(RUN),
         "its sections are those of `fpsolve run`", "give it to that command"),
]  # fmt: skip

ABSURD_WEBS = [
    Case("a raster beyond memory", changed(b"pixel = 1e-3", b"pixel = 1e-9", WEB),
         "are available", "use larger pixels", MemoryLimitError),
]  # fmt: skip
