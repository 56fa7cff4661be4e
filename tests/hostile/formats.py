"""The formats that are read, each with small good files and the reader behind the command line."""

import json
import shutil
import struct
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
_POINTS = np.round(np.random.default_rng(0).uniform(0, [6, 5, 1], (300, 3)), 3)


@dataclass(frozen=True, slots=True)
class Sample:
    """A good file.

    Attributes:
        file: The file that is damaged.
        target: What is read: the file itself, or the folder that it is in.
    """

    file: Path
    target: Path


@dataclass(frozen=True, slots=True)
class Format:
    """One kind of file.

    Attributes:
        make: Writes good files into a folder.
        read: Reads one as the command line does; raises an `ExecutiveError` if it refuses it.
        mend: Makes checksums right again, so that damage is not noticed by them alone.
        is_named: Whether errors name the file.
    """

    make: Callable[[Path], Iterator[Sample]]
    read: Callable[[Path], object]
    mend: Callable[[bytes], bytes] = bytes
    is_named: bool = True


def _written(path: Path, content: bytes | str) -> Sample:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return Sample(path, path)


def _cloud(path: Path) -> object:
    from executive.clouds.reader import read_cloud, read_points

    return read_points(path), read_cloud(path)


def _carried(path: Path) -> Sample:
    """Write a cloud with colour, intensity and coordinate system."""
    from executive.clouds.file_cloud import FileCloud, Place
    from executive.clouds.writer import write_cloud

    rng = np.random.default_rng(2)
    colour = rng.integers(0, 256, _POINTS.shape, np.uint8)
    intensity = rng.random(len(_POINTS), np.float32)
    write_cloud(path, FileCloud(_POINTS, colour, intensity, Place("EPSG:2056")))
    return Sample(path, path)


def _ply(folder: Path) -> Iterator[Sample]:
    axes = b"".join(b"property float %c\n" % axis for axis in b"xyz")
    for form, body in {
        "ascii": "\n".join(" ".join(map(str, row)) for row in _POINTS).encode(),
        "binary_little_endian": _POINTS.astype("<f4").tobytes(),
        "binary_big_endian": _POINTS.astype(">f4").tobytes(),
    }.items():
        head = f"ply\nformat {form} 1.0\ncomment x\nelement vertex {len(_POINTS)}\n".encode()
        yield _written(folder / f"{form}.ply", head + axes + b"end_header\n" + body)
    yield _carried(folder / "carried.ply")


def _pcd(folder: Path) -> Iterator[Sample]:
    columns = _POINTS.astype("<f4").T.tobytes()
    literal = b"".join(
        bytes([len(part) - 1]) + part for part in (columns[i : i + 32] for i in range(0, 3600, 32))
    )
    for form, body in {
        "ascii": "\n".join(" ".join(map(str, row)) for row in _POINTS).encode(),
        "binary": _POINTS.astype("<f4").tobytes(),
        "binary_compressed": struct.pack("<II", len(literal), len(columns)) + literal,
    }.items():
        head = (
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
            f"WIDTH {len(_POINTS)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(_POINTS)}\n"
            f"DATA {form}\n"
        )
        yield _written(folder / f"{form}.pcd", head.encode() + body)
    yield _carried(folder / "carried.pcd")


def _xyz(folder: Path) -> Iterator[Sample]:
    text = "\n".join(" ".join(map(str, row)) for row in _POINTS)
    yield _written(folder / "a.xyz", text)
    yield _written(folder / "a.csv", "x,y,z\n" + text.replace(" ", ","))
    yield _written(folder / "a.pts", f"{len(_POINTS)}\n{text}")


def _las_of(suffix: str) -> Callable[[Path], Iterator[Sample]]:
    def make(folder: Path) -> Iterator[Sample]:
        import laspy

        for version, form in (("1.2", 3), ("1.4", 7)):
            header = laspy.LasHeader(point_format=form, version=version)
            header.scales, header.offsets = np.full(3, 0.001), np.zeros(3)
            data = laspy.LasData(header)
            data.xyz = _POINTS
            data.intensity = data.red = np.arange(len(_POINTS))
            keys = struct.pack("<8H", 1, 1, 0, 1, 3076, 0, 1, 9001)
            data.header.vlrs.append(laspy.VLR("LASF_Projection", 34735, record_data=keys))
            if version == "1.4":
                record = laspy.VLR("anybody", 7, "", b"behind the points" * 9)
                data.evlrs = laspy.vlrs.vlrlist.VLRList([record])
            data.write(folder / f"{form}.{suffix}")
            yield Sample(*[folder / f"{form}.{suffix}"] * 2)

    return make


def _e57(folder: Path) -> Iterator[Sample]:
    from tests.clouds.e57_files import COLOURS, Scan, write_e57

    axes = ("cartesianX", "cartesianY", "cartesianZ", *COLOURS, "intensity")
    columns = np.hstack([_POINTS, np.round(40 * _POINTS), _POINTS[:, :1]]).T
    scan = Scan(dict(zip(axes, columns, strict=True)), (1, 0, 0, 0), (9.0, 8.0, 7.0))
    for in_steps in (False, True):
        path = write_e57(folder / f"{in_steps}.e57", [scan, scan], "LOCAL_CS", in_steps)
        yield Sample(path, path)


def _e57_mended(content: bytes) -> bytes:
    from tests.clouds.e57_files import mended

    return mended(content)


def _mesh(path: Path) -> object:
    from executive.clouds.meshes.reader import read_mesh

    return read_mesh(path)


def _icosphere() -> tuple[np.ndarray, np.ndarray]:
    from scipy.spatial import ConvexHull

    way = np.random.default_rng(1).normal(size=(60, 3))
    vertices = way / np.linalg.norm(way, axis=1)[:, None]
    return vertices, ConvexHull(vertices).simplices


def _obj(folder: Path) -> Iterator[Sample]:
    vertices, faces = _icosphere()
    lines = [f"v {x} {y} {z}" for x, y, z in vertices]
    plain = [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    backward = [f"f {a - 60}//1 {b - 60}//2 {c - 60}//3" for a, b, c in faces]
    yield _written(folder / "a.obj", "\n".join([*lines, *plain]))
    yield _written(folder / "b.obj", "# x\no stone\n" + "\n".join([*lines, "vn 0 0 1", *backward]))


def _stl(folder: Path) -> Iterator[Sample]:
    vertices, faces = _icosphere()
    rows = b"".join(bytes(12) + vertices[face].astype("<f4").tobytes() + bytes(2) for face in faces)
    yield _written(folder / "a.stl", bytes(80) + struct.pack("<I", len(faces)) + rows)
    loops = "\n".join(
        "facet normal 0 0 0\nouter loop\n"
        + "\n".join(f"vertex {x} {y} {z}" for x, y, z in vertices[face])
        + "\nendloop\nendfacet"
        for face in faces
    )
    yield _written(folder / "b.stl", f"solid a\n{loops}\nendsolid a\n")


def _ply_mesh(folder: Path) -> Iterator[Sample]:
    vertices, faces = _icosphere()
    for form, order in (("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")):
        head = (
            f"ply\nformat {form} 1.0\nelement vertex {len(vertices)}\nproperty double x\n"
            f"property double y\nproperty double z\nelement face {len(faces)}\n"
            "property uchar red\nproperty list uchar int vertex_indices\nend_header\n"
        )
        if order:
            body = vertices.astype(f"{order}f8").tobytes() + b"".join(
                struct.pack(f"{order}BB3i", 9, 3, *face) for face in faces
            )
        else:
            rows = [f"{x} {y} {z}" for x, y, z in vertices] + [
                f"9 3 {a} {b} {c}" for a, b, c in faces
            ]
            body = "\n".join(rows).encode()
        yield _written(folder / f"{form}.ply", head.encode() + body)


def _log(path: Path) -> object:
    from executive.logs.log import Log
    from executive.logs.topics import Topics

    log = Log(path, Topics())
    return log.rig(None), list(log.arrivals())


def _log_writers() -> object:
    """Return the module that writes the logs of the tests of logs."""
    sys.path.insert(0, str(ROOT / "tests/logs"))
    try:
        import conftest

        return conftest
    finally:
        sys.path.pop(0)
        sys.modules.pop("conftest", None)


def _mcap(folder: Path) -> Iterator[Sample]:
    from mcap.writer import CompressionType
    from rosbags.typesys import Stores

    logs = _log_writers()
    ros = logs.Ros(Stores.ROS2_HUMBLE)
    variants = {
        "zstd": {},
        "lz4": {"compression": CompressionType.LZ4},
        # Without checksums damage reaches the messages.
        "plain": {"compression": CompressionType.NONE, "enable_crcs": False},
        "loose": {"use_chunking": False, "enable_crcs": False},
    }
    for name, options in variants.items():
        path = folder / f"{name}.mcap"
        logs._write_mcap(path, ros, logs._car(ros, 0.3), chunk_size=4000, **options)
        yield Sample(path, path)


def _bag(folder: Path) -> Iterator[Sample]:
    from rosbags.typesys import Stores

    logs = _log_writers()
    ros1, ros2 = logs.Ros(Stores.ROS1_NOETIC), logs.Ros(Stores.ROS2_HUMBLE)
    logs._write_bag(folder / "a.bag", ros1, logs._car(ros1, 0.3))
    yield Sample(folder / "a.bag", folder / "a.bag")
    logs._write_bag(folder / "b", ros2, logs._car(ros2, 0.3))
    yield Sample(next((folder / "b").glob("*.db3")), folder / "b")
    logs._write_bag(folder / "c", ros2, logs._car(ros2, 0.3))
    yield Sample(folder / "c" / "metadata.yaml", folder / "c")


def _mission(path: Path) -> object:
    from executive.tree.load import load_mission

    return load_mission(str(path))


def _missions(folder: Path) -> Iterator[Sample]:
    for name in ("map_site.yaml", "pick_and_place.yaml", "examples/sort.yaml"):
        yield _written(folder / Path(name).name, (ROOT / "trees" / name).read_bytes())


def _machine(path: Path) -> object:
    from executive.machine.machine import load_machine

    return load_machine(str(path))


def _machines(folder: Path) -> Iterator[Sample]:
    content = (ROOT / "robot_models/m545/robot.yaml").read_bytes()
    yield Sample(_written(folder / "m545/robot.yaml", content).file, folder / "m545")


def _campaign(path: Path) -> object:
    from executive.campaign.description.load import load_campaign

    return load_campaign(str(path))


def _campaigns(folder: Path) -> Iterator[Sample]:
    shutil.copytree(ROOT / "docs/campaigns/missions", folder / "missions")
    content = (ROOT / "docs/campaigns/examples.yaml").read_bytes()
    yield _written(folder / "examples.yaml", content)


def _xml(path: Path) -> object:
    from executive.commands.missions.import_ import imported
    from executive.tree.resolved import yaml_text

    return yaml_text(imported(path).document)


def _xmls(folder: Path) -> Iterator[Sample]:
    from executive.tree.export import export
    from executive.tree.load import load_mission

    yield _written(folder / "a.xml", export(load_mission("relocate"), "xml"))
    yield _written(
        folder / "b.xml",
        """<root BTCPP_format="4" main_tree_to_execute="Main">
<BehaviorTree ID="Main"><Sequence name="s" _skipIf="a > 3">
 <Script code="a := 3; b := a * 2.5; c := 'x'"/>
 <RetryUntilSuccessful num_attempts="3"><Sleep msec="50"/></RetryUntilSuccessful>
 <Fallback><ScriptCondition code="a &lt; 5 &amp;&amp; (b == 2 || !c)"/>
  <SubTree ID="Other" port="{a}" _autoremap="true"/></Fallback>
 <Timeout msec="100"><ForceFailure><AlwaysSuccess/></ForceFailure></Timeout>
</Sequence></BehaviorTree>
<BehaviorTree ID="Other"><Parallel success_count="1">
 <AlwaysFailure/><Script code="x := port"/></Parallel></BehaviorTree></root>
""",
    )


def _journal(path: Path) -> object:
    from executive.mission.record.journal_view import line_for_people, plain_entry, reading

    with reading(path) as entries:
        return [(plain_entry(one), line_for_people(one)) for one in entries]


def _journals(folder: Path) -> Iterator[Sample]:
    from executive.events.mission import PhaseChanged, WorkerReplaced
    from executive.journal import Journal

    path = folder / "run" / "journal.jsonl"
    path.parent.mkdir()
    journal = Journal(path)
    for i in range(30):
        event = (
            WorkerReplaced("mapping", "m", "v", "r")
            if i % 3
            else PhaseChanged("a", f"phase {i}", "r")
        )
        journal.append(i, 0.05 * i, f"main/{i}:Leaf", event)
    journal.close()
    yield Sample(path, path.parent)


def _signed(content: bytes) -> bytes:
    """Return a journal whose lines have the checksums that they should have."""
    from executive.journal import entry

    before, lines = entry.FIRST_CHECKSUM, []
    for line in content.split(b"\n"):
        try:
            found = json.loads(line)
            body = entry._body(tuple(found[name] for name in entry._FIELDS))
            before = found["checksum"] = entry._chain(before, body)
            lines.append(json.dumps(found).encode())
        except (ValueError, KeyError, TypeError, RecursionError):
            lines.append(line)
    return b"\n".join(lines)


def _kept_value(path: Path) -> object:
    from executive.journal.value_file import from_bytes

    return from_bytes(path.read_bytes())


def _kept_values(folder: Path) -> Iterator[Sample]:
    from executive.journal.value_file import to_bytes

    value = {"a": np.arange(6.0).reshape(2, 3), "b": [1, 2.5, "x", None, True], "c": (1, 2)}
    yield _written(folder / "a.value", to_bytes(value))


def _map(path: Path) -> object:
    from executive.leaf.map_file import read_map

    return read_map(path.with_suffix(".ply"))


def _maps(folder: Path) -> Iterator[Sample]:
    from executive.leaf.map_file import MapFile, write_map
    from executive.messages.cloud import Cloud

    write_map(folder / "a.ply", MapFile(Cloud("map", _POINTS), 3.0, np.eye(4)))
    yield Sample(folder / "a.json", folder / "a.json")


FORMATS: dict[str, Format] = {
    "ply": Format(_ply, _cloud),
    "pcd": Format(_pcd, _cloud),
    "xyz": Format(_xyz, _cloud),
    "las": Format(_las_of("las"), _cloud),
    "laz": Format(_las_of("laz"), _cloud),
    "e57": Format(_e57, _cloud, _e57_mended),
    "obj": Format(_obj, _mesh),
    "stl": Format(_stl, _mesh),
    "ply-mesh": Format(_ply_mesh, _mesh),
    "mcap": Format(_mcap, _log),
    "bag": Format(_bag, _log),
    "mission": Format(_missions, _mission),
    "robot": Format(_machines, _machine),
    "campaign": Format(_campaigns, _campaign),
    "xml": Format(_xmls, _xml),
    "journal": Format(_journals, _journal, _signed),
    "value": Format(_kept_values, _kept_value, is_named=False),  # its reader names it
    "map": Format(_maps, _map),
}
