"""Make the README's picture of the terminal: a mission's live tree, as the command prints it.

    python docs/terminal_picture.py

Runs `executive run pick_and_place --seed 3` on a pseudo-terminal until one stone is at its slot,
stops it as Ctrl-C does, and writes the output of that moment as an SVG.
"""

import os
import pty
import re
import signal
import struct
import subprocess
import sys
import tempfile
import termios
from fcntl import ioctl
from io import StringIO
from pathlib import Path

from rich.console import Console
from rich.terminal_theme import MONOKAI
from rich.text import Text

PATH = Path(__file__).parent / "images" / "terminal.svg"
COLUMNS, LINES = 100, 30
CHARACTER_WIDTH = 12.2  # of the SVG that rich writes
WORDS = ["executive", "run", "pick_and_place", "--seed", "3"]
WANTED = re.compile(r"stone 1 of 7")  # one is placed, and the next is being planned for
# rich redraws by clearing a line, and then each line above it.
REDRAW = re.compile(r"\r?\x1b\[2K(?:\x1b\[1A\x1b\[2K)*")
LEADING_SPACES = re.compile(
    r'(<text [^>]*x=")([\d.]+)(" [^>]*textLength=")([\d.]+)("[^>]*>)((?:&#160;)+)'
)
CONTROL = re.compile(r"\x1b\[\?25[lh]|\r")


def wanted_frame() -> str:
    """Run the mission until a frame matches, and return it with its colours."""
    leader, follower = pty.openpty()
    ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", LINES, COLUMNS, 0, 0))
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "TERM": "xterm-256color", "COLORTERM": ""}
        run = subprocess.Popen(
            [*WORDS, "--run-dir", f"{folder}/run"], stdin=follower, stderr=follower, env=environment
        )
        os.close(follower)
        output = ""
        while run.poll() is None:
            output += os.read(leader, 65536).decode("utf-8", errors="replace")
            *whole, rest = REDRAW.split(output)
            for frame in whole:
                if WANTED.search(frame):
                    run.send_signal(signal.SIGINT)
                    _drain(leader)
                    run.wait()
                    return CONTROL.sub("", frame)
            output = rest
    sys.exit("the mission ended before the frame was seen")


def _drain(leader: int) -> None:
    """Read until the other end is closed, so that the mission is never held up by a full buffer."""
    try:
        while os.read(leader, 65536):
            pass
    except OSError:  # Linux reports a closed follower as an error
        pass


def _indent(match: re.Match[str]) -> str:
    """Replace leading spaces by a shift: some programs that draw SVG leave them out."""
    before, x, middle, length, after, spaces = match.groups()
    shift = CHARACTER_WIDTH * (len(spaces) // len("&#160;"))
    return f"{before}{float(x) + shift:g}{middle}{float(length) - shift:g}{after}"


def main() -> None:
    """Write the picture."""
    console = Console(record=True, width=COLUMNS, file=StringIO(), force_terminal=True)
    console.print(Text.from_ansi(f"$ {' '.join(WORDS)}\n{wanted_frame()}".rstrip()))
    svg = console.export_svg(title="executive", theme=MONOKAI, unique_id="terminal")
    svg = LEADING_SPACES.sub(_indent, svg)
    # No font from the network: the viewer's own monospaced one.
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.S)
    PATH.write_text(svg.replace("Fira Code", "DejaVu Sans Mono"), encoding="utf-8")
    print(PATH)


if __name__ == "__main__":
    main()
