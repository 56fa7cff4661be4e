"""What a stone weighs that is to be grasped."""

from dataclasses import dataclass

from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.settings import SampledPlannerSettings

from executive.messages.stone import Stone


@dataclass(frozen=True, slots=True)
class Load:
    """Mass of a stone and the least that it may be [kg], and where they come from."""

    mass_kg: float
    least_kg: float
    words: str


def load_of(target: Stone, scene: PlanningCloud, settings: SampledPlannerSettings) -> Load:
    """Return the weighed mass of a stone, or that of its hull."""
    weight = target.weight
    if weight is not None:
        return Load(weight.mass_kg, weight.mass_kg - 2 * weight.std_kg, f"weighed: {weight}")
    mass_kg = scene.volume_m3 * settings.density
    words = f"{mass_kg:.0f} kg by its volume, not weighed"
    return Load(mass_kg, mass_kg / settings.overload, words)
