"""Draw a mission's tree with Graphviz, from what `executive show` prints.

    python docs/tree_picture.py

Needs the program `dot` (Debian: graphviz). The subtrees that move one stone are left out, so that
the picture can be read at the width of a page.
"""

import re
import subprocess
import sys
from pathlib import Path

PATH = Path(__file__).parent / "images" / "tree.svg"
WORDS = ["show", "pick_and_place", "--as", "dot"]
SHOWN = ("main", "map_and_segment", "relocate_all", "relocate_each", "relocate_one")
CLUSTER = re.compile(r'  subgraph cluster_\d+ \{\n    label="(\w+)";\n.*?\n  \}\n', re.S)


def main() -> None:
    """Write the picture."""
    executive = Path(sys.executable).with_name("executive")
    dot = subprocess.run([executive, *WORDS], check=True, capture_output=True, text=True).stdout
    kept = [match.group(0) for match in CLUSTER.finditer(dot) if match.group(1) in SHOWN]
    head = dot.partition("  subgraph")[0].replace(
        "{\n", "{\n  rankdir=LR; ranksep=0.3; nodesep=0.1;\n", 1
    )
    text = head + "".join(_bottom_up(cluster) for cluster in reversed(kept)) + "}\n"
    svg = subprocess.run(
        ["dot", "-Tsvg"], input=text, check=True, capture_output=True, text=True
    ).stdout
    PATH.write_text(re.sub(r"<!--.*?-->\n?", "", svg, flags=re.S), encoding="utf-8")
    print(PATH)


def _bottom_up(cluster: str) -> str:
    """Reverse the nodes of a cluster: from left to right, dot stacks from the bottom to the top."""
    opening, label, *body, closing, _ = cluster.split("\n")
    return "\n".join([opening, label, *reversed(body), closing, ""])


if __name__ == "__main__":
    main()
