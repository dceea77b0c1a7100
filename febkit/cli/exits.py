"""Exit codes of ``febkit``. docs/commands.md has them verb by verb; tests/cli/test_exits.py holds them to it."""

from __future__ import annotations

import click

DONE = 0
NO = 1  # the answer is no: did not converge, differs, loses content, a step of a study failed
BAD_INPUT = 2  # bad input or usage, a feature that febkit does not solve, a file that cannot be read or written
UNFORESEEN = 70  # a fault of febkit (EX_SOFTWARE of sysexits.h)
INTERRUPTED = 130  # Ctrl-C, as shells have it: 128 + SIGINT


class Refused(click.ClickException):
    """What was asked for cannot be done: a sentence, and exit code 2."""

    exit_code = BAD_INPUT


def signalled(number: int) -> int:
    """Exit code of a program that a signal ended, as shells have it."""
    return 128 + number
