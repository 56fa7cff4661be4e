"""The streams hand on what an estimator says of itself, each change once."""

from types import MethodType

import numpy as np
import pytest

from executive.interfaces.estimation import Estimator
from executive.interfaces.plugin import Plugin
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.messages.status_change import StatusChange
from executive.messages.verdict import Verdict
from executive.mission.jobs.call import WrongAnswerError
from executive.mission.jobs.tick_call import observations_of
from executive.mission.streams import StreamGuard, StreamListener, Streams


class ToldEstimator(Estimator):
    """Says what it is told to."""

    def __init__(self) -> None:
        self.status, self.changes = "INITIALISING", []
        self.stamp_s = self.variance = 1.0

    def add_imu(self, sample: ImuSample) -> None: ...

    add_gnss = add_joints = add_odometry = add_imu

    def account(self) -> list[StatusChange]:
        return self.changes

    def state(self) -> BaseState:
        eye, eye6 = np.eye(4), np.eye(6)
        return BaseState(
            self.stamp_s, eye, eye, eye, np.zeros(3), np.zeros(3), self.variance * eye6, self.status
        )


class Listener(StreamListener):
    """Keeps what the streams hand on."""

    def __init__(self, changes: list[StatusChange]) -> None:
        self.changes, self.unknown, self.errors = changes, [], []
        self.verdicts: list[Verdict] = []

    def take_verdict(self, verdict: Verdict) -> None:
        self.verdicts.append(verdict)

    def take_status(self, change: StatusChange) -> None:
        self.changes.append(change)

    def take_error(self, capability: str, plugin: Plugin, error: Exception) -> None:
        self.errors.append((capability, str(error)))

    def take_unknown(self, kind: str) -> None:
        self.unknown.append(kind)


def streamed() -> tuple[ToldEstimator, Streams, list[StatusChange]]:
    estimator, told = ToldEstimator(), []
    return estimator, Streams({"estimation": estimator}, (), Listener(told)), told


def test_each_change_of_the_account_is_told_once_with_its_reason() -> None:
    estimator, streams, told = streamed()
    streams.process([])
    first = StatusChange(0.5, "GLOBAL", "SUSPECT", "no fix for 0.6 s")
    second = StatusChange(0.9, "SUSPECT", "FALLBACK", "no good fix for 1.0 s")
    estimator.changes, estimator.status = [first, second], "FALLBACK"
    streams.process([])
    streams.process([])
    assert told == [first, second]


def test_a_change_that_no_account_mentions_is_told_without_a_reason() -> None:
    estimator, streams, told = streamed()
    estimator.status = "GLOBAL"
    streams.process([])
    streams.process([])
    assert told == [StatusChange(1.0, "INITIALISING", "GLOBAL", "")]


def test_an_odometry_hears_inertia() -> None:
    class Listening:
        heard = 0

        def add_imu(self, sample: ImuSample) -> None:
            self.heard += 1

    odometry = Listening()
    streams = Streams({"estimation": ToldEstimator(), "odometry": odometry}, (), Listener([]))
    streams.process([ImuSample(0.01, "imu_cabin", np.zeros(3), np.zeros(3))])
    assert odometry.heard == 1


def test_observations_that_no_plugin_takes_are_counted_and_told_once() -> None:
    class Photograph:
        stamp_s = 0.5

    listener = Listener([])
    streams = Streams({"estimation": ToldEstimator()}, (), listener)
    streams.process([Photograph(), Photograph()])
    assert streams.ignored == {"Photograph": 2}
    assert listener.unknown == ["Photograph"]


def test_a_plugin_is_handed_the_observations_that_it_takes() -> None:
    class Photograph:
        stamp_s = 0.5

    class Camera(Plugin):
        takes = (Photograph,)
        seen = 0

        def take(self, observation: object) -> None:
            self.seen += 1

    camera, listener = Camera(), Listener([])
    streams = Streams({"estimation": ToldEstimator(), "camera": camera}, (), listener)
    streams.process([Photograph()])
    assert (camera.seen, streams.ignored, listener.unknown) == (1, {}, [])


def test_a_stream_plugin_that_fails_is_used_no_more() -> None:
    class Failing:
        calls = 0

        def add_imu(self, sample: ImuSample) -> None:
            self.calls += 1
            raise ValueError("no scan")

    odometry, listener = Failing(), Listener([])
    streams = Streams({"estimation": ToldEstimator(), "odometry": odometry}, (), listener)
    sample = ImuSample(0.01, "imu_cabin", np.zeros(3), np.zeros(3))
    streams.process([sample, sample])
    assert (odometry.calls, listener.errors) == (1, [("odometry", "no scan")])


SAMPLES: dict[str, Observation] = {
    "add_imu": ImuSample(0.1, "imu", np.zeros(3), np.zeros(3)),
    "add_gnss": GnssFix(0.1, "gnss", np.zeros(3), np.eye(3), True),
    "add_joints": JointSample(0.1, ("A",), *np.zeros((3, 1))),
}


@pytest.mark.parametrize("verb", SAMPLES)
def test_a_verb_that_answers_with_another_type_has_not_taken_its_observation(verb: str) -> None:
    estimator, streams, _ = streamed()
    streams.process(list(SAMPLES.values()))  # the estimator is well

    def wrong(self: ToldEstimator, sample: object) -> dict[str, int]:
        return {}

    wrong.__name__ = verb
    setattr(estimator, verb, MethodType(wrong, estimator))
    with pytest.raises(WrongAnswerError, match=f"'{verb}' of the estimation plugin .* dict"):
        streams.process([SAMPLES[verb]])


def test_a_state_of_another_type_is_named_whoever_asks_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    estimator, streams, _ = streamed()
    assert streams.state().status == "INITIALISING"

    def state(self: ToldEstimator) -> dict[str, int]:
        return {}

    monkeypatch.setattr(estimator, "state", MethodType(state, estimator))
    with pytest.raises(WrongAnswerError, match=r"of the estimation plugin .* dict"):
        streams.state()


def test_a_state_that_holds_a_nan_is_refused() -> None:
    estimator, streams, _ = streamed()
    estimator.stamp_s = float("nan")
    with pytest.raises(WrongAnswerError, match=r"NaN \(stamp_s\)"):
        streams.process([])


def test_a_robot_that_returns_no_sequence_is_refused() -> None:
    class Speechless:
        capability = "robot"

        def read(self, until_s: float) -> None:
            return None

    with pytest.raises(WrongAnswerError, match="NoneType instead of a sequence"):
        observations_of(Speechless(), 1.0)


class Recorder:
    """Notes which observations its verbs were given, and answers or fails as it was made."""

    def __init__(self, *, answer: object = None, failing: str = "") -> None:
        self.told: list[tuple[str, object]] = []
        self._answer, self._failing = answer, failing

    def _take(self, verb: str, *given: object) -> object:
        self.told.append((verb, *given))
        if verb == self._failing:
            raise ValueError(f"no {verb}")
        return self._answer

    def __getattr__(self, verb: str) -> object:
        if verb not in ("add_imu", "add_joints", "add_scan", "add_scan_pair", "update"):
            raise AttributeError(verb)
        return lambda *given: self._take(verb, *given)

    def verbs(self) -> list[str]:
        return [verb for verb, *_ in self.told]


class Guarded(StreamGuard):
    """Refuses some observations, and lets no scan of some stamps be fused."""

    def __init__(self, refused: tuple[object, ...] = (), unknown_s: tuple[float, ...] = ()) -> None:
        self._refused, self._unknown_s = refused, unknown_s
        self.asked_s: list[float] = []

    def refuses(self, observation: object) -> bool:
        return any(observation is one for one in self._refused)

    def may_fuse(self, stamp_s: float, behind: int = 0) -> bool:
        self.asked_s.append(stamp_s)
        return stamp_s not in self._unknown_s


class Heard(ToldEstimator):
    """Keeps what it is given."""

    def __init__(self) -> None:
        super().__init__()
        self.status, self.heard = "GLOBAL", []

    def add_imu(self, sample: object) -> None:
        self.heard.append(sample)

    add_gnss = add_joints = add_odometry = add_imu


def joints(stamp_s: float, position: float = 0.0) -> JointSample:
    return JointSample(stamp_s, ("A",), np.array([position]), *np.zeros((2, 1)))


def scan(stamp_s: float, frame: str) -> LidarScan:
    return LidarScan(stamp_s, frame, np.zeros((1, 3)), np.array([stamp_s]))


def moved(streams: Streams, estimator: ToldEstimator, *stamps_s: float) -> None:
    """Take a joint sample at each stamp, in a tick of its own, while the state is as new."""
    for stamp_s in stamps_s:
        estimator.stamp_s = estimator.variance = stamp_s
        streams.process([joints(stamp_s, 2.0 * stamp_s)])


def test_the_states_of_the_last_second_are_kept_once_each_while_the_pose_may_be_used() -> None:
    estimator = ToldEstimator()
    streams = Streams({"estimation": estimator}, (), Listener([]))
    moved(streams, estimator, 0.5)
    assert streams.recent_states() == []  # INITIALISING
    estimator.status = "GLOBAL"
    moved(streams, estimator, 1.0, 1.5, 1.5, 2.0)
    assert [one.stamp_s for one in streams.recent_states()] == [1.0, 1.5, 2.0]
    moved(streams, estimator, 2.5)
    assert [one.stamp_s for one in streams.recent_states()] == [1.5, 2.0, 2.5]
    assert streams.joints.stamp_s == 2.5
    assert streams.state().stamp_s == 2.5


def mapping(mapper: Recorder, guard: StreamGuard | None = None) -> tuple[Streams, Listener]:
    """Return streams of two lidars after two joint samples at known poses."""
    estimator, listener = ToldEstimator(), Listener([])
    estimator.status = "GLOBAL"
    plugins = {"estimation": estimator, "mapping": mapper}
    streams = Streams(plugins, ("left", "right"), listener, guard)
    moved(streams, estimator, 1.0, 1.5)
    return streams, listener


def test_a_scan_of_each_lidar_is_mapped_with_the_motion_of_the_last_second() -> None:
    mapper = Recorder()
    streams, _ = mapping(mapper)
    left, right = scan(1.3, "left"), scan(1.2, "right")
    streams.process([scan(1.1, "left"), left])  # the newest of each counts
    assert mapper.told == []
    streams.process([right])
    assert streams.arrived_scans == [right]  # of this tick
    streams.process([left])  # begins the next pair
    ((verb, pair, motion),) = mapper.told
    assert (verb, pair) == ("add_scan_pair", [left, right])
    assert motion.stamps_s.tolist() == [1.0, 1.5]
    assert motion.T_map_cabin.shape == (2, 4, 4)
    assert motion.joint_names == ("A",)
    assert motion.joint_position.tolist() == [[2.0], [3.0]]
    np.testing.assert_array_equal(motion.covariance, 1.5 * np.eye(6))  # the newest
    assert streams.scan_pairs == 1


def test_the_wall_time_of_a_mapping_is_kept_in_milliseconds(monkeypatch) -> None:
    times_s = iter([5.0, 5.25])
    monkeypatch.setattr("executive.mission.streams.wall_s", lambda: next(times_s))
    streams, _ = mapping(Recorder())
    streams.process([scan(1.3, "left"), scan(1.2, "right")])
    assert list(streams.durations_ms["mapping.add_scan_pair"]) == [250.0]


def test_no_scan_is_mapped_before_a_pose_is_known() -> None:
    mapper = Recorder()
    streams = Streams({"estimation": ToldEstimator(), "mapping": mapper}, ("left",), Listener([]))
    streams.process([joints(0.8), scan(0.9, "left")])
    assert (mapper.told, streams.scan_pairs) == ([], 0)


def test_a_pair_whose_newest_scan_may_not_be_fused_is_left_out_whole() -> None:
    mapper, guard = Recorder(), Guarded(unknown_s=(1.3,))
    streams, _ = mapping(mapper, guard)
    streams.process([scan(1.3, "left"), scan(1.2, "right")])
    streams.process([scan(1.4, "right")])
    assert mapper.told == []
    streams.process([scan(1.4, "left")])
    assert mapper.verbs() == ["add_scan_pair"]
    assert guard.asked_s == [1.3, 1.4]


def test_a_mapper_that_fails_is_told_and_used_no_more() -> None:
    mapper = Recorder(failing="add_scan_pair")
    streams, listener = mapping(mapper)
    for _ in range(2):
        streams.process([scan(1.3, "left"), scan(1.2, "right")])
    assert listener.errors == [("mapping", "no add_scan_pair")]
    assert (len(mapper.told), streams.scan_pairs, streams.durations_ms) == (1, 0, {})


def test_an_odometry_hears_all_and_its_increments_go_to_the_estimator() -> None:
    estimator, odometry = Heard(), Recorder(answer="increment")
    streams = Streams({"estimation": estimator, "odometry": odometry}, ("left",), Listener([]))
    given = [joints(0.1), scan(0.2, "left"), SAMPLES["add_imu"], SAMPLES["add_gnss"]]
    streams.process(given)
    told = [("add_joints", given[0]), ("add_scan", given[1]), ("add_imu", given[2])]
    assert odometry.told == told
    assert estimator.heard == [given[0], "increment", given[2], given[3]]


def test_an_odometry_that_finds_no_increment_tells_the_estimator_nothing() -> None:
    estimator, odometry = Heard(), Recorder()
    streams = Streams({"estimation": estimator, "odometry": odometry}, ("left",), Listener([]))
    streams.process([scan(0.2, "left")])
    assert (odometry.verbs(), estimator.heard) == (["add_scan"], [])


def test_each_monitor_watches_the_joints_and_one_that_fails_is_used_no_more() -> None:
    failing, silent, alarmed = Recorder(failing="update"), Recorder(), Recorder(answer="it slips")
    listener = Listener([])
    plugins = {"estimation": ToldEstimator(), "monitoring": (failing, silent, alarmed)}
    streams = Streams(plugins, (), listener)
    samples = [joints(0.1), joints(0.2)]
    streams.process(samples)
    assert listener.errors == [("monitoring", "no update")]
    assert listener.verdicts == ["it slips", "it slips"]
    assert failing.told == [("update", samples[0])]
    assert silent.told == alarmed.told == [("update", one) for one in samples]
    assert streams.monitors == [silent, alarmed]


def test_what_the_guard_refuses_goes_to_no_plugin() -> None:
    estimator, samples = Heard(), list(SAMPLES.values())
    streams = Streams({"estimation": estimator}, (), Listener([]), Guarded(refused=(samples[1],)))
    streams.process(samples)
    assert estimator.heard == [samples[0], samples[2]]


def test_a_plugin_that_fails_to_take_an_observation_is_handed_no_more() -> None:
    class Photograph:
        stamp_s = 0.5

    class Camera(Plugin):
        takes = (Photograph,)

        def __init__(self, *, is_failing: bool) -> None:
            self.is_failing, self.seen = is_failing, 0

        def take(self, observation: object) -> None:
            self.seen += 1
            if self.is_failing:
                raise ValueError("no film")

    failing, sound, listener = Camera(is_failing=True), Camera(is_failing=False), Listener([])
    plugins = {"estimation": ToldEstimator(), "camera": failing, "spare": sound}
    streams = Streams(plugins, (), listener)
    streams.process([Photograph(), Photograph()])
    assert (failing.seen, sound.seen) == (1, 2)
    assert (listener.errors, streams.ignored) == ([("camera", "no film")], {})
