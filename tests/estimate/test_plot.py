"""The plot of a replay: the path from above, and how far the estimate was from each fix."""

from pathlib import Path
from types import SimpleNamespace

import matplotlib.image
import numpy as np
import pytest
from matplotlib.figure import Figure

from executive.estimate.drop import Drop
from executive.estimate.plot import plot


def poses(*places: tuple[float, float, float]) -> np.ndarray:
    found = np.tile(np.eye(4), (len(places), 1, 1))
    found[:, :3, 3] = places
    return found


def test_the_path_and_the_distance_of_each_fix_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    save = Figure.savefig

    def kept(self: Figure, *given: object, **named: object) -> None:
        drawn.append(self)
        save(self, *given, **named)

    monkeypatch.setattr(Figure, "savefig", kept)
    errors = SimpleNamespace(
        p_map_antenna=np.array([[0.0, 1.0, 9.0], [2.0, 3.0, 9.0]]),
        stamps_s=np.array([1.0, 2.0]),
        predicted_m=np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 2.0]]),
        posterior_m=np.array([[0.0, 0.0, 0.0], [0.6, 0.0, 0.8]]),
    )
    track = SimpleNamespace(
        T_map_base=poses((0, 1, 5), (2, 4, 5)), T_odom_base=poses((7, 8, 0), (9, 6, 0))
    )
    smoothed = SimpleNamespace(T_map_base=poses((0, 2, 5), (2, 5, 5)))
    estimated = SimpleNamespace(
        track=track, errors=errors, reference=smoothed, report={"estimator": "a filter"}
    )
    plot(tmp_path / "replay.png", estimated, [Drop("gnss", 1.2, 1.7)])
    assert matplotlib.image.imread(tmp_path / "replay.png").shape[:2] == (600, 1320)
    ((above, over_time),) = [figure.axes for figure in drawn]
    assert above.get_title() == "a filter"
    assert [(line.get_label(), line.get_xydata().tolist()) for line in above.lines] == [
        ("fixes", [[0, 1], [2, 3]]),
        ("estimate, map frame", [[0, 1], [2, 4]]),
        ("estimate, odometry frame", [[7, 8], [9, 6]]),
        ("batch smoothing", [[0, 2], [2, 5]]),
    ]
    # A distance of 0 has no place on a logarithmic axis: it is drawn at a tenth of a millimetre.
    assert {line.get_label(): line.get_ydata().tolist() for line in over_time.lines} == {
        "prediction": [5.0, 2.0],
        "after the fix": [1e-4, 1.0],
    }
    (outage,) = over_time.patches
    assert (outage.get_x(), outage.get_width()) == (1.2, pytest.approx(0.5))
