"""All words of the mission language: nodes, modifiers, and the leaves that are installed."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive import registry
from executive.errors import ConfigError, did_you_mean
from executive.tree.catalogue import InstalledCatalogue
from executive.tree.words.leaf_word import leaf_word
from executive.tree.words.node_words import node_words
from executive.tree.words.word import Word


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """All words, and why leaves could not be imported, both by name."""

    words: Mapping[str, Word]
    broken: Mapping[str, str]

    def word(self, name: str) -> Word:
        """Return one word.

        Raises:
            ConfigError: If there is none of that name, with the nearest; if it is a leaf that
                cannot be imported, with the reason.
        """
        if name in self.words:
            return self.words[name]
        if name in self.broken:
            raise ConfigError(self.broken[name])
        alike = {one.lower(): one for one in self.words}
        near = alike.get(name.lower())
        hint = f". Did you mean '{near}'?" if near else _near(name, alike)
        raise ConfigError(f"no word '{name}'{hint}")


def _near(name: str, alike: Mapping[str, str]) -> str:
    """Return the nearest word, whatever its case; the list of all would be too long."""
    hint = did_you_mean(name.lower(), alike)
    if hint.startswith(";"):
        return "; `executive words` lists all"
    nearest = hint.partition("'")[2].partition("'")[0]
    return f". Did you mean '{alike[nearest]}'?"


def vocabulary() -> Vocabulary:
    """Describe every word; each installed leaf is imported."""
    words = {one.name: one for one in node_words()}
    broken: dict[str, str] = {}
    catalogue = InstalledCatalogue()
    packages = {one.name: one.distribution for one in registry.installed(registry.BEHAVIOURS)}
    for name in catalogue.behaviour_names():
        try:
            words[name] = leaf_word(name, catalogue.behaviour(name), packages[name])
        except ConfigError as error:
            broken[name] = str(error)
    return Vocabulary(words, broken)
