"""Work for tests of clusters, in a module of its own that is copied to where workers find it."""

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from executive.config import Settings
from executive.interfaces.work import Piece, Work


class Arguments(Settings):
    for_s: float = 0.0
    computes_s: float = 0.0
    stones: str = ""
    needs: str = ""


class Spread(Work):
    """Waits or computes, reads an input, and leaves files behind."""

    Arguments = Arguments
    keeps: ClassVar[tuple[str, ...]] = ("*.txt",)

    def inputs(self, arguments: Settings) -> Mapping[str, Path]:
        assert isinstance(arguments, Arguments)
        return {"stones": Path(arguments.stones)} if arguments.stones else {}

    def run(self, piece: Piece) -> Mapping[str, Any]:
        arguments = piece.arguments
        assert isinstance(arguments, Arguments)
        (piece.folder / "began.txt").write_text(str(os.getpid()))
        (piece.folder / "scratch.bin").write_bytes(bytes(1000))
        time.sleep(arguments.for_s)
        until_s = time.thread_time() + arguments.computes_s
        while time.thread_time() < until_s:
            pass
        stones = piece.inputs.get("stones")
        content = {one.name: _beginning(one) for one in stones.iterdir()} if stones else {}
        return {"seed": piece.seed, "stones": content, "at": str(stones), "ppid": os.getppid()}


def _beginning(path: Path) -> str:
    with path.open() as file:
        return file.read(100)
