"""What a mistake on the command line costs: one line, and no file."""

from malformed.cases import assert_said


def everything(folder):
    """Names of all that lies in a folder, contents of links not looked at."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def assert_one_line(result, case, code):
    assert result.exit_code == code, result.output
    assert result.stderr.startswith("error: ")
    assert_said(result.stderr.removeprefix("error: "), case)
    assert "Traceback" not in result.output
