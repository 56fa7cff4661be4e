"""The two kinds of leaves: actions, which take time, and conditions, which do not.

A leaf is found under the entry-point group `executive.behaviour.v1`.
"""

from abc import ABC, abstractmethod
from collections.abc import Generator, Mapping
from typing import Any, ClassVar, Generic, TypeAlias

from typing_extensions import TypeVar, get_original_bases

from executive.config import NoSettings, Settings
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import Robot
from executive.leaf.claims import Part
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, Result
from executive.leaf.port import Port, inputs_of, outputs_of

Own = TypeVar("Own", bound=Settings, default=NoSettings)

# An action yields a job to be resumed with its result, or None to be resumed at the next tick.
Steps: TypeAlias = Generator[Job[Any] | None, Any, Outcome[Result]]


class Leaf(Generic[Own]):
    """What actions and conditions share: `class PlanPick(Action[PlanPickSettings])`.

    Attributes:
        needs: Interfaces of the plugins that the leaf uses; a mission must select one of each.
        claims: Parts of the machine that the leaf drives, such as `(Part.JAWS,)`; two leaves that
            drive the same part are refused in one `parallel`. Not declared, a leaf that needs the
            robot claims the whole machine, and another leaf claims nothing.
        on_resume: What becomes of the leaf when its run is cut off while it is under way. Not
            declared, a leaf that drives a part of the machine fails, and another is redone.
        is_irreversible: What the leaf commands cannot be taken back, such as opening the jaws: its
            intention is on the disk before it begins.
        Settings: Class of the settings, as given in brackets; without settings, `NoSettings`.
        inputs: Input ports, read from the signature of `run` or `check`.
        outputs: Output ports, read from its return annotation.
    """

    needs: ClassVar[tuple[type[Plugin], ...]] = ()
    claims: ClassVar[tuple[str, ...] | None] = None
    on_resume: ClassVar[OnResume | None] = None
    is_irreversible: ClassVar[bool] = False
    Settings: ClassVar[type[Settings]] = NoSettings
    inputs: ClassVar[Mapping[str, Port]] = {}
    outputs: ClassVar[Mapping[str, Port]] = {}

    def __init__(self, settings: Own, context: Context) -> None:
        self.settings = settings
        self.context = context

    @classmethod
    def parts(cls) -> tuple[str, ...]:
        """Return the parts of the machine that the leaf drives, declared or derived."""
        if cls.claims is not None:
            return cls.claims
        return (Part.MACHINE,) if Robot in cls.needs else ()

    @classmethod
    def resumes(cls) -> OnResume:
        """Return what becomes of the leaf when it is cut off, declared or derived."""
        if cls.on_resume is not None:
            return cls.on_resume
        return OnResume.FAIL if cls.parts() else OnResume.REDO

    @property
    def state(self) -> dict[str, object]:
        """Return what the leaf remembers beyond one call; kept, and restored on resuming."""
        return {k: v for k, v in vars(self).items() if k not in ("settings", "context")}

    def restore(self, state: Mapping[str, object]) -> None:
        """Take back what `state` returned."""
        vars(self).update(state)

    def __init_subclass__(cls) -> None:
        for base in get_original_bases(cls):
            for argument in getattr(base, "__args__", ()):
                if isinstance(argument, type) and issubclass(argument, Settings):
                    cls.Settings = argument
        method = cls.__dict__.get("run") or cls.__dict__.get("check")
        if method is not None and not getattr(method, "__isabstractmethod__", False):
            cls.inputs, cls.outputs = inputs_of(method), outputs_of(method)


class Action(Leaf[Own], ABC):
    """A leaf that takes time, written as a generator that yields where it waits.

    When the tree cancels an action, its generator is closed where it waits: a `finally` block
    cleans up there.
    """

    @abstractmethod
    def run(self, *args: Any, **kwargs: Any) -> Steps[object]:  # each leaf names its own ports
        """Do what the leaf is for; the parameters are the input ports by name."""

    def verify(self, *args: Any, **kwargs: Any) -> Steps[object]:  # with the ports of `run`
        """Look how far a call that was cut off is, and do the rest; see `OnResume.VERIFY`."""
        raise NotImplementedError(f"{type(self).__name__} declares VERIFY and has no `verify`")


class Condition(Leaf[Own], ABC):
    """A leaf that answers at once."""

    @abstractmethod
    def check(self, *args: Any, **kwargs: Any) -> Outcome[object]:  # each leaf names its own ports
        """Answer; the parameters are the input ports by name."""
