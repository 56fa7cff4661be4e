"""Record the answers of the cases anew, on purpose: the change of the files is then reviewed.

Without a name all are recorded. Answers of cases that are gone are removed.
"""

import argparse
import json
import runpy
import sys
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

HERE = Path(__file__).parent
VALUES = SimpleNamespace(**runpy.run_path(str(HERE / "values.py")))
RELATIVE = 1e-9  # as conftest.py compares


class Recorder:
    """Takes the answers of the cases, and writes a file for each file of tests."""

    def __init__(self) -> None:
        self._taken: dict[Path, dict[str, Any]] = defaultdict(dict)

    def take(self, path: Path, name: str, answer: Any) -> None:
        """Keep an answer until the end."""
        self._taken[path][name] = answer

    def write(self) -> int:
        """Write all files; return how many answers changed."""
        changed = 0
        for path, answers in self._taken.items():
            old = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
            for name in set(answers) & set(old):
                if not any(VALUES.differences(answers[name], old[name], RELATIVE, VALUES.ABSOLUTE)):
                    answers[name] = old[name]  # another processor's last digits are no change
            changed += sum(old.get(name) != answer for name, answer in answers.items())
            path.write_text(_text(answers), encoding="utf-8")
        return changed


def _text(answers: dict[str, Any]) -> str:
    """Return JSON with a line for each value near the top, so that a diff says what changed."""
    lines = []
    for name, answer in sorted(answers.items()):
        if isinstance(answer, dict) and answer:
            rows = [f"  {json.dumps(key)}: {json.dumps(answer[key])}" for key in answer]
            lines.append(f" {json.dumps(name)}: {{\n" + ",\n".join(rows) + "\n }")
        elif isinstance(answer, list) and answer:
            rows = [f"  {json.dumps(one)}" for one in answer]
            lines.append(f" {json.dumps(name)}: [\n" + ",\n".join(rows) + "\n ]")
        else:
            lines.append(f" {json.dumps(name)}: {json.dumps(answer)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def main() -> int:
    command = argparse.ArgumentParser(description=__doc__)
    command.add_argument("name", nargs="*", help="part of a file's path, such as monitoring")
    names = command.parse_args().name
    files = [
        path
        for path in sorted(HERE.rglob("test_*.py"))
        if not names or any(name in path.relative_to(HERE).as_posix() for name in names)
    ]
    if not files:
        command.error(f"no file of cases is named {' or '.join(names)}")
    recorder = Recorder()
    options = ["-p", "no:cacheprovider", *map(str, files)]
    status = pytest.main(options, plugins=[_Named(recorder)])
    if status:
        print("nothing is recorded: a case fails by itself", file=sys.stderr)
        return int(status)
    print(f"{recorder.write()} answers changed", file=sys.stderr)
    return 0


class _Named:
    """Hand a plugin over to pytest by a name that the fixture knows."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder

    def pytest_configure(self, config: pytest.Config) -> None:
        config.pluginmanager.register(self._recorder, "recorder")


if __name__ == "__main__":
    sys.exit(main())
