"""Draw the trees of missions with Graphviz, from what `executive show` prints.

    python docs/tree_picture.py

Needs the program `dot` (Debian: graphviz). The subtrees that move one stone are left out, so that
the pictures can be read at the width of a page.
"""

import re
import subprocess
import sys
import textwrap
from pathlib import Path

IMAGES = Path(__file__).parent / "images"
# The trees that each picture shows, by mission and picture.
PICTURES = {
    ("pick_and_place", "tree"): (
        "main",
        "map_and_segment",
        "relocate_all",
        "relocate_each",
        "relocate_one",
    ),
    ("sort", "tree_sort"): ("main", "fill_row", "relocate_one"),
    ("clear_corridor", "tree_clear_corridor"): ("main", "clear", "relocate_one"),
    ("two_courses", "tree_two_courses"): ("main", "relocate_one"),
    ("inspect", "tree_inspect"): ("main",),
    ("long_site", "tree_long_site"): ("main", "clear_station", "clear_reach"),
    ("confirm", "tree_confirm"): ("main", "move_confirmed", "grasp_and_put_down"),
}
WIDTH = 44  # letters of a line in a node
LABEL = re.compile(r'\[label="((?:[^"\\]|\\.)*)"')
CLUSTER = re.compile(r'  subgraph cluster_\d+ \{\n    label="(\w+)";\n.*?\n  \}\n', re.S)


def main() -> None:
    """Write the pictures, those of some missions if their names are given."""
    for (mission, picture), shown in PICTURES.items():
        if not sys.argv[1:] or mission in sys.argv[1:]:
            path = IMAGES / f"{picture}.svg"
            path.write_text(_svg(mission, shown), encoding="utf-8")
            print(path)


def _svg(mission: str, shown: tuple[str, ...]) -> str:
    executive = Path(sys.executable).with_name("executive")
    words = [executive, "show", mission, "--as", "dot"]
    dot = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    kept = [match.group(0) for match in CLUSTER.finditer(dot) if match.group(1) in shown]
    head = dot.partition("  subgraph")[0].replace(
        "{\n", "{\n  rankdir=LR; ranksep=0.3; nodesep=0.1;\n", 1
    )
    text = head + "".join(_bottom_up(cluster) for cluster in reversed(kept)) + "}\n"
    text = LABEL.sub(_wrapped, text)
    svg = subprocess.run(
        ["dot", "-Tsvg"], input=text, check=True, capture_output=True, text=True
    ).stdout
    return re.sub(r"<!--.*?-->\n?", "", svg, flags=re.S)


def _wrapped(label: re.Match[str]) -> str:
    """Break a long label into lines, so that the picture stays as wide as a page."""
    lines = [textwrap.wrap(line, WIDTH) or [""] for line in label.group(1).split("\\n")]
    return '[label="' + "\\n".join(part for wrapped in lines for part in wrapped) + '"'


def _bottom_up(cluster: str) -> str:
    """Reverse the nodes of a cluster: from left to right, dot stacks from the bottom to the top."""
    opening, label, *body, closing, _ = cluster.split("\n")
    return "\n".join([opening, label, *reversed(body), closing, ""])


if __name__ == "__main__":
    main()
