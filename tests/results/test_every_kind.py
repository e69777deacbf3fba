"""The contract of a result: every kind is saved, loaded, compared, drawn, repeated."""

import importlib
from dataclasses import replace
from functools import cache
from operator import attrgetter

import numpy as np
import pytest
import result_files
import xarray as xr
from known_webs import KnownWeb
from web_numbers import choose_few_nodes

import fpsolve as fp
from fpsolve import plotting, studies
from fpsolve._support.declared import declared
from fpsolve._support.netcdf import write_dataset
from fpsolve.errors import NotRepeatableError
from fpsolve.pages.blocks import Figure
from fpsolve.pages.kinds import PAGES
from fpsolve.pages.page import report_text
from fpsolve.plotting.files import possible_figures
from fpsolve.plotting.kinds import FIGURES
from fpsolve.results.kinds import KINDS, from_xarray, kind_of, named
from fpsolve.studies.design import predictions

QUADRATIC = fp.QuadraticPotential()
REST = fp.LayDownModel(QUADRATIC, 1.0)
BELT = fp.LayDownModel(QUADRATIC, 1.0, fp.MovingBelt(0.2))
TURNING = fp.LayDownModel(QUADRATIC, 1.5, fp.RotatingNozzle(0.2, 0.5, 1.0))
SMOOTH = fp.SmoothLayDownModel(QUADRATIC, 0.5, 1.0, fp.MovingBelt(0.2))
RESTING = fp.SmoothLayDownModel(QUADRATIC, 0.1, 4.0)
PROCESS = fp.EnergyProcess(QUADRATIC, 0.5)
LIMIT = fp.HydrodynamicLimit(fp.LayDownModel(QUADRATIC, 2.0, fp.MovingBelt(0.1)))
OWN_POTENTIAL = fp.IsotropicPotential(lambda r: r**2 / 2, lambda r: r)
OWN = fp.HydrodynamicLimit(fp.LayDownModel(OWN_POTENTIAL, 2.0))
OWN_PROCESS = fp.EnergyProcess(OWN_POTENTIAL, 0.5)
GRID = fp.PhaseSpaceGrid(5.0, (12, 12, 8))
WIDE = fp.PhaseSpaceGrid(6.0, (24, 24, 16))
FINER = fp.PhaseSpaceGrid(5.5, (24, 24, 16))
CURVED = fp.SmoothPhaseSpaceGrid(6.0, 5.5, (12, 12, 8, 16))
PLANE = fp.PlaneGrid(5.0, (16, 16))
CIRCLE = np.stack([np.cos(0.1 * np.arange(9)), np.sin(0.1 * np.arange(9))], axis=-1)
NARROW = fp.paths.GaussianLaw((0.5, 0.0), 0.8, 1.0, 1.0)
SPINNING = fp.fibre.Nozzle((0.0, 0.0, 0.31), (0.1, 0.03, -1.0), 1.0, (0.01, 0.02), 6.0)
SWINGING = np.outer(np.arange(5), (0.0, 0.1, 0.0))
# The grids are coarse ones, made for quick tests.
LENIENT = {"boundary_tolerance": 1.0, "mass_tolerance": 1.0, "entropy_tolerance": 1.0}
SEVERAL = {"save_at": (0.0, 0.5, 1.0), "extrapolate": True}


def start(xi1, xi2):
    return np.exp(-((xi1 - 1) ** 2) - xi2**2)


def start_on(grid):
    return fp.initial.gaussian(grid, (0.5, 0.0), 0.8, angle=1.0, concentration=1.0)


def curved_start():
    basic = start_on(CURVED.phase_space)
    return fp.initial.with_curvature(basic, CURVED, SMOOTH.curvature_variance)


def hydrodynamic(limit=LIMIT, **options):
    return limit.solve(start, (0.0, 1.0), 0.25, grid=PLANE, **options)


def energy(signed=False, process=PROCESS, **options):
    grid = process.grid(12, signed)
    return process.solve(0.3, (0.0, 1.0), 0.25, grid=grid, **options)


# Of every kind at least one, by what computes it, beginning with the kind.
MAKERS = {
    "solution": lambda: fp.solve(
        fp.drift_kick(REST, GRID), start_on(GRID), (0.0, 0.5), 0.25, save_at=[0.5],
        **LENIENT,
    ),
    "solution, smooth": lambda: fp.solve(
        fp.smooth_drift_kick(SMOOTH, CURVED), curved_start(), (0.0, 0.5), 0.25,
        reference=curved_start(), **SEVERAL | {"save_at": [0.0, 0.5]}, **LENIENT,
    ),
    "paths": lambda: fp.sample_paths(BELT, 40, 0.5, 0.25, seed=3, initial=NARROW),
    "paths, smooth": lambda: fp.sample_paths(
        SMOOTH, 40, 0.5, 0.25, seed=3, initial=((0.5, 0.0), 1.0, 0.2)
    ),
    "fibre-curve": lambda: fp.FibreCurve(
        [CIRCLE, CIRCLE[:7]], 0.1, TURNING.curve, position_error=0.01, s_start=[0, 2]
    ),
    "fibre-motion": lambda: fp.fibre.simulate(
        fp.fibre.String(1.0, 2e-3, 1000.0, 1e9, n_edges=4), 0.1, 8, velocity=SWINGING,
        air=fp.fibre.AirFlow((1.0, 0.0, 0.0)), damping=0.01, save_every=2,
        turbulence=fp.fibre.RandomForce(1e-4, correlation_time=0.01), seed=2,
    ),
    "fibre-lay-down": lambda: fp.fibre.lay_down(
        fp.fibre.String(0.2, 2e-4, 1000.0, 1e8, SPINNING, fp.fibre.Free(), n_edges=10),
        0.1, 20, belt=fp.fibre.Belt(0.3, 0.1), air=fp.fibre.AirFlow((0.0, 0.0, -1.0)),
        save_every=5,
    ),
    "hydrodynamic": lambda: hydrodynamic(**SEVERAL),
    "hydrodynamic, plain": hydrodynamic,
    "energy": lambda: energy(**SEVERAL),
    "energy, signed": lambda: energy(signed=True),
    "steady-state": lambda: fp.steady_state(REST, WIDE, error_tolerance=1.0),
    "steady-state, a scheme": lambda: fp.steady_state(
        fp.drift_kick(REST, WIDE), ds=0.25, error_tolerance=1.0
    ),
    "steady-state, smooth": lambda: fp.steady_state(
        fp.SmoothLayDownModel(QUADRATIC, 0.3, 2.0),
        fp.SmoothPhaseSpaceGrid(5.5, 13.4, (14, 14, 12, 16)),
        ds=0.1, tolerance=1e-4, error_tolerance=1.0, boundary_tolerance=0.1,
    ),
    "periodic-state": lambda: fp.periodic_state(
        TURNING, FINER, n_phases=4, error_tolerance=1.0
    ),
    "spectral": lambda: fp.spectral_solve(
        REST, NARROW, [0.0, 1.0], tolerance=1e-2
    ),
    "spectral, on a belt": lambda: fp.spectral_solve(
        BELT, NARROW, [0.0, 1.0], tolerance=1e-2
    ),
    "spectral, from a grid": lambda: fp.spectral_solve(
        REST, (FINER, start_on(FINER)), [1.0], tolerance=1e-2
    ),
    "smooth-spectral": lambda: fp.spectral_solve(
        SMOOTH, NARROW, [0.0, 1.0], tolerance=1e-2
    ),
    "spectral-steady-state": lambda: fp.spectral_steady_state(BELT, tolerance=1e-2),
    "smooth-spectral-steady-state": lambda: fp.spectral_steady_state(
        RESTING, tolerance=1e-2
    ),
    # An iterator is used up by the call, and kept for its repetition.
    "energy-paths": lambda: PROCESS.sample(
        50, 1.0, 0.25, seed=2, initial="stationary", save_at=iter([0.5, 1.0])
    ),
    "hydrodynamic-paths": lambda: LIMIT.sample(
        50, 1.0, seed=np.random.SeedSequence(7, spawn_key=(1,)),
        initial=(PLANE, start(*PLANE.mesh())), save_at=[0.0, 1.0],
    ),
    "web": lambda: fp.lay_web(
        SMOOTH, width=2.0, length=1.0, spacing=0.2, pixel=0.25, seed=4
    ),
    "web, of a process": lambda: fp.lay_web(
        fp.Process(5e-3, 5e-3, 15.0, 0.2, 20.0), width=0.064, length=0.064,
        pixel=1e-3, positions=[0.0, 4e-3, 5e-3], spacing=2e-3, titer=1e-4, seed=4,
    ),
    "mean-pattern": lambda: fp.mean_pattern(
        result("periodic-state"), spacing=2.0, phases=[0.0, 1.5]
    ),
    "check": lambda: studies.cross_check(
        REST, start_on(FINER), [0.5], n_paths=1000, seed=1, grid=FINER, ds=0.25,
        paths_ds=0.125, solve_options={"boundary_tolerance": 1.0},
    ),
    "spectrum": lambda: fp.spectrum(REST, 3, tolerance=1e-4),
    "spectrum, smooth": lambda: fp.spectrum(RESTING, 1, tolerance=1e-3),
    "web-prediction": lambda: fp.predict_web(
        fp.LayDownModel(QUADRATIC, 2.0, fp.MovingBelt(0.2)), spacing=0.5,
        zones=[0.5, 2.0], bands=[(0.5, 2.0)], tolerance=0.05,
    ),
    "identification": lambda: fp.identify(
        fp.sample_paths(SMOOTH, 1, 140.0, 0.2, seed=1, save_at=0.2 * np.arange(701)),
        model="basic", seed=2,
    ),
    "identification-comparison": lambda: fp.compare_models(
        fp.sample_paths(SMOOTH, 1, 140.0, 0.2, seed=1, save_at=0.2 * np.arange(701)),
        seed=2,
    ),
    "rate": lambda: studies.rate_versus_noise(
        QUADRATIC, [2.0], quick=True, parts=["gap"], workers=0
    ),
    "large-noise": lambda: studies.large_noise_limit(
        QUADRATIC, [1.4], quick=True, parts=["gap"], workers=0
    ),
    "white-noise": lambda: studies.white_noise_limit(
        QUADRATIC, 1.5, [0.1, 0.2], s_end=0.5, n_paths=50, quick=True, workers=0,
        parts=["paths"],
    ),
    "web-homogeneity": lambda: studies.web_homogeneity(
        QUADRATIC, [2.0], [0.5], [0.5], zones=[0.5, 2.0], n_webs=2, tolerance=0.05,
        workers=0,
    ),
    # Bounds that the resolution of a search hardly divides, so that it is short.
    "nozzle-design": lambda: studies.design_nozzles(
        TURNING, [0.5, 1.0], spacing=3.0, bounds={"angular_speed": (0.5, 0.505)},
        n_scan=3, tolerance=0.2, n_webs=2, phases=[0.0, 1.0],
    ),
    "web-design": lambda: studies.design_web(
        fp.Process(5e-3, 5e-3, 25.0, 0.1, 50.0), {0.01: 0.0155, 0.02: 0.0155},
        spacing=2e-3, titer=1e-4, free=["noise", "speed_ratio", "spacing"],
        bounds={"noise": (15.0, 40.0), "speed_ratio": (0.05, 0.2)}, front=2, n_webs=2,
    ),
    "web-design, laying none": lambda: studies.design_web(
        fp.Process(5e-3, 5e-3, 25.0, 0.1, 50.0), [0.01], spacing=2e-3, titer=1e-4,
        free=["noise"], bounds={"noise": (15.0, 40.0)}, n_webs=0,
    ),
    "small-noise": lambda: studies.small_noise_limit(
        QUADRATIC, [0.8], belt_speed_scales=[0.0], slow_length=0.25, n_paths=50,
        quick=True,
    ),
    "small-noise-spectrum": lambda: studies.small_noise_spectrum(
        QUADRATIC, [0.8], tolerance=1e-3
    ),
    "energy-tables": lambda: result_files.energy(),
    "averages": lambda: studies.ergodic_averages(
        QUADRATIC, [1.0, 2.0], s_end=2.0, n_paths=40, seed=1
    ),
    "averages, one noise": lambda: studies.ergodic_averages(
        QUADRATIC, [1.0], s_end=2.0, n_paths=40, seed=1
    ),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def known_webs():
    """Designs of webs known in closed form, since predictions take seconds each.

    Those that are made are of few nodes: with fewer digits, which are stored as well.
    """
    with pytest.MonkeyPatch.context() as patch:
        choose_few_nodes(patch)
        patch.setattr(predictions, "predict_web", KnownWeb())
        yield


@cache
def result(name):
    return MAKERS[name]()


def saved(found, path):
    return found.save(path) if hasattr(found, "save") else write_dataset(found, path)


@cache
def file(name):
    """The file of that result, written once for all tests that read it."""
    return saved(result(name), result_files.folder() / f"kind {name}.nc")


def test_the_three_tables_know_the_same_kinds():
    assert KINDS.keys() == FIGURES.keys() == PAGES.keys()
    assert KINDS.keys() == {name.partition(",")[0] for name in MAKERS}


@pytest.mark.parametrize("name", KINDS)
def test_what_a_row_names_is_there(name):
    kind = KINDS[name]
    module, _, function = kind.function.partition(":")
    assert callable(attrgetter(function)(importlib.import_module(module)))
    for place in (kind.reading, PAGES[name]):
        assert not place or callable(named(place))


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_says_its_kind_and_equals_itself(name):
    assert kind_of(result(name)) == name.partition(",")[0]
    comparison = fp.compare(result(name), result(name))
    assert comparison.equal
    assert not comparison.parameters


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_says_versions_and_machine(name):
    about = declared(as_dataset(result(name)).attrs)
    origin = {**about.get("provenance", {}), **about}
    assert origin["versions"]["fpsolve"]
    assert origin["environment"]["packages"]


def as_dataset(found):
    return found if isinstance(found, xr.Dataset) else found.to_xarray()


def assert_same(name, found):
    assert type(found) is type(result(name))
    comparison = fp.compare(result(name), found)
    assert comparison.equal, str(comparison)
    assert not comparison.parameters


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_is_loaded_bit_for_bit(name, tmp_path):
    loaded = fp.load(file(name))
    assert_same(name, loaded)
    # And what is loaded is saved as it was: a study as a file again, the others as
    # stores, which are read in a third of the time.
    ending = "nc" if isinstance(loaded, xr.Dataset) else "zarr"
    assert_same(name, fp.load(saved(loaded, tmp_path / f"again.{ending}")))


# Studies with variables of every type between them.
@pytest.mark.parametrize("name", ["rate", "averages"])
def test_a_study_is_loaded_from_a_store_bit_for_bit(name, tmp_path):
    assert_same(name, fp.load(saved(result(name), tmp_path / "result.zarr")))


# What takes seconds to compute is repeated at night; others of its sort are here.
DEAR = {
    "identification-comparison", "rate", "spectrum, smooth", "steady-state, smooth",
    "web-homogeneity", "web-prediction",
}  # fmt: skip


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=[pytest.mark.nightly] if name in DEAR else [])
    for name in MAKERS
])  # fmt: skip
def test_a_result_is_repeated_from_its_file_to_the_last_bit(name):
    # One of the studies is repeated in processes, as all would be without this.
    in_process = KINDS[name.partition(",")[0]].counts == "cases" and name != "rate"
    again = fp.rerun(file(name), **({"workers": 0} if in_process else {}))
    assert type(again) is type(result(name))
    comparison = fp.compare(result(name), again)
    assert comparison.equal, str(comparison)
    assert not comparison.parameters


# Where figures are drawn that take the most time: in test_report, or as PNG below. Here
# only that there are as many as allowed.
DRAWN_ELSEWHERE = {
    "solution", "paths", "check", "spectrum", "rate", "large-noise", "small-noise",
    "energy-tables", "steady-state", "steady-state, a scheme", "spectral",
    "spectral, from a grid", "smooth-spectral", "energy", "energy-paths", "web",
    "hydrodynamic", "hydrodynamic, plain", "hydrodynamic-paths", "web, of a process",
}  # fmt: skip


@pytest.fixture
def undrawn_pages(monkeypatch):
    """Figures of pages are empty: for tests of the words, or of how many there are."""
    monkeypatch.setattr(
        "fpsolve.pages.figures.embedded",
        lambda draw, caption, alt: Figure("data:,", 100, caption, alt),
    )


@pytest.mark.parametrize("name", MAKERS)
def test_a_result_is_told_with_figures_and_where_it_comes_from(name, request):
    if name in DRAWN_ELSEWHERE:
        request.getfixturevalue("undrawn_pages")
    page = report_text(file(name))
    assert file(name).name in page
    figures = possible_figures(result(name))
    assert page.count("<figure") == len(figures)
    assert figures or "There is no figure: " in page
    assert "numpy" in page


# Numbers that a page must tell, by the kind.
NUMBERS = {
    "steady-state": lambda found: f"{found.error:.2g}",
    "periodic-state": lambda found: f"{found.error:.2g}",
    "spectral": lambda found: f"{found.mean_xi1[-1]:.10g}",
    "smooth-spectral": lambda found: f"{found.mean_kappa2[-1]:.10g}",
    "spectral-steady-state": lambda found: f"{found.moments['mean_xi1']:.10g}",
    "smooth-spectral-steady-state": lambda found: (
        f"{found.moments['mean_kappa2']:.10g}"
    ),
    "energy-paths": lambda found: f"{found.g[-1].mean():.5g}",
    "hydrodynamic-paths": lambda found: f"{found.mean()[0][-1, 0]:.5g}",
    "spectrum": lambda found: f"{found.gap:.12g}",
    "fibre-motion": lambda found: f"{found.energy[-1]:.6g} J at last",
    "fibre-lay-down": lambda found: f"{found.fed:.6g} m",
    "identification-comparison": lambda found: f"by {found.aic_difference:.2f}",
    "web": lambda found: f"{found.mean_length_density():.6g}",
    "nozzle-design": lambda found: f"{found.values[0]:.5g}",
    "web-design": lambda found: f"{found.cv[0]:.5g}",
    "averages": lambda found: f"{float(found['expectation'][0]):.6g}",
    "small-noise-spectrum": lambda found: f"{float(found['limit'][0]):.6g}",
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_page_tells_the_numbers(name, undrawn_pages):
    assert NUMBERS[name](result(name)) in report_text(result(name))


def test_every_figure_of_a_result_is_written(tmp_path):
    for name in (
        "steady-state",
        "spectral",
        "smooth-spectral",
        "energy-paths",
        "hydrodynamic-paths",
    ):
        (path,) = plotting.save_figures(result(name), tmp_path, prefix=f"{name}-")
        assert path.read_bytes().startswith(b"\x89PNG")


def test_what_is_loaded_answers_like_what_was_saved():
    def loaded(name):
        return fp.load(file(name))

    spectral, spectrum = loaded("spectral"), loaded("spectrum")
    np.testing.assert_array_equal(
        spectral.density(1.0, GRID), result("spectral").density(1.0, GRID)
    )
    steady = loaded("spectral-steady-state")
    assert steady.density_error(GRID) == result("spectral-steady-state").density_error(
        GRID
    )
    smooth, curved = loaded("smooth-spectral-steady-state"), loaded("spectrum, smooth")
    np.testing.assert_array_equal(
        smooth.density(CURVED, tolerance=0.1),
        result("smooth-spectral-steady-state").density(CURVED, tolerance=0.1),
    )
    for mode in ("eigenfunction", "density_mode"):
        np.testing.assert_array_equal(
            getattr(curved, mode)(0, CURVED),
            getattr(result("spectrum, smooth"), mode)(0, CURVED),
        )
    for i in range(3):
        np.testing.assert_array_equal(
            spectrum.eigenfunction(i, GRID), result("spectrum").eigenfunction(i, GRID)
        )
        np.testing.assert_array_equal(
            spectrum.density_mode(i, GRID), result("spectrum").density_mode(i, GRID)
        )
    assert str(spectrum) == str(result("spectrum"))
    assert repr(loaded("steady-state")) == repr(result("steady-state"))


def test_arguments_of_a_method_and_of_its_object_can_be_changed():
    paths = result("energy-paths")
    assert fp.rerun(paths, noise=1.0).process.noise == 1.0
    assert fp.rerun(paths, n_paths=7).g.shape == (2, 7)
    other = fp.rerun(result("hydrodynamic-paths"), model=OWN.model, ds=0.25)
    assert other.method == "heun"
    assert fp.rerun(result("steady-state"), grid=FINER).grid == FINER


OWN_RESULTS = {
    "steady-state": (
        lambda: fp.steady_state(OWN.model, WIDE, error_tolerance=1.0), "model"
    ),
    "hydrodynamic-paths": (
        lambda: OWN.sample(20, 0.5, 0.25, seed=1, initial=(1.0, 0.0)), "model"
    ),
    "energy-paths": (
        lambda: OWN_PROCESS.sample(20, 0.5, 0.25, seed=1, initial=0.2), "potential"
    ),
    "energy": (lambda: energy(process=OWN_PROCESS), "potential"),
    "hydrodynamic": (lambda: hydrodynamic(OWN), "model"),
}  # fmt: skip


@pytest.mark.parametrize("name", OWN_RESULTS)
def test_code_of_the_users_own_is_described_and_must_be_given_again(
    name, tmp_path, undrawn_pages
):
    make, argument = OWN_RESULTS[name]
    found = make()
    path = found.save(tmp_path / "own.nc")
    with pytest.warns(UserWarning, match="could not be read back"):
        loaded = fp.load(path)
    assert fp.compare(found, loaded).equal
    assert fp.compare(found, loaded.save(tmp_path / "again.zarr")).equal
    with pytest.warns(UserWarning, match="could not be read back"):
        page = report_text(path)
    assert "a user&#39;s own functions" in page
    with pytest.raises(NotRepeatableError, match=f"`{argument}` was your own code"):
        fp.rerun(path)
    given = {"model": OWN.model, "potential": OWN_POTENTIAL}[argument]
    assert fp.compare(found, fp.rerun(loaded, **{argument: given})).equal


def test_a_start_of_ones_own_is_named_when_paths_of_a_limit_are_repeated(tmp_path):
    paths = LIMIT.sample(
        20, 0.5, seed=1, initial=lambda rng, n: rng.normal(size=(n, 2))
    )
    with pytest.raises(NotRepeatableError, match="`initial` was your own code"):
        fp.rerun(paths.save(tmp_path / "own.nc"))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"s_span": "x"}, "`s_span` and `ds` would give x and 0.25"),
        ({"ds": [1]}, "`s_span` and `ds` would give"),
        ({"record_every": "x"}, "`record_every` would give x"),
        ({"ds": 0.125}, "`record_every` would give 9 records, and it holds 5"),
        ({"s_span": [0.0, 1e15], "record_every": 2**50}, "days at the very least"),
    ],
)
@pytest.mark.parametrize("name", ["hydrodynamic", "energy, signed"])
def test_a_call_that_does_not_fit_its_result_is_not_repeated(name, changes, reason):
    found = result(name)
    asked = {**found.call.arguments, **changes}
    wrong = replace(found, call=replace(found.call, arguments=asked))
    with pytest.raises(NotRepeatableError, match=reason):
        fp.rerun(wrong)


def test_a_tampered_expansion_is_refused_by_name():
    dataset = result("spectral, on a belt").to_xarray()
    wrong = dataset.assign(limit=("held_degree", dataset["limit"].values + 1))
    with pytest.raises(ValueError, match="`coefficient` must fill the limits"):
        from_xarray(wrong)
    with pytest.raises(ValueError, match="`limit` must hold harmonics of every degree"):
        from_xarray(dataset.assign(limit=("held_degree", dataset["limit"].values * 0
                                             + 10**6)))  # fmt: skip


def test_tampered_sectors_are_refused_by_name():
    dataset = result("spectral").to_xarray()
    counts = dataset["held_count"].values
    with pytest.raises(ValueError, match="`held_count` must hold counts of every row"):
        from_xarray(dataset.assign(held_count=("held_row", counts - 1)))
    with pytest.raises(
        ValueError, match=r"`coefficient` must be .* as in `held_count`"
    ):
        from_xarray(dataset.assign(held_count=("held_row", counts + 4)))
    rows = dataset["n_rows"]
    with pytest.raises(ValueError, match=r"`n_rows` must be .* as in `held_count`"):
        from_xarray(dataset.assign(n_rows=rows + 2))
    with pytest.raises(ValueError, match="`held_count` must be zero in outer rows"):
        from_xarray(dataset.assign(held_count=("held_row", np.roll(counts, 1))))


def test_what_is_no_result_is_named():
    with pytest.raises(TypeError, match="`result` must be a result of fpsolve"):
        fp.compare(3, 3)
    with pytest.raises(TypeError, match="`result` must be a result of fpsolve"):
        plotting.save_figures(3, "figures")
    with pytest.raises(ValueError, match="it is not a result of fpsolve"):
        plotting.save_figures(xr.Dataset(), "figures")


@pytest.mark.parametrize("name", ["hydrodynamic", "hydrodynamic, plain", "energy"])
def test_a_report_about_a_solution_of_a_limit_tells_its_numbers(name, undrawn_pages):
    solution = result(name)
    page = report_text(solution)
    assert page.count("<figure") == 1
    assert f"ds = {solution.ds:g}" in page
    assert f"{solution.series['relative_entropy'][-1]:.6g}" in page
    extrapolated = solution.errors is not None
    assert ("Not extrapolated" in page) is not extrapolated
    if extrapolated:
        assert f"{solution.errors['relative_entropy'].max():.1e}" in page


def test_the_commands_write_what_they_can(fpsolve, tmp_path, undrawn_pages):
    result("hydrodynamic").save(tmp_path / "h.nc")
    result("energy").save(tmp_path / "e.nc")
    assert fpsolve("plot", "h.nc").output.split() == ["h-hydrodynamic.png"]
    assert fpsolve("plot", "e.nc").output.split() == ["e-law.png"]
    assert fpsolve("compare", "h.nc", "h.nc").exit_code == 0
    assert fpsolve("rerun", "e.nc").exit_code == 0
    assert fpsolve("report", "e.nc").output.split() == ["e.html"]


def test_without_a_saved_density_there_is_nothing_to_draw():
    for solution in (hydrodynamic(save_at=()), energy(save_at=())):
        assert possible_figures(solution) == {}
        assert "<figure" not in report_text(solution)
    with pytest.raises(ValueError, match="must hold a saved density to show"):
        plotting.plot_hydrodynamic(hydrodynamic(save_at=()))
    with pytest.raises(TypeError, match=r"see HydrodynamicLimit\.solve"):
        plotting.plot_hydrodynamic(3)


def test_a_study_is_loaded_and_drawn(fpsolve):
    path = result_files.result_file("energy.nc")
    assert fp.compare(fp.load(path), path).equal
    found = fpsolve("plot", str(path), "--out", "figures")
    assert found.exit_code == 0, found.output
    assert found.output.split() == [
        f"figures/energy-{name}.png"
        for name in ("orbits", "coefficients", "eigenfunctions")
    ]


def test_averages_are_not_saved_more_often_than_memory_allows():
    with pytest.raises(ValueError, match="`n_saved` must be at most 100000, got 10"):
        studies.ergodic_averages(
            fp.QuadraticPotential(), [1.0], s_end=2.0, n_paths=40, seed=1,
            n_saved=10**12,
        )  # fmt: skip


def test_averages_over_too_few_steps_name_the_step_that_was_chosen():
    with pytest.raises(ValueError, match=r"into at least 4 steps, got 0\.5; try 0\.25"):
        studies.ergodic_averages(
            fp.QuadraticPotential(), [1.0], s_end=1.0, n_paths=40, seed=1
        )
