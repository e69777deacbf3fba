"""What tests of the command line look at, and commands in processes of their own."""

import subprocess
import sys

# Seconds after which a process hangs; however loaded the machine is, it is faster.
HANGS = 600
# The command, which tells when so many steps are done, and waits there for a signal.
WAITING = f"""
import sys, time
from contextlib import contextmanager
from fpsolve.cli import main, progress

reached = int(sys.argv.pop(1))

@contextmanager
def bar():
    def report(n_done, n_total, s):
        if n_done >= reached:
            print("here", flush=True)
            # In short sleeps: a signal just before a long one would not end it.
            for _ in range(100 * {HANGS}):
                time.sleep(0.01)
    yield report

progress.progress_bar = bar
main()
"""
# Told by the first use of kernels on a machine, which may be any test.
COMPILING = "compiling kernels (once, then cached) …\n"


def command_waiting_at(step, *words, cwd):
    """A command in a process that has made so many steps and awaits a signal.

    What is done when the signal comes is the same on any machine.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", WAITING, str(step), *map(str, words)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd,
    )  # fmt: skip
    for line in process.stdout:
        if line == "here\n":
            return process
    raise AssertionError(process.communicate(timeout=HANGS))


def assert_mistake(result, message, code=2):
    """One line of error, the right exit code, no traceback."""
    assert result.exit_code == code, result.output
    assert message in result.stderr
    assert result.stderr.removeprefix(COMPILING).startswith("error: ")
    assert "Traceback" not in result.output


def files(folder):
    """Names in a folder, in order."""
    return sorted(path.name for path in folder.iterdir())
