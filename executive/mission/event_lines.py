"""Events as lines for a person."""

from executive.events import control, driving, fault, mission, site, stone, watch
from executive.events.event import Event


def line_of(event: Event) -> str:
    """Return what a person is shown of an event; empty for what is not worth a line."""
    lines = (
        of(event) for of in (_of_site, _of_stone, _of_mission, _of_watch, _of_faults_and_people)
    )
    return next(filter(None, lines), "")


def _of_site(event: Event) -> str:
    """Return what is found out about the site."""
    match event:
        case site.Localised():
            return f"localised ({event.status})"
        case site.SiteSurveyed():
            return f"drone map of {event.points} points"
        case site.SiteScanned():
            return f"map of {event.points} points"
        case site.SurveyRegistered():
            verdict = "registered" if event.accepted else "refused"
            return f"drone map {verdict}: {event.reason}"
        case site.SurveyFitted():
            shifts = f"{100 * event.median_m:.1f} cm, at most {100 * event.largest_m:.1f} cm"
            return f"drone map shifted by {shifts}, and the map shows {event.share:.0%} of it"
        case site.SiteSegmented():
            others = f", {len(event.left_out)} other things left out" if event.left_out else ""
            return "; ".join([f"{len(event.stones)} stones found{others}", *event.warnings])
        case site.SlotsFound():
            return f"{len(event.slots)} free places"
    return _of_building(event)


def _of_building(event: Event) -> str:
    """Return what is planned for a structure."""
    match event:
        case site.BuildingPlanned():
            on = f" on {len(event.standing)} that stand" if event.standing else ""
            return f"{event.structure}: stone {event.stone} is next{on}"
        case site.PlaceNotFound():
            held = ", as the jaws hold it" if event.is_held else ""
            return f"{event.structure}: no place for stone {event.stone}{held}, {event.reason}"
        case site.BuildingEnded():
            told = f": {event.detail}" if event.detail else ""
            return f"{event.structure} ends with {len(event.standing)} stones, {event.reason}{told}"
    return _of_driving(event)


def _of_driving(event: Event) -> str:
    """Return where the machine drives, and how that ends."""
    match event:
        case driving.DriveStarted():
            x, y, _ = event.goal_map
            return f"drives {event.length_m:.1f} m to ({x:.1f}, {y:.1f})"
        case driving.DriveEnded():
            return f"stands {event.off_m:.2f} m off the goal"
        case driving.DriveFailed():
            return f"does not drive on: {event.trouble}, {event.reason}"
    return ""


def hanging(event: stone.StoneNotLifted) -> str:
    """Return how much of a stone hangs in the jaws."""
    if event.tipping_kg is not None:
        hangs = f"{event.hanging_kg:.0f} kg hang in the jaws"
        return f"{hangs}, and {event.tipping_kg:.0f} kg tip the machine there"
    if event.most_kg is not None:
        return f"{event.hanging_kg:.0f} kg hang in the jaws, more than {event.most_kg:.0f} kg"
    told = f"{event.hanging_kg:.0f} of at least {event.least_kg:.0f} kg hang in the jaws"
    return told if event.higher_kg is None else f"{told}, {event.higher_kg:.0f} kg higher up"


def _expected(event: stone.AttemptStarted) -> str:
    """Return the chance of an attempt in words, if one is expected."""
    return "" if event.success is None else f", {event.success:.0%} likely to be placed"


def _of_stone(event: Event) -> str:
    """Return what became of a stone."""
    match event:
        case stone.AttemptStarted():
            return f"stone {event.stone}: moving to a grasp{_expected(event)}"
        case stone.StoneGrasped():
            return f"stone {event.stone}: grasped at {event.jaw_rad:.2f} rad"
        case stone.JawsClosedOnNothing():
            return f"stone {event.stone}: {event.reason}"
        case stone.StoneNotLifted():
            return f"stone {event.stone}: not lifted, {hanging(event)}"
        case stone.StoneTouchedDown():
            return f"stone {event.stone}: stands, {event.above_m:+.2f} m from the planned height"
        case stone.StoneReleased():
            return f"stone {event.stone}: set down on slot {event.slot}"
        case stone.StoneLetGo():
            return f"stone {event.stone}: released where it was"
        case stone.StoneSetAside():
            return f"stone {event.stone}: set aside, {event.reason}"
    return _of_sighting(event)


def _of_sighting(event: Event) -> str:
    """Return what a look at a stone, or its weight, showed."""
    match event:
        case stone.StoneRealigned():
            result = "realigned" if event.accepted else f"not realigned: {event.reason}"
            return f"stone {event.stone}: {result}"
        case stone.StoneSeenInJaws() if event.refused:
            return f"not carried on: {event.refused}"
        case stone.StoneSeenInJaws():
            result = f"kept as expected: {event.reason}"
            if event.shift_m is not None and event.turn_rad is not None:
                result = f"{100 * event.shift_m:.1f} cm and {event.turn_rad:.2f} rad off"
            return f"stone {event.stone}: in the jaws {result}"
        case stone.StoneWeighed():
            return f"stone {event.stone}: weighs {event.mass_kg:.0f} ± {event.std_kg:.0f} kg"
        case stone.PlacementVerified() if event.seen != "placed":
            return f"stone {event.stone}: {event.seen}, {event.reason}"
        case stone.StoneLost():
            return f"stone {event.stone}: lost, {event.reason}"
    return ""


def _of_mission(event: Event) -> str:
    """Return what became of the mission, its plugins and its time."""
    match event:
        case mission.VerdictGiven():
            return f"{event.trouble}: {event.detail}"
        case mission.PluginFailed():
            return f"warning: {event.fault.summary}"
        case mission.ObservationIgnored():
            return f"warning: no plugin takes observations of type {event.type}"
        case mission.TickLate():
            return _of_late_tick(event)
        case mission.PartsReleased():
            return f"{' and '.join(event.parts)} at rest {event.after_s:.1f} s after a cancel"
        case mission.StopFailed():
            return f"warning: the stop failed: {event.reason}"
        case mission.PhaseChanged():
            return event.after + (f": {event.reason}" if event.reason else "")
    return ""


def _of_late_tick(event: mission.TickLate) -> str:
    """Return by how much a tick was late, and what took the time."""
    line = f"warning: a tick was {1e3 * event.late_s:.0f} ms late ({event.in_a_row} in a row)"
    if not event.step:
        return line
    took, computed = 1e3 * event.took_s, 1e3 * event.computed_s
    return f"{line}: {event.cause} took {took:.0f} ms, {computed:.0f} ms of it computed"


def _of_watch(event: Event) -> str:
    """Return what is refused, missing, or no longer holds."""
    match event:
        case watch.ObservationRefused():
            return f"warning: {event.sensor}: an observation is refused: {event.reason}"
        case watch.SamplesMissing():
            return f"warning: {event.sensor}: samples are missing, gap {event.gaps}"
        case watch.ConditionBroken():
            return f"warning: {event.reason}"
        case watch.ConditionRestored():
            return f"{event.condition} is well again after {event.lasted_s:.1f} s"
        case watch.ScansNotFused():
            return f"warning: scans are not fused: {event.reason}"
        case watch.MissionWentOn():
            return f"goes on after a hold of {event.held_s:.1f} s: {event.reason}"
    return ""


def _of_faults_and_people(event: Event) -> str:
    """Return what is done on purpose, or asked for by a person."""
    match event:
        case fault.FaultInjected():
            return f"fault {event.number} on purpose: {event.target} {event.how}"
        case fault.FaultShows():
            return f"fault {event.number} on purpose shows: {event.withheld:.3f} off the path"
        case fault.FaultRemoved():
            return f"fault {event.number} on purpose is over"
        case control.ControlRequested():
            done = "" if event.is_done else " is refused"
            words = " ".join(filter(None, (event.verb, event.argument, event.target)))
            return f"{event.user} asks: {words}{done}: {event.reply}"
    return ""
