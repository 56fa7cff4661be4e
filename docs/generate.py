"""Write the pages that are generated from the code: the words of missions, the fields of
`robot.yaml`, the events of the journal, and the metrics of campaigns; and the tables of nodes on
the page about trees.

    python docs/generate.py

`tests/docs/test_generated.py` fails when a page is not what this script would write.
"""

import re
from pathlib import Path

from generators.events import events_page
from generators.metrics import metrics_page
from generators.robot_yaml import robot_yaml_page
from generators.words import of_kind, shipped_words, table_of, words_page

DOCS = Path(__file__).parent
HOW_TO = DOCS / "how-to" / "write_a_tree.md"
TABLES = {"node": "kind", "modifier": "modifier, outermost first"}


def pages() -> dict[Path, str]:
    """Return the generated pages, and those with generated tables."""
    return {
        DOCS / "words.md": words_page(),
        DOCS / "robot_yaml.md": robot_yaml_page(),
        DOCS / "journal_events.md": events_page(),
        DOCS / "metrics.md": metrics_page(),
        HOW_TO: with_tables(HOW_TO.read_text(encoding="utf-8")),
    }


def with_tables(page: str) -> str:
    """Return the page about trees with its tables of nodes and of modifiers written anew."""
    words = shipped_words()
    for kind, title in TABLES.items():
        table = table_of(of_kind(words, kind), title)
        page = re.sub(
            rf"(<!-- {kind}s: .*?-->\n).*?(\n<!-- end -->)",
            lambda match, table=table: f"{match[1]}{table}{match[2]}",
            page,
            flags=re.S,
        )
    return page


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
        print(path)
