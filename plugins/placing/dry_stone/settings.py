"""Settings of the dry-stone planner: which parts it is made of, and their numbers."""

from typing import ClassVar, Literal

from pydantic import Field

from executive.config import Kilograms, Meters, Radians, Seconds, Settings
from executive.interfaces.declaration import PluginSettings

OTHER_SIDE_RAD = 0.35  # a stone that tilts farther than this comes to rest on another side


class Weights(Settings):
    """Weights of the named terms of a place: about 0 to 1, `void` -1 to 0; more is better."""

    volume: float = Field(
        2.0, ge=-100, le=100, description="Volume over that of the inventory's largest stone."
    )
    contact: float = Field(1.0, ge=-100, le=100, description="Share of the underside that touches.")
    void: float = Field(1.0, ge=-100, le=100, description=(
        "0 without a hollow below, -1 if it is as large as the inventory's largest stone."
    ))  # fmt: skip
    height: float = Field(
        1.5, ge=-100, le=100, description="1 if the stone lies on the ground, 0 if on the top."
    )
    face: float = Field(
        0.6, ge=-100, le=100, description="1 flush with a face, 0 at 0.3 m behind it."
    )
    interlock: float = Field(
        1.0, ge=-100, le=100, description="Share of the contact not on one stone alone."
    )
    margin: float = Field(
        1.0, ge=-100, le=100, description="Support around the centre of mass, over 0.2 m."
    )
    beside: float = Field(
        1.0, ge=-100, le=100, description="Share of the rim with a neighbour within 15 cm."
    )
    joints: float = Field(1.0, ge=-100, le=100, description=(
        "1 if joints of the course below are covered, -1 if they run on through this one."
    ))  # fmt: skip
    into: float = Field(2.0, ge=-100, le=100, description=(
        "1 less its length along the structure over that of the inventory's longest stone: stones "
        "lie with their length into the structure, as masons lay them."))  # fmt: skip
    gaps: float = Field(2.0, ge=-100, le=100, description=(
        "0 if all others fit into what is left free of the course on either side, -1 if a length "
        "as that of a stone is left into which none fits."))  # fmt: skip
    flat: float = Field(1.0, ge=-100, le=100, description=(
        "1 if its upper side is level, 0 if that is 0.3 m below its highest point in the mean."
    ))  # fmt: skip


class GeneratorSettings(Settings):
    """How places are generated."""

    part: str = Field("height_maps", description="`height_maps`, or `package.module:Class`.")
    cell: Meters = Field(0.05, gt=0.01, le=0.2, description="Distance of nodes of height maps [m].")
    stride: int = Field(2, ge=1, le=10, description="Places are so many nodes apart.")
    attitude: Literal["any", "kept"] = Field("any", description=(
        "`kept`: stones are turned about the vertical and leaned a little, as a gripper carries "
        "them; `any`: also onto other sides."))  # fmt: skip
    lean: Radians = Field(0.0, ge=0, le=0.7, description=(
        "How far a stone of a `kept` attitude may be leaned to lie as its bed does [rad]: what the "
        "gripper tilts it to, as it sets it down. 0 leaves it level."))  # fmt: skip
    sides: int = Field(6, ge=1, le=20, description="Broad sides of each stone that are tried.")
    turns: int = Field(12, ge=1, le=36, description=(
        "Turns about the vertical of each side, from the one in which its length lies along the "
        "structure; only of a multiple of four does one lay it straight across."))  # fmt: skip
    finer: int = Field(3, ge=1, le=10, description=(
        "How many times as many turns are tried before nothing is said to fit; 1 tries no more."
    ))  # fmt: skip
    supported: bool = Field(True, description=(
        "Whether a stone's centre of mass must be over what it first touches. Without this it must "
        "be where the stone has tilted to rest; that is tried, too, before nothing is said to fit."
    ))  # fmt: skip
    touch: Meters = Field(0.03, gt=0, le=0.2, description="Gap that counts as touching [m].")
    most_outside: float = Field(
        0.12, ge=0, le=1, description="Largest share of the stone, from above, off the envelope."
    )
    astray: Meters = Field(0.075, ge=0, le=0.5, description=(
        "How far a stone may be let go beside its place [m]: 2.5 standard deviations of a release."
    ))  # fmt: skip
    most_rise: Meters = Field(0.10, gt=0, description=(
        "Largest height by which it may rest higher there [m]; in a gap that is too narrow it "
        "rests on the neighbours."))  # fmt: skip
    over_top: Meters | None = Field(None, ge=0, le=1, description=(
        "How far a stone may stand above the envelope [m]; without it half of the thickness of "
        "the stones at hand, so that tops lie about the height that is wanted."))  # fmt: skip
    stones: int = Field(20, ge=1, description="Stones of the inventory that are tried at a time.")
    kept: int = Field(60, ge=1, description="Places of each stone that are kept.")
    rested: int = Field(1000, ge=0, description=(
        "Best places of each lot at which the stone rolls to rest on the height map, by itself and "
        "under noise, before it is ranked again and checked; 0 checks it as it first touches. Of "
        "`kept` attitudes without `lean` the place stays as it is, and is left out if the stone "
        "tilts too far."
    ))  # fmt: skip

    @property
    def tilts(self) -> bool:
        """Return whether stones tilt to rest on the height map before they are checked."""
        return self.rested > 0 and self.most_lean_rad > 0

    @property
    def most_lean_rad(self) -> float:
        """Return how far a stone may tilt to rest from the attitude in which it is tried [rad]."""
        return OTHER_SIDE_RAD if self.attitude == "any" else self.lean


class ScorerSettings(Settings):
    """How places are ranked."""

    part: str = Field("weighted", description="`weighted`, or `package.module:Class`.")
    weights: Weights = Field(Weights(), description="Weight of each named term.")


class CheckSettings(Settings):
    """How the stability of a place is checked."""

    part: str = Field("both", description=(
        "`equilibrium` (a convex program), `settling` (physics under noise), `both`, `none`, "
        "or `package.module:Class`."))  # fmt: skip
    noise: Meters = Field(0.03, ge=0, le=0.5, description=(
        "Standard deviation of a release along each axis of the ground [m]."))  # fmt: skip
    tilt_noise: Radians = Field(0.035, ge=0, le=0.5, description=(
        "Standard deviation of its rotation about each axis [rad]."))  # fmt: skip
    samples: int = Field(8, ge=1, le=100, description="Releases under noise that are tried.")
    worst: Meters = Field(0.10, gt=0, description="Largest distance from the plan of any [m].")
    worst_tilt: Radians = Field(0.14, gt=0, description="Largest rotation from it [rad].")
    most_tilt: Radians | None = Field(None, gt=0, le=3.2, description=(
        "Largest tilt against the attitude of its place in which a stone may settle [rad]; without "
        "it 26°. A stone that is not known all around does not settle as its model does."
    ))  # fmt: skip
    moved: Meters = Field(0.06, gt=0, description="Largest motion of any other stone [m].")
    friction: float = Field(0.6, gt=0, le=2, description="Coefficient of friction.")
    load: float = Field(0.03, ge=0, le=1, description=(
        "Horizontal load that the stone must bear, over its weight; 0.03 is a tilt of 2°."
    ))  # fmt: skip
    step_s: float = Field(0.005, gt=0, le=0.02, description="Time step of the physics [s].")
    pieces: int = Field(10, ge=1, le=100, description="Convex pieces of each stone.")
    other_pieces: int = Field(30, ge=0, le=100, description=(
        "Convex pieces of each stone in a second model of its shape, in which a stone that has "
        "settled must stay; 0 leaves this out."))  # fmt: skip
    reseated: Meters = Field(0.01, gt=0, le=0.5, description=(
        "Largest distance by which it may move there [m]: what a wall may drift."))  # fmt: skip
    tries: int = Field(100, ge=1, description=(
        "Places of each lot of stones that are checked; one that is refused as `tilts` counts as "
        "one release of all."))  # fmt: skip
    cost: float = Field(0.1, ge=0, description=(
        "What a check costs, in terms of the score: a place that holds with the chance p is ranked "
        "lower by this over p, as so many checks find one such place; 0 ranks by the score alone."
    ))  # fmt: skip
    doubt: float = Field(1.0, ge=0, description=(
        "Taken off the score of places near one where a stone did not hold (0.25 m, one standard "
        "deviation), as much as a term of the score is worth, and off that of a place from which a "
        "stone has fallen; 0 checks by the score alone."))  # fmt: skip
    failures: int = Field(2, ge=1, description=(
        "Releases that failed on the same stones after which no stone is placed there any more. "
        "Of all, two of three hold; after two that failed, by the rule of succession two of five."
    ))  # fmt: skip

    @property
    def is_free(self) -> bool:
        """Return whether a check costs nothing, so that places are ranked by their score alone."""
        return self.part == "none" or self.cost == 0


class DryStoneSettings(PluginSettings):
    """Settings of `dry_stone`."""

    needs: ClassVar[tuple[str, ...]] = ()

    generator: GeneratorSettings = Field(
        GeneratorSettings(), description="How places are generated."
    )
    scorer: ScorerSettings = Field(ScorerSettings(), description="How places are ranked.")
    check: CheckSettings = Field(CheckSettings(), description="How stability is checked.")
    max_mass: Kilograms = Field(2500.0, gt=0, description="Heaviest stone that is used [kg].")
    slenderest: float = Field(6.0, ge=1, description=(
        "Length over thickness, with the room that is taken for its unseen parts, above which a "
        "stone is a needle or a slab and is left out. Of 100 natural stones the most slender has "
        "4.3, 4.7 with 5 cm of room on each side; flat ones make good courses."))  # fmt: skip
    release_height: Meters = Field(
        0.02, ge=0, le=0.5, description="Height above its place at which a stone is let go [m]."
    )
    level: Meters = Field(0.15, ge=0, description=(
        "The structure is complete where its top is at most this far below its height [m]."
    ))  # fmt: skip
    covered: float = Field(0.9, gt=0, le=1, description=(
        "Share of the inner half of its foot over which it must be, to end as complete."
    ))  # fmt: skip
    targets: int = Field(1, ge=1, le=10, description="Targets after which the search ends.")
    fills: Literal["largest", "any"] = Field("largest", description=(
        "Which stones are tried first: the largest that are left, or any."))  # fmt: skip
    budget: Seconds | None = Field(None, gt=0, description=(
        "Time after which the search ends at its best answer so far [s]; without it, it goes on. "
        "Only within it is the answer the same on all computers. A mission ends with a fault where "
        "a search takes 120 s."))  # fmt: skip
