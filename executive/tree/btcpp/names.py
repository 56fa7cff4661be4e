"""Names that BehaviorTree.CPP 4 has taken: of its nodes, and of attributes."""

from collections.abc import Mapping

COMPOSITES: Mapping[str, str] = {
    "sequence": "Sequence",
    "fallback": "Fallback",
    "reactive_sequence": "ReactiveSequence",
    "reactive_fallback": "ReactiveFallback",
    "persistent_sequence": "SequenceWithMemory",
}
TURNED: Mapping[str, str] = {"not": "Inverter", "force_failure": "ForceFailure"}
OWN = ("ForEach", "Consume", "LoopUntil", "OnHalt", "Ask", "Holds")  # of the mission language
MOST_CASES = 6  # there are Switch2 to Switch6
LEFT_OUT = "true"  # the `_skipIf` of a node that stands for nothing

# All that the library registers by itself, and the words of its long form.
BUILT_IN = frozenset(
    (
        *COMPOSITES.values(),
        *TURNED.values(),
        *(f"Switch{count}" for count in range(2, MOST_CASES + 1)),
        *("Parallel", "ParallelAll", "IfThenElse", "WhileDoElse", "TryCatch", "ManualSelector"),
        *("AsyncSequence", "AsyncFallback", "RetryUntilSuccessful", "Repeat", "Timeout", "Delay"),
        *("KeepRunningUntilFailure", "RunOnce", "ForceSuccess", "Precondition", "SubTree"),
        *("AlwaysSuccess", "AlwaysFailure", "Script", "ScriptCondition", "SetBlackboard", "Sleep"),
        *("UnsetBlackboard", "LoopInt", "LoopBool", "LoopDouble", "LoopString", "WasEntryUpdated"),
        *("SkipUnlessUpdated", "WaitValueUpdate"),
        *("Action", "Condition", "Control", "Decorator", "BehaviorTree", "Root", "root"),
    )
)
USES = "use"  # of a leaf and a SubTree
_TAKEN = BUILT_IN | set(OWN)
_RESERVED = ("name", "ID")


def attribute(name: str) -> str:
    """Return a port's or setting's name as an attribute."""
    return f"{name}_" if name in _RESERVED else name


def port(name: str) -> str:
    """Return the port's or setting's name of an attribute."""
    return name[:-1] if name[:-1] in _RESERVED and name.endswith("_") else name


def uses_attribute(uses: Mapping[str, str]) -> dict[str, str]:
    """Return the plugins that a leaf or tree uses by name as an attribute: `placing=rows`."""
    text = ";".join(f"{capability}={name}" for capability, name in uses.items())
    return {USES: text} if uses else {}


def uses_of_attribute(text: str) -> dict[str, str]:
    """Return such an attribute as `use` has it."""
    pairs = (part.partition("=") for part in text.split(";"))
    return {capability: name for capability, _, name in pairs}


def leaf_tag(name: str) -> str:
    """Return the tag of a leaf; one that the library has taken gets an underscore."""
    return f"{name}_" if name in _TAKEN else name


def leaf_name(tag: str) -> str:
    """Return the leaf's name of a tag."""
    return tag[:-1] if tag.endswith("_") and tag[:-1] in _TAKEN else tag


def is_taken(name: str) -> bool:
    """Whether a name is one of the library's nodes, or of the mission language's own."""
    return name in _TAKEN


def tree_id(name: str, leaves: frozenset[str]) -> str:
    """Return a tree's ID, which must be the name of no node; `leaves` are the tags in use."""
    return f"{name}_tree" if name in _TAKEN | leaves else name
