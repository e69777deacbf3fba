"""Configuration files that ask for what does not exist or does not fit."""

from __future__ import annotations

from .cases import Case

RUN = b"""
[potential]
kind = "quadratic"
sigma1 = 1.0

[model]
noise = 1.0

[curve]
kind = "moving_belt"
speed = 0.1

[grid]
half_width = 6.0
shape = [16, 16, 8]

[initial]
kind = "gaussian"
mean = [0.5, 0.0]

[scheme]
kind = "drift_kick"

[run]
s_end = 1.0
ds = 0.25
save_at = [0.5, 1.0]
"""
PROCESS = b"""
[process]
sigma1 = 0.01
sigma2 = 0.02
noise = 16.0
speed_ratio = 0.1
spinning_speed = 50.0
""" + RUN[RUN.index(b"[grid]") :]
PATHS = b"""
[potential]
kind = "quadratic"

[model]
noise = 1.0

[paths]
n_paths = 10
s_end = 1.0
ds = 0.25
seed = 1
"""


def written(content):
    """Write the content to a file in the folder; the row of a raw file."""
    return lambda folder: write(folder, content)


def write(folder, content):
    path = folder / "run.toml"
    path.write_bytes(content)
    return path


def changed(old, new, base=RUN):
    """The valid file with one place changed."""
    assert base.count(old) == 1, old
    return written(base.replace(old, new))


def added(text, base=RUN):
    return written(base + text)


def a_folder(folder):
    path = folder / "run.toml"
    path.mkdir()
    return path


def below_a_file(folder):
    (folder / "notes.txt").write_text("no folder")
    return folder / "notes.txt" / "run.toml"


def a_circle(folder):
    path = folder / "run.toml"
    path.symlink_to(path)
    return path


NOT_TOML = [
    Case("no such file", lambda folder: folder / "none.toml",
         "got `.*none.toml`", "must be an existing TOML file"),
    Case("a folder", a_folder, "got the folder `.*run.toml`", "name a file in it"),
    Case("a file as folder", below_a_file, "notes.txt.run.toml`",
         "cannot be read|must be an existing"),
    Case("a link to itself", a_circle, "run.toml` cannot be read", "symbolic links"),
    Case("nothing in it", written(b""), r"got none|\[initial\] must be given",
         "must be given"),
    Case("spaces only", written(b" \n\n"), "got none", "must be given"),
    Case("two bytes a letter", written(RUN.decode().encode("utf-16")),
         "run.toml` is not valid TOML", "not text in UTF-8"),
    Case("a picture", written(b"\x89PNG\r\n\x1a\n" + bytes(range(256))),
         "run.toml` is not valid TOML", "not text in UTF-8"),
    Case("zeros", written(bytes(64)), "is not valid TOML", "line 1"),
    Case("another language", written(b"potential: {kind: quadratic}\n"),
         "is not valid TOML", "line 1"),
    Case("a section that is not closed", changed(b"[grid]", b"[grid"),
         "is not valid TOML", "line 13"),
    Case("a string that is not closed", changed(b'"drift_kick"', b'"drift_kick'),
         "is not valid TOML", "line 22"),
    Case("a number with a comma", changed(b"noise = 1.0", b"noise = 1,0"),
         "is not valid TOML", "line 7"),
    Case("a key twice", changed(b"noise = 1.0", b"noise = 1.0\nnoise = 2.0"),
         "is not valid TOML", "overwrite"),
    Case("a section twice", added(b"[run]\ns_end = 2.0\n"),
         "is not valid TOML", "Cannot declare|twice"),
    Case("cut off in the middle", written(RUN[: RUN.index(b"shape") + 12]),
         "is not valid TOML", "line|end of document"),
]  # fmt: skip

NAMES = [
    Case("a section misspelt", changed(b"[scheme]", b"[schema]"),
         r"unknown section \[schema\]", r"did you mean \[scheme\]"),
    Case("a section of another command", added(b"[paths]\nn_paths = 10\n"),
         "sections are those of `fpsolve paths`", "give it to that command"),
    Case("a section that nobody knows", added(b"[weather]\nrain = true\n"),
         r"unknown section \[weather\]", "Sections are"),
    Case("a section left out", changed(b"[initial]\n", b""),
         r"\[initial\] must be given|`kind`", "must be given|did you mean|Keys are"),
    Case("a section as a number",
         written(b"potential = 1.0\n" + RUN[RUN.index(b"[model]") :]),
         "got 1.0", r"section \[potential\] must be a table"),
    Case("a section as a list", changed(b"[model]", b"[[model]]"),
         r"got (\[|\()", r"section \[model\] must be a table"),
    Case("a key misspelt", changed(b"noise =", b"noice ="),
         "`noice` is not a key", "did you mean `noise`"),
    Case("a key of another kind", changed(b"sigma1 =", b"slope ="),
         "`slope` is not a key of the kind 'quadratic'",
         "Keys are kind, sigma1, sigma2"),
    Case("a key in capitals", changed(b"half_width", b"Half_Width"),
         "`Half_Width` is not a key", "did you mean `half_width`"),
    Case("a kind misspelt", changed(b'"quadratic"', b'"quadradic"'),
         "got 'quadradic'", "did you mean 'quadratic'"),
    Case("a kind left out", changed(b'kind = "drift_kick"\n', b""),
         "got none", "`kind` must be one of 'drift_kick'"),
    Case("a kind as a number", changed(b'"gaussian"', b"1"),
         "got '?1", "`kind` must be one of"),
    Case("a kind of potential that only Python has",
         changed(b'"quadratic"\nsigma1 = 1.0', b'"callable"'),
         "got 'callable'", "must be one of 'quadratic'"),
    Case("a scheme of another program", changed(b'"drift_kick"', b'"rk4"'),
         "got 'rk4'", "must be one of 'drift_kick', 'semi_lagrangian'"),
    Case("a format that does not exist", added(b'[output]\nformat = "csv"\n'),
         "got 'csv'", "'netcdf' or 'zarr'"),
    Case("a model and a process", added(b"[model]\nnoise = 1.0\n", PROCESS),
         r"got \[model\] beside it", r"\[process\] must stand alone"),
    Case("neither model nor process", written(RUN[RUN.index(b"[grid]") :]),
         "got none of them", r"\[potential\] and \[model\], or \[process\]"),
    Case("two ways to save", added(b"save_every = 0.5\n"),
         "`save_at` and `save_every`", "remove one of them"),
]  # fmt: skip

VALUES = [
    Case("noise in words", changed(b"noise = 1.0", b'noise = "one"'),
         "got 'one'", r"section \[model\]: `noise` must be a number"),
    Case("noise true", changed(b"noise = 1.0", b"noise = true"),
         "got True", "`noise` must be a number"),
    Case("noise a list", changed(b"noise = 1.0", b"noise = [1.0, 2.0]"),
         r"got \[1.0, 2.0\]", "`noise` must be a number"),
    Case("noise a date", changed(b"noise = 1.0", b"noise = 2026-01-01"),
         "got datetime.date", "`noise` must be a number"),
    Case("noise negative", changed(b"noise = 1.0", b"noise = -1.0"),
         "got -1", "`noise` must be non-negative and finite"),
    Case("noise nan", changed(b"noise = 1.0", b"noise = nan"),
         "got nan", "`noise` must be non-negative"),
    Case("noise infinite", changed(b"noise = 1.0", b"noise = inf"),
         "got inf", "finite"),
    Case("a deviation of zero", changed(b"sigma1 = 1.0", b"sigma1 = 0.0"),
         "got 0", r"`sigma1` must be positive and finite"),
    Case("a belt in per cent", changed(b"speed = 0.1", b"speed = 10"),
         "got 10", "strictly between -1 and 1"),
    Case("a half width of zero", changed(b"half_width = 6.0", b"half_width = 0"),
         "got 0", r"section \[grid\]: `half_width` must be positive"),
    Case("a half width in words", changed(b"half_width = 6.0", b'half_width = "6"'),
         "got '6'", "`half_width` must be a number"),
    Case("cells in two directions", changed(b"[16, 16, 8]", b"[16, 16]"),
         r"got \[16, 16\]", "longer list"),
    Case("cells in four directions", changed(b"[16, 16, 8]", b"[16, 16, 8, 8]"),
         "got", "list of 3|at most 3"),
    Case("a fraction of a cell", changed(b"[16, 16, 8]", b"[16, 16, 8.5]"),
         "got 8.5", r"`shape\[2\]` must be an integer"),
    Case("three cells", changed(b"[16, 16, 8]", b"[3, 16, 8]"), "got 3", "at least 4"),
    Case("a negative number of cells", changed(b"[16, 16, 8]", b"[16, -16, 8]"),
         "got -16", "at least 4"),
    Case("an odd number of angles", changed(b"[16, 16, 8]", b"[16, 16, 9]"),
         "got 9", "use 10"),
    Case("a mean of one number", changed(b"mean = [0.5, 0.0]", b"mean = 0.5"),
         "got 0.5", "`mean` must be a list"),
    Case("a mean outside", changed(b"[0.5, 0.0]", b"[50.0, 0.0]"),
         r"got \(50, 0\)", "enlarge `half_width` or move the mean"),
    Case("a variance negative", changed(b"mean =", b"variance = -1.0\nmean ="),
         "got -1.0", "`variance` must be positive"),
    Case("a variance in words", changed(b"mean =", b'variance = "one"\nmean ='),
         "got 'one'", "`variance` must be a number or a list"),
    Case("a concentration without a direction",
         changed(b"mean =", b"concentration = 4.0\nmean ="),
         "got None with concentration 4", "`angle` must be given"),
    Case("an order that does not exist",
         changed(b'"drift_kick"', b'"drift_kick"\ninterpolation_order = 7'),
         "got 7", "even integer from 2 to 16"),
    Case("a switch as a string",
         changed(b'"drift_kick"', b'"drift_kick"\npositive = "no"'),
         "got 'no'", "`positive` must be true or false"),
    Case("an end of zero", changed(b"s_end = 1.0", b"s_end = 0.0"),
         r"got \(0, 0\)", "start < end"),
    Case("an end infinite", changed(b"s_end = 1.0", b"s_end = inf"),
         r"got \(0, inf\)", "start < end"),
    Case("a step of zero", changed(b"ds = 0.25", b"ds = 0.0"), "got 0", "positive"),
    Case("a step that does not fit", changed(b"ds = 0.25", b"ds = 0.3"),
         "got 0.3", "use ds = 0.25"),
    Case("a step beyond counting", changed(b"ds = 0.25", b"ds = 1e-300"),
         "got 1e-300", "use a longer one"),
    Case("more records than memory", changed(b"ds = 0.25", b"ds = 1e-9"),
         "got 1", "record_every = 100"),
    Case("a place to save between steps", changed(b"[0.5, 1.0]", b"[0.3, 1.0]"),
         "got 0.3", "the nearest is 0.25"),
    Case("a place to save beyond the end", changed(b"[0.5, 1.0]", b"[5.0]"),
         "got 5", r"lie in the span \[0, 1\]"),
    Case("an interval to save of zero",
         changed(b"save_at = [0.5, 1.0]", b"save_every = 0.0"),
         "got 0", "`save_every` must be positive"),
    Case("records every zero steps", added(b"record_every = 0\n"), "got 0",
         "at least 1"),
    Case("a tolerance of mass negative", added(b"mass_tolerance = -1.0\n"),
         "got -1", "`mass_tolerance` must be positive"),
    Case("a tolerance as a percentage",
         changed(b"ds = 0.25\nsave_at = [0.5, 1.0]", b"tolerance = 5.0"),
         "got 5", "between 0 and 1"),
    Case("a name with a folder", added(b'[output]\nname = "../result"\n'),
         "got '../result'", "a file without folders"),
    Case("no name", added(b'[output]\nname = ""\n'), "got ''", "name of a file"),
    Case("a hidden name", added(b'[output]\nname = ".result"\n'),
         "got '.result'", "name of a file"),
    Case("a curve from a table that ends too early",
         changed(b'"moving_belt"\nspeed = 0.1',
                 b'"tabulated"\ns = [0.0]\ngamma1 = [0.0]\ngamma2 = [0.0]'),
         r"got \(1,\)|got 'tabulated'", "n >= 2|must be one of"),
]  # fmt: skip

UNITS = [
    Case("throwing range in millimetres",
         changed(b"sigma1 = 0.01", b"sigma1 = 10", PROCESS),
         "got 10", r"section \[process\].*millimetres given instead of metres"),
    Case("speed ratio in per cent",
         changed(b"speed_ratio = 0.1", b"speed_ratio = 10", PROCESS),
         "got 10", "strictly between -1 and 1"),
    Case("spinning speed per minute",
         changed(b"spinning_speed = 50.0", b"spinning_speed = 3000", PROCESS),
         "got 3000", "metres per minute"),
    Case("noise per kilometre", changed(b"noise = 16.0", b"noise = 16e3", PROCESS),
         "got 16000", "industrial range is 1 to 50"),
    Case("a length with its unit",
         changed(b"sigma1 = 0.01", b'sigma1 = "10 mm"', PROCESS),
         "got '10 mm'", "`sigma1` must be a number"),
    Case("a process without a length",
         changed(b"sigma2 = 0.02\n", b"", PROCESS),
         "`sigma2` must be given", "Keys are sigma1, sigma2"),
]  # fmt: skip

# Exit code 1: nothing is wrong with the file, but the machine is too small for it.
ABSURD = [
    Case("a million cells in each direction",
         changed(b"[16, 16, 8]", b"[1000000, 1000000, 1000000]"),
         "needs .*GiB", "choose a coarser grid"),
    Case("a grid beyond any address",
         changed(b"[16, 16, 8]", b"[1000000000000, 1000000000000, 8]"),
         "needs", "choose a coarser grid"),
]  # fmt: skip

PATHS_FILES = [
    Case("no number of paths", changed(b"n_paths = 10\n", b"", PATHS),
         "`n_paths` must be given", "Keys are"),
    Case("zero paths", changed(b"n_paths = 10", b"n_paths = 0", PATHS),
         "got 0", "at least 1"),
    Case("half a path", changed(b"n_paths = 10", b"n_paths = 1.5", PATHS),
         "got 1.5", "an integer"),
    Case("a seed below zero", changed(b"seed = 1", b"seed = -1", PATHS),
         "got -1", "at least 0"),
    Case("a seed in words", changed(b"seed = 1", b'seed = "luck"', PATHS),
         "got 'luck'", "an integer"),
    Case("an unknown method", added(b'method = "milstein"\n', PATHS),
         "got 'milstein'", "'splitting'"),
    Case("a start of an unknown kind", added(b'[start]\nkind = "line"\n', PATHS),
         "got 'line'", "must be one of 'point'"),
    Case("a start at one number", added(b'[start]\nkind = "point"\nxi = 1.0\n', PATHS),
         "got 1.0", "`xi` must be a list"),
    Case("a histogram without a box", added(b"[histogram]\n", PATHS),
         "`half_width` must be given", "Keys are"),
    Case("a run in the file of paths", written(RUN),
         "its sections are those of `fpsolve run`", "give it to that command"),
]  # fmt: skip

RUN_FILES = [*NOT_TOML, *NAMES, *VALUES, *UNITS]
CONFIGURATIONS = [*RUN_FILES, *ABSURD, *PATHS_FILES]
