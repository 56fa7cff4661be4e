"""The report's picks are read from the journal."""

import numpy as np

from executive.events.event import plain
from executive.events.mission import MissionEnded, VerdictGiven
from executive.events.node import NodeNotRetried, NodeRetried, NodeStarted
from executive.events.site import SiteSegmented
from executive.events.stone import (
    AttemptStarted,
    GraspRecord,
    GraspsPlanned,
    JawsClosedOnNothing,
    PlacementVerified,
    StoneGrasped,
    StoneLost,
    StoneNotLifted,
    StoneRealigned,
    StoneReleased,
    StoneSeenInJaws,
    StoneSetAside,
    StoneSoughtAgain,
    StonesTakenUpAgain,
)
from executive.journal import Journal
from executive.messages.verdict import Trouble
from executive.mission.picks import attempts_from
from executive.mission.record.account import Account
from executive.mission.selections import verifies
from executive.tree.load import load_mission


def journal_of(*entries):
    journal = Journal()
    for time_s, event in entries:
        journal.append(int(time_s * 20), time_s, "main", event)
    return list(journal.newest)


def attempt(stone):
    grasp = GraspRecord(np.eye(4), 1.2, 1.0, {})
    return AttemptStarted(stone, np.array([1.0, 2.0, 0.5]), grasp, ())


def grasped(stone):
    return StoneGrasped(stone, 0.4, 100, 0)


def released(stone, slot=4):
    return StoneReleased(stone, slot, np.array([5.0, 0, 0]), np.array([[1]]), np.array([[2]]))


def verdict(trouble, detail):
    return VerdictGiven("monitor", trouble, detail)


STORY = journal_of(
    (10, attempt(1)),
    (14, JawsClosedOnNothing(1, "nothing there")),
    (20, attempt(1)),
    (25, grasped(1)),
    (40, released(1)),
    (50, StoneRealigned(1, True, "alignment", "", 0.01, 0.9, np.array([[3]]))),
    (60, attempt(2)),
    (70, verdict(Trouble.DROP, "900 kg gone")),
    (71, verdict(Trouble.SLIP, "jaws closed further")),
    (80, StoneSetAside(2, "three attempts failed")),
)


def test_tells_each_stones_attempts_and_their_outcomes():
    first, second = Account.of(STORY).picks()
    assert [t.outcome for t in first.tries] == ["empty", "placed"]
    assert [(t.outcome, t.reason) for t in second.tries] == [("drop", "900 kg gone")]


def test_a_realigned_pose_replaces_the_grippers_estimate():
    report = plain(Account.of(STORY).picks()[0].as_report())
    assert (report["slot"], report["placed"], report["estimated_pose"]) == (4, True, [[3]])


def test_a_stone_that_was_set_aside_is_not_placed():
    report = Account.of(STORY).picks()[1].as_report()
    assert (report.placed, report.set_aside) == (False, "three attempts failed")


def test_attempts_come_in_order_of_time():
    assert [a.started_s for a in attempts_from(Account.of(STORY).picks())] == [10, 20, 60]


def test_counts_what_a_person_asks_for():
    counts = Account.of(STORY).counts()
    assert counts.picks == 2
    assert (counts.placed, counts.first_attempt, counts.attempts) == (1, 0, 3)
    assert (counts.drops, counts.slips, counts.empty, counts.set_aside) == (1, 0, 1, 1)


def test_a_slip_that_ends_in_a_fall_is_one_fall():
    slip, fall = verdict(Trouble.SLIP, "jaws closed further"), verdict(Trouble.DROP, "gone")
    story = journal_of((10, attempt(1)), (20, grasped(1)), (30, slip), (31, fall), (40, attempt(1)))
    account = Account.of(story)
    (pick,) = account.picks()
    assert (pick.tries[0].outcome, pick.tries[0].reason) == ("drop", "gone")
    assert (account.counts().drops, account.counts().slips) == (1, 0)


def test_a_trial_lift_that_found_no_hanging_stone_is_how_an_attempt_ended():
    """What comes of it as it is let down again, such as a fall, follows from that."""
    refused, fall = StoneNotLifted(1, 0.2, 900.0, 1400.0), verdict(Trouble.DROP, "gone")
    story = journal_of((10, attempt(1)), (20, grasped(1)), (25, refused), (27, fall))
    ((only,),) = (pick.as_report().attempts for pick in Account.of(story).picks())
    assert (only.outcome, only.ended_s) == ("not lifted", 27)
    assert only.reason == "900 of at least 1400 kg hang in the jaws"


def test_a_stone_that_a_look_found_shifted_in_the_jaws_is_how_an_attempt_ended():
    told = "stone 1 does not lie in the jaws as expected"
    refused = StoneSeenInJaws(1, False, "rmse 5 cm", 9, None, None, None, None, told)
    fall = verdict(Trouble.DROP, "gone")
    story = journal_of((10, attempt(1)), (20, grasped(1)), (25, refused), (27, fall))
    ((only,),) = (pick.as_report().attempts for pick in Account.of(story).picks())
    assert (only.outcome, only.reason) == ("shifted", told)


def test_a_look_at_a_stone_that_is_carried_on_ends_no_attempt():
    kept = StoneSeenInJaws(1, False, "rmse 5 cm", 9, None, None, None, None)
    story = journal_of((10, attempt(1)), (20, grasped(1)), (25, kept), (40, attempt(1)))
    first, _ = next(pick.as_report().attempts for pick in Account.of(story).picks())
    assert (first.outcome, first.reason) == ("unfinished", "")


def test_an_attempt_that_no_stone_tells_the_end_of_has_the_reason_of_what_failed():
    """A stone that hangs, and has no slot that the machine may carry it to, is put back."""
    failure, later = NodeRetried(1, 3, "no path to any of 9 slots"), NodeRetried(2, 3, "no grasp")
    story = journal_of((10, attempt(1)), (20, failure), (21, later), (30, attempt(1)))
    first, second = next(pick.as_report().attempts for pick in Account.of(story).picks())
    assert (first.outcome, first.reason) == ("unfinished", "no path to any of 9 slots")
    assert (second.outcome, second.reason) == ("unfinished", "")
    stopped = journal_of((10, attempt(1)), (22, MissionEnded("stopped", "by the operator")))
    ((only,),) = (pick.as_report().attempts for pick in Account.of(stopped).picks())
    assert (only.outcome, only.reason) == ("unfinished", "by the operator")
    set_aside = journal_of((10, attempt(1)), (20, StoneSetAside(1, "no place")))
    ((last,),) = (pick.as_report().attempts for pick in Account.of(set_aside).picks())
    assert (last.outcome, last.reason) == ("unfinished", "no place")


def test_what_was_tried_again_within_an_attempt_is_not_how_it_ended():
    again, slip = NodeRetried(1, 2, "no path"), verdict(Trouble.SLIP, "jaws closed further")
    ends = [(slip, ("slip", "jaws closed further")), (released(1), ("placed", ""))]
    for end, told in ends:
        story = journal_of((10, attempt(1)), (20, again), (30, end))
        ((only,),) = (pick.as_report().attempts for pick in Account.of(story).picks())
        assert (only.outcome, only.reason) == told


def test_a_slip_of_the_next_attempt_is_another_one():
    slip = verdict(Trouble.SLIP, "jaws closed further")
    story = journal_of((10, attempt(1)), (20, slip), (30, attempt(1)), (40, slip))
    assert Account.of(story).counts().slips == 2


def test_a_stone_whose_failure_was_final_is_given_up():
    unplanned = GraspsPlanned(3, 0, {"too_heavy": 1})
    story = journal_of(
        (5, NodeNotRetried(1, 10, "fewer than three stones")), (8, SiteSegmented((1, 3), (9, 9))),
        (10, StoneSetAside(1, "no place is free")),
        (20, unplanned), (21, NodeNotRetried(1, 3, "too heavy")), (22, StoneSetAside(3, "")),
        (30, unplanned), (40, StoneSetAside(4, "every attempt failed")),
    )  # fmt: skip
    assert Account.of(story).given_up == {3}


def looked_at(stone, seen, rule=""):
    off_m = 0.36 if seen == "off" else 0.04
    reason = "is 0.36 m off its place" if seen == "off" else ""
    return PlacementVerified(stone, 4, seen, off_m, 0.0, rule, reason)


def test_placed_is_what_was_seen():
    story = journal_of(
        (10, attempt(1)), (40, released(1)), (50, looked_at(1, "off", "correct")),
        (60, attempt(1)), (90, released(1)), (95, looked_at(1, "placed")),
        (100, attempt(2)), (140, released(2)), (150, looked_at(2, "off", "keep")),
        (160, attempt(3)), (190, released(3)), (195, looked_at(3, "unseen", "correct")),
        (195, StoneLost(3, "nowhere")),
    )  # fmt: skip
    account = Account.of(story)
    first, second, third = (pick.as_report() for pick in account.picks())
    assert [t.outcome for t in first.attempts] == ["off", "placed"]
    assert [pick.placed for pick in (first, second, third)] == [True, False, False]
    assert [pick.seen for pick in (first, second, third)] == ["placed", "off", "unseen"]
    told = ("placed", "off", "unseen", "lost", "corrected", "first_attempt")
    assert [getattr(account.counts(), name) for name in told] == [1, 1, 0, 1, 2, 0]


def test_a_placed_stone_that_is_lost_later_is_not_placed_until_it_is_again():
    story = [
        (10, attempt(1)), (40, released(1)), (50, looked_at(1, "placed")),
        (60, StoneLost(1, "is not seen at its place")),
    ]  # fmt: skip
    counts = Account.of(journal_of(*story)).counts()
    assert (counts.placed, counts.lost) == (0, 1)
    story += [
        (65, StoneSoughtAgain(1, (1,), "registration", "")),
        (70, attempt(1)), (90, released(1, slot=5)), (95, looked_at(1, "placed")),
    ]  # fmt: skip
    counts = Account.of(journal_of(*story)).counts()
    assert (counts.placed, counts.lost) == (1, 0)


def test_the_first_cause_of_a_stone_that_is_given_up_is_known():
    journal, under = Journal(), "main/0:fallback"
    for node, event in [
        (under, NodeStarted()),
        (f"{under}/0:move/1:x@retry", NodeRetried(1, 2, "the jaws closed on nothing")),
        (f"{under}/0:move@on_failure/0:x@retry", NodeRetried(1, 3, "no path up")),
        (f"{under}/0:move@retry", NodeRetried(1, 3, "slip: jaws 0.5 m open")),
        (f"{under}/0:move@retry", NodeRetried(2, 3, "no grasp is left")),
    ]:
        journal.append(0, 0.0, node, event)
    assert Account.of(journal.newest).first_failure(under) == "slip: jaws 0.5 m open"
    journal.append(0, 0.0, under, NodeStarted())  # another stone, tried once
    assert Account.of(journal.newest).first_failure(under) == ""


def test_stones_that_were_found_and_never_tried_are_told():
    story = journal_of(
        (5, SiteSegmented((1, 2, 3), (9, 9, 9))), (10, attempt(1)), (40, released(1))
    )
    counts = Account.of(story).counts()
    assert (counts.known, counts.untouched, counts.unseen) == (3, 2, 1)


def test_a_stone_that_is_moved_again_is_picked_again():
    again = journal_of(
        (10, attempt(1)),
        (40, released(1)),
        (60, attempt(1)),
        (90, released(1, slot=5)),
    )
    picks = Account.of(again).picks()
    assert [(pick.stone, pick.as_report().slot, len(pick.tries)) for pick in picks] == [
        (1, 4, 1),
        (1, 5, 1),
    ]
    assert Account.of(again).counts().first_attempt == 2


def test_an_attempt_that_nothing_ended_lasts_to_the_end_of_the_run():
    story = journal_of((10, attempt(1)), (15, grasped(1)), (22, MissionEnded("failure", "")))
    (cut_off,) = Account.of(story).picks()
    assert (cut_off.tries[0].outcome, cut_off.tries[0].ended_s) == ("unfinished", 22)


def test_a_stone_that_is_taken_up_again_goes_on_with_its_pick():
    again = [StonesTakenUpAgain((2,)), attempt(2), released(2)]
    story = journal_of(
        *((entry.time_s, entry.event) for entry in STORY),
        *((90 + i, event) for i, event in enumerate(again)),
    )
    picks = Account.of(story).picks()
    assert [(pick.stone, len(pick.tries), pick.set_aside) for pick in picks] == [
        (1, 2, ""),
        (2, 2, ""),
    ]
    counts = Account.of(story).counts()
    assert (counts.placed, counts.set_aside, counts.first_attempt) == (2, 0, 0)


def test_a_stone_that_is_placed_by_a_surface_seen_later_is_told():
    turned = PlacementVerified(2, 5, "placed", 0.04, 0.0, "", "", turn_known=False)
    story = journal_of(
        (10, attempt(1)), (40, released(1)), (50, looked_at(1, "placed")),
        (60, attempt(2)), (90, released(2)), (95, turned),
    )  # fmt: skip
    account = Account.of(story)
    assert [pick.as_report().turn_known for pick in account.picks()] == [True, False]
    assert (account.counts().placed, account.counts().turn_unknown) == (2, 1)


def test_a_stone_that_was_released_and_not_looked_at_any_more_is_not_placed():
    story = journal_of(
        (10, attempt(1)), (25, grasped(1)), (40, released(1)), (50, looked_at(1, "placed")),
        (60, attempt(2)), (75, grasped(2)), (90, released(2)), (91, MissionEnded("stopped", "")),
    )  # fmt: skip
    account = Account(verifies=True)
    for entry in story:
        account.add(entry)
    seen, released_only = (pick.as_report() for pick in account.picks())
    assert (seen.placed, seen.unverified) == (True, False)
    assert (released_only.placed, released_only.unverified) == (False, True)
    assert released_only.attempts[0].outcome == "released, not verified"
    told = ("placed", "unverified", "unseen", "first_attempt")
    assert [getattr(account.counts(), name) for name in told] == [1, 1, 0, 1]
    assert Account.of(story).counts().placed == 2  # a mission that does not look


def test_a_mission_verifies_if_a_tree_that_it_calls_does():
    assert verifies(load_mission("pick_and_place"))
    assert not verifies(load_mission("map_site"))


def test_a_stone_that_was_believed_lost_and_is_then_seen_at_its_place_is_not_lost():
    lost = StoneLost(1, "the look did not show it")
    story = [(10, attempt(1)), (40, released(1)), (45, lost)]
    assert Account.of(journal_of(*story)).picks()[0].lost
    (pick,) = Account.of(journal_of(*story, (50, looked_at(1, "placed")))).picks()
    assert not pick.lost
    (pick,) = Account.of(journal_of(*story, (50, looked_at(1, "unseen", "keep")))).picks()
    assert pick.lost
