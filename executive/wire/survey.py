"""A survey of a simulated site, made in a thread beside the machine's own life."""

import logging
import threading
from collections.abc import Callable

import numpy as np

from executive.errors import DataError
from executive.messages.cloud import Cloud
from executive.wire.connection import Connection
from executive.wire.frame import LARGEST_BYTES, Frame, Kind, WireError

_NUMBER = np.dtype("<f8")
_ROW_BYTES = 3 * _NUMBER.itemsize
_HEAD_BYTES = 4096

_log = logging.getLogger(__name__)


class SurveyUnderWay:
    """One survey that somebody has asked for.

    Attributes:
        asked_by: Who gets the answer.
    """

    def __init__(self, survey: Callable[[], Cloud], asked_by: Connection, sequence: int) -> None:
        self.asked_by, self._sequence = asked_by, sequence
        self._survey = survey
        self._answer: Frame | None = None
        # A daemon: a machine that ends does not wait for a survey.
        threading.Thread(target=self._make, name="survey", daemon=True).start()

    def answer(self) -> Frame | None:
        """Return the answer; None as long as it is not there."""
        return self._answer

    def _make(self) -> None:
        try:
            cloud = self._survey()
        except DataError as error:
            self._answer = self._refused(str(error))
        except Exception as error:  # whatever a plugin raises: the machine lives on without it
            _log.exception("the survey failed")
            self._answer = self._refused(f"{type(error).__name__}: {error}")
        else:
            self._answer = self._cloud(cloud)

    def _cloud(self, cloud: Cloud) -> Frame:
        numbers = np.ascontiguousarray(cloud.points, dtype=_NUMBER).tobytes()
        if len(numbers) > LARGEST_BYTES - _HEAD_BYTES:
            return self._refused(f"a survey of {len(cloud)} points is too large for one frame")
        head = {"frame": cloud.frame, "points": {"shape": [len(cloud), 3]}}
        return Frame(Kind.CLOUD, head, numbers, self._sequence)

    def _refused(self, reason: str) -> Frame:
        return Frame(Kind.REFUSED, {"reason": reason}, sequence=self._sequence)


def cloud_of(frame: Frame) -> Cloud:
    """Return the cloud of a frame.

    Raises:
        WireError: If it holds none.
    """
    name, told = frame.head.get("frame"), frame.head.get("points")
    shape = told.get("shape") if isinstance(told, dict) else None
    rows = len(frame.body) // _ROW_BYTES
    if not isinstance(name, str) or shape != [rows, 3] or len(frame.body) % _ROW_BYTES:
        raise WireError(f"no cloud: {str(frame.head)[:80]}, {len(frame.body)} bytes")
    return Cloud(name, np.frombuffer(frame.body, dtype=_NUMBER).reshape(-1, 3).copy())
