"""The run's log: what libraries and plugins have to say, for people."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def run_log(path: Path) -> Iterator[None]:
    """Send the process's log records and warnings into a file while a run lasts."""
    handler = logging.FileHandler(path, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    root = logging.getLogger()
    root.addHandler(handler)
    logging.captureWarnings(True)
    told, logging.raiseExceptions = logging.raiseExceptions, False  # a full disk is told elsewhere
    try:
        yield
    finally:
        logging.raiseExceptions = told
        logging.captureWarnings(False)
        root.removeHandler(handler)
        handler.close()
