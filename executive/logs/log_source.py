"""Files that hold ROS messages: MCAP files, and ROS 1 and ROS 2 bags."""

import sqlite3
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag1 import ReaderError as Bag1Error
from rosbags.rosbag2 import ReaderError as Bag2Error
from rosbags.rosbag2 import storage_sqlite3
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError
from zstandard import ZstdError

from executive.errors import DataError
from executive.logs.mcap_contents import Contents, Cut, read_contents
from executive.logs.mcap_messages import in_order
from executive.logs.mcap_records import BrokenRecordError
from executive.logs.topics import TYPES

# Newer releases of rosbags read the database of a bag by apsw, older ones by sqlite3.
_database: Any = getattr(storage_sqlite3, "apsw", sqlite3)

# The readers pass on the errors of their decoders on a damaged file. These occurred in tests with
# flipped bytes.
_DAMAGED = (
    McapError,
    AnyReaderError,
    Bag1Error,
    Bag2Error,
    SerdeError,
    TypesysError,
    ZstdError,
    struct.error,
    _database.Error,
    OSError,
    EOFError,
    ValueError,
    LookupError,
    TypeError,
    ArithmeticError,
    AssertionError,
    RuntimeError,
    MemoryError,
)

_MCAP = b"\x89MCAP"  # how such a file begins, whatever its name is
_KINDS = "give an .mcap file, a .bag file, or a ROS 2 bag's folder"
_REPAIR_OF_BAGS = " by `rosbag reindex` (ROS 1) or `ros2 bag reindex` (ROS 2)"


@dataclass(frozen=True, slots=True)
class Recorded:
    """One message as it was recorded.

    Attributes:
        topic: Its topic.
        arrival_ns: Time at which it was recorded [ns].
        message: The ROS message, as rosbags decodes it.
    """

    topic: str
    arrival_ns: int
    message: Any


class LogSource:
    """A log file or bag folder.

    Attributes:
        path: The file or folder.
        types: ROS type by topic, such as `sensor_msgs/msg/Imu`.
        cut: Where the log was cut off; None if it is whole.
    """

    def __init__(self, path: Path) -> None:
        """Open a log and read its topics.

        Raises:
            DataError: If it does not exist, is no log, or cannot be read; the message gives the
                reason.
        """
        if not path.exists():
            raise DataError(f"{path}: no such log; {_KINDS}")
        self.path = path
        self._is_mcap = path.suffix.lower() == ".mcap"
        with self._explained():
            self._is_mcap = self._is_mcap or _begins_as_mcap(path)
            if not self._is_mcap and not _may_be_bag(path):
                raise DataError(f"{path}: neither an MCAP file nor a bag; {_KINDS}")
            self._contents = self._mcap_contents() if self._is_mcap else Contents()
            self.types: Mapping[str, str] = (
                self._mcap_types() if self._is_mcap else self._bag_types()
            )
        self.cut: Cut | None = self._contents.cut

    def metadata(self, name: str) -> Mapping[str, str]:
        """Return the metadata record of a name in an MCAP file; empty if there is none."""
        named = (one.metadata for one in self._contents.metadata if one.name == name)
        return next(named, {})

    def messages(self, topics: Sequence[str]) -> Iterator[Recorded]:
        """Yield the messages of some topics in order of arrival.

        Raises:
            DataError: If the file ends early, or a message cannot be decoded.
        """
        with self._explained():
            yield from self._mcap_messages(topics) if self._is_mcap else self._bag_messages(topics)

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except _DAMAGED as error:
            reason = str(error) or type(error).__name__
            raise DataError(
                f"{self.path}: incomplete or damaged log: {reason}; record it again, or repair "
                f"it{'' if self._is_mcap else _REPAIR_OF_BAGS}"
            ) from error

    def _mcap_contents(self) -> Contents:
        with self.path.open("rb") as file:
            found = read_contents(file)
        if found.cut is not None and not found.parts:
            size = found.cut.file_bytes
            raise BrokenRecordError(f"its {size} bytes end before the first messages are whole")
        return found

    def _mcap_types(self) -> dict[str, str]:
        schemas = self._contents.schemas
        names = {
            channel.topic: schemas.get(channel.schema_id)
            for channel in self._contents.channels.values()
        }
        return {
            topic: _full_name(schema.name if schema else "?") for topic, schema in names.items()
        }

    def _bag_types(self) -> dict[str, str]:
        with self._bag() as reader:
            return {connection.topic: connection.msgtype for connection in reader.connections}

    def _bag(self) -> AnyReader:
        return AnyReader([self.path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))

    def _mcap_messages(self, topics: Sequence[str]) -> Iterator[Recorded]:
        cdr, ros1 = get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS1_NOETIC)
        ros1.register(
            get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TYPES["tf_static"])
        )
        decoders = {"cdr": cdr.deserialize_cdr, "ros1": ros1.deserialize_ros1}
        with self.path.open("rb") as file:
            for schema, channel, message in in_order(file, self._contents, topics):
                decode = decoders.get(channel.message_encoding)
                if decode is None or schema is None:
                    encoding = channel.message_encoding
                    raise DataError(
                        f"{self.path}: {channel.topic} is encoded as '{encoding}'; supported "
                        "encodings are cdr and ros1"
                    )
                try:
                    decoded = decode(message.data, _full_name(schema.name))
                except _DAMAGED as error:
                    raise self._undecodable(channel.topic, error) from error
                yield Recorded(channel.topic, message.log_time, decoded)

    def _bag_messages(self, topics: Sequence[str]) -> Iterator[Recorded]:
        with self._bag() as reader:
            connections = [
                connection for connection in reader.connections if connection.topic in topics
            ]
            for connection, stamp_ns, data in reader.messages(connections=connections):
                try:
                    decoded = reader.deserialize(data, connection.msgtype)
                except _DAMAGED as error:
                    raise self._undecodable(connection.topic, error) from error
                yield Recorded(connection.topic, stamp_ns, decoded)

    def _undecodable(self, topic: str, error: Exception) -> DataError:
        return DataError(
            f"{self.path}: a message on {topic} is not a valid {self.types[topic]}: "
            f"{type(error).__name__} {error}"
        )


def _begins_as_mcap(path: Path) -> bool:
    if path.is_dir():
        return False
    with path.open("rb") as file:
        return file.read(len(_MCAP)) == _MCAP


def _may_be_bag(path: Path) -> bool:
    """Return whether a path looks like a bag, whole or damaged: its readers go by names."""
    if path.is_dir():
        stored = any(one.suffix in (".db3", ".mcap") for one in path.iterdir())
        return stored or (path / "metadata.yaml").exists()
    return path.suffix in (".bag", ".db3")


def _full_name(name: str) -> str:
    """Return `sensor_msgs/msg/Imu` for the ROS 1 name `sensor_msgs/Imu`."""
    parts = name.split("/")
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else name
