"""Coverage of the runs in folders, real ones and dry ones, from their missions and journals."""

from collections.abc import Sequence
from pathlib import Path

from executive.coverage.branch import Limb, limbs_of
from executive.coverage.coverage import Coverage, CoveredRun, Tally
from executive.coverage.sketch import sketch_of
from executive.errors import ConfigError, DataError
from executive.events.mission import MissionEnded
from executive.mission.record.journal_view import reading
from executive.mission.run_folder import RunFolder
from executive.tree.load import load_mission


def coverage_of(folders: Sequence[Path]) -> Coverage:
    """Return what the runs in folders have taken of their tree.

    Raises:
        ConfigError: If a folder holds no run, or the trees of two runs differ.
        DataError: At a damaged line of a journal, by its place, or if it is of another tree.
    """
    coverage: Coverage | None = None
    known: dict[str, tuple[str, tuple[Limb, ...]]] = {}  # by the text of the mission
    for path in folders:
        name, limbs = _tree(path, known)
        if coverage is None:
            coverage = Coverage(name, limbs)
        elif limbs != coverage.limbs:
            told = f"{path} and {folders[0]} are runs of different trees"
            raise ConfigError(f"{told} ({_difference(coverage.limbs, limbs)}); ask for each alone")
        run, tally = _run(path)
        if strangers := sorted({*tally.ticked} - {limb.path for limb in limbs}):
            told = f"its journal names {strangers[0]}, which the tree of mission.yaml does not have"
            raise DataError(f"{path}: {told}: was that file changed?")
        coverage.add(run, tally)
    if coverage is None:
        raise ConfigError("no run is named")
    return coverage


def _tree(
    path: Path, known: dict[str, tuple[str, tuple[Limb, ...]]]
) -> tuple[str, tuple[Limb, ...]]:
    file = RunFolder(path).mission
    if not file.is_file():
        raise ConfigError(f"{path} holds no run: it has no {file.name}")
    text = file.read_text(encoding="utf-8")
    if text not in known:
        mission = load_mission(str(file))
        known[text] = (mission.name, limbs_of(sketch_of(mission)))
    return known[text]


def _run(path: Path) -> tuple[CoveredRun, Tally]:
    tally, outcome, reason, ended_s = Tally(), "", "", 0.0
    with reading(path) as entries:
        for entry in entries:
            tally(entry)
            ended_s = entry.time_s
            if isinstance(entry.event, MissionEnded):
                outcome, reason = entry.event.outcome, entry.event.reason
    is_dry = RunFolder(path).dry_note.is_file()
    return CoveredRun(str(path), is_dry, outcome, reason, ended_s), tally


def _difference(one: Sequence[Limb], other: Sequence[Limb]) -> str:
    paths = [{limb.path for limb in limbs} for limbs in (one, other)]
    only = sorted(paths[0] ^ paths[1])
    return f"only one has {only[0]}" if only else "their nodes can end in different ways"
