"""The account of a run: every count of the report, and what failed first and last."""

from dataclasses import asdict

import numpy as np
import pytest

from executive.events.mission import Fault, MissionEnded, PluginFailed, VerdictGiven
from executive.events.node import NodeEnded, NodeNotRetried, NodeResult, NodeRetried, NodeStarted
from executive.events.site import (
    PlaceNotFound,
    SiteScanned,
    SiteSegmented,
    SlotPlace,
    SlotsFound,
    SurveyRegistered,
)
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    GraspsPlanned,
    JawsClosedOnNothing,
    PlacementVerified,
    StoneGrasped,
    StoneLost,
    StoneReleased,
    StoneSetAside,
    StoneSoughtAgain,
)
from executive.journal import Journal
from executive.messages.verdict import Trouble
from executive.mission.record.account import Account

FAULT = Fault("motion plugin 'x'", "motion", "x", "move", "main", "KeyError: 1", "x.py:3", "")


def account_of(*events, verifies=False):
    """Return the account of events, one a second."""
    journal, account = Journal(), Account(verifies=verifies)
    for second, event in enumerate(events, 1):
        journal.append(second, float(second), "main", event)
    for entry in journal.newest:
        account.add(entry)
    return account


def attempt(stone):
    return AttemptStarted(stone, np.zeros(3), GraspRecord(np.eye(4), 1.0, 1.0, {}), ())


def grasped(stone):
    return StoneGrasped(stone, 0.4, 100, 0)


def released(stone):
    return StoneReleased(stone, stone, np.zeros(3), np.eye(4), np.eye(4))


def looked_at(stone, seen, rule=""):
    return PlacementVerified(stone, stone, seen, 0.1, 0.0, rule, "" if seen == "placed" else "off")


def verdict(trouble):
    return VerdictGiven("jaws", trouble, "")


def registered(accepted, reason=""):
    return SurveyRegistered(accepted, reason, 0.1, 0.5, 1.0, 3, np.eye(4))


def test_an_account_of_nothing_counts_nothing():
    account = Account()
    assert set(asdict(account.counts()).values()) == {0}
    assert (account.ended_s, account.placed, account.picks()) == (0.0, 0, [])
    assert (account.last, account.registered, account.has_ended) == (None, None, False)
    assert (account.stones_found, account.slots, account.given_up) == (0, {}, set())


def repeated(event, times):
    return [event() for _ in range(times)]


@pytest.mark.parametrize(
    ("name", "event"),
    [
        ("empty", lambda: JawsClosedOnNothing(1, "")),
        ("scans", lambda: SiteScanned(100)),
        ("not_retried", lambda: NodeNotRetried(1, 3, "too heavy")),
        ("plugin_failures", lambda: PluginFailed(FAULT)),
        ("corrected", lambda: looked_at(1, "off", "correct")),
        ("registrations", lambda: registered(accepted=False)),
    ],
)
def test_what_happens_three_times_counts_three_times_and_under_its_name_alone(name, event):
    counts = account_of(*repeated(event, 3)).counts()
    assert {one: count for one, count in asdict(counts).items() if count} == {name: 3}


@pytest.mark.parametrize("rule", ["", "keep", "set_aside"])
def test_only_a_stone_that_is_to_be_picked_again_counts_as_corrected(rule):
    assert account_of(looked_at(1, "off", rule)).counts().corrected == 0


def test_the_newest_accepted_registration_is_kept():
    first, second, refused = registered(True, "a"), registered(True, "b"), registered(False, "c")
    account = account_of(first, second, refused)
    assert account.registered is second
    counts = account.counts()
    assert (counts.registrations, counts.registrations_accepted) == (3, 2)


def test_the_stones_of_the_last_segmentation_are_told_and_all_are_known():
    account = account_of(SiteSegmented((1, 2, 3), (9, 9, 9)), SiteSegmented((3, 4), (9, 9)))
    assert account.stones_found == 2
    counts = account.counts()
    assert (counts.known, counts.untouched) == (4, 4)


def test_a_stone_that_is_picked_though_no_segmentation_found_it_is_known():
    counts = account_of(SiteSegmented((1,), (9,)), attempt(2)).counts()
    assert (counts.known, counts.untouched) == (2, 1)


@pytest.mark.parametrize(
    ("seen", "lost"),
    [
        (SiteSegmented((1, 3), (9, 9)), 1),
        (StoneSoughtAgain(1, (1, 2), "registration", ""), 0),
        (StoneSoughtAgain(1, (), "registration", "nothing is there"), 2),
    ],
)
def test_a_lost_stone_is_lost_until_it_is_seen(seen, lost):
    assert account_of(StoneLost(1, "fell"), StoneLost(2, "fell"), seen).counts().lost == lost


def test_each_place_of_a_stone_is_told_by_its_slot_and_the_newest_place_counts():
    def found(*slots):
        return SlotsFound(tuple(SlotPlace(number, np.array(at)) for number, at in slots))

    first = found((1, (1.0, 0.0, 0.0)), (2, (2.0, 0.0, 0.0)))
    account = account_of(first, found((2, (2.5, 0.0, 0.0))))
    assert {slot: float(at[0]) for slot, at in account.slots.items()} == {1: 1.0, 2: 2.5}


def test_the_end_is_told_with_the_time_of_the_newest_entry():
    account = account_of(SiteScanned(1), MissionEnded("success", ""))
    assert account.has_ended
    assert account.ended_s == 2.0


@pytest.mark.parametrize(
    ("troubles", "slips", "drops"),
    [
        ([Trouble.SLIP], 1, 0),
        ([Trouble.DROP], 0, 1),
        ([Trouble.SLIP, Trouble.SLIP], 1, 0),
        ([Trouble.DROP, Trouble.DROP], 0, 1),
        ([Trouble.SLIP, Trouble.DROP], 0, 1),
        ([Trouble.DROP, Trouble.SLIP], 0, 1),
    ],
)
@pytest.mark.parametrize("between", [attempt(1), grasped(1)])
def test_a_hold_has_one_trouble_and_a_fall_outweighs_a_slip(troubles, slips, drops, between):
    story = [grasped(1), *map(verdict, troubles)]
    counts = account_of(*story).counts()
    assert (counts.slips, counts.drops) == (slips, drops)
    twice = account_of(*story, between, *map(verdict, troubles)).counts()
    assert (twice.slips, twice.drops) == (2 * slips, 2 * drops)


def test_stones_off_unseen_and_unverified_are_counted_apart():
    def stone(number, *after):
        return [attempt(number), grasped(number), released(number), *after]

    account = account_of(
        *stone(1, looked_at(1, "placed")),
        *stone(2, looked_at(2, "off", "keep")),
        *stone(3, looked_at(3, "off", "keep")),
        *stone(4, looked_at(4, "unseen", "keep")),
        *(attempt(5), StoneSetAside(5, "no grasp")),
        *stone(6),
        verifies=True,
    )
    counts = account.counts()
    assert (counts.picks, counts.placed, counts.attempts) == (6, 1, 6)
    assert (counts.off, counts.unverified, counts.set_aside) == (2, 1, 1)
    assert (counts.unseen, counts.first_attempt, account.placed) == (0, 1, 1)


def test_a_stone_that_is_set_aside_without_a_final_failure_is_not_given_up():
    assert account_of(StoneSetAside(1, "every attempt failed")).given_up == set()


def no_place(reason):
    return PlaceNotFound("wall", 1, True, reason, {})


@pytest.mark.parametrize(
    ("reason", "given_up"),
    [("nothing_fits", set()), ("out_of_time", set()), ("all_too_heavy", {1})],
)
def test_a_stone_without_a_place_on_what_stands_is_not_given_up_and_one_too_heavy_is(
    reason, given_up
):
    final = NodeNotRetried(1, 4, "no other place")
    account = account_of(GraspsPlanned(1, 2, {}), no_place(reason), final, StoneSetAside(1, ""))
    assert account.given_up == given_up


def test_what_a_stone_had_no_place_for_says_nothing_of_the_next_one():
    final = NodeNotRetried(1, 4, "")
    later = [StoneSetAside(1, ""), final, StoneSetAside(2, "too heavy")]
    assert account_of(no_place("nothing_fits"), final, *later).given_up == {2}


@pytest.mark.parametrize("between", [GraspsPlanned(1, 2, {}), SiteSegmented((1,), (9,))])
def test_a_final_failure_before_the_newest_plan_gives_no_stone_up(between):
    final = NodeNotRetried(1, 3, "too heavy")
    assert account_of(final, StoneSetAside(1, "")).given_up == {1}
    assert account_of(final, between, StoneSetAside(1, "")).given_up == set()
    assert account_of(final, StoneSetAside(1, ""), StoneSetAside(2, "")).given_up == {1}


UNDER = "main/0:fallback"


def account_of_nodes(*entries):
    """Return the account of events of nodes, each with the path of its node."""
    journal = Journal()
    for node, event in entries:
        journal.append(0, 0.0, node, event)
    return Account.of(journal.newest)


def failed(reason):
    return NodeEnded(NodeResult.FAILURE, reason)


def test_the_last_failure_is_the_newest_below_a_path_without_recoveries():
    story = [
        (f"{UNDER}/1:lift", failed("no path up")),
        (f"{UNDER}/0:grasp", failed("the jaws closed on nothing")),
        (f"{UNDER}/0:grasp@on_failure/0:open", failed("the jaws are stuck")),
        (f"{UNDER}/2:place", NodeEnded(NodeResult.SUCCESS, "it went well")),
        (f"{UNDER}-two/0:grasp", failed("of another node")),
        (UNDER, failed("of the node itself")),
    ]
    account = account_of_nodes(*story)
    assert account.last_failure(UNDER) == "the jaws closed on nothing"
    assert account.last_failure("main/7:sequence") == ""
    again = account_of_nodes(*story, (f"{UNDER}/1:lift", failed("no path down")))
    assert again.last_failure(UNDER) == "no path down"


def test_a_recovery_tells_its_own_failures_where_it_is_asked_for_them():
    recovery = f"{UNDER}@on_failure/0:open"
    account = account_of_nodes((f"{recovery}/0:jaws", failed("the jaws are stuck")))
    assert account.last_failure(recovery) == "the jaws are stuck"


def test_the_first_failure_is_of_the_outermost_retry_since_the_node_began():
    outer, inner = f"{UNDER}/0:move@retry", f"{UNDER}/0:move/1:grasp@retry"
    story = [
        (UNDER, NodeStarted()),
        (inner, NodeRetried(1, 2, "the jaws closed on nothing")),
        (outer, NodeRetried(1, 3, "slip")),
        (outer, NodeRetried(2, 3, "no grasp is left")),
    ]
    assert account_of_nodes(*story).first_failure(UNDER) == "slip"
    assert account_of_nodes(*story[:2]).first_failure(UNDER) == "the jaws closed on nothing"
    assert account_of_nodes(*story, (UNDER, NodeStarted())).first_failure(UNDER) == ""
    never_begun = [("other", NodeStarted()), (outer, NodeRetried(1, 3, "slip"))]
    assert account_of_nodes(*never_begun).first_failure(UNDER) == "slip"
