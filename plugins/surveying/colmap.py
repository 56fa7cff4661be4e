"""A survey from a drone's photographs: pycolmap for their places, own plane sweep for the cloud."""

from typing import ClassVar

import numpy as np
from executive_plugins.surveying.photogrammetry import Tell, print_nothing, reconstruct
from executive_plugins.surveying.photograph_folder import Photographs, read_photographs
from executive_plugins.surveying.settings import ColmapSettings
from executive_plugins.surveying.structure_from_motion import load_pycolmap

from executive.config import Settings
from executive.interfaces.surveying import Survey
from executive.messages.cloud import Cloud

FEWEST_PICTURES = 6


class Colmap(Survey):
    """Makes a folder of pictures into a cloud that is metric and upright as far as the rough
    positions say.
    """

    Settings: ClassVar[type[Settings]] = ColmapSettings
    latency_s: ClassVar[dict[str, float]] = {
        "survey": 1.0
    }  # made before the machine drives in: it is handed over
    is_stateless: ClassVar[bool] = True

    def __init__(self, settings: ColmapSettings) -> None:
        self._settings = settings
        self._account: dict[str, float | tuple[str, ...]] = {}
        self._tell: Tell = print_nothing

    def follow(self, tell: Tell) -> None:
        """Say from now on what is done, a line a step."""
        self._tell = tell

    def start(self) -> None:
        """Look whether there is something to survey, before anything moves.

        Raises:
            MissingExtraError: If pycolmap is not installed.
            DataError: If the folder holds no survey.
        """
        load_pycolmap()
        self._account = dict(self._photographs().origin)

    def survey(self, rng: np.random.Generator) -> Cloud:
        """Reconstruct the site: forty pictures of 12 megapixels take minutes on two cores.

        Deterministic by the generator. With `work`, what was finished before is not done again.

        Raises:
            DataError: If the pictures make no map; the message says why and what to change.
        """
        photographs = self._photographs()
        found = reconstruct(photographs, self._settings, rng, self._tell, self._settings.work)
        self._account = {
            **photographs.origin,
            "pictures": found.pictures,
            "placed": found.names,
            "positions_rms_m": float(found.alignment.residual_m),
            "positions_used": int(found.alignment.is_used.sum()),
            "scale_error": float(found.alignment.scale_error),
        }
        return found.cloud

    def account(self) -> dict[str, float | tuple[str, ...]]:
        """Return where the cloud's origin is, how many pictures were used, and how well their
        positions fit; before the survey the first alone.
        """
        return dict(self._account)

    def _photographs(self) -> Photographs:
        return read_photographs(
            self._settings.photographs, self._settings.positions, FEWEST_PICTURES
        )
