"""The options of `executive run`: each with what it means."""

from pathlib import Path
from typing import Annotated

import typer

RunDirOption = Annotated[
    Path | None, typer.Option(help="Folder for the run; a new one under runs/ by default.")
]
RecordOption = Annotated[bool, typer.Option("--record", help="Write recording.rrd for the viewer.")]
RealTimeOption = Annotated[
    bool, typer.Option("--real-time", help="Tick on the wall clock, not in lock-step.")
]
RecordLogOption = Annotated[
    Path | None,
    typer.Option(help="Write what the robot measures to an MCAP log, for `executive estimate`."),
]
StonesOption = Annotated[
    Path | None, typer.Option(help="Folder of meshes for the simulated stones.")
]
WallOption = Annotated[
    Path | None,
    typer.Option(
        metavar="WALL.yaml",
        help="What `build_wall` and missions like it build, instead of their own wall.",
    ),
]
RunnerOption = Annotated[
    str | None, typer.Option(help="Where long computations run: inline, thread or process.")
]
AnswerOption = Annotated[
    list[str] | None,
    typer.Option(
        "--answer",
        help="Answer the mission's questions: yes, no, or one of a question's choices; may be "
        "repeated.",
    ),
]
MachineOption = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Drive the machine that listens there, such as one of `executive simulate`, in "
        "real time: unix:PATH or 127.0.0.1:PORT.",
    ),
]
AttendedOption = Annotated[
    bool,
    typer.Option(
        "--attended",
        help="Without a terminal, let questions wait for `executive ctl RUN answer`.",
    ),
]
PauseOnFailureOption = Annotated[
    bool,
    typer.Option(
        "--pause-on-failure",
        help="Pause when an action fails, until `executive ctl RUN skip`, retry or resume.",
    ),
]
DryOption = Annotated[
    bool,
    typer.Option(
        "--dry", help="Run the tree alone: leaves are mocked, and an hour takes milliseconds."
    ),
]
MocksOption = Annotated[
    Path | None,
    typer.Option(help="With --dry: a file of what leaves do, and of what is expected."),
]
FailuresOption = Annotated[
    float | None,
    typer.Option(
        min=0.0, max=1.0, help="With --dry: probability that a mocked action fails.  [0.1]"
    ),
]
RunsOption = Annotated[
    int | None, typer.Option(min=1, help="With --dry: number of runs, each with the next seed.")
]
AtLeastOption = Annotated[
    float | None,
    typer.Option(
        metavar="PERCENT",
        min=0.0,
        max=100.0,
        help="With --dry: fail if the runs take fewer of the tree's branches.",
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="No progress.")]
