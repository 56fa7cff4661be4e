"""What a dry run tells of many runs, of what it made up, and of branches that were not taken."""

from types import SimpleNamespace

import pytest

from executive.commands.missions import dry
from executive.commands.missions.dry import Asked, Draws, Wanted, run_dry
from executive.coverage import by_tree as grouping
from executive.coverage import text
from executive.dry_run import rehearsal
from executive.mission import preset_answers
from executive.tree import load


def run(seed, outcome="success", reason="", broken=()):
    result = SimpleNamespace(outcome=outcome, reason=reason, ended_s=2.0)
    return SimpleNamespace(seed=seed, name=f"seed {seed}", result=result, broken=list(broken))


def rehearsed(runs, **fields):
    """Return what a rehearsal has shown."""
    known = {
        "coverage": SimpleNamespace(mission="yard", percent=60.0),
        "made_up": {},
        "expectations": 0,
        "is_as_expected": True,
    }
    return SimpleNamespace(runs=runs, **(known | fields))


@pytest.fixture
def told(monkeypatch):
    """Return what makes a dry run of given results, and tells its status and its lines."""

    def begin(done, wanted=None, runs=1):
        lines, answers, asked = [], [], []
        monkeypatch.setattr(dry, "say", lines.append)
        monkeypatch.setattr(dry, "answer", answers.append)
        monkeypatch.setattr(load, "load_mission", lambda *given: "mission")
        monkeypatch.setattr(preset_answers, "preset_answers", lambda *given: "preset")
        monkeypatch.setattr(rehearsal, "rehearse", lambda *given: (asked.append(given), done)[1])
        monkeypatch.setattr(text, "coverage_text", lambda *given, **more: f"coverage {more}")
        monkeypatch.setattr(text, "coverage_answer", lambda coverage: coverage.percent)
        wanted = wanted or Wanted(None, False, False, False)
        status = run_dry(Asked("yard", (), (), None, None), Draws(5, runs, 0.2), wanted)
        ((mission, chances, *_),) = asked
        assert mission == "mission"
        assert [(one.seed, one.failures) for one in chances] == [(5 + i, 0.2) for i in range(runs)]
        return status, lines, answers

    return begin


@pytest.mark.parametrize(("at_least", "status"), [(None, 0), (60.0, 0), (60.1, 1)])
def test_too_few_branches_are_an_error(told, at_least, status):
    wanted = Wanted(at_least, False, True, False)
    ended, lines, _ = told(rehearsed([run(5)]), wanted)
    assert ended == status
    assert ("error: 60.0 % of the branches were taken, not 60.1 %" in lines) == bool(status)


def test_of_more_than_ten_runs_the_others_are_counted(told):
    runs = [
        run(5 + i, "failure" if i in (0, 11) else "success", "lost" * (not i)) for i in range(12)
    ]
    _, lines, _ = told(rehearsed(runs), runs=12)
    assert lines[2] == "  seed 5: failure after 2.00 s: lost"
    assert lines[3] == "  seed 6: success after 2.00 s"
    assert [line for line in lines if "seed 14" in line]
    assert not [line for line in lines if "seed 15" in line]
    assert "  …: 10 of 12 runs succeeded" in lines
    assert lines[-1] == "\ncoverage {'lists_never': True}"
    _, lines, _ = told(rehearsed(runs[:10]), runs=10)
    assert not [line for line in lines if "…" in line]


def test_what_was_made_up_is_told_and_ten_of_the_values_that_were_read(told):
    made_up = {"rock": object(), "count": 3} | {f"rock.part{i}": 0.5 + i for i in range(11)}
    _, lines, _ = told(rehearsed([run(5)], made_up=made_up))
    assert "  made up by their types: count, rock" in lines
    shown = [line for line in lines if "read by the tree" in line]
    assert shown[0] == "  made up, and read by the tree: rock.part0 = 0.5"
    assert shown[10:] == ["  made up, and read by the tree: 1 more; --json lists all"]
    _, lines, _ = told(rehearsed([run(5)], made_up=made_up), Wanted(None, False, True, False))
    assert not [line for line in lines if "made up" in line]


@pytest.mark.parametrize(
    ("broken", "is_met", "line"),
    [([], True, "expectations: 3, all met"),
     (["a:1: late"], False, "expectations: 3, not all met (1 broken)")],
)  # fmt: skip
def test_expectations_are_counted(told, broken, is_met, line):
    done = rehearsed([run(5, broken=broken)], expectations=3, is_as_expected=is_met)
    status, lines, _ = told(done)
    assert status == (0 if is_met else 1)
    assert lines[-1] == line
    assert [one for one in lines if one in broken] == broken


def test_calls_of_one_tree_may_count_together(told, monkeypatch):
    coverage = SimpleNamespace(mission="yard", percent=90.0)
    monkeypatch.setattr(grouping, "by_tree", lambda given: coverage)
    monkeypatch.setattr(
        dry, "replace", lambda done, coverage: rehearsed(done.runs, coverage=coverage)
    )
    assert told(rehearsed([run(5)]), Wanted(80.0, True, True, False))[0] == 0
    assert told(rehearsed([run(5)]), Wanted(80.0, False, True, False))[0] == 1


def test_programs_are_answered(told):
    made_up = {"rock": 1.5, "rock.mass": 3.0}
    done = rehearsed([run(5, "failure", "lost", ["late"])], made_up=made_up, is_as_expected=False)
    status, _, (answer,) = told(done, Wanted(None, False, True, True))
    assert status == 1
    assert answer == {
        "mission": "yard",
        "dry": True,
        "failures": 0.2,
        "runs": [
            {"seed": 5, "outcome": "failure", "reason": "lost", "ended_s": 2.0, "broken": ["late"]}
        ],
        "expectations": 0,
        "as_expected": False,
        "made_up": {"rock": "float", "rock.mass": 3.0},
        "coverage": 60.0,
    }
