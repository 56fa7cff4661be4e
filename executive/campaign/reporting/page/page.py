"""A page of sections and charts, written as one HTML file that loads nothing."""

import json
from functools import cache
from pathlib import Path

from executive.campaign.reporting.charts.picture import Picture
from executive.campaign.reporting.page.markup import Markup, joined, tag
from executive.campaign.reporting.page.style import STYLE

# Nothing is loaded from anywhere; Vega compiles its expressions, which is `unsafe-eval`.
_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline' 'unsafe-eval'; img-src data:"
)
_DRAW = """
for (const one of document.querySelectorAll("script[data-chart]"))
  vegaEmbed(document.getElementById(one.dataset.chart), JSON.parse(one.textContent),
    {renderer: "svg", actions: false, tooltip: {theme: "light"}});
"""


class Page:
    """Collects sections; charts are drawn by the browser from their specifications."""

    def __init__(self, title: str, subtitle: str = "") -> None:
        self._title = title
        self._sections: list[str] = []
        self._top = [tag("h1", title), *([tag("p", subtitle, class_="lead")] if subtitle else [])]
        self._parts: list[Markup] = []
        self.pictures: list[Picture] = []

    def add(self, *parts: str) -> None:
        """Add content; a text that is no `Markup` becomes a paragraph."""
        self._parts += [p if isinstance(p, Markup) else tag("p", p) for p in parts if p]

    def section(self, title: str, *parts: str) -> None:
        """Begin a section."""
        self._parts.append(tag("h2", title, id=_anchor(title)))
        self._sections.append(title)
        self.add(*parts)

    def chart(self, picture: Picture) -> Markup:
        """Return the place of a chart."""
        self.pictures.append(picture)
        name = f"chart-{len(self.pictures)}"
        # "<" is escaped, so that no text in the data can end the script.
        data = Markup(json.dumps(picture.spec, separators=(",", ":")).replace("<", "\\u003c"))
        return joined(
            (
                tag("div", id=name, class_="chart", role="img", aria_label=picture.title),
                tag("script", data, type="application/json", data_chart=name),
            )
        )

    def write(self, path: Path) -> None:
        """Write the page, whole or not at all."""
        partial = path.with_suffix(".partial")
        partial.write_text(self._html(), encoding="utf-8")
        partial.replace(path)

    def _html(self) -> str:
        head = tag(
            "head",
            tag("meta", charset="utf-8"),
            tag("meta", http_equiv="Content-Security-Policy", content=_POLICY),
            tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
            tag("title", self._title),
            tag("style", Markup(STYLE)),
        )
        scripts = [tag("script", Markup(_vega())), tag("script", Markup(_DRAW))]
        links = (tag("a", title, href=f"#{_anchor(title)}") for title in self._sections)
        main = tag("main", *self._top, tag("nav", *links), *self._parts)
        body = tag("body", main, *(scripts if self.pictures else []))
        return f"<!DOCTYPE html>\n{tag('html', head, body, lang='en')}\n"


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


@cache
def _vega() -> str:
    """Return the scripts that draw charts: Vega, Vega-Lite and vega-embed."""
    import vl_convert

    bundle: str = vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed;")
    return bundle.replace("</script", "<\\/script")
