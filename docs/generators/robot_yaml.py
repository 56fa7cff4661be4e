"""The page of the fields of `robot.yaml`."""

from collections.abc import Iterator

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from executive.machine.driving import Driving
from executive.machine.gripper import Gripper, JawPart
from executive.machine.joint import Jaw, Joint
from executive.machine.link import Link
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders, Gnss, Imu, Lidar
from executive.machine.shape import Shape
from executive.machine.stance import Stance
from executive.tree.words.field_words import bounds_words, default_words, type_words
from generators.markdown import NOTE, cell, code, first_line

PROVENANCE = "source, or field → source"
ROBOT_YAML = """\
# A machine's robot.yaml

A machine is a folder with one file, `robot.yaml`: joints, links, sensors, gripper. URDF, MJCF,
kinematics, the self-filter and all limits are made from it. Two are shipped: `robot_models/m545`
(HEAP) and `robot_models/mini` (a generic machine of eight tonnes). For your own, copy one, change
it, and name its folder:

```sh
executive check map_site --set robot.model=robot_models/mini
```

SI units; frames as on the page of [conventions](conventions.md). An unknown field, a missing one
or a value out of bounds is refused, with its place. `provenance` says of each block where its
figures come from: `measured`, `paper` or `guess`. Most efforts, accelerations and masses of the
shipped machines are guesses.

Not described: a load chart (the lift capacity is computed from masses and points of support),
and single wheels. Every machine has one chain of joints from the base to a gripper with two
mirrored jaws.
"""
SENSORS = """\
## sensors

A mapping from the sensor's name. `kind` selects the fields.
"""


def robot_yaml_page() -> str:
    """Return the page of all fields of a machine's file."""
    parts = [
        ROBOT_YAML,
        *_block("The file", Machine, "The top level."),
        *_block("stance", Stance),
        *_block("driving", Driving),
        *_block("joints", Joint, "A list, from the base to the gripper; each carries the next."),
        *_block("jaw", Jaw),
        *_block("gripper", Gripper),
        *_block("gripper.jaw_parts", JawPart, "A list."),
        *_block("bodies", Link, "A mapping from the link's name. Without the gripper's links."),
        *_block("shapes", Shape, "A list, in a body or in `gripper.palm_shapes`."),
        SENSORS,
        *_block("sensors, kind: lidar", Lidar),
        *_block("sensors, kind: imu", Imu),
        *_block("sensors, kind: gnss", Gnss),
        *_block("sensors, kind: encoders", Encoders),
    ]
    return "\n".join([NOTE, *parts])


def _block(title: str, model: type[BaseModel], introduction: str = "") -> Iterator[str]:
    yield f"## {title}\n"
    yield f"{introduction} {first_line(model)}".strip() + "\n"
    yield "| field | type | default | bounds | meaning |"
    yield "|---|---|---|---|---|"
    for name, info in model.model_fields.items():
        if name == "name" and model in (Link, Lidar, Imu, Gnss, Encoders):
            continue  # the key of the mapping
        kind = PROVENANCE if name == "provenance" else type_words(info.annotation)
        meaning = cell(info.description or first_line(info.annotation))
        yield f"| `{name}` | {kind} | {_default(info)} | {bounds_words(info) or '–'} | {meaning} |"
    yield ""


def _default(info: FieldInfo) -> str:
    text = default_words(info)
    return text if text == "required" else code(text)
