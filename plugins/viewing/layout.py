"""The layout in which a recording opens: site, tree states, documents and plots."""

import rerun.blueprint as rrb

TIMELINE = "mission"


def layout() -> rrb.Blueprint:
    """Return the blueprint that is stored in a recording."""
    site = rrb.Spatial3DView(
        origin="/world",
        name="Site",
        background=[24, 26, 30],
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=(-6.0, -9.0, 8.0),
            look_target=(2.5, 0.0, 0.5),
            eye_up=(0, 0, 1),
        ),
    )
    beside = rrb.Vertical(
        rrb.Tabs(
            rrb.TextDocumentView(origin="/tree", name="Tree"),
            rrb.TextLogView(origin="/log", name="Log"),
            rrb.Spatial3DView(origin="/survey", name="Survey, own frame"),
        ),
        rrb.TimeSeriesView(origin="/plots/jaw", name="Jaw angle [rad]"),
        rrb.TimeSeriesView(origin="/plots/effort", name="Effort of the arm, share of the limit"),
        row_shares=[3, 1, 1],
    )
    states = rrb.StateTimelineView(origin="/states", name="States of the tree")
    return rrb.Blueprint(
        rrb.Vertical(rrb.Horizontal(site, beside, column_shares=[5, 2]), states, row_shares=[3, 1]),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )
