"""A world whose leaves answer as a test has scripted them, for composites."""

from executive.config import Settings
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, failed, succeeded


class ActSettings(Settings):
    id: str
    ticks: int = 1
    fails: bool = False


class World:
    """What the leaves of one test share: what they did, and what the condition says."""

    def __init__(self) -> None:
        self.log: list[str] = []
        self.is_safe = True

    def leaves(self) -> dict[str, type]:
        world = self

        class Act(Action[ActSettings]):
            def run(self) -> Steps[None]:
                name = self.settings.id
                world.log.append(f"{name} begins")
                try:
                    for _ in range(self.settings.ticks):
                        yield None
                except GeneratorExit:
                    world.log.append(f"{name} cancelled")
                    raise
                world.log.append(f"{name} ends")
                if self.settings.fails:
                    return failed(f"{name} failed")
                return succeeded(reason=f"{name} done")

        class Safe(Condition):
            def check(self) -> Outcome[None]:
                return succeeded(reason="safe") if world.is_safe else failed("not safe")

        return {"Act": Act, "Safe": Safe}


def act(name: str, ticks: int = 1, fails: bool = False) -> str:
    return f"  - run: Act\n    with: {{id: {name}, ticks: {ticks}, fails: {str(fails).lower()}}}\n"


def indented(text: str) -> str:
    return "".join(f"  {line}\n" for line in text.splitlines())
