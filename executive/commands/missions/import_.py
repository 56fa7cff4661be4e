"""`executive import`: trees of another language as a mission."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import answer, check_writable, say
from executive.commands.options import JsonOption
from executive.errors import ConfigError

if TYPE_CHECKING:
    from executive.tree.btcpp.import_xml import Imported


def import_mission(
    file: Annotated[
        Path,
        typer.Argument(help="XML of BehaviorTree.CPP 4, as Groot2 writes it.", show_default=False),
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="File to write; standard output without.", show_default=False),
    ] = None,
    extends: Annotated[
        str, typer.Option(help="Mission whose plugins and settings it takes over, such as base.")
    ] = "",
    as_json: JsonOption = False,
) -> None:
    """Turn trees of BehaviorTree.CPP 4 into a mission.

    What the mission language cannot say is listed with its line, and nothing is written.

    Example: executive import patrol.xml --extends base --out patrol.yaml
    """
    from executive.tree.resolved import yaml_text
    from executive.tree.sources import find

    if extends and find(extends) is None:
        raise ConfigError(f"--extends: '{extends}' is no file and no shipped mission")
    if out is not None:
        check_writable("--out", out, (file,))
    found = imported(file)
    document = found.document
    if extends:
        head = {key: document[key] for key in ("api", "mission")}
        document = {**head, "extends": extends, "trees": document["trees"]}
    for warning in found.warnings:
        say(str(warning))
    if as_json:
        answer(document)
    elif out is None:
        print(yaml_text(document), end="")
    else:
        out.write_text(yaml_text(document), encoding="utf-8")
        count = len(document["trees"])
        say(f"{out}: {count} tree{'s' if count > 1 else ''}; `executive check {out}` checks them")


def imported(file: Path) -> "Imported":
    """Return the trees of a file as a mission that is called as the file is.

    Raises:
        ConfigError: If the file cannot be read, or holds what a mission cannot say.
    """
    from executive.tree.btcpp.import_xml import from_xml
    from executive.tree.catalogue import InstalledCatalogue

    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"{file} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{file} cannot be read: it is no text in UTF-8") from error
    name = "".join(letter if letter.isalnum() else "_" for letter in file.stem) or "imported"
    return from_xml(text, str(file), InstalledCatalogue(), name)
