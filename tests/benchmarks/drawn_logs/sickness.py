"""What can be wrong with one sensor for some time, as changes of a log's measurements."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.logs.log import Arrival
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What a change may need.

    Attributes:
        since_s: Time since the sensor fell sick [s].
        datum: Origin of the map, shape (3,).
        first: The first measurement of the same sensor that it touched.
        number: How many it touched before.
        rng: Source of randomness.
    """

    since_s: float
    datum: Float
    first: Any
    number: int
    rng: np.random.Generator


# Returns the changed arrivals of one: none, one or several.
Change = Callable[[Arrival, Context], Sequence[Arrival]]


@dataclass(frozen=True, slots=True)
class Sickness:
    """A kind of fault.

    Attributes:
        kind: Type of the measurements that it touches.
        lasts_s: How long [s].
        change: What it does to each.
    """

    kind: type
    lasts_s: float
    change: Change

    def of(
        self, arrivals: Sequence[Arrival], datum: Float, from_s: float, rng: np.random.Generator
    ) -> tuple[Arrival, ...]:
        """Return a log's measurements with the fault from a time on, in order of arrival."""
        answer: list[Arrival] = []
        first: dict[str, Any] = {}
        number = 0
        for arrival in arrivals:
            since_s, one = arrival.arrival_s - from_s, arrival.observation
            if not isinstance(one, self.kind) or not 0 <= since_s < self.lasts_s:
                answer.append(arrival)
                continue
            name = str(getattr(one, "antenna", getattr(one, "frame", "")))
            known = first.setdefault(name, one)
            answer += self.change(arrival, Context(since_s, datum, known, number, rng))
            number += 1
        return tuple(sorted(answer, key=lambda arrival: arrival.arrival_s))


def _changed(arrival: Arrival, **values: Any) -> Sequence[Arrival]:
    observation: Any = arrival.observation
    return (replace(arrival, observation=replace(observation, **values)),)


def _silent(_: Arrival, __: Context) -> Sequence[Arrival]:
    return ()


def _late(arrival: Arrival, _: Context, by_s: float) -> Sequence[Arrival]:
    """Let it arrive later, with the true stamp."""
    return (replace(arrival, arrival_s=arrival.arrival_s + by_s),)


def _stamped(arrival: Arrival, _: Context, by_s: float) -> Sequence[Arrival]:
    """Let it carry a wrong stamp."""
    one: Any = arrival.observation
    if isinstance(one, LidarIncrement):
        return _changed(arrival, from_s=one.from_s + by_s, to_s=one.to_s + by_s)
    return _changed(arrival, stamp_s=one.stamp_s + by_s)


def _twice(arrival: Arrival, _: Context) -> Sequence[Arrival]:
    return (arrival, arrival)


def _thinned(arrival: Arrival, context: Context, keep: int) -> Sequence[Arrival]:
    return () if context.number % keep else (arrival,)


def _shuffled(arrival: Arrival, context: Context, by_s: float) -> Sequence[Arrival]:
    return (replace(arrival, arrival_s=arrival.arrival_s + context.rng.uniform(0, by_s)),)


# Fixes


def _moved(arrival: Arrival, context: Context, by_m: Float) -> Sequence[Arrival]:
    fix: Any = arrival.observation
    p_map = enu_from_geodetic(fix.geodetic, context.datum) + by_m
    return _changed(arrival, geodetic=geodetic_from_enu(p_map, context.datum))


def _jumped(arrival: Arrival, context: Context, by_m: Sequence[float]) -> Sequence[Arrival]:
    return _moved(arrival, context, np.array(by_m))


def _ramped(arrival: Arrival, context: Context, m_s: float) -> Sequence[Arrival]:
    return _moved(arrival, context, context.since_s * m_s * np.array([0.8, 0.6, 0.0]))


def _stuck(arrival: Arrival, context: Context) -> Sequence[Arrival]:
    return _changed(arrival, geodetic=context.first.geodetic)


def _noisy_fix(arrival: Arrival, context: Context, factor: float) -> Sequence[Arrival]:
    fix: Any = arrival.observation
    std = np.sqrt(np.diag(fix.covariance_enu_m2)) * factor
    return _moved(arrival, context, context.rng.normal(0, std))


def _spiked_fix(arrival: Arrival, context: Context, by_m: float) -> Sequence[Arrival]:
    if context.number % 5:
        return (arrival,)
    away = context.rng.normal(size=3)
    return _moved(arrival, context, by_m * away / np.linalg.norm(away))


def _float(arrival: Arrival, context: Context, std_m: float) -> Sequence[Arrival]:
    """Make it a float solution: a slow error of the declared size."""
    wave = std_m * np.sin([context.since_s / 4, context.since_s / 5 + 1, context.since_s / 6 + 2])
    (moved,) = _moved(arrival, context, wave)
    return _changed(moved, covariance_enu_m2=std_m**2 * np.eye(3), is_rtk_fixed=False)


def _declared(arrival: Arrival, _: Context, factor: float) -> Sequence[Arrival]:
    fix: Any = arrival.observation
    return _changed(arrival, covariance_enu_m2=factor**2 * fix.covariance_enu_m2)


# Inertial samples


def _inertial(
    arrival: Arrival,
    context: Context,
    rate: Callable[[Float, np.random.Generator], Float] | None = None,
    force: Callable[[Float, np.random.Generator], Float] | None = None,
) -> Sequence[Arrival]:
    sample: Any = arrival.observation
    values = {}
    if rate is not None:
        values["angular_velocity_rad_s"] = rate(sample.angular_velocity_rad_s, context.rng)
    if force is not None:
        values["specific_force_m_s2"] = force(sample.specific_force_m_s2, context.rng)
    return _changed(arrival, **values)


def _frozen(arrival: Arrival, context: Context) -> Sequence[Arrival]:
    return _changed(
        arrival,
        angular_velocity_rad_s=context.first.angular_velocity_rad_s,
        specific_force_m_s2=context.first.specific_force_m_s2,
    )


# Odometry


def _turned(arrival: Arrival, _: Context, angle_rad: float, scale: float) -> Sequence[Arrival]:
    """Scale the way, and turn by an angle in each increment."""
    one: Any = arrival.observation
    T = one.T_from_to
    turn = exp_so3(np.array([0.0, 0.0, angle_rad]))
    return _changed(arrival, T_from_to=pose(T[:3, :3] @ turn, scale * T[:3, 3]))


def _stands(arrival: Arrival, _: Context) -> Sequence[Arrival]:
    return _changed(arrival, T_from_to=np.eye(4))


def _noisy_step(arrival: Arrival, context: Context, factor: float) -> Sequence[Arrival]:
    one: Any = arrival.observation
    noise = factor * context.rng.normal(0, np.sqrt(np.diag(one.covariance)))
    T = one.T_from_to
    wrong = pose(T[:3, :3] @ exp_so3(noise[:3]), T[:3, 3] + noise[3:])
    return _changed(arrival, T_from_to=wrong)


def _one_step(arrival: Arrival, context: Context, by_m: float) -> Sequence[Arrival]:
    one: Any = arrival.observation
    if context.number:
        return (arrival,)
    T = one.T_from_to
    return _changed(arrival, T_from_to=pose(T[:3, :3], T[:3, 3] + [by_m, 0.0, 0.0]))


def _fixes() -> Iterator[tuple[str, float, Change]]:
    for lasts_s in (3.0, 10.0):
        yield f"silent {lasts_s:.0f} s", lasts_s, _silent
    for by_s in (0.3, 1.0, 3.0):
        yield f"arrive {by_s} s late", 10.0, partial(_late, by_s=by_s)
    for by_s in (-0.3, 0.1, 0.3, 1.5):
        yield f"stamps {by_s:+} s", 10.0, partial(_stamped, by_s=by_s)
    for by_m in (0.3, 1.0, 5.0, 100.0):
        yield f"jump {by_m} m", 8.0, partial(_jumped, by_m=(by_m, 0.0, 0.0))
    yield "jump 2 m up", 8.0, partial(_jumped, by_m=(0.0, 0.0, 2.0))
    for m_s in (0.1, 0.5):
        yield f"run away {m_s} m/s", 10.0, partial(_ramped, m_s=m_s)
    for factor in (5.0, 20.0):
        yield f"noise x {factor:.0f}", 10.0, partial(_noisy_fix, factor=factor)
    for by_m in (2.0, 20.0):
        yield f"every fifth {by_m} m off", 10.0, partial(_spiked_fix, by_m=by_m)
    for factor in (0.1, 10.0):
        yield f"declare {factor} of their error", 10.0, partial(_declared, factor=factor)
    yield "stand still", 10.0, _stuck
    yield "float of 1 m", 10.0, partial(_float, std_m=1.0)
    yield "come twice", 10.0, _twice
    yield "one in ten", 10.0, partial(_thinned, keep=10)
    yield "out of order", 10.0, partial(_shuffled, by_s=0.4)


def _samples() -> Iterator[tuple[str, float, Change]]:
    for lasts_s in (0.3, 1.0, 3.0):
        yield f"silent {lasts_s} s", lasts_s, _silent
    yield "arrive 0.2 s late", 10.0, partial(_late, by_s=0.2)
    for by_s in (-0.1, 0.05):
        yield f"stamps {by_s:+} s", 10.0, partial(_stamped, by_s=by_s)
    for bias in (0.02, 0.1):
        step = partial(_inertial, rate=lambda w, _, b=bias: w + b)
        yield f"rate + {bias} rad/s", 10.0, step
    for bias in (0.2, 1.0):
        step = partial(_inertial, force=lambda f, _, b=bias: f + b)
        yield f"force + {bias} m/s²", 10.0, step
    yield "rate x 1.05", 10.0, partial(_inertial, rate=lambda w, _: 1.05 * w)
    yield "force x 1.02", 10.0, partial(_inertial, force=lambda f, _: 1.02 * f)
    noisy_rate = partial(_inertial, rate=lambda w, rng: w + rng.normal(0, 0.1, 3))
    noisy_force = partial(_inertial, force=lambda f, rng: f + rng.normal(0, 2.0, 3))
    yield "rate noise 0.1 rad/s", 10.0, noisy_rate
    yield "force noise 2 m/s²", 10.0, noisy_force
    yield "frozen 0.5 s", 0.5, _frozen
    yield "frozen 2 s", 2.0, _frozen
    yield "zero 1 s", 1.0, partial(_inertial, rate=lambda w, _: 0 * w, force=lambda f, _: 0 * f)
    yield (
        "rate clipped to 0.3 rad/s",
        10.0,
        partial(_inertial, rate=lambda w, _: np.clip(w, -0.3, 0.3)),
    )
    yield "yaw rate mirrored", 5.0, partial(_inertial, rate=lambda w, _: w * [1, 1, -1])
    yield "come twice", 10.0, _twice
    yield "one in four", 10.0, partial(_thinned, keep=4)


def _increments() -> Iterator[tuple[str, float, Change]]:
    yield "silent", 10.0, _silent
    yield "stands still", 5.0, _stands
    for scale in (0.5, 0.95, 1.1, 2.0):
        yield f"way x {scale}", 10.0, partial(_turned, angle_rad=0.0, scale=scale)
    for angle_rad in (0.002, 0.05):
        yield f"turns {angle_rad} rad a step", 10.0, partial(_turned, angle_rad=angle_rad, scale=1)
    yield "noise x 10", 10.0, partial(_noisy_step, factor=10.0)
    yield "one step of 1 m", 10.0, partial(_one_step, by_m=1.0)
    yield "arrives 0.5 s late", 10.0, partial(_late, by_s=0.5)
    yield "stamps +0.1 s", 10.0, partial(_stamped, by_s=0.1)
    yield "comes twice", 10.0, _twice


def _named() -> Iterator[tuple[str, Sickness]]:
    rooms = (
        ("fixes", GnssFix, _fixes()),
        ("samples", ImuSample, _samples()),
        ("odometry", LidarIncrement, _increments()),
    )
    for sensor, kind, some in rooms:
        for name, lasts_s, change in some:
            yield f"{sensor}: {name}", Sickness(kind, lasts_s, change)


SICKNESSES: Mapping[str, Sickness] = dict(_named())
