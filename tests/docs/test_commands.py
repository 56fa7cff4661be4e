"""Every command of the README and of the pages works as it stands.

Cheap commands are run. Missions are run with a time limit of a fraction of a second, so that their
options are read and their plugins are made. Of the others the verb and the options are parsed. A
line of a kind that this file does not know fails.
"""

import json
import re
import shlex
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import typer

from executive.commands.main import app, main
from executive.tree.load import load_mission

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PROGRAMS = ("executive", "make", "python", "pip", "pytest", "kill", "rerun", "dask")
CHEAP = {"check", "show", "schema", "words", "--help", "--version"}
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def commands_of(page: Path) -> list[str]:
    """Return the commands of a page: the lines of shell blocks, and code that begins as one."""
    text = page.read_text(encoding="utf-8")
    blocks = re.findall(r"```sh\n(.*?)```", text, re.S)
    lines = [line for block in blocks for line in block.splitlines()]
    prose = re.sub(r"```.*?```", "", text, flags=re.S)
    lines += re.findall(r"^ {4}((?:\w+=\S+ )*(?:executive|python) .*)$", prose, re.M)
    starts = re.compile(rf"(?:\w+=\S+ )*(?:{'|'.join(PROGRAMS)}) \S")
    inline = (" ".join(code.split()) for code in re.findall(r"`([^`]+)`", prose))
    verbs = ("executive run", "executive check", "pip install")  # named, not shown
    lines += [code for code in inline if starts.match(code) and code not in verbs]
    return [line for line in lines if line.strip() and not line.lstrip().startswith("#")]


ALL = sorted({line.strip() for page in PAGES for line in commands_of(page)})


def words_of(line: str) -> list[str]:
    """Return a command's words, without its comment, redirection and environment."""
    words = shlex.split(line, comments=True)
    words = words[: words.index(">")] if ">" in words else words
    while re.fullmatch(r"\w+=\S+", words[0]):
        words = words[1:]
    return words


def of(program: str) -> list[str]:
    return [line for line in ALL if words_of(line)[0] == program]


EXECUTIVE = of("executive")
RUNS = [line for line in EXECUTIVE if words_of(line)[1] == "run" and "--dry" not in words_of(line)]
RUN_HERE = [
    line
    for line in EXECUTIVE
    if words_of(line)[1] in CHEAP
    or "--dry" in words_of(line)
    or (words_of(line)[1] == "plugins" and "CAPABILITY" not in line and "boom_watch" not in line)
]
OF_A_PACKAGE = ("boom_watch", "my_mission")  # test_write_a_plugin.py installs what these need


def mistake_of(words: list[str]) -> str:
    """Parse a command without running it; return what is wrong with it, empty if nothing is."""
    command: Any = typer.main.get_command(app)
    context, rest = None, words[1:]
    if rest == ["--install-completion"]:  # to parse it is to write to the user's home
        known = {option for parameter in command.params for option in parameter.opts}
        return "" if rest[0] in known else f"no option {rest[0]}"
    try:
        while hasattr(command, "resolve_command") and not rest[0].startswith("-"):
            context = command.context_class(command, parent=context)
            _, command, rest = command.resolve_command(context, rest)
        command.make_context(command.name, list(rest), parent=context)
    except Exception as error:  # typer has its own copy of click's exceptions
        if type(error).__name__ != "Exit":  # of --help and --version
            return f"{type(error).__name__}: {error}"
    return ""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with the files that the README and the pages on trees and campaigns
    show, with those of the repository that commands name, and with a surveyed cloud.
    """
    readme = PAGES[0].read_text(encoding="utf-8")
    how_to = ROOT / "docs" / "how-to"
    page = (how_to / "write_a_tree.md").read_text(encoding="utf-8")
    campaigns = (how_to / "campaigns.md").read_text(encoding="utf-8")
    shown = {"yard": readme, "my_tree": readme, "my_wall": page, "grasping": campaigns}
    for name, text in shown.items():
        mission = re.search(r"```yaml\n(.*?)```", text, re.S).group(1)
        (tmp_path / f"{name}.yaml").write_text(mission, encoding="utf-8")
    dry = (how_to / "try_a_tree.md").read_text(encoding="utf-8")
    for name, text in re.findall(r"Save this as `(\S+)`:\n\n```yaml\n(.*?)```", dry, re.S):
        (tmp_path / name).write_text(text, encoding="utf-8")
    for name in ("docs", "robot_models"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "survey.ply").write_text(survey(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def survey() -> str:
    """Return a cloud such as `executive survey` writes: level ground, in PLY."""
    points = [f"{0.2 * i:.1f} {0.2 * j:.1f} 0" for i in range(20) for j in range(20)]
    axes = "".join(f"property float {axis}\n" for axis in "xyz")
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{axes}end_header\n"
    return head + "\n".join(points) + "\n"


def status_of(words: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    """Run a command in this process; return its exit status."""
    monkeypatch.setattr(sys, "argv", words)
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_every_command_is_of_a_known_kind() -> None:
    assert len(ALL) > 60
    assert [line for line in ALL if words_of(line)[0] not in PROGRAMS] == []


@pytest.mark.parametrize("line", EXECUTIVE)
def test_its_verb_and_options_are_known(line: str, folder: Path) -> None:
    words = words_of(line)
    mistake = mistake_of(words)
    if len(words) == 2:  # a verb that the text names, without its arguments
        assert not mistake or mistake.startswith("MissingParameter")
    elif "…" not in line:
        assert not mistake


@pytest.mark.parametrize(
    "line", [one for one in RUN_HERE if not any(n in one for n in OF_A_PACKAGE)]
)
def test_a_cheap_command_ends_with_the_status_that_its_page_says(
    line: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    status = re.search(r"# exit status (\d)", line)
    if re.search(r"\b[A-Z]{4,}\b", line.partition("#")[0]):
        pytest.skip("has a placeholder; its verb and options are parsed above")
    if "$" in line:
        return  # printed by the program: see test_readme.py
    wanted = int(status.group(1)) if status else 0
    if words_of(line)[1:] == ["check", "yard.yaml"]:
        wanted = 0
    assert status_of(words_of(line), monkeypatch) == wanted


def without_seed(line: str) -> str:
    return re.sub(r" --seed \d+", "", " ".join(words_of(line)))


# A mission begins in the same way with any seed.
BEGUN = {without_seed(one): one for one in RUNS if not re.search(r"\b[A-Z]{3,}\b", one)}


@pytest.mark.slow
@pytest.mark.parametrize("line", BEGUN.values())
def test_a_mission_begins(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = [*words_of(line), "--set", "loop.time_limit=0.2", "--json"]
    if "--real-time" in words:  # a busy computer cannot simulate in time, and the watch tells it
        words += ["--set", "watch.encoders={do: stop, after: 10 s}"]
    is_without_pictures = "surveying.plugin=colmap" in line  # the folder of pictures is not here
    with monkeypatch.context() as patch:
        assert status_of(words, patch) == (2 if is_without_pictures else 1)
    if is_without_pictures:
        return
    (report,) = (folder / "runs").glob("*/report.json")
    assert json.loads(report.read_text())["reason"].startswith("the time limit of 0")


@pytest.mark.parametrize("line", RUNS)
def test_the_settings_of_a_mission_are_known(line: str, folder: Path) -> None:
    words = words_of(line)
    if not re.search(r"[A-Z/]", words[2]):
        load_mission(words[2], [b for a, b in pairwise(words) if a == "--set"])


@pytest.mark.parametrize("line", of("make"))
def test_a_target_of_make_is_there(line: str) -> None:
    words = ["make", "--dry-run", *words_of(line)[1:]]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_make_mission_runs_a_command_that_parses() -> None:
    words = ["make", "--dry-run", "mission", "ARGS=--seed 3 --record"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    (line,) = re.findall(r"bin/(executive run .*)", done.stdout)
    assert line == "executive run pick_and_place --seed 3 --record"
    assert not mistake_of(shlex.split(line))


@pytest.mark.parametrize("line", of("python"))
def test_a_script_is_there_and_knows_its_options(line: str) -> None:
    _, script, *rest = words_of(line)
    assert (ROOT / script).is_file()
    options = {word for word in rest if word.startswith("--")}
    if options:
        words = [sys.executable, script, "--help"]
        done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60)
        assert options <= set(re.findall(r"--[\w-]+", done.stdout)), done.stderr


@pytest.mark.parametrize("line", of("pip"))
def test_what_pip_installs_is_declared(line: str) -> None:
    _, verb, what = words_of(line)
    assert verb == "install"
    extras = re.fullmatch(r"(?:executive|\.)\[([\w,]+)\]", what)
    assert extras or what == "."
    for extra in extras.group(1).split(",") if extras else ():
        assert re.search(rf"^{extra} = \[", PYPROJECT, re.M)


@pytest.mark.parametrize("line", of("pytest"))
def test_what_pytest_runs_is_there(line: str) -> None:
    words = words_of(line)[1:]
    paths = [word for word in words if "/" in word]
    modules = [word for word in words if word.startswith("executive.")]
    assert paths or modules
    assert all((ROOT / path).exists() for path in paths)
    assert all(find_spec(module) for module in modules)


@pytest.mark.parametrize("line", of("dask"))
def test_what_dask_starts_knows_its_options(line: str) -> None:
    _, verb, *rest = words_of(line)
    words = [Path(sys.executable).with_name("dask"), verb, "--help"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    options = {word for word in rest if word.startswith("--")}
    assert options <= set(re.findall(r"--[\w-]+", done.stdout)), done.stderr


def test_the_viewer_is_installed() -> None:
    assert of("rerun")
    assert Path(sys.executable).with_name("rerun").is_file()


def test_signals_pause_and_stop_a_mission_as_the_page_says(folder: Path) -> None:
    told = {words_of(line)[1] for line in of("kill")} - {"-9"}
    assert told == {"-USR1", "-TERM"}
    (folder / "waits.yaml").write_text(
        "api: 1\nmission: waits\ntrees:\n  main:\n    wait: 60 s\n"
        "plugins:\n  robot: {plugin: kinematic}\n  estimation: gnss_imu_filter\n"
    )
    executive = Path(sys.executable).with_name("executive")
    words = [executive, "run", "waits.yaml", "--real-time", "--run-dir", "run", "--quiet"]
    with subprocess.Popen(words, stderr=subprocess.PIPE) as run:
        journal = folder / "run" / "journal.jsonl"
        waited_for(journal, '"node_started"')
        run.send_signal(signal.SIGUSR1)
        waited_for(journal, '"after":"paused"')
        run.send_signal(signal.SIGUSR1)
        waited_for(journal, "resumed by the operator")
        run.send_signal(signal.SIGTERM)
        assert run.wait(timeout=60) == 1
    report = json.loads((folder / "run" / "report.json").read_text())
    assert (report["outcome"], report["reason"]) == ("stopped", "stopped by the operator")


def waited_for(path: Path, text: str) -> None:
    """Wait until a file holds a text."""
    for _ in range(1800):  # a busy computer may take long to import the plugins
        if path.is_file() and text in path.read_text(encoding="utf-8"):
            return
        time.sleep(0.1)
    pytest.fail(f"{path.name} never held {text}")
