"""What the desk replies to each request, and what it asks of the mission for it."""

from collections import deque
from types import SimpleNamespace

import py_trees
import pytest
from py_trees.common import Status

from executive.control.request import Person, Request, Verb
from executive.control.server import Asked
from executive.errors import RobotError
from executive.mission.control.desk import Desk
from executive.mission.hold import Hold
from executive.mission.operator import Answered, OpenQuestion
from executive.mission.phase import Phase
from executive.mission.wishes import Wishes
from executive.tree.leaf_nodes import RunNode

CLIENT = SimpleNamespace(person=Person(1, 2))


class Leaf(RunNode):
    """An action under way, of which the desk sees its place, its failure and what it is told."""

    def __init__(self, path, failure=None, refuses=""):
        py_trees.behaviour.Behaviour.__init__(self, path)
        self.path, self.given, self.refuses = path, [], refuses
        self.broken, self.status = failure, Status.RUNNING

    failure = property(lambda self: self.broken)

    def order(self, order):
        self.given.append((order.kind, order.by))
        return self.refuses


class Robot:
    def __init__(self):
        self.why, self.refuses = "", None

    def latched(self):
        return self.why

    def reset(self):
        if self.refuses:
            raise self.refuses
        self.why = ""


class Mission:
    def __init__(self):
        self.wishes, self.questions, self.robot = Wishes(), [], Robot()
        self.phase, self.phase_reason = Phase.RUNNING, ""
        self.is_ending = self.is_held = self.is_stopped = False
        self.pause = SimpleNamespace(is_on=False)
        self.services = SimpleNamespace(plugins={"robot": self.robot})
        self.root = py_trees.composites.Parallel(
            "main", py_trees.common.ParallelPolicy.SuccessOnAll()
        )
        self.recorded = []

    def record(self, node, event):
        self.recorded.append(event)

    def request_stop(self):
        self.is_stopped = True

    def runs(self, *leaves):
        self.root.add_children(leaves)
        return leaves


class Server:
    def __init__(self):
        self.asked, self.looks, self.replies = deque(), deque(), []

    def reply(self, asked, reply):
        self.replies.append(reply)


@pytest.fixture
def mission():
    return Mission()


@pytest.fixture
def ask(mission, monkeypatch):
    """Ask the desk for something, and return its reply."""
    monkeypatch.setattr(Person, "user", "ada")
    server = Server()
    desk = Desk(mission, server)

    def asked(verb, argument="", node=""):
        server.asked.append(Asked(Request(Verb(verb), argument, node), CLIENT))
        desk.serve()
        return server.replies[-1]

    return asked


def test_the_journal_is_told_who_asked_for_what_and_what_became_of_it(mission, ask):
    ask("resume")
    ask("pause")
    refused, done = mission.recorded
    assert (refused.verb, refused.user, refused.uid, refused.pid) == ("resume", "ada", 1, 2)
    assert (refused.is_done, refused.reply) == (False, "it is not paused")
    assert (done.verb, done.is_done) == ("pause", True)
    assert "the machine is held" in done.reply


def test_a_mission_that_ends_takes_no_request(mission, ask):
    mission.is_ending = True
    assert ask("pause").text == "the mission ends already"
    assert not mission.wishes.pause


def test_a_pause_is_wanted_once(mission, ask):
    assert ask("pause").is_done
    assert mission.wishes.pause == "paused by ada (ctl)"
    again = ask("pause")
    assert (again.is_done, again.text) == (False, "it is paused already: paused by ada (ctl)")


def test_a_pause_is_wanted_again_while_single_ticks_are_made(mission, ask):
    ask("pause")
    ask("step", "3")
    assert ask("pause").is_done
    assert mission.wishes.steps == 0


def test_a_pause_on_failure_is_wanted_until_it_is_not(mission, ask):
    assert ask("pause", "on_failure").is_done
    assert mission.wishes.pause_on_failure
    assert not mission.wishes.pause
    told = "the mission does not pause any more when an action fails"
    assert ask("resume", "on_failure").text == told
    assert not mission.wishes.pause_on_failure
    ask("pause")
    ask("pause", "on_failure")
    assert ask("resume", "on_failure").text == "the mission goes on"
    assert (mission.wishes.pause, mission.wishes.pause_on_failure) == ("", False)


def test_a_resume_leaves_the_pause_on_failure(mission, ask):
    ask("pause", "on_failure")
    ask("pause")
    assert ask("resume").is_done
    assert mission.wishes.pause_on_failure
    assert mission.wishes.resumed == "resumed by ada (ctl)"


@pytest.mark.parametrize(
    ("phase", "told"),
    [(Phase.RUNNING, "it is not paused"), (Phase.HELD, "it is held: rain; it goes on by itself"),
     (Phase.AWAITING_OPERATOR, "it awaits an answer: use `answer`")],
)  # fmt: skip
def test_what_is_not_paused_is_not_resumed(mission, ask, phase, told):
    mission.phase, mission.phase_reason = phase, "rain"
    reply = ask("resume")
    assert not reply.is_done
    assert reply.text.startswith(told)


def test_a_stop_is_asked_of_the_mission(mission, ask):
    reply = ask("stop")
    assert reply.is_done
    assert reply.text == "the machine slows down along its path, and the mission ends"
    assert mission.is_stopped


@pytest.mark.parametrize(("word", "ticks"), [("", 1), ("1", 1), ("2", 2), ("1000", 1000)])
def test_a_step_makes_as_many_ticks_as_are_asked_for(mission, ask, word, ticks):
    ask("pause")
    reply = ask("step", word)
    assert reply.is_done
    assert reply.text.startswith("1 tick," if ticks == 1 else f"{ticks} ticks,")
    assert mission.wishes.steps == ticks


@pytest.mark.parametrize("word", ["0", "1001", "-1", "two", "1.5", "00001", "9999"])
def test_a_step_of_no_number_of_ticks_is_refused(mission, ask, word):
    ask("pause")
    assert ask("step", word).text == f"step takes 1 to 1000 ticks, got '{word}'"
    assert mission.wishes.steps == 0


def test_a_step_needs_a_mission_that_is_paused_and_nothing_in_its_way(mission, ask):
    assert "needs a paused mission, and it is running" in ask("step").text
    ask("pause")
    mission.is_held = True
    assert "a watched condition holds it" in ask("step").text
    mission.questions = [SimpleNamespace(node="main/0")]
    assert "answer it first" in ask("step").text
    mission.questions, mission.is_held = [], False
    assert ask("step").is_done


def test_a_skip_and_a_retry_go_to_the_action_that_runs(mission, ask):
    (leaf,) = mission.runs(Leaf("main/0:swing"))
    assert ask("skip").text == "main/0:swing counts as done"
    assert ask("retry").text == "main/0:swing begins again"
    assert leaf.given == [("skip", "ada (ctl)"), ("retry", "ada (ctl)")]
    ask("pause")
    assert ask("skip").text == "main/0:swing counts as done, when the mission goes on"
    assert mission.wishes.pause


def test_a_failed_action_that_is_decided_lets_a_paused_mission_go_on(mission, ask):
    mission.runs(Leaf("main/0:swing", failure="no path"))
    mission.wishes.hold("an action failed")
    assert ask("retry").text == "main/0:swing begins again"
    assert not mission.wishes.pause
    assert mission.wishes.resumed == "resumed by ada (ctl)"
    mission.wishes.resumed = ""
    assert ask("skip").is_done
    assert not mission.wishes.resumed  # it was not paused any more


def test_an_action_that_refuses_an_order_stays_as_it_is(mission, ask):
    mission.runs(Leaf("main/0:close", failure="slip", refuses="it cannot be repeated"))
    mission.wishes.hold("an action failed")
    assert ask("retry").text == "it cannot be repeated"
    assert mission.wishes.pause


def test_one_of_several_actions_has_to_be_named_unless_one_has_failed(mission, ask):
    first, second = mission.runs(Leaf("main/0:swing"), Leaf("main/1:scan"))
    several = ask("skip").text
    assert several == "several actions run, name one (--node): main/0:swing, main/1:scan"
    assert ask("skip", node="main/1:scan").is_done
    assert (len(first.given), len(second.given)) == (0, 1)
    assert "no action runs at 'main/1:scna'. Did you mean 'main/1:scan'" in (
        ask("skip", node="main/1:scna").text
    )
    first.broken = "no path"
    assert ask("skip").is_done
    assert (len(first.given), len(second.given)) == (1, 1)
    assert ask("skip", node="main/1:scan").is_done
    assert (len(first.given), len(second.given)) == (1, 2)


def test_where_no_action_runs_nothing_is_skipped(mission, ask):
    (leaf,) = mission.runs(Leaf("main/0:swing"))
    leaf.status = Status.SUCCESS
    assert ask("skip").text == "no action runs"
    mission.questions = [SimpleNamespace(node="main/0")]
    assert ask("skip").text == "no action runs; use `answer`"
    assert leaf.given == []


def put(node, text, choices=()):
    question = OpenQuestion(text, None, choices)
    return SimpleNamespace(node=node, text=text, choices=choices, question=question)


def test_an_answer_goes_to_the_oldest_question_or_to_the_named_one(mission, ask):
    first, second = mission.questions = [put("main/0", "Begin?"), put("main/1", "How?", ("a", "b"))]
    assert ask("answer", "b", "main/1").text == "answered: How? b"
    assert second.question.source() == "ctl"
    assert first.question.answer() is None
    assert ask("answer", "no").text == "answered: Begin? no"


def test_what_is_no_answer_is_refused_with_the_nearest(mission, ask):
    assert ask("answer", "yes").text == "no question is open"
    assert ask("answer", "yes", "main/7").text == "no question is open at main/7"
    mission.questions = [put("main/0", "Begin?")]
    assert ask("answer", "yse").text == "'yse' is no answer to 'Begin?'. Did you mean 'yes'?"
    mission.questions[0].question = Answered(True, "option")
    assert not ask("answer", "yes").is_done


def test_a_latched_stop_is_released_in_a_pause_alone(mission, ask):
    assert ask("reset").text == "no safe stop is latched"
    mission.robot.why = "the beacon fell silent"
    assert "pause the mission first" in ask("reset").text
    mission.pause.is_on = True
    mission.robot.refuses = RobotError("the chain is open")
    assert ask("reset").text == "the chain is open"
    assert mission.robot.why
    mission.robot.refuses = None
    assert ask("reset").text == "the safe stop is released: the beacon fell silent"
    assert not mission.robot.why


def test_eight_requests_are_served_in_one_go_and_the_others_wait(mission):
    server = Server()
    desk = Desk(mission, server)
    server.asked.extend(Asked(Request(Verb.STOP), CLIENT) for _ in range(9))
    desk.serve()
    assert (len(server.replies), len(server.asked)) == (8, 1)
    server.looks.append(Asked(Request(Verb.STATUS), CLIENT))
    desk.close()
    assert [reply.text for reply in server.replies[8:]] == ["the mission has ended"] * 2
    assert not any(reply.is_done for reply in server.replies[8:])


# --- what people want


def test_a_paused_mission_makes_the_ticks_of_a_step_and_is_paused_again():
    wishes = Wishes()
    wishes.hold("paused by ada")
    wishes.step(2, "ada")
    assert wishes.resumed == "2 ticks for ada"
    for left in (2, 1):
        assert wishes.steps == left
        assert wishes.phase(None, is_asking=False) == (Phase.RUNNING, "")
        wishes.ticked()
    wishes.ticked()  # a tick that ends in the pause costs no step
    assert wishes.steps == 0
    assert wishes.phase(None, is_asking=False) == (Phase.PAUSED, "paused by ada")
    wishes.step(1, "ada")
    assert wishes.resumed == "1 tick for ada"


def test_a_pause_outranks_a_hold_and_a_hold_a_question():
    wishes, held = Wishes(), Hold("rain", 0.0, None)
    assert wishes.phase(None, is_asking=True) == (Phase.AWAITING_OPERATOR, "")
    assert wishes.phase(held, is_asking=True) == (Phase.HELD, "rain")
    wishes.toggle()
    assert wishes.phase(held, is_asking=True) == (Phase.PAUSED, "paused by the operator")
    wishes.step(5, "ada")
    wishes.toggle()
    assert wishes.phase(None, is_asking=False) == (Phase.RUNNING, "")
    assert (wishes.steps, wishes.resumed) == (0, "resumed by the operator")
