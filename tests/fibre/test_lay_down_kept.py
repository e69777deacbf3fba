"""A run of a laid fibre is kept where it stops, and goes on to the same bits."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import fibre
from fpsolve.fibre import lay_keeper

SPUN = fibre.String(
    0.2, 2e-4, 1000.0, 1e8, n_edges=10, end=fibre.Free(),
    start=fibre.Nozzle((0.0, 0.0, 0.25), (0.1, 0.03, -1.0), 1.0),
)  # fmt: skip
N_STEPS = 40


def laid(**options):
    options = {"belt": fibre.Belt(0.3), "save_every": 7, **options}
    return fibre.lay_down(SPUN, 0.2, N_STEPS, **options)


def stopping_after(n_steps):
    """A callback that presses Ctrl-C."""

    def report(n_done, n_total, t):
        assert n_total == N_STEPS
        assert t == pytest.approx(0.2 * n_done / N_STEPS)
        if n_done == n_steps:
            raise KeyboardInterrupt

    return report


NOISE = [
    {},
    {"turbulence": fibre.RandomForce(3e-6), "seed": 4},
    {"turbulence": fibre.RandomForce(3e-6, correlation_time=0.02), "seed": 4},
]


@pytest.mark.parametrize("noise", NOISE, ids=["quiet", "white", "correlated"])
@pytest.mark.parametrize("stopped", [1, 30])
def test_an_interrupted_run_goes_on_to_the_bits_of_one_that_never_stopped(
    tmp_path, noise, stopped
):
    path = tmp_path / "part.nc"
    with pytest.raises(fp.RunInterrupted) as caught:
        laid(checkpoint=path, progress=stopping_after(stopped), **noise)
    part = caught.value.solution
    assert part.status == fp.load(path).status == "interrupted"
    assert part.t.size == stopped + 1
    whole, seen = laid(**noise), []
    np.testing.assert_array_equal(part.kinetic, whole.kinetic[: stopped + 1])
    again = laid(checkpoint=path, progress=lambda n, *_: seen.append(n), **noise)
    assert seen == list(range(stopped + 1, N_STEPS + 1))
    comparison = fp.compare(again, whole)
    assert comparison.equal, str(comparison)
    assert not comparison.parameters
    assert again.status == "finished"
    assert not path.exists()


def test_long_runs_are_kept_on_the_way(tmp_path, monkeypatch):
    monkeypatch.setattr(lay_keeper, "BETWEEN", 0.0)
    path, seen = tmp_path / "part.nc", []

    def report(n_done, n_total, t):
        seen.append(fp.load(path).t.size if path.exists() else 0)
        if n_done == 4:
            raise RuntimeError("killed")

    with pytest.raises(RuntimeError, match="killed"):
        laid(checkpoint=path, progress=report, estimate_error=False)
    # Every step is in the file before the next one is told of.
    assert seen == [0, 2, 3, 4]


def test_what_fails_brings_the_fibre_until_then(tmp_path):
    def gust(r, t):
        return np.full(r.shape, 0.0 if t < 0.1 else 1e9)

    with pytest.raises(fp.EdgeLengthError) as caught:
        laid(air=fibre.AirFlow(gust), estimate_error=False)
    part = caught.value.solution
    assert part.status == "failed"
    assert part.t[-1] == pytest.approx(caught.value.t, abs=0.006)
    assert part.stretched.max() < 1e-12


def test_a_checkpoint_of_another_run_is_refused(tmp_path):
    path = tmp_path / "part.nc"
    with pytest.raises(fp.RunInterrupted):
        laid(checkpoint=path, progress=stopping_after(3))
    with pytest.raises(ValueError, match="`checkpoint` must be of the same arguments"):
        laid(checkpoint=path, theta=0.7)
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(fp.FileFormatError):
        laid(checkpoint=path)
    fibre.simulate(fibre.String(1.0, 2e-3, 1e3, 1e9, n_edges=4), 0.1, 2).save(path)
    with pytest.raises(fp.FileFormatError, match="no fibre that is laid down"):
        laid(checkpoint=path)
    with pytest.raises(TypeError, match="`progress` must be True, False or a function"):
        laid(progress="yes")
