"""The pose graph against known motions, against least squares, and over long times."""

import numpy as np
import pytest
from executive_plugins.mapping.pair_graph import PairGraph, PairNode
from executive_plugins.mapping.pose_constraint import PoseConstraint

from executive.errors import DataError, ShapeError
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, exp_so3


def covariance(rotation_rad: float, position_m: float) -> np.ndarray:
    return np.diag(np.repeat([rotation_rad**2, position_m**2], 3))


def on_circle(k: int) -> np.ndarray:
    angle = 0.02 * k
    return pose(exp_so3(np.array([0.0, 0.0, angle])), np.array([np.cos(angle), np.sin(angle), 1.5]))


def perturbed(
    rng: np.random.Generator, T: np.ndarray, rotation_rad: float, position_m: float
) -> np.ndarray:
    return T @ pose(exp_so3(rng.normal(0, rotation_rad, 3)), rng.normal(0, position_m, 3))


def chain(
    count: int, rng: np.random.Generator, with_matches: bool = True, anchored: int = 10
) -> list[PairNode]:
    """Nodes on a circle: increments of 1 mm, matches of 0.5 mm, a tie to an estimate of 5 mm now
    and then.
    """
    nodes, guess = [], on_circle(0)
    for k in range(count):
        estimate = PoseConstraint(perturbed(rng, on_circle(k), 1e-3, 5e-3), covariance(1e-3, 5e-3))
        odometry = match = None
        if k:
            step = inverse(on_circle(k - 1)) @ on_circle(k)
            odometry = PoseConstraint(perturbed(rng, step, 2e-4, 1e-3), covariance(2e-4, 1e-3))
            guess = guess @ odometry.T
            if with_matches:
                match = PoseConstraint(perturbed(rng, step, 1e-4, 5e-4), covariance(1e-4, 5e-4))
        nodes.append(PairNode(k, guess, estimate, k % anchored == 0, odometry, match))
    return nodes


def errors_m(graph: PairGraph, nodes: list[PairNode]) -> np.ndarray:
    for node in nodes:
        poses = graph.add(node)
    true = np.array([on_circle(poses.first + i) for i in range(len(poses.T_map_cabin))])
    return np.linalg.norm(poses.T_map_cabin[:, :3, 3] - true[:, :3, 3], axis=1)


def test_perfect_increments_lead_to_the_true_poses() -> None:
    steps = [inverse(on_circle(k - 1)) @ on_circle(k) for k in range(1, 30)]
    first = PoseConstraint(on_circle(0), covariance(1e-3, 1e-2))
    nodes = [PairNode(0, on_circle(0), first, True)]
    for k, step in enumerate(steps, 1):
        wrong = perturbed(np.random.default_rng(k), on_circle(k), 0.02, 0.05)
        nodes.append(PairNode(k, wrong, first, False, PoseConstraint(step, covariance(1e-4, 1e-3))))
    assert errors_m(PairGraph(100), nodes).max() < 1e-6


def test_matches_and_anchors_each_bring_it_nearer_to_the_truth() -> None:
    def rms_mm(with_matches: bool, anchored: int) -> float:
        runs = [chain(60, np.random.default_rng(seed), with_matches, anchored) for seed in range(6)]
        return 1e3 * float(
            np.sqrt(np.mean([(errors_m(PairGraph(200), nodes) ** 2).mean() for nodes in runs]))
        )

    alone, matched, anchored, both = (
        rms_mm(*kind) for kind in ((False, 999), (True, 999), (False, 10), (True, 10))
    )
    assert matched < 0.95 * alone
    assert anchored < 0.8 * alone
    assert both < 0.95 * anchored


def test_one_pair_of_measurements_is_weighted_by_their_covariances() -> None:
    first = PoseConstraint(np.eye(4), covariance(1e-6, 1e-6))
    odometry = PoseConstraint(pose(t=np.array([0.10, 0, 0])), covariance(1e-3, 0.02))
    match = PoseConstraint(pose(t=np.array([0.11, 0, 0])), covariance(1e-3, 0.01))
    graph = PairGraph(20)
    graph.add(PairNode(0, np.eye(4), first, True))
    poses = graph.add(PairNode(1, odometry.T, first, False, odometry, match))
    assert poses.T_map_cabin[1][0, 3] == pytest.approx(
        (0.10 / 4e-4 + 0.11 / 1e-4) / (1 / 4e-4 + 1 / 1e-4), abs=1e-6
    )


def test_an_outlying_match_is_weighted_down_by_the_kernel() -> None:
    nodes = chain(40, np.random.default_rng(0))
    wild = nodes[20]
    assert wild.match is not None
    shifted = PoseConstraint(wild.match.T @ pose(t=np.array([0.1, 0, 0])), wild.match.covariance)
    nodes[20] = PairNode(
        20, wild.T_map_cabin, wild.estimate, wild.is_anchor, wild.odometry, shifted
    )
    assert (
        errors_m(PairGraph(100), nodes).max() < 0.012
    )  # plain least squares would follow it by eight centimetres


def test_marginalised_nodes_leave_their_information() -> None:
    nodes = chain(
        170, np.random.default_rng(1), with_matches=False
    )  # a kernel has its own way with old residuals
    whole, windowed = PairGraph(1000), PairGraph(40)
    for node in nodes:
        everything, newest = whole.add(node), windowed.add(node)
        assert len(windowed) <= 60
    assert newest.first >= 110
    there, here = everything.T_map_cabin[-1], newest.T_map_cabin[-1]
    assert np.linalg.norm(there[:3, 3] - here[:3, 3]) < 1e-4
    assert angle_between(there[:3, :3], here[:3, :3]) < 2e-5


def test_an_unconnected_node_starts_a_new_graph() -> None:
    graph = PairGraph(20)
    first, *_ = chain(1, np.random.default_rng(0))
    graph.add(first)
    poses = graph.add(PairNode(1, on_circle(1), first.estimate, False))
    assert graph.restarts == 1
    assert (poses.first, len(poses.T_map_cabin)) == (1, 1)


def test_a_covariance_that_is_nan_or_not_positive_is_refused() -> None:
    with pytest.raises(ShapeError, match="covariance holds 36 values that are not finite"):
        PoseConstraint(np.eye(4), np.full((6, 6), np.nan))
    with pytest.raises(DataError, match="must be positive"):
        PoseConstraint(np.eye(4), np.diag([1.0, 1, 1, 1, 1, 0]))


def test_after_a_solution_that_fails_a_new_graph_begins_with_the_node(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As after a singular system: earlier nodes are gone, and the next one goes on from it."""
    nodes, graph = chain(7, np.random.default_rng(0)), PairGraph(20)
    for node in nodes[:5]:
        graph.add(node)
    assert graph.restarts == 0
    solved, fails = PairGraph._solved, [True]

    def once(self: PairGraph) -> object:
        if fails.pop() if fails else False:
            raise RuntimeError("singular")
        return solved(self)

    monkeypatch.setattr(PairGraph, "_solved", once)
    poses = graph.add(nodes[5])
    assert (graph.restarts, poses.first, len(poses.T_map_cabin)) == (1, 5, 1)
    assert np.linalg.norm((poses.T_map_cabin[0] - on_circle(5))[:3, 3]) < 0.02
    poses = graph.add(nodes[6])
    assert (graph.restarts, poses.first, len(poses.T_map_cabin)) == (1, 5, 2)


def test_a_solution_that_is_no_number_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """If it stays so, the caller is told."""
    node = chain(1, np.random.default_rng(0))[0]
    graph = PairGraph(20)
    monkeypatch.setattr(
        "executive_plugins.mapping.pair_graph.np.isfinite", lambda values: np.zeros(1, dtype=bool)
    )
    with pytest.raises(RuntimeError, match="not finite"):
        graph.add(node)
    assert graph.restarts == 1
