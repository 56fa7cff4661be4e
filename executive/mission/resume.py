"""A run that was cut off goes on in its folder."""

from pathlib import Path

from executive.mission.options import Options
from executive.mission.record.resumption import Resumption
from executive.mission.record.run_options import KeptOptions
from executive.mission.run import Run
from executive.mission.run_folder import RunFolder
from executive.tree.load import load_mission


def resumed_run(path: Path) -> Run:
    """Return the run of a folder, ready to go on; nothing has moved.

    Raises:
        ConfigError: If the folder holds no run, its mission has ended, or another process runs it.
        DataError: If what it holds is damaged.
    """
    folder = RunFolder.open(path)
    try:
        kept = KeptOptions.read(folder.options)
        resumption = Resumption.read(folder)
        options = Options(
            seed=kept.seed,
            run_dir=path,
            real_time=kept.real_time,
            runner=kept.runner,
            answer=kept.answer,
            choices=tuple(kept.choices),
            attended=kept.attended,
            pause_on_failure=kept.pause_on_failure,
        )
        return Run(load_mission(str(folder.mission)), options, resumption)
    except BaseException:
        folder.release()
        raise
