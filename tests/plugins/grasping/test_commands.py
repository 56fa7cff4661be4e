"""The verbs of grasping: light to ask for, from nothing to weights by two commands, and clear about
mistakes.
"""

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest
import typer
from executive_plugins.grasping import commands
from executive_plugins.grasping.classifier.outcome_net import load_net

from executive.commands.bulk import Where
from executive.errors import ConfigError, UnknownPluginError
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


def test_the_count_of_stones_grows_by_each_that_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of four stones one is there already; the second of the missing ones fails."""
    asked: list[object] = []

    def spread(work: str, arguments: Mapping[str, object], seeds: Sequence[int], where, take):
        asked.extend((work, dict(arguments), list(seeds), where))
        for seed in (0, 3):
            made = tmp_path / "runs" / str(seed)
            made.mkdir(parents=True)
            (made / f"stone_{seed:05d}.npz").write_bytes(b"labels")
            take(seed, made)
        return 1

    monkeypatch.setattr(commands, "spread", spread)
    folder = tmp_path / "labels"
    folder.mkdir()
    (folder / "stone_00001.npz").write_bytes(b"there")
    with pytest.raises(typer.Exit) as ended:
        commands.grasp_data(
            folder, 4, 6, 9, "m545", "wet", 0.02, 1.5, "mine.safetensors", 3, "tcp://here:1",
            views="surveyed", volume_m3=(0.3, 0.9),
        )  # fmt: skip
    assert ended.value.exit_code == 1
    work, arguments, seeds, where = asked
    assert (work, seeds) == ("grasp_labels", [0, 2, 3])
    wanted = {"machine": "m545", "seed": 9, "grasps_per_stone": 6, "physics": "wet"}
    wanted |= {"arm_error_m": 0.02, "weights": "mine.safetensors"}
    wanted |= {"views": "surveyed", "volume_m3": [0.3, 0.9]}
    assert wanted.items() <= arguments.items()
    assert arguments["arm_error_rad"] == pytest.approx(0.0261799, rel=1e-5)
    assert where == Where(folder / "unfinished", 3, "tcp://here:1")
    told = [part.strip() for part in capsys.readouterr().err.split("\r") if part]
    assert [one.partition("\n")[0] for one in told] == [f"{n} of 4 stones" for n in (1, 2, 3)]
    names = sorted(path.name for path in folder.glob("*.npz"))
    assert names == ["stone_00000.npz", "stone_00001.npz", "stone_00003.npz"]
    assert (folder / "stone_00001.npz").read_bytes() == b"there"


def test_contacts_that_nobody_knows_are_refused_before_a_folder_is_made(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="--physics"):
        commands.grasp_data(tmp_path / "labels", physics="stormy")
    assert not (tmp_path / "labels").exists()


def test_views_and_volumes_that_are_none_are_refused_before_a_folder_is_made(
    tmp_path: Path,
) -> None:
    with pytest.raises(ConfigError, match="--views: 'blind' is not one of mixed, surveyed"):
        commands.grasp_data(tmp_path / "labels", views="blind")
    with pytest.raises(ConfigError, match=r"--volume-m3: expected LEAST MOST, got 0\.9 0\.3"):
        commands.grasp_data(tmp_path / "labels", volume_m3=(0.9, 0.3))
    assert not (tmp_path / "labels").exists()


def test_a_training_is_told_where_to_start_and_how_fast(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from executive_plugins.grasping.learning import grasp_training

    asked: list[object] = []
    monkeypatch.setattr(grasp_training, "train_weights", lambda *given: asked.append(given) or {})
    out = tmp_path / "out.safetensors"
    commands.grasp_train(tmp_path, out, start="two_stream", rate=2e-4, epochs=3)
    folder, to, settings, test, _ = asked[0]
    assert (folder, to, test) == (tmp_path, out, None)
    assert (settings.start, settings.rate, settings.epochs) == ("two_stream", 2e-4, 3)


def test_an_unknown_architecture_is_refused_before_anything_is_imported(tmp_path: Path) -> None:
    told = "--architecture: 'resnet' is not one of four_layer, two_stream"
    with pytest.raises(ConfigError, match=told):
        commands.grasp_train(tmp_path, tmp_path / "out.safetensors", architecture="resnet")
