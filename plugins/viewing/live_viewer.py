"""A rerun viewer on this computer: the one that listens at a port, or one that is started there.

Rerun's own functions that start or serve a viewer bind all interfaces, and none of them takes an
address. The viewer is therefore started as a program, which does (`--bind 127.0.0.1`).
"""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence

from executive.errors import ConfigError

_HOST = "127.0.0.1"
_START_S = 60.0  # for a viewer to listen
_LOOK_S = 0.05
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")


class LiveViewer:
    """A viewer that listens; without a display it is a page for a browser.

    Attributes:
        url: Where recordings are sent.
        place: Where it can be seen, for people.
    """

    def __init__(self, port: int, environment: Mapping[str, str] = os.environ) -> None:
        """Find a viewer, or start one.

        Args:
            port: Its port; a page for a browser takes the next one as well.
            environment: Environment variables, which tell whether there is a display.

        Raises:
            ConfigError: If none listens and none can be started.
        """
        self.url = f"rerun+http://{_HOST}:{port}/proxy"
        self._page: subprocess.Popen[bytes] | None = None
        if _listens(port):
            self.place = f"the viewer that listens at {_HOST}:{port}"
        elif any(environment.get(name) for name in _DISPLAYS):
            self.place = f"a viewer of its own, at {_HOST}:{port}; it stays open after the mission"
            _started(["--port", str(port), "--hide-welcome-screen"], [port], environment)
        else:
            page = f"http://{_HOST}:{port + 1}?url=rerun%2Bhttp%3A%2F%2F{_HOST}%3A{port}%2Fproxy"
            self.place = f"a browser, until the mission ends: {page}"
            words = ["--serve-web", "--port", str(port), "--web-viewer-port", str(port + 1)]
            self._page = _started(words, [port, port + 1], environment)

    def close(self) -> None:
        """End a page for a browser; a window stays open."""
        if self._page is not None:
            _end(self._page)
            self._page = None


def _listens(port: int) -> bool:
    try:
        socket.create_connection((_HOST, port), timeout=1.0).close()
    except OSError:
        return False
    return True


def _started(
    words: Sequence[str], ports: Sequence[int], environment: Mapping[str, str]
) -> "subprocess.Popen[bytes]":
    """Start a viewer that listens at this computer's own address alone.

    Raises:
        ConfigError: If it does not listen in time.
    """
    with tempfile.TemporaryFile() as said:
        started = subprocess.Popen(
            [sys.executable, "-m", "rerun", "--bind", _HOST, *words],
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,  # Ctrl-C stops the mission, and not the viewer
        )
        until_s = time.monotonic() + _START_S
        while not all(map(_listens, ports)):
            if started.poll() is None and time.monotonic() < until_s:
                time.sleep(_LOOK_S)  # noqa: TID251 - nothing moves before the mission is started
                continue
            status = _end(started)
            said.seek(0)
            last = said.read().decode(errors="replace").strip().rpartition("\n")[2]
            raise ConfigError(
                f"--live: the rerun viewer did not start at {_HOST}:{ports[0]} "
                f"(exit status {status}): {last or 'it said nothing'}"
            )
    return started


def _end(started: "subprocess.Popen[bytes]") -> int:
    """End a viewer and the processes that it has started; return its exit status."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(started.pid, number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            return started.wait(5.0)
    return started.wait()
