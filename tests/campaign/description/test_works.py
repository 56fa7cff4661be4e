"""Campaigns of work that is no mission."""

from collections.abc import Callable

import pytest

from executive.campaign.description.campaign import Campaign

HEAD = "api: 1\ncampaign: one\nseeds: 98:99\nwork: misbehaving\n"


@pytest.mark.usefixtures("misbehaving")
def test_settings_are_paths_in_the_arguments_of_a_work(read: Callable[..., Campaign]) -> None:
    text = "arguments: {for_s: 0.5}\nset: {mebibytes: 3}\nvariants: {a: , b: {behaviour: exits}}\n"
    campaign = read(text, HEAD)
    found = [dict(one.arguments) for one in campaign.trials[:2]]
    assert found == [
        {"behaviour": "answer", "for_s": 0.5, "mebibytes": 3},
        {"behaviour": "exits", "for_s": 0.5, "mebibytes": 3},
    ]
    assert [one.work for one in campaign.trials] == ["misbehaving"] * 4


@pytest.mark.usefixtures("misbehaving")
def test_mistakes_in_arguments_are_reported_at_their_place(
    mistakes: Callable[..., list[str]],
) -> None:
    text = "arguments: {for_s: soon}\nset: {mebibyte: 3}\nmissions: pick_and_place\n"
    assert mistakes(text, HEAD) == [
        "5:20 for_s: input should be a valid number, got 'soon'",
        "6:7 work 'misbehaving' has no setting 'mebibyte'. Did you mean 'mebibytes'?",
        "7:1 no 'missions' here: the work is 'misbehaving', which runs no mission",
    ]
