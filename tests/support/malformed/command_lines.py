"""Words on the command line that no command can work with.

A row gives the words, and what must be said. Rows of USAGE are refused by the parser of
the command line, in its own words; all others by fpsolve, in one line that begins with
"error: ". Commands with files find `run.toml`,
`result.nc` and `paths.nc` in the folder,
and `notes.txt`, which is none of them. For a new command, add its rows here; the last
test of `test_malformed_command_lines.py` asks for at least three of every command.
"""

from __future__ import annotations

from .cases import Case


def row(words, value, remedy):
    """A command line is what it says; `do` splits it."""
    return Case(words, words.split, value, remedy)


# Words, and the option or argument that the parser names.
USAGE = [
    ("fly", "fly"),
    ("run --speed 3", "--speed"),
    ("run run.toml run.toml", "run.toml"),
    ("run --threads 0", "--threads"),
    ("run --threads two", "--threads"),
    ("run --out", "--out"),
    ("paths --n-paths 0", "--n-paths"),
    ("paths --n-paths 1e4", "--n-paths"),
    ("paths --seed -1", "--seed"),
    ("paths --seed luck", "--seed"),
    ("web --spacing wide", "--spacing"),
    ("web --seed -1", "--seed"),
    ("web --width 10mm", "--width"),
    ("check --seed 1.5", "--seed"),
    ("check --at end", "--at"),
    ("check --n-paths many", "--n-paths"),
    ("rate --noise loud", "--noise"),
    ("rate --workers -1", "--workers"),
    ("rate --quick yes", "yes"),
    ("spectrum --count 0", "--count"),
    ("spectrum --noise 1,5", "--noise"),
    ("energy --passage 0.1", "--passage"),
    ("energy --energies 0", "--energies"),
    ("energy --count -3", "--count"),
    ("limits --noise loud", "--noise"),
    ("limits large-noise small-noise", "small-noise"),
    ("plot", "FILE"),
    ("plot result.nc --fps fast", "--fps"),
    ("info everything", "everything"),
    ("info --all", "--all"),
    ("info --out results", "--out"),
    ("resume", "DIR"),
    ("report", "FILE"),
    ("rerun", "FILE"),
    ("compare result.nc", "B"),
]

RUN = [
    row("run none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("run .", "got the folder `.`", "name a file in it"),
    row("run notes.txt", "`notes.txt`", "is not valid TOML"),
    row("run result.nc", "`result.nc`", "not text in UTF-8"),
    row("run --example laydwn", "got 'laydwn'", "did you mean `laydown`"),
    row(
        "run run.toml --example laydown",
        "got 'laydown' and `run.toml`",
        "leave one out",
    ),
    row("run run.toml --threads 9999", "got 9999", "NUMBA_NUM_THREADS sets the limit"),
    row("run run.toml --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
    row("run run.toml --out notes.txt/out", "`notes.txt` is none", "name another one"),
    row("run run.toml --checkpoint soon", "'soon'", "`"),
    row("run run.toml --checkpoint 0", "0", "must"),
    row("run run.toml --checkpoint -5", "-5", "must"),
]
PATHS = [
    row("paths none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("paths run.toml", "those of `fpsolve run`", "give it to that command"),
    row("paths --threads 9999", "got 9999", "must be at most"),
    row("paths --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
]
WEB = [
    row("web none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("web run.toml", "those of `fpsolve run`", "give it to that command"),
    row("web run.toml --noise 2", "`--noise` .*got `run.toml`", "change its sections"),
    row("web --spacing 0", "got 0", "`spacing` must be positive"),
    row("web --spacing -1", "got -1", "`spacing` must be positive"),
    row("web --spacing nan", "got nan", "`spacing` must be positive"),
    row("web --width 0.1003", "got 0.1003", "`width` must be a multiple of `pixel`"),
    row("web --pixel 1", "got 1 for", "must not be larger than the window"),
    row("web --pixel nan", "got nan", "`pixel` must be positive"),
    row("web --length inf", "got inf", "`length` must be positive and finite"),
    row("web --positions hexagonal", "got 'hexagonal'", "'regular' or 'random'"),
    row("web --phases random", "got 'random'", "'independent' or 'in phase'"),
    row("web --titer 1.5", "got 1.5", "dtex given instead"),
    row("web --noise 1 --titer 1e-4", "got 0.0001", "must be given with a Process"),
    row("web --ds 0", "got 0", "`ds` must be positive"),
    row("web --zone 1", "got 1", "the shorter side of the window"),
    row("web --zone nan", "got nan", "`zones` must be positive"),
    row("web --export jpeg", "got 'jpeg'", "'png', 'tiff', 'vtp' or 'csv'"),
    row("web --noise 0", "got 0|0", "must have noise for a web"),
    row("web --noise nan", "got nan", "`noise` must be non-negative"),
    row("web --belt-speed 0", "MovingBelt|FixedBelt", "must have a moving belt"),
    row("web --belt-speed 10", "got 10", "strictly between -1 and 1"),
    row("web --relaxation-length -1", "got -1", "must be positive"),
    row("web --potential free", "Free", "`potential` must confine"),
    row("web --potential cubic", "got 'cubic'", "one of quadratic, linear"),
    row(
        "web --periodic --spacing 3e-3",
        "= 0.003 .* got 0.1",
        "`width` must be a multiple of",
    ),
    row("web --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
    row("web --threads 9999", "got 9999", "must be at most"),
]
STRING = [
    row("string none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("string run.toml", "sections are those of", "`fpsolve run`"),
    row("string --n-steps 0", "got 0", "`n_steps` must be at least 1"),
    row("string --t-end nan", "got nan", "`t_end` must be"),
    row("string --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
]
PREDICT = [
    row("design none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("design --front 1", "got 1", "0 or at least 2"),
    row("design --n-webs 1", "got 1", "0 or at least 2"),
    row("design --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
    row("predict none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("predict --spacing nan", "got nan", "`spacing` must be positive"),
    row("predict --positions hexagonal", "got 'hexagonal'", "`positions` must be"),
    row("predict --zone nan", "nan", "`zones` must be"),
    row("predict --band 1", "got '1'", "must be SHORT:LONG"),
    row("predict --tolerance 0", "got 0", "`tolerance` must be positive"),
    row("predict --belt-speed 10", "got 10", "strictly between -1 and 1"),
    row("predict --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
]
IDENTIFY = [
    row("identify none.csv --belt-speed 0.1", "got `none.csv`", "an existing table"),
    row("identify folder --belt-speed 0.1", "got `folder`", "an existing table"),
    row("identify notes.txt --belt-speed 0.1", "`notes.txt`", "columns must be"),
    row("identify result.nc", "got `result.nc`", "a table or a saved fibre curve"),
    row("identify none.nc", "got `none.nc`", "must exist to be read"),
    row("identify run.toml --ds 1", "got none", "`--belt-speed` must be given"),
    row("identify --belt-speed nan", "got nan", "must be finite"),
    row("identify --belt-speed 10", "got 10", "strictly between -1 and 1"),
    row("identify --ds 0", "got 0", "`ds` must be positive"),
    row("identify --ds nan", "got nan", "`ds` must be positive"),
    row("identify --ds 1e-4", "got 0.0001", "no fibre is shorter than its chord"),
    row("identify --unit mm", "apart on average", "in another unit"),
    row("identify --unit inch", "got 'inch'", "`--unit` must be one of"),
    row("identify --position-error nan", "got nan", "must be non-negative"),
    row("identify --nozzle square", "got 'square'", "`--nozzle` must be one of"),
    row("identify --radius 1", "got 1", "must not be given without `--nozzle`"),
    row("identify --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
    row("web --from none.nc", "got `none.nc`", "`path` must exist to be read"),
    row("web --from result.nc", "got `result.nc`", "must be an identification"),
    row("web --from result.nc --noise 2", "`--noise` .*got `result.nc`", "that of the"),
    row("predict --from notes.txt", "`notes.txt`", "it is not a netCDF-4 file"),
    row("predict --from paths.nc", "got `paths.nc`", "must be an identification"),
    row("predict run.toml --from paths.nc", "got `paths.nc`", "beside `--from`"),
]
CHECK = [
    row("check none.toml", "got `none.toml`", "must be an existing TOML file"),
    row("check run.toml --n-paths 5", "got 5", "at least 1000"),
    row("check run.toml --at -1", "got", "non-negative arclengths"),
    row("check run.toml --at nan", "got", "arclengths"),
    row("check run.toml --false-alarm 2", "got 2", "between 0 and 1"),
    row("check run.toml --false-alarm nan", "got nan", "between 0 and 1"),
    row(
        "check run.toml --out notes.txt", "got `notes.txt`", "`--out` must be a folder"
    ),
]
RATE = [
    row("rate --noise 0 --quick", "got 0", "never forgets its start"),
    row("rate --noise -1 --quick", "got -1", "positive and finite"),
    row("rate --noise nan --quick", "got nan", "positive and finite"),
    row("rate --noise inf --quick", "got inf", "positive and finite"),
    row("rate --potential free --quick", "Free", "must confine"),
    row("rate --potential cubic --quick", "got 'cubic'", "one of quadratic, linear"),
    row("rate --part rest --quick", "'?rest", "`parts` must be among relaxation"),
    row("rate --tolerance 0 --quick", "got 0", "`tolerance` must lie in"),
    row("rate --tolerance 5 --quick", "got 5", "no more digits"),
    row("rate --out notes.txt --quick", "got `notes.txt`", "`--out` must be a folder"),
    row("rate --sigma1 0 --quick", "got 0", "must be positive"),
]
SPECTRUM = [
    row("spectrum --noise 0", "got 0", "`noise` must be positive"),
    row("spectrum --noise nan", "got nan", "non-negative and finite"),
    row("spectrum --noise inf", "got inf", "non-negative and finite"),
    row("spectrum --potential free", "Free", "must confine"),
    row("spectrum --potential harmonic", "got 'harmonic'", "one of quadratic, linear"),
    row("spectrum --tolerance 1e-30", "got 1e-30", "no more digits"),
    row("spectrum --belt-speed 10", "got 10", "strictly between -1 and 1"),
    row("spectrum --count 5000", "got 5000", "at most 1000"),
    row("spectrum --memory-limit -1", "got -1", "`--memory-limit` must be positive"),
    row("spectrum --work-limit 0", "got 0", "`--work-limit` must be positive"),
    row("spectrum --memory-limit nan", "got nan", "`--memory-limit` must be positive"),
    row("spectrum --potential power --exponent 0.5", "got 0.5", "at least 1"),
    row("spectrum --potential linear --slope -1", "got -1", "must be positive"),
    row("spectrum --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
]
ENERGY = [
    row("energy --noise 0", "got 0", "without noise the energy does not change"),
    row("energy --noise inf", "got inf", "positive and finite"),
    row("energy --sigma2 2", "Quadratic", "must be isotropic"),
    row("energy --potential free", "Free", "exactly one radius"),
    row("energy --potential round", "got 'round'", "one of quadratic, linear"),
    row("energy --passage 0.1 0.9", "got 0.9", "`target` must lie in"),
    row("energy --passage nan 0.5", "got nan", "`g` must lie in"),
    row("energy --count 5000", "got 5000", "at most 1000"),
    row("energy --out notes.txt", "got `notes.txt`", "`--out` must be a folder"),
]
LIMITS = [
    row("limits middle-noise", "got 'middle-noise'", "large-noise"),
    row("limits --noise 2", "got it with", "the two limits need other noises"),
    row("limits large-noise --noise 0 --quick", "got 0", "positive and finite"),
    row("limits small-noise --noise nan --quick", "got nan", "positive and finite"),
    row(
        "limits small-noise --potential free --quick", "Free", "one radius|single well"
    ),
    row("limits --potential cubic", "got 'cubic'", "one of quadratic, linear"),
    row("limits large-noise --out notes.txt", "got `notes.txt`", "must be a folder"),
]
PLOT = [
    row("plot none.nc", "got `none.nc`", "`path` must exist to be read"),
    row("plot notes.txt", "`notes.txt`: it is not a netCDF-4 file", "name one"),
    row("plot run.toml", "`run.toml`: it is not a netCDF-4 file", "name one"),
    row("plot .", "cannot read `.`", "make it again"),
    row("plot result.nc --movie --fps 0", "got 0", "`fps` must be positive"),
    row("plot result.nc --movie --fps nan", "got nan", "`fps` must be positive"),
    row("plot result.nc --movie --fps 1e9", "got 1e[+]09", "at most 100"),
    row("plot paths.nc --movie", "got paths in `paths.nc`", "leave it out"),
    row(
        "plot result.nc --out notes.txt", "got `notes.txt`", "`--out` must be a folder"
    ),
]
RESUME = [
    row("resume none", "none", "`"),
    row("resume notes.txt", "notes.txt", "`"),
    row("resume .", "`", "checkpoint"),
]
REPORT = [
    row("report none.nc", "got `none.nc`", "`path` must exist to be read"),
    row("report notes.txt", "`notes.txt`: it is not a netCDF-4 file", "name one"),
    row("report notes.txt result.nc", "`notes.txt`", "it is not a netCDF-4 file"),
]
RERUN = [
    row("rerun none.nc", "got `none.nc`", "must exist to be read"),
    row("rerun notes.txt", "`notes.txt`: it is not a netCDF-4 file", "name one"),
    row("rerun result.nc --out .", "got `.`", "must not be the folder of the file"),
    row("rerun result.nc --out notes.txt", "got `notes.txt`", "must be a folder"),
]
COMPARE = [
    row("compare result.nc none.nc", "got `none.nc`", "must exist to be read"),
    row("compare notes.txt result.nc", "`notes.txt`: it is not a netCDF-4", "name one"),
    row("compare result.nc paths.nc", "paths", "must"),
    row("compare result.nc result.nc --tolerance -1", "got -1", "must be positive"),
]

MISTAKES = [
    *RUN, *PATHS, *WEB, *STRING, *PREDICT, *IDENTIFY, *CHECK, *RATE, *SPECTRUM, *ENERGY,
    *LIMITS, *PLOT, *RESUME, *REPORT, *RERUN, *COMPARE,
]  # fmt: skip
