"""What tests of the command line look at."""

# Told by the first use of kernels on a machine, which may be any test.
COMPILING = "compiling kernels (once, then cached) …\n"


def assert_mistake(result, message, code=2):
    """One line of error, the right exit code, no traceback."""
    assert result.exit_code == code, result.output
    assert message in result.stderr
    assert result.stderr.removeprefix(COMPILING).startswith("error: ")
    assert "Traceback" not in result.output


def files(folder):
    """Names in a folder, in order."""
    return sorted(path.name for path in folder.iterdir())
