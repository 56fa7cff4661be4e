"""People who walk: where they are by the time, seen by the lidars, hit without a push."""

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.sensors.settings import SensorSettings
from executive_plugins.robot.mujoco.sensors.suite import SensorSuite
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from executive_plugins.robot.mujoco.site.site import Site, make_site
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.truth.contact_log import ContactLog
from executive_plugins.robot.mujoco.world import World

from executive.arrays import Float
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import transform
from executive.machine.machine import load_machine
from executive.messages.lidar import LidarScan

MACHINE = load_machine("m545")
LEVEL = {"half_size_m": 12, "undulation_m": 0, "roughness_m": 0}
SIZE = {"width_m": 0.6, "height_m": 1.9}
LIDAR = MACHINE.sensors["lidar_horizontal"]


def site(*people: object, **terrain: object) -> Site:
    chosen = {"terrain": {**LEVEL, **terrain}, "stones": {"count": 0}, "people": people}
    settings = SiteSettings.model_validate(chosen)
    return make_site(settings, MACHINE, PhysicsSettings(), np.random.default_rng(3))


def through(place: Float) -> dict[str, object]:
    """Return somebody who walks 3 m along y, through a place in the middle, at 1 m/s."""
    x, y = float(place[0]), float(place[1])
    return {"path_m": [(x, y - 1.5), (x, y + 1.5)], "speed_m_s": 1.0, "height_m": 2.5}


def test_a_person_walks_along_the_line_and_back() -> None:
    (person,) = site({"path_m": [(4, 0), (4, 3), (6, 3)], "speed_m_s": 0.5, **SIZE}).people
    for time_s, place in [(0, (4, 0)), (2, (4, 1)), (8, (5, 3)), (10, (6, 3)), (12, (5, 3))]:
        np.testing.assert_allclose(person.at(time_s)[:2], place, atol=1e-12)
    np.testing.assert_allclose(person.at(20.0), person.at(0.0), atol=1e-12)
    assert (person.radius_m, person.height_m) == (0.3, 1.9)
    np.testing.assert_allclose(person.at(1000.5), person.at(0.5), atol=1e-9)


def test_a_person_stands_on_the_ground() -> None:
    (person,) = site({"path_m": [(8, 0), (8, 4)]}, slope_rad=0.1, uphill_rad=1.5707963).people
    assert person.at(0.0)[2] == pytest.approx(0.0, abs=0.01)
    assert person.at(4.0 / 1.2)[2] == pytest.approx(4 * np.tan(0.1), abs=0.01)


def scan_at(world: World, time_s: float) -> Float:
    """Return the returns of a scan that ends at a time, in the world, shape (N, 3)."""
    suite = SensorSuite(
        MACHINE,
        world.site,
        SensorSettings(azimuth_stride=2),
        world.model,
        np.random.default_rng(0),
    )
    suite.lidars_on, found = True, None
    while world.time_s < time_s + 0.05:
        world.step()
        for observation in suite.step(world.time_s, world.model, world.data):
            if isinstance(observation, LidarScan) and observation.frame == LIDAR.name:
                found = observation
    assert found is not None
    T_world_lidar = world.T_world_body("cabin") @ LIDAR.T_link_sensor
    return np.asarray(transform(T_world_lidar, found.points_lidar))


def test_the_lidars_see_a_person_where_it_is_by_then() -> None:
    person = {"path_m": [(6, -3), (6, 3)], "speed_m_s": 1.0}
    for time_s, y in [(0.5, -2.5), (3.0, 0.0)]:
        points = scan_at(World(MACHINE, site(person), PhysicsSettings()), time_s)
        upright = points[(points[:, 2] > 0.2) & (np.abs(points[:, 0] - 6) < 0.5)]
        assert len(upright) > 20
        # It walks 10 cm while a scan lasts; the noise of a range is 2 cm.
        assert np.abs(upright[:, 1] - y).max() < 0.25 + 0.1 + 0.08
        assert upright[:, 2].max() < 1.75 + 0.08
    empty = scan_at(World(MACHINE, site(), PhysicsSettings()), 0.5)
    assert not len(empty[(empty[:, 2] > 0.2) & (np.abs(empty[:, 0] - 6) < 0.5)])


def test_a_person_who_is_hit_is_a_contact_that_moves_nothing() -> None:
    palm = World(MACHINE, site(), PhysicsSettings()).T_world_body(MACHINE.gripper_link)[:3, 3]
    alone = World(MACHINE, site(), PhysicsSettings())
    beside = World(MACHINE, site(through(palm), through(palm + [0, 5, 0])), PhysicsSettings())
    log = ContactLog(MACHINE, (), beside.model)
    for _ in range(200):
        alone.step()
        beside.step()
        log.step(beside.time_s, beside.model, beside.data)
    hits = [span for span in log.spans() if span.other == "person_1"]
    assert hits
    assert {span.max_force_n for span in hits} == {0.0}
    # It comes along the line after a second at the earliest: half of its width and of the jaws'.
    assert min(span.from_s for span in hits) > 0.3
    assert not any(span.other == "person_2" for span in log.spans())
    np.testing.assert_array_equal(alone.arm.position(), beside.arm.position())


def test_a_world_that_goes_on_has_its_people_where_they_were() -> None:
    made = site(through(np.array([6.0, 0.0])))
    world, other = (World(MACHINE, made, PhysicsSettings()) for _ in range(2))
    for _ in range(120):
        world.step()
    other.restore(world.keep())
    place = other.T_world_body("person_1")[:3, 3]
    np.testing.assert_allclose(place, made.people[0].at(1.2), atol=1e-9)


@pytest.mark.parametrize(
    ("person", "words"),
    [
        ({"path_m": [(4, 0)]}, "at least 2 items"),
        ({"path_m": [(4, 0), (4, 0)]}, "the same corner twice in a row"),
        ({"path_m": [(4, 0), (4, 1)], "speed_m_s": 0}, "greater than 0"),
    ],
)
def test_a_line_that_is_none_is_refused(person: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        SiteSettings.model_validate({"people": [person]})


def test_a_person_is_a_pillar_on_its_feet_with_its_sides_and_height() -> None:
    (person,) = site({"path_m": [(4, 0), (4, 3)], **SIZE}).people
    vertices, triangles = person.mesh()
    assert len(vertices) == 24
    np.testing.assert_allclose(np.hypot(*vertices[:, :2].T), 0.3)
    assert sorted(set(vertices[:, 2])) == [0.0, 1.9]
    area_m2 = 6 * 0.3**2 * np.sin(2 * np.pi / 12)  # of a polygon of twelve sides
    corners = vertices[triangles]
    volume_m3 = np.linalg.det(corners).sum() / 6
    assert volume_m3 == pytest.approx(area_m2 * 1.9)


def test_what_stands_on_a_site_is_drawn_opaque_and_a_person_stands_out() -> None:
    """Shares of red, green and blue are from 0 to 1; a person is orange, all else is of earth."""
    boxes = [
        {"at_m": (8.0, 3.0 * i), "size_m": (1.0, 1.0, 1.0), "shape": shape}
        for i, shape in enumerate(("box", "cylinder"))
    ]
    person = {"path_m": [(4, 0), (4, 3)]}
    chosen = {"terrain": LEVEL, "stones": {"count": 0}, "people": [person], "obstacles": boxes}
    made = make_site(
        SiteSettings.model_validate(chosen), MACHINE, PhysicsSettings(), np.random.default_rng(3)
    )
    spec = mujoco.MjSpec()
    made.add_to(spec)
    skin = hull_mesh(np.array([[x, y, z] for x in (0, 1.0) for y in (0, 1.0) for z in (0, 1.0)]))
    StoneModel.from_skin("stone_1", skin, 2700.0).add_to(spec, np.eye(4))
    colours = spec.compile().geom_rgba
    assert len(colours) >= 5
    assert ((colours >= 0.0) & (colours <= 1.0)).all()
    assert (colours[:, 3] == 1.0).all()
    saturated = np.ptp(colours[:, :3], axis=1) > 0.5
    assert saturated.sum() == 1
    red, green, blue = colours[saturated][0, :3]
    assert red > green > blue
