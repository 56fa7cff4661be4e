"""`--topic KIND=NAME`: names of topics on the command line."""

from collections.abc import Sequence

from executive.errors import ConfigError
from executive.logs.topics import Topics
from executive.tree.problem import Mark, Problems
from executive.tree.settings import check_settings
from executive.tree.value import Scalar, Table, TableEntry


def read_topics(pairs: Sequence[str]) -> Topics:
    """Return the names of a log's topics, with some replaced.

    Raises:
        ConfigError: If a pair is not `KIND=NAME`, or there is no such kind.
    """
    problems, entries = Problems(), dict[str, TableEntry]()
    for pair in pairs:
        mark = Mark(f"--topic {pair}")
        kind, equals, name = pair.partition("=")
        if not equals:
            problems.error(mark, "expected KIND=NAME, such as imu=/car/imu")
        entries[kind] = TableEntry(mark, Scalar(name, mark))
    topics = check_settings(Topics, Table(entries, Mark("--topic")), "a log", problems)
    problems.raise_errors()
    if topics is None:
        raise ConfigError("--topic: the names of the topics cannot be read")
    return topics
