"""The process of a simulated machine: how it is started, told to end, and what becomes of faults.

Small scripts stand for the machine; `tests/wire/test_machine_of_a_run.py` runs the real one.
"""

import os
import stat
import sys
from pathlib import Path

import pytest

from executive.errors import ConfigError, RobotError
from executive.mission import machine_process
from executive.mission.machine_folder import MachineFolder
from executive.mission.machine_process import (
    MachineProcess,
    behind_the_wire,
    listener_at,
    lives_apart,
    silence_of,
)
from executive.tree.load import load_mission

LISTENING = f"""#!{sys.executable}
import signal, socket, sys, time
signal.signal(signal.SIGTERM, signal.HANDLER)
address = sys.argv[sys.argv.index("--address") + 1].removeprefix("unix:")
with socket.socket(socket.AF_UNIX) as listener:
    listener.bind(address)
    listener.listen()
    print(*sys.argv[1:], sep="\\n", file=sys.stderr, flush=True)
    time.sleep(600)
"""


def mission(tmp_path, heartbeat="1 s", robot="{plugin: kinematic, model: m545}"):
    path = tmp_path / "mission.yaml"
    path.write_text(
        f"api: 1\nmission: apart\nplugins: {{robot: {robot}, estimation: gnss_imu_filter}}\n"
        f"loop: {{heartbeat_limit: {heartbeat}}}\n"
        "trees: {main: {sequence: [{run: Localise}]}}"
    )
    return load_mission(str(path))


@pytest.fixture
def folder(tmp_path):
    return MachineFolder(tmp_path)


@pytest.fixture
def machine_is(tmp_path, monkeypatch):
    """Let a script be what is started as the machine."""

    def started_as(script):
        path = tmp_path / "machine"
        path.write_text(script)
        path.chmod(0o755)
        monkeypatch.setattr(machine_process.sys, "executable", str(path))

    return started_as


def home_of(process):
    return Path(process.address.removeprefix("unix:")).parent


@pytest.mark.parametrize("handler", ["SIG_DFL", "SIG_IGN"])
def test_a_machine_listens_until_it_is_ended(folder, machine_is, monkeypatch, handler):
    monkeypatch.setattr(machine_process, "_END_S", 0.3)  # a machine that does not end is killed
    machine_is(LISTENING.replace("HANDLER", handler))
    process = MachineProcess(seed=7, silence_s=0.45)
    process.start(folder)
    try:
        assert listener_at(process.address) not in (0, os.getpid())
        assert folder.address.read_text().strip() == process.address
        assert stat.S_IMODE(home_of(process).stat().st_mode) == 0o700  # of this user alone
    finally:
        process.end()
    assert listener_at(process.address) == 0
    assert not home_of(process).exists()
    process.end()  # a second time it does nothing


def test_a_machine_is_given_the_mission_the_seed_and_the_silence(folder, machine_is):
    machine_is(LISTENING.replace("HANDLER", "SIG_DFL"))
    process = MachineProcess(seed=7, silence_s=0.45)
    process.start(folder)
    process.end()
    words = folder.log.read_text().splitlines()
    assert words[:4] == ["-m", "executive.commands.entry", "simulate", str(folder.mission)]
    given = dict(zip(words[4::2], words[5::2], strict=True))
    assert given == {
        "--seed": "7",
        "--address": process.address,
        "--silence": "0.45 s",
        "--run-dir": str(folder.path),
    }


def test_each_machine_has_an_address_of_its_own():
    addresses = {MachineProcess(seed=1, silence_s=0.3).address for _ in range(20)}
    assert len(addresses) == 20
    assert max(len(one) for one in addresses) < len("unix:") + 107  # bytes of a socket's path


@pytest.mark.parametrize(("status", "error"), [(2, ConfigError), (1, RobotError), (0, RobotError)])
def test_a_machine_that_ends_at_its_start_is_told_by_its_last_words(
    folder, machine_is, status, error
):
    machine_is(f"#!/bin/sh\necho first >&2\necho 'no site' >&2\nexit {status}\n")
    with pytest.raises(error, match=r"^no site$"):
        MachineProcess(seed=1, silence_s=0.3).start(folder)


def test_a_machine_that_ends_without_a_word_is_told_so(folder, machine_is):
    machine_is("#!/bin/sh\nexit 1\n")
    with pytest.raises(RobotError, match="ended at its start, without a word"):
        MachineProcess(seed=1, silence_s=0.3).start(folder)


def test_a_machine_that_never_listens_is_ended_and_told(folder, machine_is, monkeypatch):
    monkeypatch.setattr(machine_process, "_START_S", 0.2)
    machine_is("#!/bin/sh\nexec sleep 600\n")
    process = MachineProcess(seed=1, silence_s=0.3)
    with pytest.raises(RobotError, match=r"does not listen after 0\.2 s"):
        process.start(folder)
    assert not home_of(process).exists()


def test_the_machine_of_a_run_that_was_killed_ends_before_another_starts(folder, machine_is):
    machine_is(LISTENING.replace("HANDLER", "SIG_DFL"))
    killed, resumed = (MachineProcess(seed=1, silence_s=0.3) for _ in range(2))
    killed.start(folder)
    resumed.start(folder)
    try:
        assert listener_at(killed.address) == 0
        assert listener_at(resumed.address) != 0
    finally:
        resumed.end()
        killed.end()


@pytest.mark.parametrize("address", ["unix:/nowhere/machine.sock", "no address at all"])
def test_where_nobody_listens_there_is_no_process(address):
    assert listener_at(address) == 0


def test_only_a_simulated_machine_lives_apart(tmp_path):
    assert lives_apart(mission(tmp_path))
    wire = "{plugin: wire, address: 'unix:/tmp/machine.sock', model: m545}"
    assert not lives_apart(mission(tmp_path, robot=wire))


@pytest.mark.parametrize(
    ("heartbeat", "silence_s", "limit_s"),
    [("100 ms", 0.3, 0.6), ("200 ms", 0.3, 0.6), ("1 s", 1.5, 3.0), ("8 s", 12.0, 10.0)],
)
def test_the_machine_waits_longer_than_the_supervisor_and_the_executive_twice_as_long(
    tmp_path, heartbeat, silence_s, limit_s
):
    described = mission(tmp_path, heartbeat)
    assert silence_of(described) == pytest.approx(silence_s)
    (selection,) = behind_the_wire(described, "unix:/tmp/machine.sock").plugins["robot"]
    settings = selection.settings
    assert (selection.name, settings.address, settings.model) == (
        "wire",
        "unix:/tmp/machine.sock",
        "m545",
    )
    assert settings.silence_limit == settings.answer_limit == pytest.approx(limit_s)


def test_behind_the_wire_all_other_plugins_stay(tmp_path):
    described = mission(tmp_path)
    wired = behind_the_wire(described, "unix:/tmp/machine.sock")
    assert wired.plugins["estimation"] == described.plugins["estimation"]
