"""A mission's trees for people and for other tools: text, DOT, BehaviorTree.CPP XML."""

from executive.tree.btcpp.export_xml import to_xml
from executive.tree.export_dot import to_dot
from executive.tree.export_text import to_text
from executive.tree.language import MissionFile

FORMS = {"text": to_text, "dot": to_dot, "xml": to_xml}


def export(mission: MissionFile, form: str = "text") -> str:
    """Return the mission's trees in one of `FORMS`."""
    return FORMS[form](mission)
