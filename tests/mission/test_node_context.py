"""What a leaf asks of a mission is asked of its monitors, in their order, and of its records."""

from types import SimpleNamespace

import pytest

from executive.errors import ConfigError
from executive.events.mission import PauseEnded
from executive.journal import Journal
from executive.messages.weight import Weight
from executive.mission.context import NodeContext


class Monitor:
    """Answers as it was made, and counts the holds that it was told of."""

    def __init__(self, weight=None, payload=None, standing=None):
        self._weight, self._payload, self._standing = weight, payload, standing
        self.holds, self.carries = 0, 0

    def begin_hold(self):
        self.holds += 1

    def begin_carry(self):
        self.carries += 1

    def carry_over(self, below):
        self.below = below

    def end_hold(self):
        self.holds -= 1

    def weight(self):
        return self._weight

    def payload_kg(self, joints):
        assert joints == "joints"
        return self._payload

    def standing(self):
        return self._standing


def context(*monitors, **services):
    given = {
        "streams": SimpleNamespace(monitors=monitors),
        "joints": lambda: "joints",
        "verdicts": [],
        "trial_weights": [],
        "regions": {},
    }
    return NodeContext(SimpleNamespace(**given | services), "main/scan", {})


@pytest.mark.parametrize("ask", ["weight", "payload_kg", "standing"])
@pytest.mark.parametrize(
    ("told", "answer"), [((), None), ((None,), None), ((None, 0.0, 5.0), 0.0), ((5.0, 0.0), 5.0)]
)
def test_the_first_monitor_that_knows_answers(ask, told, answer):
    name = ask.removesuffix("_kg")
    assert getattr(context(*(Monitor(**{name: one}) for one in told)), ask)() == answer


def test_every_monitor_is_told_of_a_hold_and_earlier_verdicts_are_forgotten():
    monitors, verdicts = (Monitor(), Monitor()), ["slip"]
    asked = context(*monitors, verdicts=verdicts)
    assert asked.verdicts() == ("slip",)
    asked.begin_hold()
    assert [one.holds for one in monitors] == [1, 1]
    assert asked.verdicts() == ()
    asked.begin_carry()
    assert [one.carries for one in monitors] == [1, 1]
    asked.carry_over("the ground")
    assert [one.below for one in monitors] == ["the ground", "the ground"]
    verdicts.append("drop")
    asked.end_hold()
    assert [one.holds for one in monitors] == [0, 0]
    assert asked.verdicts() == ("drop",)


@pytest.mark.parametrize("end", ["end_hold", "begin_hold"])
def test_what_a_trial_lift_weighed_is_known_until_the_end_of_the_hold(end):
    asked = context(Monitor())
    asked.begin_hold()
    assert asked.trial_weight() is None
    asked.begin_carry(Weight(1200.0, 90.0))
    assert asked.trial_weight() == Weight(1200.0, 90.0)
    getattr(asked, end)()
    assert asked.trial_weight() is None


def test_a_region_is_known_by_its_name_alone():
    asked = context(regions={"yard": "a region"})
    assert asked.region("yard") == "a region"
    with pytest.raises(ConfigError, match=r"no region 'yrd'\. Did you mean 'yard'"):
        asked.region("yrd")


def test_a_stone_is_given_up_and_a_failure_is_told_by_the_missions_account():
    account = SimpleNamespace(
        given_up={3}, last_failure=lambda node: f"last in {node}", first_failure=lambda n: f"1 {n}"
    )
    asked = context(account=account)
    assert asked.is_given_up(3)
    assert not asked.is_given_up(4)
    assert asked.last_failure() == "last in main"  # of the nodes beside the leaf
    assert asked.first_failure() == "1 main"


def test_a_leaf_that_follows_the_journal_is_told_each_entry_once():
    journal = Journal()
    journal.append(1, 1.0, "main", PauseEnded(1.0))
    news = context(journal=journal).follow_journal()
    assert list(news()) == []
    journal.append(2, 2.0, "main", PauseEnded(2.0))
    journal.append(3, 3.0, "main", PauseEnded(3.0))
    assert [entry.time_s for entry in news()] == [2.0, 3.0]
    assert list(news()) == []
