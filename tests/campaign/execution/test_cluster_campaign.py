"""A whole campaign over a cluster that is lost in the middle, and goes on over another one."""

from pathlib import Path

import pytest

from executive.campaign.description.campaign import Campaign
from executive.campaign.engine import Plan, run_campaign
from executive.campaign.execution.cluster_pool import ClusterPool
from executive.campaign.execution.cluster_workers import ClusterError
from executive.campaign.execution.ledger import Ledger
from executive.campaign.execution.progress import Progress
from executive.campaign.trial import Limits, Status, Trial

LIMITS = Limits(time_s=60.0, memory_bytes=2 << 30)
SHORT = """
api: 1
mission: short
trees:
  main:
    wait: 0.2 s
plugins:
  robot: {plugin: kinematic}
  estimation: gnss_imu_filter
"""


def campaign(*trials: Trial) -> Campaign:
    return Campaign(
        name="spread",
        description="",
        trials=trials,
        factors={},
        metrics=(),
        bounds=(),
        comparisons=(),
        digest="one",
        command="",
    )


@pytest.fixture
def two_clusters(clusters, spread, tmp_path):
    made = []
    for name in ("lost", "next"):
        (tmp_path / name).mkdir()
        made.append(clusters.Cluster(tmp_path / name))
        made[-1].add_worker("worker", [spread])
    yield made
    for one in made:
        one.stop()


def test_a_campaign_goes_on_over_another_cluster(two_clusters, tmp_path: Path) -> None:
    asked = campaign(
        *(Trial(n, "spread", {"for_s": 0.1}, n, {}, LIMITS) for n in range(5)),
        Trial(5, "mission", {"mission": SHORT}, 5, {}, LIMITS),
    )
    folder = tmp_path / "campaign"

    def lose_scheduler(progress: Progress) -> None:
        if progress.counts.total() >= 3:
            two_clusters[0].scheduler.kill()

    with pytest.raises(ClusterError, match="does not answer any more"):
        run_campaign(asked, Plan(folder), ClusterPool(two_clusters[0].address), lose_scheduler)
    end = run_campaign(
        asked,
        Plan(folder, is_resumed=True),
        ClusterPool(two_clusters[1].address),
        lambda progress: None,
    )
    assert end.counts[Status.DONE] == 6
    ledger = Ledger(folder / "results.sqlite")
    outcomes = {outcome.number: outcome for outcome in ledger.outcomes()}
    ledger.close()
    assert sorted(outcomes) == list(range(6))
    assert [outcomes[number].tries for number in range(3)] == [1, 1, 1]
    assert outcomes[5].answer["report"]["outcome"] == "success"
    run = folder / "runs" / f"5-{outcomes[5].tries}"
    assert {"report.json", "journal.jsonl", "log.txt", "mission.yaml"} <= {
        one.name for one in run.iterdir()
    }
