"""`executive plugins test`: hold one installed plugin to its contract."""

from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, SetOption


def hold_plugin(
    capability: Annotated[str, typer.Argument(help="Its capability, such as segmentation.")],
    name: Annotated[str, typer.Argument(help="Its name, as `plugins list` prints it.")],
    set_: SetOption = None,
    model: Annotated[str, typer.Option(help="The machine that it is made for.")] = "m545",
    time_limit: Annotated[
        float, typer.Option(min=0.0, help="Longest call of any verb in seconds.")
    ] = 30.0,
    must_succeed: Annotated[
        bool,
        typer.Option("--must-succeed", help="Fail where it refuses what a capable plugin answers."),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Hold a plugin, robot or leaf to its contract.

    One line a check. Exit status 1 says that a check failed.

    Example: executive plugins test segmentation ground_and_clusters
    """
    try:
        from executive.testing.run import Trial, hold_to_contract
    except ModuleNotFoundError as error:
        from executive.errors import ConfigError

        if error.name is None or error.name.partition(".")[0] not in ("pytest", "_pytest"):
            raise
        raise ConfigError(
            "the checks need pytest: install it with `pip install 'executive[testing]'`"
        ) from error
    options = tuple(set_ or ())
    findings = hold_to_contract(
        Trial(capability, name, options, model, time_limit, must_succeed=must_succeed)
    )
    failures = [one for one in findings if one.outcome == "fail"]
    if as_json:
        answer(
            {
                "capability": capability,
                "name": name,
                "passed": not failures,
                "checks": [one.as_json() for one in findings],
            }
        )
    else:
        for one in findings:
            print(one.line())
    skipped = sum(one.outcome == "skip" for one in findings)
    passed = len(findings) - len(failures) - skipped
    say(f"{capability} {name}: {passed} passed, {len(failures)} failed, {skipped} skipped")
    raise typer.Exit(1 if failures else 0)
