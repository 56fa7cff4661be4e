"""Contacts of two links in a world of three spheres, whose forces are their weights."""

from types import SimpleNamespace

import mujoco
import pytest
from executive_plugins.robot.mujoco.truth.contact_log import ContactLog, Span

WORLD = """
<mujoco>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <worldbody>
    <geom name="terrain" type="plane" size="0 0 1"/>
    <body name="arm" pos="5 0 0.1">
      <joint name="arm" type="slide" axis="0 0 1" damping="300"/>
      <geom type="sphere" size="0.1" mass="10"/>
    </body>
    <body name="stone_1" pos="0 0 0.2">
      <joint type="slide" axis="0 0 1" damping="300"/>
      <geom type="sphere" size="0.2" mass="5"/>
    </body>
    <body name="jaw" pos="0 0 0.5">
      <joint type="slide" axis="0 0 1" damping="300"/>
      <geom type="sphere" size="0.1" mass="2"/>
    </body>
  </worldbody>
</mujoco>
"""


class Spheres:
    """The world at rest, and a log of it."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(WORLD)
        self.data = mujoco.MjData(self.model)
        for _ in range(1500):
            mujoco.mj_step(self.model, self.data)
        self.rest_m = float(self.data.joint("arm").qpos[0])
        machine = SimpleNamespace(links=("arm", "jaw"))
        self.log = ContactLog(machine, ("stone_1",), self.model)

    def look(self, time_s: float, lifted_m: float = 0.0) -> None:
        self.data.joint("arm").qpos[0] = self.rest_m + lifted_m
        mujoco.mj_forward(self.model, self.data)
        self.log.step(time_s, self.model, self.data)

    def of(self, link: str) -> list[Span]:
        return [span for span in self.log.spans() if span.link == link]


@pytest.fixture
def spheres() -> Spheres:
    return Spheres()


def test_a_link_is_told_with_what_it_touches_and_the_force(spheres: Spheres) -> None:
    """A stone on the ground is no contact of the machine."""
    spheres.look(1.0)
    spheres.look(1.01)
    told = [(span.link, span.other, span.from_s, span.to_s) for span in spheres.log.spans()]
    assert told == [("arm", "terrain", 1.0, 1.01), ("jaw", "stone_1", 1.0, 1.01)]
    forces = [span.max_force_n for span in spheres.log.spans()]
    assert forces == pytest.approx([98.1, 19.62], rel=0.02)  # it still settles a little


def test_the_largest_force_of_a_contact_is_told(spheres: Spheres) -> None:
    spheres.look(1.0)
    spheres.look(1.01, lifted_m=-0.002)  # pressed into the ground
    spheres.look(1.02)
    (span,) = spheres.of("arm")
    assert span.max_force_n > 130.0


def test_a_short_gap_is_no_end_of_a_contact(spheres: Spheres) -> None:
    for time_s, lifted_m in ((1.0, 0.0), (1.1, 0.01), (1.19, 0.0), (1.3, 0.01), (1.4, 0.0)):
        spheres.look(time_s, lifted_m)
    assert [(span.from_s, span.to_s) for span in spheres.of("arm")] == [(1.0, 1.19), (1.4, 1.4)]
    assert [(span.link, span.from_s) for span in spheres.log.spans()][:2] == [
        ("arm", 1.0),
        ("jaw", 1.0),
    ]


def test_the_contacts_of_another_process_take_the_place_of_those_seen(spheres: Spheres) -> None:
    spheres.look(1.0)
    earlier = Span("arm", "stone_1", 0.2, 0.3, 7.0)
    spheres.log.take([earlier])
    assert spheres.log.spans() == (earlier,)
    spheres.look(2.0)
    assert [(span.link, span.from_s) for span in spheres.log.spans()] == [
        ("arm", 0.2),
        ("arm", 2.0),
        ("jaw", 2.0),
    ]
