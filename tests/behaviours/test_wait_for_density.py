"""The trigger of segmentation and registration."""

import numpy as np
import pytest
from executive_plugins.mapping.density import dense_share

from executive.behaviours.wait_for_density import WaitForDensity, WaitForDensitySettings
from executive.messages.cloud import Cloud


class GrowingMap:
    """Gains points everywhere within some metres, so many on a square metre and second."""

    def __init__(self, context, rate, radius_m=12.0):
        self._context, self._rate, self._radius_m = context, rate, radius_m

    def dense_share(self, sector, points_per_m2):
        return dense_share(self.cloud().points, sector, points_per_m2)

    def cloud(self):
        count = int(self._rate * self._context.now_s() * 4 * self._radius_m**2)
        xy = np.random.default_rng(0).uniform(-self._radius_m, self._radius_m, (count, 2))
        return Cloud("map", np.column_stack([xy, np.zeros(count)]))


def waiting(fakes, rate, radius_m=12.0, **settings):
    context = fakes.Context(mapping=None)
    context.plugins["mapping"] = GrowingMap(context, rate, radius_m)
    return context, WaitForDensity(WaitForDensitySettings(**settings), context)


@pytest.mark.parametrize("rate", [20.0, 50.0])
def test_it_ends_when_the_density_is_reached(fakes, rate: float) -> None:
    context, leaf = waiting(fakes, rate, density=100.0)
    assert fakes.finish(leaf).success
    assert context.time_s == pytest.approx(
        100.0 / rate, rel=0.35
    )  # counts scatter, and it looks twice a second


def test_points_next_to_the_machine_do_not_count_for_the_region(fakes) -> None:
    context, leaf = waiting(fakes, 1000.0, radius_m=4.0)
    steps, answer = leaf.run(), None
    for _ in range(100):
        job = steps.send(answer)
        answer = None if job is None else job.result()
        context.time_s += 0.05
    steps.close()


def test_settings_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="share"):
        WaitForDensitySettings(share=1.5)
