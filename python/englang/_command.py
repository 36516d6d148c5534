"""The command `eng` of the wheel."""

import signal
import sys

from ._native import cli


def main() -> int:
    """Runs the command with the arguments of the process and returns its exit code."""
    # native code does not look for signals of Python, so Ctrl-C ends the process as it ends every command
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return cli(["eng", *sys.argv[1:]])
