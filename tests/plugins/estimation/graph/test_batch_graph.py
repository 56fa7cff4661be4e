"""Batch smoothing against the window, and against the truth through an outage."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.estimation.factors import fix_factor
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.batch_graph import SMOOTHED, BatchGraph, _smoothed
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import DualGraphSettings, SmootherSettings
from executive_plugins.estimation.graph.whole_graph import Recording, WholeGraph
from executive_plugins.estimation.graph.window import GraphWindow
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState

from executive.geometry.geodesy import geodetic_from_enu
from executive.messages.gnss import GnssFix

NOISE = InertialNoise(1e-3, 1e-2, 1e-5, 1e-4, 1e-2, 9.81, 0.01)
COVARIANCE = np.diag(np.repeat([0.02, 0.1, 0.05, 1e-3, 1e-2], 3) ** 2)


@pytest.fixture(scope="module")
def recording() -> Recording:
    """Two seconds of a turning, accelerating IMU with noisy fixes of two antennas."""
    rng = np.random.default_rng(2)
    z = np.zeros(3)
    state = InertialState(Inertial(0.0, z, z), np.eye(3), z, z, z, z)
    recording = Recording(GraphEstimate(state, COVARIANCE))
    for k in range(1, 201):
        t = k / 100
        force = np.array([np.cos(t), 0.3, 9.7])
        recording.samples.append(Inertial(t, np.array([0.1, -0.05, 0.8 * np.sin(t)]), force, 0.01))
    window = GraphWindow(NOISE, buffer(recording), state, COVARIANCE)
    for stamp_s in np.arange(1, 20) / 10:
        there = window.state_at(stamp_s)
        for arm in (np.array([1.0, 0.5, 0.3]), np.array([-1.0, 0.5, 0.3])):
            p = there.p_map_imu + there.R_map_imu @ arm + rng.normal(0, 0.01, 3)
            recording.measurements.append(Fix(stamp_s, "gnss", arm, p, 1e-4 * np.eye(3)))
    return recording


def buffer(recording: Recording) -> SampleBuffer:
    samples = SampleBuffer()
    for sample in (recording.first.state.sample, *recording.samples):
        samples.append(sample)
    return samples


def test_the_newest_state_equals_that_of_a_window_without_marginalisation(recording) -> None:
    graph = WholeGraph(recording, SmootherSettings(), NOISE)
    first = recording.first
    window = GraphWindow(NOISE, buffer(recording), first.state, first.covariance)
    for fix in recording.measurements:
        window.add("fix", fix.stamp_s, [fix_factor(window.node_at(fix.stamp_s), fix)])
    window.node_at(2.0)
    window.solve()
    states = graph.solve()
    assert len(states) == len(window)
    # The window linearises anew only what has moved far, which is worth some tenths of a
    # millimetre.
    for name in ("R_map_imu", "p_map_imu", "v_map_imu", "gyro_bias", "accel_bias"):
        np.testing.assert_allclose(
            getattr(states[-1], name), getattr(window.newest(), name), atol=1e-3
        )


def test_an_outlying_fix_is_left_out(recording) -> None:
    wrong = replace(
        recording.measurements[20], p_map_antenna=recording.measurements[20].p_map_antenna + 2.0
    )
    spoilt = Recording(recording.first, recording.samples, [*recording.measurements, wrong])
    clean, graph = (WholeGraph(r, SmootherSettings(), NOISE) for r in (recording, spoilt))
    before, after = clean.solve(), graph.solve()
    assert graph.left_out == 1
    np.testing.assert_allclose(after[10].p_map_imu, before[10].p_map_imu, atol=1e-4)


def test_states_between_nodes_have_no_step_at_the_nodes(recording) -> None:
    graph = WholeGraph(recording, SmootherSettings(), NOISE)
    nodes = graph.solve()
    path = [state for node in range(len(nodes) - 1) for state in graph.between(nodes, node)]
    for node in nodes[1:]:
        (there,) = (s for s in path if abs(s.stamp_s - node.stamp_s) < 1e-9)
        np.testing.assert_allclose(there.p_map_imu, node.p_map_imu, atol=1e-9)
        np.testing.assert_allclose(there.R_map_imu, node.R_map_imu, atol=1e-9)


def test_without_measurements_there_is_a_node_every_half_a_second_up_to_the_last_gap() -> None:
    """A gap is filled until no more than two of these times are left."""
    z = np.zeros(3)
    rest = InertialState(Inertial(0.0, z, z), np.eye(3), z, z, z, z)
    samples = [Inertial(k / 100, z, np.array([0.0, 0.0, 9.81]), 0.01) for k in range(1, 261)]
    fixes = [Fix(s, "gnss", z, z, 1e-4 * np.eye(3)) for s in (0.3, 2.5)]
    graph = WholeGraph(
        Recording(GraphEstimate(rest, COVARIANCE), samples, fixes),
        SmootherSettings(node_after_s=0.5),
        NOISE,
    )
    states = graph.solve()
    assert len(graph) == len(states)
    stamps_s = [0.0, 0.3, 0.8, 1.3, 1.8, 2.5, 2.6]
    assert [state.stamp_s for state in states] == pytest.approx(stamps_s)
    for state in states:
        np.testing.assert_allclose(state.p_map_imu, z, atol=1e-3)
        np.testing.assert_allclose(state.v_map_imu, z, atol=1e-3)


@pytest.mark.parametrize(("apart_s", "nodes"), [(0.0004, 3), (0.0007, 4)])
def test_measurements_half_a_millisecond_apart_share_a_node(apart_s: float, nodes: int) -> None:
    z = np.zeros(3)
    rest = InertialState(Inertial(0.0, z, z), np.eye(3), z, z, z, z)
    samples = [Inertial(k / 100, z, np.array([0.0, 0.0, 9.81]), 0.01) for k in range(1, 41)]
    fixes = [Fix(s, "gnss", z, z, 1e-4 * np.eye(3)) for s in (0.3, 0.3 + apart_s)]
    first = GraphEstimate(rest, COVARIANCE)
    graph = WholeGraph(Recording(first, samples, fixes), SmootherSettings(), NOISE)
    assert len(graph.solve()) == nodes


def test_a_recording_without_fixes_or_samples_has_no_trajectory(recording) -> None:
    """Nothing ties it to the map, or there is only where it began."""
    lost = WholeGraph(Recording(recording.first, recording.samples), SmootherSettings(), NOISE)
    assert len(lost) > 1
    assert list(_smoothed(lost)) == []
    short = Recording(recording.first, [], recording.measurements)
    assert list(_smoothed(WholeGraph(short, SmootherSettings(), NOISE))) == []
    whole = list(_smoothed(WholeGraph(recording, SmootherSettings(), NOISE)))
    stamps_s = [state.stamp_s for state, _ in whole]
    assert stamps_s == pytest.approx([k / 100 for k in range(201)])
    for _, covariance in whole:
        assert (np.linalg.eigvalsh(covariance) > -1e-12).all()


def test_an_outage_is_bridged_from_both_ends(cabin) -> None:
    observations = [
        o
        for o in cabin.observations(13.0)
        if not (isinstance(o, GnssFix) and 7.5 < o.stamp_s < 10.5)
    ]
    states = BatchGraph(DualGraphSettings(standing={"is_used": False}), cabin.machine).smooth(
        observations
    )
    assert {state.status for state in states} == {SMOOTHED}
    stamps_s = np.array([state.stamp_s for state in states])
    np.testing.assert_allclose(np.diff(stamps_s), 0.01, atol=1e-6)  # one for each sample
    distances = [
        np.linalg.norm((s.T_map_cabin - cabin.T_map_cabin(s.stamp_s))[:3, 3]) for s in states
    ]
    assert max(distances) < 0.02  # online, inertia alone is off by decimetres after three seconds
    # The end of one step is the beginning of the next: a step of the trajectory would show as a
    # wrong velocity.
    p = np.array([state.T_map_cabin[:3, 3] for state in states])
    v = np.array([state.v_map_cabin for state in states])
    np.testing.assert_allclose(np.diff(p, axis=0), 0.01 * 0.5 * (v[1:] + v[:-1]), atol=1e-3)


def test_without_a_first_state_there_is_no_trajectory(cabin) -> None:
    nowhere = [o for o in cabin.observations(3.0) if not isinstance(o, GnssFix)]
    assert BatchGraph(DualGraphSettings(), cabin.machine).smooth(nowhere) == []


def test_the_map_starts_at_the_datum(cabin) -> None:
    datum = geodetic_from_enu(np.array([10.0, 20.0, 30.0]), np.array([47.4084, 8.5106, 440.0]))
    settings = DualGraphSettings(datum=tuple(map(float, datum)))
    state = BatchGraph(settings, cabin.machine).smooth(cabin.observations(4.0))[-1]
    moved = cabin.T_map_cabin(4.0)[:3, 3] - [10.0, 20.0, 30.0]
    np.testing.assert_allclose(state.T_map_cabin[:3, 3], moved, atol=0.02)
