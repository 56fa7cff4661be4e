"""Batch smoothing of a whole recording, as a reference for online trajectories."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from executive_plugins.estimation.cabin.sensors import cabin_imu
from executive_plugins.estimation.gate.measurements import Measurement
from executive_plugins.estimation.graph.dual_graph import DualGraph
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.graph.settings import DualGraphSettings, SmootherSettings
from executive_plugins.estimation.graph.smoother_process import InlineSmoother, SmootherHost
from executive_plugins.estimation.graph.whole_graph import Recording, WholeGraph
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.packing import packed
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import inverse
from executive.interfaces.recorded_log import RecordedBody
from executive.interfaces.smoothing import TrajectorySmoother
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

SMOOTHED = "SMOOTHED"


class _RecordingSmoother(InlineSmoother):
    """Smooths inline, and records measurements and estimates since each start."""

    def __init__(self, settings: SmootherSettings, noise: InertialNoise) -> None:
        super().__init__(settings, noise)
        self.recordings: list[Recording] = []

    def begin(self, propagator: LivePropagator, first: GraphEstimate) -> None:
        self.recordings.append(Recording(first))
        super().begin(propagator, first)

    def add(self, measurement: Measurement) -> None:
        self.recordings[-1].measurements.append(measurement)
        super().add(measurement)

    def _updated(self, sample: Inertial) -> Estimate | None:
        recording = self.recordings[-1]
        recording.samples.append(sample)
        estimate = super()._updated(sample)
        if estimate is not None and (
            not recording.estimates or estimate.state.stamp_s > recording.estimates[-1].stamp_s
        ):
            recording.estimates.append(estimate.state)
        return estimate


class _RecordingGraph(DualGraph):
    """The online estimator, for its checks, its first state and initial values."""

    def _made_host(self) -> SmootherHost:
        self.host = _RecordingSmoother(self._settings.smoother, self._noise)
        return self.host


class BatchGraph(TrajectorySmoother):
    """The dual graph's main graph over a whole recording, without lag and without gate.

    There is only one graph, since with the whole recording an outage is bridged from both of its
    ends. Outliers among the fixes are found from the solution itself.
    """

    Settings = DualGraphSettings

    def __init__(self, settings: DualGraphSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        return DualGraph.settings_for(body)

    @property
    def datum(self) -> tuple[float, float, float] | None:
        return self._settings.datum

    def smooth(self, observations: Iterable[Observation | LidarIncrement]) -> Sequence[BaseState]:
        online = _RecordingGraph(self._settings, self._machine)
        online.start()
        try:
            joints = list(_fed(online, observations))
        finally:
            online.close()
        imu = cabin_imu(self._machine, self._settings.imu)
        noise = InertialNoise.of(imu, self._settings.noise_factor, self._settings.gravity_m_s2)
        graphs = [
            WholeGraph(recording, self._settings.smoother, noise)
            for recording in online.host.recordings
        ]
        turn = TurnJoint(self._machine)
        propagator = LivePropagator(
            inverse(imu.T_link_sensor), turn, noise, self._settings.restart_after_s
        )
        answers, k = [], 0
        for state, P in (pair for graph in graphs for pair in _smoothed(graph)):
            while k < len(joints) and joints[k].stamp_s <= state.stamp_s:
                turn.update(joints[k])
                k += 1
            propagator.set_turn()
            if not propagator.take(packed(state, P), is_alone=True):
                raise DataError(f"the smoothed state at {state.stamp_s:.2f} s is not finite")
            answers.append(propagator.state(SMOOTHED))
        return answers


def _fed(
    online: DualGraph, observations: Iterable[Observation | LidarIncrement]
) -> Iterator[JointSample]:
    """Feed all observations to the estimator; yield the joint samples among them."""
    for observation in observations:
        online.add(observation)
        if isinstance(observation, JointSample):
            yield observation


def _smoothed(graph: WholeGraph) -> Iterator[tuple[InertialState, Float]]:
    """Yield the states at the samples of one graph, each with the covariance of the node before."""
    if len(graph) < 2 or not graph.has_fix:
        return
    nodes = graph.solve()
    for node, covariance in zip(range(len(nodes) - 1), graph.covariances(), strict=False):
        if node == 0:
            yield nodes[0], covariance
        for state in graph.between(nodes, node):
            if graph.is_sample(state.stamp_s):
                yield state, covariance
