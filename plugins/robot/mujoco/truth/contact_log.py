"""Contacts of the machine with other bodies: when, with what, how strong."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.site.person import PERSON
from executive_plugins.robot.mujoco.site.terrain import FIRM, TERRAIN

from executive.arrays import Float
from executive.machine.machine import Machine

_TOUCH_M = 0.01  # farther bodies need no exact distance
_MERGE_S = 0.2  # contacts of one pair that are separated by less count as one


@dataclass(slots=True)
class Span:
    """A contact of a link of the machine with another body.

    Attributes:
        link: Link of the machine.
        other: A stone, `terrain`, an obstacle, a person, or another link.
        from_s: Start [s].
        to_s: End [s].
        max_force_n: Largest force of one contact point [N].
    """

    link: str
    other: str
    from_s: float
    to_s: float
    max_force_n: float


class ContactLog:
    """Reads MuJoCo's contacts at every control step."""

    def __init__(self, machine: Machine, stones: Sequence[str], model: mujoco.MjModel) -> None:
        self._names = {model.body(name).id: name for name in (*machine.links, *stones)}
        # Of the world itself, each geometry has a name of its own.
        fixed = {int(i): model.geom(i).name for i in np.flatnonzero(model.geom_bodyid == 0)}
        self._fixed = {i: TERRAIN if name == FIRM else name for i, name in fixed.items()}
        self._is_link = np.zeros(model.nbody, dtype=bool)
        self._is_link[[model.body(name).id for name in machine.links]] = True
        self._body_of_geom = model.geom_bodyid
        bodies = {i: model.body(i).name for i in range(model.nbody)}
        self._people = [
            (geom, bodies[int(body)])
            for geom, body in enumerate(model.geom_bodyid)
            if bodies[int(body)].startswith(PERSON)
        ]
        self._link_geoms = np.flatnonzero(self._is_link[model.geom_bodyid])
        self._open: dict[tuple[str, str], Span] = {}
        self._closed: list[Span] = []

    def step(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Record the contacts of a control step."""
        for geom, person in self._people:
            for hit in self._links_at(geom, model, data):
                self._note(hit, person, time_s, 0.0)
        touching = np.flatnonzero(data.contact.dist <= 0.0)
        geoms = data.contact.geom[touching]  # (N, 2)
        bodies = self._body_of_geom[geoms]
        links = self._is_link[bodies]
        for i in np.flatnonzero(links.any(axis=1)):
            link, other = (0, 1) if links[i, 0] else (1, 0)
            self._note(
                self._names[int(bodies[i, link])],
                self._fixed.get(int(geoms[i, other])) or self._names[int(bodies[i, other])],
                time_s,
                _force_n(model, data, int(touching[i])),
            )

    def _links_at(self, geom: int, model: mujoco.MjModel, data: mujoco.MjData) -> list[str]:
        """Return the links that touch a geometry which has no contacts of its own."""
        links = self._link_geoms
        gaps_m = np.linalg.norm(data.geom_xpos[links] - data.geom_xpos[geom], axis=1)
        near = links[gaps_m <= model.geom_rbound[links] + model.geom_rbound[geom]]
        return [
            self._names[int(self._body_of_geom[other])]
            for other in near
            if mujoco.mj_geomDistance(model, data, geom, int(other), _TOUCH_M, None) <= 0.0
        ]

    def _note(self, link: str, other: str, time_s: float, force_n: float) -> None:
        key = (link, other)
        span = self._open.get(key)
        if span is None or time_s - span.to_s > _MERGE_S:
            if span is not None:
                self._closed.append(span)
            self._open[key] = Span(link, other, time_s, time_s, force_n)
            return
        span.to_s = time_s
        span.max_force_n = max(span.max_force_n, force_n)

    def take(self, spans: Sequence[Span]) -> None:
        """Take the contacts of another process instead of those seen so far."""
        self._open.clear()
        self._closed = list(spans)

    def spans(self) -> tuple[Span, ...]:
        """Return all contacts so far, in order of their start."""
        return tuple(
            sorted([*self._closed, *self._open.values()], key=lambda span: (span.from_s, span.link))
        )


def _force_n(model: mujoco.MjModel, data: mujoco.MjData, contact: int) -> float:
    wrench: Float = np.zeros(6)
    mujoco.mj_contactForce(model, data, contact, wrench)
    return float(np.linalg.norm(wrench[:3]))
