"""Look for a stone that is no longer where it was."""

from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.search import SearchSettings, search


class FindAgainSettings(SearchSettings):
    """How far to search, and what counts as found."""


class FindAgain(Action[FindAgainSettings]):
    """Look for a dropped or missed stone in the new map, and update the database.

    The stone's whole model is registered first, in any orientation and beside whatever it leans
    on, so that model and rotation are kept. If registration refuses, the map is segmented, and the
    segment that is found there may replace the model. A stone that is not found is lost.
    """

    needs = (Mapper, Segmenter, Registrar, ObjectDatabase)
    on_resume = OnResume.REDO

    def run(self, stone: int) -> Steps[None]:
        """Search the surroundings of the stone's last known place.

        Args:
            stone: Id of the stone.
        """
        return (yield from search(self.context, stone, self.settings))
