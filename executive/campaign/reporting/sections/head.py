"""What was asked, and what came of it in numbers."""

from executive.campaign.reporting.page.markup import Markup, pairs, tag
from executive.campaign.reporting.summary import Head
from executive.campaign.reporting.wording import number_ranges


def head_list(head: Head) -> Markup:
    """Return command, version, seeds, factors, and numbers of runs."""
    runs = head.runs
    counted = (
        f"{runs.asked:,} asked, {runs.done:,} done, {runs.without_answer:,} without an answer, "
        f"{runs.not_successful:,} missions not successful"
    )
    missing = f"; {runs.missing:,} have not ended" if runs.missing else ""
    return pairs(
        (
            ("Command", tag("code", head.command)),
            ("Runs", counted + missing),
            ("Seeds", f"{number_ranges(head.seeds)} ({len(head.seeds):,} in all)"),
            *((f"Factor {name}", ", ".join(levels)) for name, levels in head.factors.items()),
            ("Version", f"executive {', '.join(head.versions)}"),
            *((("Begun", ", ".join(head.begun)),) if head.begun else ()),
            ("Trials", tag("code", head.digest[:12])),
        )
    )
