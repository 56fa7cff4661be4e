"""Bulk work: one piece of what a campaign spreads over processes and machines."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from executive.config import NoSettings, Settings


@dataclass(frozen=True, slots=True)
class Piece:
    """What one run of a piece of work is given.

    Attributes:
        arguments: Checked arguments, of the work's `Arguments` class.
        seed: Seed of all random numbers of the run.
        folder: An empty folder of the run's own, for whatever it writes.
        inputs: Local path of each input by its name, as `inputs` returned them: on another machine
            a copy with the same content.
    """

    arguments: Settings
    seed: int
    folder: Path
    inputs: Mapping[str, Path]


class Work(ABC):
    """One kind of bulk work, such as whole missions or labels of grasps.

    A package brings its own in the entry-point group `executive.work.v1`. A run happens in a
    process of its own, with one thread for each numerical library, under limits of time and
    memory. It may be ended at any moment and is then begun anew in an empty folder, so that it
    must not write anywhere else. Equal arguments and seeds give equal answers.
    """

    Arguments: ClassVar[type[Settings]] = NoSettings

    # Glob patterns of the files that are kept with the results when a run on another machine ends.
    keeps: ClassVar[tuple[str, ...]] = ()

    def inputs(self, arguments: Settings) -> Mapping[str, Path]:
        """Return the files and folders that a run reads, by a name that `arguments` determine.

        They are copied to other machines by their content. Nothing else may be read from disk but
        what belongs to an installed package.
        """
        return {}

    def prepare(self, arguments: Settings, inputs: Mapping[str, Path]) -> None:  # noqa: B027
        """Import and compute what takes long and is the same for every run with these arguments.

        It is called in the process from which the processes of runs are forked, so that they find
        modules imported and caches filled. It must start no thread, use no random numbers and
        write nothing. An error is ignored here: `run` meets it again and reports it.
        """

    @abstractmethod
    def run(self, piece: Piece) -> Mapping[str, object]:
        """Do the work, and return what JSON can hold.

        Raises:
            ConfigError: If the arguments are refused, such as a plugin that is not installed: the
                campaign ends, because every run would end so.
            DataError: If an input is wrong; this costs the run.
        """
