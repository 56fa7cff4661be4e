"""A mission is shown live: in a viewer that listens, or in one that is started on this computer."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.viewing import backlog, live_viewer, recording
from executive_plugins.viewing.live_viewer import LiveViewer
from executive_plugins.viewing.none import NoViewer
from executive_plugins.viewing.rerun import RerunViewer
from executive_plugins.viewing.settings import RerunSettings
from rerun.chunk import RrdReader
from typer.testing import CliRunner

from executive.commands.main import app
from executive.config import NoSettings
from executive.errors import ConfigError
from executive.machine.machine import load_machine
from executive.messages.joints import JointSample

WITHOUT_DISPLAY = {
    name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")
}


@pytest.fixture
def port():
    """A port that is free, and the next one as well."""
    for candidate in range(22_667, 32_667, 2):
        with socket.socket() as first, socket.socket() as second:
            try:
                first.bind(("127.0.0.1", candidate))
                second.bind(("127.0.0.1", candidate + 1))
            except OSError:
                continue
        return candidate
    pytest.fail("no two free ports")


def listening(port):
    """Return the local addresses at which something listens at a port, IPv4 and IPv6."""
    found = []
    for name in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]:
            _, local, _, state = line.split()[:4]
            if state == "0A" and int(local.rpartition(":")[2], 16) == port:
                found.append(local.rpartition(":")[0])
    return found


@pytest.fixture
def silent():
    """A port where somebody takes connections and never answers."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        yield taken.getsockname()[1]


def test_a_page_for_a_browser_listens_on_this_computer_alone_and_ends_with_the_mission(port):
    viewer = LiveViewer(port, WITHOUT_DISPLAY)
    try:
        assert f"http://127.0.0.1:{port + 1}" in viewer.place
        assert listening(port) == listening(port + 1) == ["0100007F"]
    finally:
        viewer.close()
    limit_s = time.monotonic() + 10.0  # its program has ended, what that has started is ending
    while listening(port) or listening(port + 1):
        assert time.monotonic() < limit_s
        time.sleep(0.02)


def test_a_viewer_that_does_not_start_is_told_with_what_it_said(port, monkeypatch, tmp_path):
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\necho 'no such option' >&2\nexit 3\n")
    program.chmod(0o700)
    monkeypatch.setattr(sys, "executable", str(program))
    with pytest.raises(ConfigError, match=r"did not start.*\(exit status 3\): no such option"):
        LiveViewer(port, WITHOUT_DISPLAY)


def test_a_window_is_opened_where_there_is_a_display(port, monkeypatch):
    words = []
    monkeypatch.setattr(live_viewer, "_started", lambda given, *_: words.extend(given))
    assert "stays open" in LiveViewer(port, {"DISPLAY": ":0"}).place
    assert "--serve-web" not in words


def test_a_viewer_that_hangs_does_not_hold_the_end_of_the_mission_up(silent, monkeypatch, caplog):
    monkeypatch.setattr(recording, "_CLOSING_S", 0.1)
    unregistered = threading.Event()
    monkeypatch.setattr("rerun.unregister_shutdown", unregistered.set)
    viewer = RerunViewer(RerunSettings(), load_machine("m545"))
    assert viewer.show_live(silent) == f"the viewer that listens at 127.0.0.1:{silent}"
    began_s = time.monotonic()
    viewer.close()
    assert time.monotonic() - began_s < 3.0
    assert unregistered.is_set()
    assert "does not show the end of the mission" in caplog.text


def test_what_a_viewer_that_hangs_would_get_is_dropped_counted_and_told(monkeypatch, caplog):
    class Stream:
        takes = True

        def flush(self, *, timeout_sec):
            if not self.takes:
                raise RuntimeError("Flush timed out")

    monkeypatch.setattr(backlog, "_LOOK_S", 0.002)
    stream = Stream()
    waiting = backlog.Backlog(stream)
    assert not waiting.drops()
    for takes in (False, True):
        stream.takes, limit_s = takes, time.monotonic() + 5.0
        while waiting.is_full is takes and time.monotonic() < limit_s:
            time.sleep(0.002)
        assert waiting.drops() is not takes
    waiting.close()
    assert "the rerun viewer takes nothing (Flush timed out)" in caplog.text
    assert "takes messages again" in caplog.text
    assert "1 messages were not shown" in caplog.text


def test_a_recording_has_few_chunks_of_many_rows(tmp_path):
    machine = load_machine("m545")
    viewer = RerunViewer(RerunSettings(batch_period_s=60.0), machine)
    viewer.open(str(tmp_path / "recording.rrd"))
    for k in range(200):
        n = len(machine.joint_names)
        viewer.show(k / 10, "joints", JointSample(k / 10, machine.joint_names, *np.zeros((3, n))))
    viewer.close()
    chunks = list(RrdReader(str(tmp_path / "recording.rrd")).stream())
    rows = [len(one.to_record_batch()) for one in chunks if not one.is_static]
    assert sum(rows) == 200 * (1 + len(machine.joints))
    assert len(rows) <= 2 * (1 + len(machine.joints))


def test_a_mission_without_a_viewer_that_can_is_not_shown_live(tmp_path):
    with pytest.raises(ConfigError, match="NoViewer shows nothing live"):
        NoViewer(NoSettings()).show_live(1)
    path = tmp_path / "dry.yaml"
    path.write_text(
        "api: 1\nmission: dry\nplugins: {robot: kinematic, estimation: gnss_imu_filter}\n"
        "trees: {main: {wait: 0.1 s}}\n"
    )
    words = ["run", str(path), "--live", "--run-dir", str(tmp_path / "run")]
    assert "--set viewing.plugin=rerun" in str(CliRunner().invoke(app, words).exception)
    assert not (tmp_path / "run").exists()


def test_a_mission_is_shown_in_the_viewer_that_listens(tmp_path, silent, monkeypatch):
    monkeypatch.setattr(recording, "_CLOSING_S", 0.1)
    monkeypatch.setattr("rerun.unregister_shutdown", lambda: None)
    path = tmp_path / "dry.yaml"
    path.write_text(
        "api: 1\nmission: dry\nplugins: {robot: kinematic, estimation: gnss_imu_filter, "
        "viewing: rerun}\ntrees: {main: {wait: 0.1 s}}\n"
    )
    words = ["run", str(path), "--live-port", str(silent), "--run-dir", str(tmp_path / "run")]
    ended = CliRunner().invoke(app, words)
    assert ended.exit_code == 0, ended.output
    assert f"shown in the viewer that listens at 127.0.0.1:{silent}" in ended.output
    assert not (tmp_path / "run" / "recording.rrd").exists()


class Stubborn:
    """A viewer that ends on a signal, or late after all of them."""

    pid = 4711

    def __init__(self, ends_on: int | None) -> None:
        self.heard: list[int] = []
        self._ends_on = ends_on

    def wait(self, limit_s: float | None = None) -> int:
        if self._ends_on not in self.heard and limit_s is not None:
            raise subprocess.TimeoutExpired("rerun", limit_s)
        return -self.heard[-1]


@pytest.mark.parametrize(
    ("ends_on", "heard"),
    [
        (signal.SIGTERM, [signal.SIGTERM]),
        (signal.SIGKILL, [signal.SIGTERM, signal.SIGKILL]),
        (None, [signal.SIGTERM, signal.SIGKILL]),
    ],
)
def test_a_viewer_is_asked_to_end_then_killed_and_its_status_is_told(monkeypatch, ends_on, heard):
    viewer = Stubborn(ends_on)

    def kill(group, number):
        assert group == viewer.pid  # with the processes that it has started
        viewer.heard.append(number)

    monkeypatch.setattr(live_viewer.os, "killpg", kill)
    assert live_viewer._end(viewer) == -heard[-1]
    assert viewer.heard == heard


def test_a_viewer_that_has_ended_by_itself_is_no_error(monkeypatch):
    def kill(group, number):
        viewer.heard.append(number)
        raise ProcessLookupError

    viewer = Stubborn(signal.SIGTERM)
    monkeypatch.setattr(live_viewer.os, "killpg", kill)
    assert live_viewer._end(viewer) == -signal.SIGTERM


class Program:
    """A program that is started in place of rerun, and when it listens."""

    def __init__(self, looks: int, monkeypatch, status: int | None = None) -> None:
        self.words, self.how, self.looks, self.slept = None, None, looks, []
        self._status = status
        self.now_s = 0.0
        monkeypatch.setattr(live_viewer.subprocess, "Popen", self._start)
        monkeypatch.setattr(live_viewer, "_listens", self._listens)
        monkeypatch.setattr(live_viewer, "_end", lambda started: self._status)
        # Its name of the module, and not the module: threads that other tests have left behind
        # would sleep by this clock as well, not at all, and note it without an end.
        clock = SimpleNamespace(sleep=self._sleep, monotonic=lambda: self.now_s)
        monkeypatch.setattr(live_viewer, "time", clock)

    def _start(self, words, **how):
        self.words, self.how = words, how
        return self

    def _listens(self, port):
        return self.words is not None and len(self.slept) >= self.looks

    def _sleep(self, duration_s):
        self.slept.append(duration_s)
        self.now_s += duration_s

    def poll(self):
        return self._status


def test_a_page_is_served_to_this_computer_and_ended_once(monkeypatch):
    program = Program(2, monkeypatch, None)
    viewer = LiveViewer(5000, {"HOME": "/home/me", "DISPLAY": ""})
    assert viewer.url == "rerun+http://127.0.0.1:5000/proxy"
    assert viewer.place == (
        "a browser, until the mission ends: "
        "http://127.0.0.1:5001?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A5000%2Fproxy"
    )
    serve = ["--serve-web", "--port", "5000", "--web-viewer-port", "5001"]
    assert program.words == [sys.executable, "-m", "rerun", "--bind", "127.0.0.1", *serve]
    assert program.how["env"] == {"HOME": "/home/me", "DISPLAY": ""}
    assert program.how["stdin"] == program.how["stdout"] == subprocess.DEVNULL
    assert program.how["start_new_session"] is True
    assert program.slept == [0.05, 0.05]
    ended = []
    monkeypatch.setattr(live_viewer, "_end", ended.append)
    viewer.close()
    viewer.close()
    assert ended == [program]


def test_a_window_stays_open_after_the_mission(monkeypatch):
    program = Program(0, monkeypatch)
    viewer = LiveViewer(5000, {"WAYLAND_DISPLAY": "wayland-0"})
    assert viewer.place == "a viewer of its own, at 127.0.0.1:5000; it stays open after the mission"
    assert program.words[3:] == ["--bind", "127.0.0.1", "--port", "5000", "--hide-welcome-screen"]
    monkeypatch.setattr(live_viewer, "_end", lambda started: pytest.fail("a window was ended"))
    viewer.close()


def test_a_viewer_has_a_minute_to_listen(monkeypatch):
    program = Program(10**6, monkeypatch)
    with pytest.raises(ConfigError, match=r"at 127\.0\.0\.1:5000 \(exit status None\): it said"):
        LiveViewer(5000, {})
    assert sum(program.slept) == pytest.approx(60.0, abs=0.1)
    program = Program(10**6, monkeypatch, status=2)  # it has ended by itself
    with pytest.raises(ConfigError, match=r"\(exit status 2\): it said nothing"):
        LiveViewer(5000, {})
    assert program.slept == []
