"""Every wrong configuration costs one line, by Python and on the command line."""

import pytest
from command_line import files
from malformed.cases import assert_said, parametrised
from malformed.configurations import ABSURD, PATHS_FILES, RUN, RUN_FILES, written
from malformed.designs import DESIGN_FILES
from malformed.webs import ABSURD_WEBS, WEB_FILES
from refusals import assert_one_line, everything

from fpsolve.cli.config import (
    DesignConfig,
    PathsConfig,
    RunConfig,
    WebConfig,
    load_config,
)
from fpsolve.errors import ConfigurationError, MemoryLimitError


@parametrised(RUN_FILES)
def test_a_wrong_run_is_refused_by_python(case, tmp_path):
    path = case.do(tmp_path)
    with pytest.raises(ConfigurationError) as caught:
        load_config(path, RunConfig).build()
    assert_said(str(caught.value), case)


@parametrised(ABSURD)
def test_a_run_that_never_fits_is_refused_before_anything_is_made(case, tmp_path):
    with pytest.raises(MemoryLimitError) as caught:
        load_config(case.do(tmp_path)).build()
    assert "GiB" in str(caught.value) or "TiB" in str(caught.value)


@parametrised([*RUN_FILES, *ABSURD])
def test_a_wrong_run_costs_one_line_and_no_file(case, fpsolve, tmp_path):
    path = case.do(tmp_path)
    before = everything(tmp_path)
    result = fpsolve("run", path, "--out", "out")
    if case in ABSURD:
        assert result.exit_code == 1
        assert "choose a coarser grid" in result.stderr
    else:
        assert_one_line(result, case, 2)
    assert everything(tmp_path) == before


def refused(case, kind, words, fpsolve, tmp_path):
    path = case.do(tmp_path)
    with pytest.raises(ConfigurationError) as caught:
        load_config(path, kind).build()
    assert_said(str(caught.value), case)
    before = files(tmp_path)
    assert_one_line(fpsolve(*words, path, "--out", "out"), case, 2)
    assert files(tmp_path) == before


@parametrised(PATHS_FILES)
def test_wrong_paths_cost_one_line_and_no_file(case, fpsolve, tmp_path):
    refused(case, PathsConfig, ["paths"], fpsolve, tmp_path)


@parametrised(DESIGN_FILES)
def test_a_wrong_design_costs_one_line_and_no_file(case, fpsolve, tmp_path):
    refused(case, DesignConfig, ["design"], fpsolve, tmp_path)


@parametrised(WEB_FILES)
def test_a_wrong_web_costs_one_line_and_no_file(case, fpsolve, tmp_path):
    refused(case, WebConfig, ["web"], fpsolve, tmp_path)


@parametrised(ABSURD_WEBS)
def test_a_web_that_never_fits_is_refused_before_anything_is_made(
    case, fpsolve, tmp_path
):
    path = case.do(tmp_path)
    with pytest.raises(MemoryLimitError) as caught:
        load_config(path, WebConfig).build()
    assert_said(str(caught.value), case)
    before = files(tmp_path)
    assert_one_line(fpsolve("web", path, "--out", "out"), case, 1)
    assert files(tmp_path) == before


def test_a_byte_order_mark_does_no_harm(tmp_path):
    plain = written(RUN)(tmp_path)
    expected = load_config(plain)
    assert load_config(written(b"\xef\xbb\xbf" + RUN)(tmp_path)) == expected
