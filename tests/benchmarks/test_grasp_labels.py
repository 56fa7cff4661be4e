"""Which of a stone's labelled grasps lifts: the paper's first against the one of the highest predicted success.

On labels that no network has learned from, made in two minutes by `executive grasp-data unseen --stones 120 --seed 2`;
EXECUTIVE_LABELS names their folder. Of a stone's grasps the first half is the paper's order, the rest is drawn from its
pool at random; each has been lifted once. `EXECUTIVE_LABELS=unseen pytest tests/benchmarks/test_grasp_labels.py -s`.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from executive.arrays import Float
from plugins.grasping.labels import read_labels
from plugins.grasping.outcome_net import load_net
from plugins.grasping.sampled_cnn import weights_file
from plugins.grasping.training import area_under_curve, predictions


def said(lifted: Float) -> str:
    """Return the mean and its 95 % interval by bootstrap over stones [%]."""
    draws = np.random.default_rng(0).integers(len(lifted), size=(4000, len(lifted)))
    low, high = np.percentile(lifted[draws].mean(axis=1), [2.5, 97.5])
    return f"{100 * lifted.mean():5.1f} [{100 * low:.0f}, {100 * high:.0f}]"


@pytest.mark.skipif("EXECUTIVE_LABELS" not in os.environ, reason="EXECUTIVE_LABELS names no folder")
def test_predicted_success_picks_better_than_the_papers_order() -> None:
    labels = read_labels(Path(os.environ["EXECUTIVE_LABELS"]))
    of_stone = [np.flatnonzero(labels.stone == stone) for stone in np.unique(labels.stone)]
    lifted = labels.is_lifted.astype(float)
    first = lifted[[index[0] for index in of_stone]]
    print(f"\n{len(of_stone)} stones; the paper's first lifts {said(first)} %")
    for name in ("two_stream", "four_layer"):
        likely, _ = predictions(load_net(weights_file(name)), labels)
        picked = lifted[[index[likely[index].argmax()] for index in of_stone]]
        gain = f"{said(picked - first)} points more"
        print(f"  {name:12} {said(picked)} %, {gain}; AUC {area_under_curve(likely, labels.is_lifted):.3f}")
        assert picked.mean() > first.mean()
