"""Work for tests, in a module of its own that is copied to where processes of runs find it."""

import ctypes
import errno
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.work import Piece, Work

_prepared: list[str] = []


class Arguments(Settings):
    behaviour: str = "answer"
    for_s: float = 0.0
    mebibytes: int = 0


class Misbehaving(Work):
    """Does what its argument says."""

    Arguments = Arguments

    def prepare(self, arguments: Settings, inputs: Mapping[str, Path]) -> None:
        _prepared.append("here")
        if os.environ.get("MISBEHAVING_PREPARES") == "badly":
            os._exit(7)
        if os.environ.get("MISBEHAVING_PREPARES") == "with a thread":
            threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()

    def run(self, piece: Piece) -> Mapping[str, Any]:
        arguments = piece.arguments
        assert isinstance(arguments, Arguments)
        getattr(self, arguments.behaviour)(piece, arguments)
        time.sleep(arguments.for_s)
        return {
            "seed": piece.seed,
            "inputs": {k: str(v) for k, v in piece.inputs.items()},
            "prepared": len(_prepared),
        }

    def answer(self, piece: Piece, arguments: Arguments) -> None:
        pass

    def computes(self, piece: Piece, arguments: Arguments) -> None:
        end_s = time.process_time() + arguments.for_s
        while time.process_time() < end_s:
            sum(range(10_000))

    def threads(self, piece: Piece, arguments: Arguments) -> None:
        (piece.folder / "omp").write_text(os.environ["OMP_NUM_THREADS"])

    def raises(self, piece: Piece, arguments: Arguments) -> None:
        raise ValueError("the arm is too short")

    def exits(self, piece: Piece, arguments: Arguments) -> None:
        os._exit(3)

    def leaves(self, piece: Piece, arguments: Arguments) -> None:
        sys.exit("enough")

    def segfaults(self, piece: Piece, arguments: Arguments) -> None:
        ctypes.string_at(0)

    def aborts(self, piece: Piece, arguments: Arguments) -> None:
        os.write(2, b"terminate called after throwing 'gtsam::Error'\n")
        os.abort()

    def kills_itself(self, piece: Piece, arguments: Arguments) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    def hangs(self, piece: Piece, arguments: Arguments) -> None:
        time.sleep(1000)

    def ignores_signals(self, piece: Piece, arguments: Arguments) -> None:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        time.sleep(1000)

    def has_children(self, piece: Piece, arguments: Arguments) -> None:
        """Begin a child in the session, and one in a session of its own; both outlive the work."""
        for name, is_apart in (("child", False), ("apart", True)):
            child = subprocess.Popen(["sleep", "1000"], start_new_session=is_apart)
            (piece.folder / "unfinished").write_text(str(child.pid))
            (piece.folder / "unfinished").rename(piece.folder / name)

    def leaves_a_group_to_itself(self, piece: Piece, arguments: Arguments) -> None:
        """Detach a group whose leader ends while another member of it goes on."""
        group = f"(sleep 1; touch {piece.folder / 'finished'}) & sleep 0.3"
        subprocess.run(["sh", "-c", f"setsid sh -c '{group}' & exit 0"], check=True)
        time.sleep(2.0)
        assert (piece.folder / "finished").exists()

    def has_children_and_hangs(self, piece: Piece, arguments: Arguments) -> None:
        self.has_children(piece, arguments)
        time.sleep(1000)

    def eats(self, piece: Piece, arguments: Arguments) -> None:
        self._held = bytearray(os.urandom(1 << 20)) * arguments.mebibytes
        time.sleep(1000)

    def lets_a_child_eat(self, piece: Piece, arguments: Arguments) -> None:
        held = f"a = bytearray(b'1' * (1 << 20)) * {arguments.mebibytes}"
        subprocess.run([sys.executable, "-c", f"import time; {held}; time.sleep(1000)"])

    def is_refused(self, piece: Piece, arguments: Arguments) -> None:
        raise ConfigError("no grasping plugin 'sampled_cn'. Did you mean 'sampled_cnn'?")

    def fills_the_disk(self, piece: Piece, arguments: Arguments) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    def writes(self, piece: Piece, arguments: Arguments) -> None:
        (piece.folder / "cloud").write_bytes(os.urandom(arguments.mebibytes << 20))
