"""The page on grasping is true: its selections load, its commands have the options that it gives
them.
"""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from executive_plugins.grasping import sampled_planner
from executive_plugins.grasping.sampling.closing import HoldOutcome

from executive import registry
from executive.clouds.ply_writer import write_parts

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "grasping.md").read_text(encoding="utf-8")
SELECTIONS = re.findall(
    r"grasping: (\{.*?\}|\w+)", re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1)
)
BLOCKS = re.findall(r"```sh\n(.*?)```", PAGE, re.S)
COMMANDS = [
    line for block in BLOCKS for line in re.findall(r"^(executive .*?)(?:\s+#.*)?$", block, re.M)
]
EXECUTIVE = Path(sys.executable).with_name("executive")


@pytest.mark.parametrize("selection", SELECTIONS)
def test_a_selection_of_the_page_is_a_plugin_with_such_settings(selection: str) -> None:
    chosen = yaml.safe_load(selection)
    chosen = chosen if isinstance(chosen, dict) else {"plugin": chosen}
    name = chosen.pop("plugin")
    registry.settings_of("grasping", name).model_validate(chosen)


def test_the_page_shows_every_planner() -> None:
    assert {plugin.name for plugin in registry.installed("grasping")} <= set(
        re.findall(r"\w+", PAGE)
    )
    assert len(SELECTIONS) == 6
    assert len(COMMANDS) == 6


def test_the_page_names_every_reason_of_refusal() -> None:
    source = (Path(sampled_planner.__file__)).read_text(encoding="utf-8")
    reasons = set(re.findall(r'refused\["(\w+)"\]', source)) | set(
        re.findall(r'\{"(\w+)": 1\}', source)
    )
    reasons |= {outcome.name.lower() for outcome in HoldOutcome} - {"held"} | {"too_steep"}
    assert len(reasons) > 10
    assert reasons <= set(re.findall(r"`(\w+)`", PAGE))


def test_a_stone_of_a_cloud_is_grasped_as_the_page_says(tmp_path: Path) -> None:
    """Run the page's command with pictures and recording on a slab; the others differ from it by
    options alone.
    """
    rng = np.random.default_rng(0)
    ground = np.column_stack([rng.uniform(-5, 5, (20_000, 2)), rng.normal(0, 0.005, 20_000)])
    slab = rng.uniform((-0.6, -0.4, 0.0), (0.6, 0.4, 0.6), (9000, 3))
    slab = slab[(np.abs(slab / (1.2, 0.8, 1.2)) > 0.48).any(axis=1)]
    write_parts(
        tmp_path / "site.ply", [ground[(np.abs(ground[:, :2]) > (0.6, 0.4)).any(axis=1)], slab]
    )
    command = next(command for command in COMMANDS if "--picture" in command)
    words = [EXECUTIVE, *command.split()[1:]]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"site.ply", "best.png", "grasps.rrd"}
