"""The real BehaviorTree.CPP: its sources are compiled with a small program that plays trees.

The library is no dependency and no part of this project. Where its sources lie says the environment
variable BTCPP_SOURCES, such as a checkout of version 4.10; a compiler for C++17 is needed.

    git clone --depth 1 --branch 4.10.0 https://github.com/BehaviorTree/BehaviorTree.CPP
    BTCPP_SOURCES=BehaviorTree.CPP python tests/tree/btcpp/compare.py

Its timers run by the clock of the played tree (program/behaviortree_cpp/utils/timer_queue.h), so
that a timeout comes at the same tick on every run. Loggers, Groot2 and SQLite are left out.
"""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

PROGRAM = Path(__file__).parent / "program"
VARIABLE = "BTCPP_SOURCES"
LEFT_OUT = (
    "bt_cout_logger",
    "bt_file_logger_v2",
    "bt_minitrace_logger",
    "bt_observer",
    "bt_sqlite_logger",
    "groot2_publisher",
    "manual_node",
    "shared_library_WIN",
)


@dataclass(frozen=True, slots=True)
class Scene:
    """A tree and how it is ticked.

    Attributes:
        xml: The tree for BehaviorTree.CPP 4.
        ticks: How often it is ticked.
        step_ms: Time from one tick to the next [ms].
        halts: After which ticks the tree is halted, the first tick being 1.
    """

    xml: str
    ticks: int = 1
    step_ms: int = 100
    halts: tuple[int, ...] = ()


class NotFoundError(Exception):
    """The sources or the compiler are not there; the message says what to do."""


def sources() -> Path:
    """Return the folder of the library's sources.

    Raises:
        NotFoundError: If it is not known or holds something else.
    """
    named = os.environ.get(VARIABLE, "")
    if not named:
        raise NotFoundError(f"{VARIABLE} names no folder with the sources of BehaviorTree.CPP 4.10")
    folder = Path(named).resolve()
    if not (folder / "src" / "bt_factory.cpp").is_file():
        raise NotFoundError(f"{VARIABLE}: {folder} holds no sources of BehaviorTree.CPP")
    return folder


def answers(scenes: Sequence[Scene]) -> list[dict[str, Any]]:
    """Play scenes on the real library; each answer is `{"ticks": […]}` or `{"error": "…"}`.

    Raises:
        NotFoundError: If the library cannot be built.
    """
    given = "".join(
        f"tree {one.ticks} {one.step_ms} {','.join(map(str, one.halts)) or '-'} "
        f"{len(one.xml.encode())}\n{one.xml}"
        for one in scenes
    )
    done = subprocess.run(
        [built()], input=given.encode(), capture_output=True, check=True, timeout=600
    )
    lines = [line for line in done.stdout.decode().splitlines() if line.startswith("{")]
    return [json.loads(line) for line in lines]


def built() -> Path:
    """Compile the library and the program, as far as they are not up to date; return the program.

    Raises:
        NotFoundError: If sources or compiler are missing, or compiling fails.
    """
    folder = sources()
    compiler = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        raise NotFoundError("no C++ compiler was found (g++, clang++ or CXX)")
    place = _build_folder(folder)
    files = [
        *(one for one in sorted(folder.glob("src/**/*.cpp")) if one.stem not in LEFT_OUT),
        folder / "3rdparty" / "tinyxml2" / "tinyxml2.cpp",
        PROGRAM / "player.cpp",
    ]
    header = PROGRAM / "behaviortree_cpp" / "utils" / "timer_queue.h"
    objects = [_object(compiler, folder, one, place, header) for one in files]
    program = place / "player"
    newest = max(one.stat().st_mtime for one in objects)
    if not program.is_file() or program.stat().st_mtime < newest:
        _run([compiler, *map(str, objects), "-o", str(program), "-lpthread", "-ldl"])
    return program


def _build_folder(folder: Path) -> Path:
    name = f"btcpp_{sha256(str(folder).encode()).hexdigest()[:8]}"
    place = Path(os.environ.get("BTCPP_BUILD") or Path(tempfile.gettempdir()) / name)
    place.mkdir(parents=True, exist_ok=True)
    return place


def _object(compiler: str, folder: Path, source: Path, place: Path, header: Path) -> Path:
    made = place / f"{source.stem}.o"
    newest = max(source.stat().st_mtime, header.stat().st_mtime)
    if made.is_file() and made.stat().st_mtime >= newest:
        return made
    third = folder / "3rdparty"
    places = [PROGRAM, folder / "include", third, third / "tinyxml2", third / "minicoro"]
    included = [f"-I{one}" for one in (*places, third / "minitrace")]
    version = '-DBTCPP_LIBRARY_VERSION="4.10.0"'
    _run([compiler, "-std=c++17", "-O1", "-w", *included, version, "-c", str(source), "-o", made])
    return made


def _run(command: Sequence[Any]) -> None:
    done = subprocess.run([str(one) for one in command], capture_output=True, text=True)
    if done.returncode:
        raise NotFoundError(f"compiling BehaviorTree.CPP failed:\n{done.stderr[-2000:]}")
