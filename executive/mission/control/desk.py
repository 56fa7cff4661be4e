"""Takes the requests of people one by one, and asks the mission for what each means.

It is called by the loop where that can follow, never within a tick of the tree.
"""

from collections.abc import Callable, Mapping

from executive.control.request import Reply, Request, Verb
from executive.control.server import Asked, ControlServer
from executive.errors import ConfigError, DataError, RobotError, did_you_mean
from executive.events.control import ControlRequested
from executive.mission.control.standing import failed_leaves, running_leaves, standing
from executive.mission.mission import Mission
from executive.mission.operator import OpenQuestion
from executive.mission.phase import Phase
from executive.tree.leaf_nodes import RunNode
from executive.tree.orders import Order

MOST_STEPS = 1000
_AT_ONCE, _LOOKS_AT_ONCE = 8, 2  # a client that floods is served over several ticks
_ON_FAILURE = "on_failure"


class RefusedError(ConfigError):
    """A request makes no sense now; the message says why."""


class Desk:
    """Answers requests until `close`."""

    def __init__(self, mission: Mission, server: ControlServer) -> None:
        self._mission = mission
        self._server = server
        self._verbs: Mapping[Verb, Callable[[Request, str], str]] = {
            Verb.PAUSE: self._pause,
            Verb.RESUME: self._resume,
            Verb.STOP: self._stop,
            Verb.STEP: self._step,
            Verb.SKIP: self._order,
            Verb.RETRY: self._order,
            Verb.ANSWER: self._answer,
            Verb.RESET: self._reset,
        }

    def serve(self) -> None:
        """Answer what has been asked, as much of it as costs the tick nothing."""
        for waiting, most in ((self._server.asked, _AT_ONCE), (self._server.looks, _LOOKS_AT_ONCE)):
            for _ in range(min(most, len(waiting))):
                asked = waiting.popleft()
                self._server.reply(asked, self._reply(asked))

    def close(self) -> None:
        """Refuse what the mission did not come to."""
        for waiting in (self._server.asked, self._server.looks):
            while waiting:
                self._server.reply(waiting.popleft(), Reply(False, "the mission has ended"))

    def _reply(self, asked: Asked) -> Reply:
        request, person = asked.request, asked.person
        if request.verb is Verb.STATUS:
            return Reply(True, "", standing(self._mission))
        try:
            reply = Reply(True, self._done(request, f"{person.user} (ctl)"))
        except RefusedError as refused:
            reply = Reply(False, str(refused))
        event = ControlRequested(
            verb=request.verb,
            argument=request.argument,
            target=request.node,
            user=person.user,
            uid=person.uid,
            pid=person.pid,
            is_done=reply.is_done,
            reply=reply.text,
        )
        self._mission.record("", event)
        return reply

    def _done(self, request: Request, by: str) -> str:
        """Ask the mission for it; return what to reply.

        Raises:
            RefusedError: If it makes no sense now.
        """
        if self._mission.is_ending:
            raise RefusedError("the mission ends already")
        return self._verbs[request.verb](request, by)

    # --- verbs

    def _pause(self, request: Request, by: str) -> str:
        wishes = self._mission.wishes
        if request.argument == _ON_FAILURE:
            wishes.pause_on_failure = True
            return "the mission pauses when an action fails, until skip, retry or resume"
        if wishes.pause and not wishes.steps:
            raise RefusedError(f"it is paused already: {wishes.pause}")
        wishes.hold(f"paused by {by}")
        return "the machine is held, and mission time stands still"

    def _resume(self, request: Request, by: str) -> str:
        wishes, phase = self._mission.wishes, self._mission.phase
        if request.argument == _ON_FAILURE:
            wishes.pause_on_failure = False
        if wishes.pause:
            wishes.go_on(by)
            return "the mission goes on"
        if request.argument == _ON_FAILURE:
            return "the mission does not pause any more when an action fails"
        if phase is Phase.HELD:
            held = f"it is held: {self._mission.phase_reason}"
            raise RefusedError(f"{held}; it goes on by itself when that is well again")
        if phase is Phase.AWAITING_OPERATOR:
            raise RefusedError("it awaits an answer: use `answer`")
        raise RefusedError("it is not paused")

    def _stop(self, request: Request, by: str) -> str:
        self._mission.request_stop()
        return "the machine slows down along its path, and the mission ends"

    def _step(self, request: Request, by: str) -> str:
        ticks = request.argument or "1"
        if not (ticks.isdecimal() and len(ticks) < 5 and 1 <= int(ticks) <= MOST_STEPS):
            raise RefusedError(f"step takes 1 to {MOST_STEPS} ticks, got '{ticks}'")
        if not self._mission.wishes.pause:
            raise RefusedError(f"a step needs a paused mission, and it is {self._mission.phase}")
        if self._mission.questions:
            raise RefusedError("a question is open: answer it first")
        if self._mission.is_held:
            raise RefusedError("a watched condition holds it: wait until that is well again")
        self._mission.wishes.step(int(ticks), by)
        return f"{ticks} tick{'' if ticks == '1' else 's'}, then the pause goes on"

    def _order(self, request: Request, by: str) -> str:
        leaf = self._leaf(request.node)
        order = Order("skip" if request.verb is Verb.SKIP else "retry", by)
        refused = leaf.order(order)
        if refused:
            raise RefusedError(refused)
        if leaf.failure is not None and self._mission.wishes.pause:
            self._mission.wishes.go_on(by)
        what = "counts as done" if order.kind == "skip" else "begins again"
        later = ", when the mission goes on" if self._mission.wishes.pause else ""
        return f"{leaf.path} {what}{later}"

    def _answer(self, request: Request, by: str) -> str:
        put = [
            one for one in self._mission.questions if not request.node or one.node == request.node
        ]
        if not put:
            where = f" at {request.node}" if request.node else ""
            raise RefusedError(f"no question is open{where}")
        question, allowed = put[0].question, put[0].choices or ("yes", "no")
        if not isinstance(question, OpenQuestion) or not question.take(request.argument, "ctl"):
            near = did_you_mean(request.argument, allowed)
            raise RefusedError(f"'{request.argument}' is no answer to '{put[0].text}'{near}")
        given = question.answer()
        word = given if isinstance(given, str) else "yes" if given else "no"
        return f"answered: {put[0].text} {word}"

    def _reset(self, request: Request, by: str) -> str:
        robot = self._mission.services.plugins["robot"]
        latched = robot.latched()
        if not latched:
            raise RefusedError("no safe stop is latched")
        if not self._mission.pause.is_on:
            raise RefusedError("pause the mission first: it would go on at once")
        try:
            robot.reset()
        except (RobotError, DataError) as error:
            raise RefusedError(str(error)) from error
        return f"the safe stop is released: {latched}"

    def _leaf(self, node: str) -> RunNode:
        """Return the leaf that is meant: one that failed before one that runs.

        Raises:
            RefusedError: If none runs, several do, or the named one does not.
        """
        root = self._mission.root
        found = failed_leaves(root) or running_leaves(root)
        named = [leaf for leaf in running_leaves(root) if leaf.path == node]
        if node and not named:
            paths = [leaf.path for leaf in running_leaves(root)]
            raise RefusedError(f"no action runs at '{node}'{did_you_mean(node, paths)}")
        if not found:
            asks = bool(self._mission.questions)
            raise RefusedError("no action runs" + ("; use `answer`" if asks else ""))
        if len(found) > 1 and not node:
            paths = [leaf.path for leaf in found]
            raise RefusedError(f"several actions run, name one (--node): {', '.join(paths)}")
        return named[0] if node else found[0]
