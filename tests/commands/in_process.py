"""The command line in this process, so that a test may replace what it imports."""

import sys

import pytest

from executive.commands.main import main


def executive(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """Run a command, and return its exit status."""
    monkeypatch.setattr(sys, "argv", ["executive", *map(str, words)])
    try:
        main()
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0
