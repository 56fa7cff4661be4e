"""What grasping plugins answer to the ordinary inputs of the conformance kit."""

import inspect
from typing import get_args

import pytest
from executive_plugins.grasping import commands


@pytest.mark.parametrize("name", ["sampled_antipodal", "sampled_cnn"])
def test_answer(recorded, exercised, name) -> None:
    # The network computes in single precision, and contacts of the rehearsal amplify it: a slip of
    # 80 µm differed by 1 µm between two processors.
    few = "grasping.samples=20", "grasping.downward_yaws=9", "grasping.rehearsed=1"
    # Whether one of the drawn lifts holds may depend on the last digits; `kind` has fixed ones.
    few = (*few, "grasping.physics=kind")
    recorded(exercised("grasping", name, *few), relative=1e-5, absolute=1e-5)


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.grasping"))


@pytest.mark.parametrize("verb", [commands.grasp_data, commands.grasp_train])
def test_options_of_verbs(recorded, verb) -> None:
    """Defaults and bounds, as the help of the verb tells them."""
    told = {}
    for name, one in inspect.signature(verb).parameters.items():
        (_, option) = get_args(one.annotation)
        default = None if one.default is inspect.Parameter.empty else one.default
        told[name] = [default, option.min, option.max]
    recorded(told)
