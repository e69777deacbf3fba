"""A command adds what it computes; the frame adds folder, names, bar, files, errors."""

from pathlib import Path
from typing import Annotated

import numpy as np
import pytest
import typer
import xarray as xr
from command_line import assert_mistake, files
from matplotlib.image import imread
from typer.testing import CliRunner

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_table
from fpsolve.cli.frame import command
from fpsolve.cli.options import CONFINING, NoFigures, Out
from fpsolve.cli.potentials import PARAMETERS, Kind, Parameters, with_parameters
from fpsolve.errors import MassDriftError, RunInterrupted
from fpsolve.model.potentials.dictionaries import KINDS
from fpsolve.plotting.style import new_figure

app = typer.Typer(rich_markup_mode=None)
WELL = ("well.nc", "well-part.nc", "well.png")
COMPUTED = []


def computed(potential, xi1):
    """B(ξ₁, 0); a test replaces it to see whether it comes to that, and how it ends."""
    COMPUTED.append(potential)
    return xr.Dataset({"value": ("xi1", potential.value(xi1, 0.0))}, {"xi1": xi1})


def drawn(table):
    figure = new_figure(3.4, 2.0)
    figure.subplots().plot(table["xi1"], table["value"])
    return figure


@app.command()
@with_parameters
def well(
    end: Annotated[float, typer.Argument(metavar="END")],
    potential: Kind = "quadratic",
    parameters: Parameters = PARAMETERS,
    out: Out = Path("results"),
    no_figures: NoFigures = False,
) -> None:
    """Tabulate the potential along the belt."""
    with command(out, *WELL, figures=not no_figures) as frame:
        chosen = parameters.make(potential)
        with frame.computing(
            keep=lambda part: frame.finish(part, "well-part.nc"), kept="a part is kept"
        ) as report:
            report(0, 1, 0.0)
            table = computed(chosen, np.linspace(0.0, end, 3))
        pairs = zip(table["xi1"].values, table["value"].values, strict=True)
        print_table(("ξ₁", "B"), ((f"{xi1:g}", f"{b:g}") for xi1, b in pairs))
        print_lines(chosen.formula)
        used = command_line("well", str(end), potential=chosen)
        frame.finish(table.assign_attrs(used), "well.nc")
        frame.figure(drawn, table, name="well.png")


@pytest.fixture
def call(tmp_path, monkeypatch):
    """Call the command in an empty folder; returns what click recorded."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    COMPUTED.clear()
    return lambda *words: CliRunner().invoke(app, list(map(str, words)))


@pytest.fixture
def ending_in(monkeypatch):
    """What is computed ends in an error instead."""

    def end(error):
        def computing(*arguments):
            raise error

        monkeypatch.setitem(globals(), "computed", computing)

    return end


PART = xr.Dataset({"value": ("xi1", [0.0])}, {"xi1": [0.0]})


def test_a_command_prints_writes_and_draws_in_this_order(call, tmp_path):
    result = call(2, "--sigma1", 0.5, "--out", "out")
    assert result.exit_code == 0, result.output
    lines = [line.split() for line in result.stdout.splitlines() if line.strip()]
    assert lines[0] == ["ξ₁", "B"]
    # B = ξ₁²/(2 σ₁²) with σ₁ = 1/2.
    assert lines[2:5] == [["0", "0"], ["1", "2"], ["2", "8"]]
    assert " ".join(lines[5]) == "(ξ₁²/0.5² + ξ₂²/0.5²)/2"
    assert lines[6:] == [["out/well.nc"], ["out/well.png"]]
    assert files(tmp_path / "out") == ["well.nc", "well.png"]
    with xr.open_dataset(tmp_path / "out" / "well.nc") as table:
        np.testing.assert_array_equal(table["value"], [0.0, 2.0, 8.0])
        again = table.attrs["command"]
    assert again == ("fpsolve well 2.0 --potential quadratic --sigma1 0.5 --sigma2 0.5")
    assert imread(tmp_path / "out" / "well.png").shape[1] == 680


def test_what_is_written_repeats_the_command(call, tmp_path):
    assert call(3, "--potential", "power", "--exponent", 3).exit_code == 0
    with xr.open_dataset(tmp_path / "results" / "well.nc") as table:
        first, (_, name, *words) = table.load(), table.attrs["command"].split()
    assert name == "well"
    assert words == ["3.0", "--potential", "power", "--exponent", "3.0"]
    assert call(*words, "--out", "again").exit_code == 0
    with xr.open_dataset(tmp_path / "again" / "well.nc") as second:
        xr.testing.assert_identical(first, second)


def test_without_figures_there_are_none(call, tmp_path):
    assert call(1, "--no-figures").exit_code == 0
    assert files(tmp_path / "results") == ["well.nc"]


def test_the_parameters_of_potentials_stand_where_the_command_has_them(call):
    shown = call("--help").stdout
    names = ("--potential", "--sigma1", "--sigma2", "--slope", "--exponent", "--out")
    places = [shown.index(f"{name} ") for name in names]
    assert places == sorted(places)
    assert "[default: (σ1)]" in shown


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--potential", "cubic"], "`--potential` must be one of quadratic, linear"),
        (["--sigma1", -1], "`sigma1` must be positive"),
        (["--out", "file"], "`--out` must be a folder, got `file`"),
    ],
)
def test_a_mistake_is_one_line_and_no_file(call, tmp_path, words, message):
    (tmp_path / "file").touch()
    result = call(1, *words)
    assert_mistake(result, message)
    assert result.stderr.count("\n") == 1
    assert files(tmp_path) == ["file"]


@pytest.mark.parametrize("name", WELL)
def test_a_name_that_is_taken_is_refused_before_anything_is_computed(
    call, tmp_path, name
):
    (tmp_path / "results" / name).mkdir(parents=True)
    assert_mistake(call(1), f"`path` must not be a folder, got `results/{name}`")
    assert COMPUTED == []
    assert files(tmp_path / "results") == [name]


def test_ctrl_c_keeps_what_was_computed(call, tmp_path, ending_in):
    ending_in(RunInterrupted(PART))
    result = call(1)
    assert_mistake(result, "error: interrupted; a part is kept\n", code=130)
    assert result.stdout == "results/well-part.nc\n"
    assert files(tmp_path / "results") == ["well-part.nc"]
    ending_in(RunInterrupted(None))
    assert_mistake(call(1, "--out", "none"), "interrupted; a part is kept", code=130)
    ending_in(KeyboardInterrupt())
    assert_mistake(call(1, "--out", "none"), "error: interrupted\n", code=130)
    assert not (tmp_path / "none").exists()


def test_a_run_that_cannot_go_on_keeps_what_it_recorded(call, tmp_path, ending_in):
    error = MassDriftError(1.0, 0.5, 1e-9)
    ending_in(error)
    assert_mistake(call(1), f"error: {error}", code=1)
    assert files(tmp_path) == []
    error.solution = PART
    assert_mistake(call(1), f"error: {error}", code=1)
    assert files(tmp_path / "results") == ["well-part.nc"]


def test_where_the_part_finds_no_room_the_error_is_told_too(
    call, ending_in, monkeypatch
):
    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", full)
    error = MassDriftError(1.0, 0.5, 1e-9)
    error.solution = PART
    ending_in(error)
    result = call(1)
    assert result.exit_code == 1
    first, last = result.stderr.splitlines()
    assert first.startswith("warning: what was recorded cannot be written: ")
    assert last == f"error: {error}"


def test_a_defect_keeps_its_traceback(call, ending_in):
    ending_in(ZeroDivisionError("defect"))
    assert isinstance(call(1).exception, ZeroDivisionError)


def test_a_shell_proposes_the_potentials_that_confine():
    assert tuple(kind for kind in KINDS if kind != "free") == CONFINING


@pytest.mark.parametrize("kind", KINDS)
def test_every_potential_of_the_model_is_made_from_options(kind):
    chosen = Parameters(sigma1=2.0, slope=3.0, exponent=5.0).make(kind)
    values = {"sigma1": 2.0, "sigma2": 2.0, "slope": 3.0, "exponent": 5.0}
    own = chosen.to_dict()
    assert own.pop("kind") == kind
    assert {name: own[name] for name in values.keys() & own.keys()} == {
        name: values[name] for name in values if name in own
    }
    # What no option gives has a default in the model.
    assert own.keys() - values.keys() <= {"scale"}
