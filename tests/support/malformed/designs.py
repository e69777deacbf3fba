"""Designs of webs that cannot be searched, by Python and in files."""

from __future__ import annotations

from dataclasses import replace

import fpsolve as fp
from fpsolve import studies

from .cases import INF, NAN, POSITIVE, Case
from .configurations import PATHS, PROCESS, added, changed
from .webs import WEB

PROCESS_OF = fp.Process(0.005, 0.005, 25.0, 0.1, 50.0)
NOISE = {"noise": (15.0, 40.0)}
BELT = {"speed_ratio": (0.05, 0.2)}


def design(target=0.01, process=PROCESS_OF, **options):
    asked = {"spacing": 2e-3, "titer": 1.5e-4, "free": ["noise"], "bounds": NOISE}
    return lambda: studies.design_web(process, target, **asked | options)


DESIGNS = [
    Case("design of a model", design(process=PROCESS_OF.model),
         "got LayDownModel", "`process` must be a Process", TypeError),
    Case("design of a belt at rest",
         design(process=replace(PROCESS_OF, speed_ratio=0.0)),
         "`speed_ratio` 0", "a belt in motion"),
    Case("design of the relaxation length of basic fibres",
         design(free=["relaxation_length"], bounds={"relaxation_length": (1e-4, 1e-3)}),
         "got none", "`process` must have a `relaxation_length`"),
    Case("design of relaxation lengths in millimetres",
         design(process=replace(PROCESS_OF, relaxation_length=1e-3),
                free=["relaxation_length"], bounds={"relaxation_length": (0.1, 1.0)}),
         "got 1", "`relaxation_length` must be at most 0.5 m"),
    Case("design without noise", design(process=replace(PROCESS_OF, noise=0.0)),
         "got 0", "`noise` must be positive"),
    Case("design for no zone", design(target=[]), "got none", "`target` must name"),
    Case("design for a zone that is nan", design(target=NAN), "nan",
         "`target` must be finite"),
    Case("design for a zone in words", design(target="10 mm"), "10 mm", "`target`",
         TypeError),
    Case("design for a zone in millimetres", design(target=10.0), "got 10",
         "`zones` must lie between"),
    Case("design for a CV in per cent", design(target={0.01: 5.0},
         free=["speed_ratio", "spacing"], bounds=BELT), "got 5", "per cent given"),
    Case("design for a CV that is nan", design(target={0.01: NAN}), "got nan",
         POSITIVE),
    Case("design for a CV below zero", design(target={0.01: -0.05}), "got -0.05",
         POSITIVE),
    Case("design for a zone with a CV and one without",
         design(target=[(0.01, 0.05), 0.05]), "got 0.05 without one",
         "largest CV of every zone"),
    Case("design with nothing free", design(free=[]), "got none",
         "`free` must be among"),
    Case("design of a misspelt parameter", design(free=["niose"]), "got 'niose'",
         "`free` must be among"),
    Case("design of a name without brackets", design(free="noise"), "got 'noise'",
         "needs brackets too", TypeError),
    Case("design of moving nozzles", design(free=["omega"]), "got 'omega'",
         "moving nozzles it does not predict"),
    Case("design of the belt alone", design(free=["speed_ratio"], bounds=BELT),
         "got speed_ratio alone", "two of speed_ratio, spacing and titer"),
    Case("design of the titer alone",
         design(free=["noise", "titer"], bounds=NOISE | {"titer": (1e-4, 2e-4)}),
         "got titer alone", "two of speed_ratio, spacing and titer"),
    Case("design without bounds", design(bounds=None), "got none",
         "`bounds` must be given for noise"),
    Case("design with bounds that are none", design(bounds=[15.0, 40.0]),
         r"got \[15", "a mapping of names", TypeError),
    Case("design with bounds of what is not free", design(bounds=NOISE | BELT),
         "got 'speed_ratio'", "name it in `free` too"),
    Case("design with reversed bounds", design(bounds={"noise": (40.0, 15.0)}),
         r"got \(40, 15\)", r"must be \(lowest, highest\)"),
    Case("design with one bound", design(bounds={"noise": 15.0}), "got 15.0",
         r"must be \(lowest, highest\)"),
    Case("design with a bound that is nan", design(bounds={"noise": (NAN, 15.0)}),
         "got nan", POSITIVE),
    Case("design with a bound that is infinite", design(bounds={"noise": (1.0, INF)}),
         "got inf", POSITIVE),
    Case("design with a bound of zero", design(bounds={"noise": (0.0, 15.0)}),
         "got 0", POSITIVE),
    Case("design with a bound in millimetres",
         design(free=["sigma2"], bounds={"sigma2": (1.0, 50.0)}), "got 1",
         "millimetres given instead"),
    Case("design with a bound in dtex",
         design(free=["spacing", "titer"], bounds={"titer": (1e-4, 1.5)}), "got 1.5",
         "dtex given instead"),
    Case("design with bounds that exclude its base weight",
         design(free=["speed_ratio", "spacing"],
                bounds=BELT | {"spacing": (1e-5, 2e-5)}),
         "got none within speed_ratio 0.05 to 0.2", "base weight"),
    Case("design of a spacing of zero", design(spacing=0.0), "got 0",
         "`spacing` must be positive"),
    Case("design of a spacing that is nan", design(spacing=NAN), "got nan",
         "`spacing` must be positive"),
    Case("design of a titer in dtex", design(titer=1.5), "got 1.5",
         "dtex given instead"),
    Case("design of no titer", design(titer=None), "got None", "`titer`", TypeError),
    Case("design of unknown positions", design(positions="hexagonal"),
         "got 'hexagonal'", "`positions` must be one of"),
    Case("design at an unknown cost",
         design({0.01: 0.2}, cost="money"), "got 'money'", "`cost` must be one of"),
    Case("design at a cost that cannot change", design({0.01: 0.2}), "got noise",
         "free it, or choose another `cost`"),
    Case("design with a tolerance of zero", design(tolerance=0.0), "got 0",
         "`tolerance` must be positive"),
    Case("design with a front of one point",
         design(front=1, free=["speed_ratio", "spacing"], bounds=BELT), "got 1",
         "0 or at least 2"),
    Case("design with a front at one throughput", design(front=3), "got noise",
         "`free` must name speed_ratio for a front"),
    Case("design with one web", design(n_webs=1), "got 1", "0 or at least 2"),
    Case("design with half a web", design(n_webs=2.5), "got 2.5", "an integer",
         TypeError),
    Case("design with a seed below zero", design(seed=-1), "got -1", "at least 0"),
]  # fmt: skip

FILE = (
    PROCESS[: PROCESS.index(b"[grid]")]
    + b"""
[design]
spacing = 2e-3
titer = 1.5e-4
zones = [0.01]
free = ["noise"]

[bounds]
noise = [15.0, 40.0]
"""
)

DESIGN_FILES = [
    Case("a design of an unknown parameter",
         changed(b'["noise"]', b'["niose"]', FILE), "got 'niose'", "`free"),
    Case("a design with reversed bounds",
         changed(b"[15.0, 40.0]", b"[40.0, 15.0]", FILE), r"got \(40, 15\)",
         r"section \[design\]: .*lowest, highest"),
    Case("a design with three bounds",
         changed(b"[15.0, 40.0]", b"[15.0, 20.0, 40.0]", FILE), "got", "`noise`"),
    Case("a design with bounds of what is not known",
         changed(b"noise = [15.0, 40.0]", b"omega = [15.0, 40.0]", FILE),
         "`omega` is not a key", "Keys are noise"),
    Case("a design with two bounds of CV for one zone",
         changed(b"zones = [0.01]", b"zones = [0.01]\nlargest = [0.1, 0.2]", FILE),
         "got 2", "each of the 1 zones"),
    Case("a design without a process",
         added(FILE[FILE.index(b"[design]") :], PATHS[: PATHS.index(b"[paths]")]),
         r"got \[potential\] and \[model\]", "base weight"),
    Case("a web in the file of a design", lambda folder: added(b"", WEB)(folder),
         "its sections are those of `fpsolve web`", "give it to that command"),
]  # fmt: skip
