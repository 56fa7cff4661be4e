"""The verbs of grasping: light to ask for, from nothing to weights by two commands, and clear about
mistakes.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from executive_plugins.grasping.classifier.outcome_net import load_net

from executive.errors import UnknownPluginError
from executive.registry import VERBS, installed, load_verb


def executive(*words: str) -> subprocess.CompletedProcess[str]:
    code = (
        f"import sys; sys.argv = ['executive', *{list(words)!r}]; from "
        "executive.commands.main import main; main()"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("verb", ["grasp-data", "grasp-train"])
def test_help_is_light(verb: str) -> None:
    code = (
        f"import sys; sys.argv = ['executive', '{verb}', '--help']; from "
        "executive.commands.main import main\n"
    )
    code += (
        "try: main()\nexcept SystemExit: print(sorted({'torch', 'mujoco', 'numba', "
        "'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert verb in done.stdout
    assert done.stdout.splitlines()[-1] == "[]", done.stdout


def test_verbs_are_installed_and_listed_in_the_help() -> None:
    assert {"grasp-data", "grasp-train"} <= {verb.name for verb in installed(VERBS)}
    assert "grasp-train" in executive("--help").stdout
    with pytest.raises(UnknownPluginError, match="Did you mean 'grasp-data'"):
        load_verb("grasp-dat")


def test_labels_and_then_weights_come_from_two_commands(tmp_path: Path) -> None:
    labels, weights = str(tmp_path / "labels"), tmp_path / "weights" / "net.safetensors"
    made = executive("grasp-data", labels, "--stones", "2", "--grasps", "4")
    assert made.returncode == 0, made.stderr
    trained = executive(
        "grasp-train", labels, str(weights), "--epochs", "1", "--architecture", "four_layer"
    )
    assert trained.returncode == 0, trained.stderr
    assert json.loads(trained.stdout)["training"]["architecture"] == "four_layer"
    load_net(weights)


def test_labels_go_on_where_they_were_interrupted_and_are_the_same(tmp_path: Path) -> None:
    words = ("grasp-data", str(tmp_path), "--stones", "3", "--grasps", "2", "--workers", "2")
    assert executive(*words).returncode == 0
    files = sorted(tmp_path.glob("stone_*.npz"))
    before = [path.read_bytes() for path in files]
    files[1].unlink()
    left_behind = tmp_path / "unfinished" / "runs" / "0-1"  # by a process that was killed
    left_behind.mkdir(parents=True)
    again = executive(*words)
    assert again.returncode == 0, again.stderr
    assert "2 of 3 stones" in again.stderr
    assert [path.read_bytes() for path in files] == before
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "labels.json",
        *(path.name for path in files),
    ]


def test_a_machine_that_is_not_there_is_a_message_and_no_traceback(tmp_path: Path) -> None:
    failed = executive(
        "grasp-data", str(tmp_path), "--stones", "1", "--machine", str(tmp_path / "no_machine")
    )
    assert failed.returncode == 2
    assert "no_machine" in failed.stderr
    assert "Traceback" not in failed.stderr


def test_an_unknown_architecture_is_a_message_and_no_traceback(tmp_path: Path) -> None:
    failed = executive("grasp-train", str(tmp_path), "out.safetensors", "--architecture", "resnet")
    assert failed.returncode == 2
    assert "'resnet' is not one of four_layer, two_stream" in failed.stderr
    assert "Traceback" not in failed.stderr
