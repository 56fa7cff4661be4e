"""A run that was cut off goes on in its folder."""

from pathlib import Path

from executive.mission.options import Options
from executive.mission.record.resumption import Resumption
from executive.mission.record.run_options import KeptOptions
from executive.mission.run import Run
from executive.mission.run_folder import RunFolder
from executive.tree.load import load_mission


def resumed_run(path: Path, *, groot: int | None = None, live: int | None = None) -> Run:
    """Return the run of a folder, ready to go on; nothing has moved.

    Args:
        path: The folder.
        groot: Port of 127.0.0.1 at which Groot2 may watch it.
        live: Port of 127.0.0.1 at which a viewer shows it.

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
            apart=kept.apart,
            runner=kept.runner,
            answer=kept.answer,
            choices=tuple(kept.choices),
            attended=kept.attended,
            pause_on_failure=kept.pause_on_failure,
            groot=groot,
            live=live,
        )
        return Run(load_mission(str(folder.mission)), options, resumption)
    except BaseException:
        folder.release()
        raise
