"""What all pictures share: style, colours, text that is safe to draw, and deterministic SVG."""

from __future__ import annotations

import io
import math
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, TypeAlias
from xml.sax.saxutils import escape

from matplotlib import style
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont
from matplotlib.ft2font import FT2Font

from ...problem import file_name, visible
from ..blocks import Drawn
from ..documents import two_digits

# Greys of a white page, and Okabe & Ito's colours: told apart with any common colour blindness.
INK = "#1f2933"  # text and the main lines: nearly black
MUTED = "#5b6673"  # ticks and notes: lighter than the text, and still read with ease on white
GRID = "#d5dae1"  # lines of reference behind the data: just seen
PAPER = "#ffffff"  # what all of it stands on
BLUE = "#0072b2"  # the first series; Okabe & Ito's blue
ORANGE = "#e69f00"  # the second series; their orange
GREEN = "#009e73"  # the third series; their bluish green
PURPLE = "#cc79a7"  # the fourth series; their reddish purple
SKY = "#56b4e9"  # the light one beside a dark one; their sky blue
RED = "#c8102e"  # what is printed, or wrong: darker than their vermilion, apart from the orange
DARK = {
    "ink": "#e6eaf0",
    "muted": "#a3adba",
    "grid": "#3a434f",
    "paper": "#1a2027",
    "blue": "#58b4f0",
    "orange": "#f0b429",
    "green": "#3fcf9f",
    "purple": "#e3a1c6",
    "sky": "#8fd0f7",
    "red": "#ff6b81",
}
"""The same colours on a dark page, as its style has them."""
THEME = dict(
    zip(DARK, (INK, MUTED, GRID, PAPER, BLUE, ORANGE, GREEN, PURPLE, SKY, RED), strict=True)
)
"""Colours that a page may replace, by the name of their CSS variable."""
KINDS = ("png", "svg", "pdf")
"""Formats of a file with a picture, as its name ends."""
Line = Literal["-", "--", "-.", ":"]
"""Line styles of matplotlib."""
Style: TypeAlias = dict[str, Any]
"""Keywords of a drawing function."""


class Picture(Figure):
    """A figure with a title and a description in words for those who cannot see it."""

    def __init__(self, title: str, description: str, width: float, height: float) -> None:
        super().__init__(figsize=(width, height), layout="constrained")
        self.title = title
        self.description = description

    def _repr_html_(self) -> str:
        return svg(self)


@contextmanager
def drawing() -> Iterator[None]:
    """Style of every picture, whatever the user's own matplotlib settings."""
    with style.context(["default", Path(__file__).parent / "static" / "trajgap.mplstyle"]):
        yield


@lru_cache(maxsize=1)
def _font() -> FT2Font:
    return FT2Font(findfont(FontProperties(family=["DejaVu Sans"])))


def shown(text: str, width: int | None = None, lines: int = 1) -> str:
    """Text as a picture can draw it: on few lines, without characters that the font lacks.

    `width`: largest number of characters in a line; what does not fit is cut with an ellipsis.
    `lines`: largest number of lines.
    """
    flat = " ".join(text.split())
    drawn = "".join(c if c.isprintable() and _font().get_char_index(ord(c)) else "?" for c in flat)
    if width is None:
        return drawn
    cut = [w if len(w) <= width else w[: width - 1] + "…" for w in drawn.split(" ")]
    wrapped = textwrap.wrap(
        " ".join(cut), width, max_lines=lines, placeholder="…", break_on_hyphens=False
    )
    return "\n".join(wrapped or [""])


def series(at: int) -> tuple[str, Line]:
    """Colour and line style of an algorithm; nine are told apart, without colour too."""
    colours = BLUE, ORANGE, GREEN, PURPLE, SKY, INK, MUTED, INK, MUTED
    lines: tuple[Line, ...] = "-", "--", "-.", ":", "-", "-.", "--", ":", "-"
    return colours[at % len(colours)], lines[at % len(lines)]


@contextmanager
def picture(
    title: str, description: str, width: float, height: float, note: str = "", line: int = 105
) -> Iterator[Picture]:
    """A picture that is drawn inside: then title and note are written and the layout settles.

    `width, height`: inches. `note`: below it. `line`: characters in a line of the title.
    """
    with drawing():
        figure = Picture(title, description, width, height)
        yield figure
        figure.suptitle(shown(title, line, 2), x=0.005, ha="left", fontsize=11, weight="bold")
        if note:
            figure.supxlabel(note, x=0.005, ha="left", fontsize=8, color=MUTED)
        for axes in figure.axes:
            _settle_titles(axes)
        # The layout moves a little with every drawing; frozen, the same figure gives the same
        # bytes.
        layout = figure.get_layout_engine()
        if layout is not None:
            layout.execute(figure)
        figure.set_layout_engine("none")


def legend(holder: Axes | Picture, signs: Mapping[str, Artist], **place: Any) -> None:
    """Write what signs mean, each with its words; below the picture unless the place is given."""
    where = {"loc": "outside lower left"} if isinstance(holder, Picture) else {}
    holder.legend(list(signs.values()), list(signs), **where | place)


def _settle_titles(axes: Axes) -> None:
    """Tell matplotlib that titles need not rise, where nothing stands in their way.

    Otherwise it measures every axis anew for each title of each drawing, half of its time.
    """
    formatter = axes.yaxis.get_major_formatter()
    formatter.format_ticks(axes.get_yticks().tolist())
    above = axes.xaxis.get_ticks_position() in ("top", "unknown") or formatter.get_offset()
    if not above and not axes.get_title(loc="center"):
        axes.set_title("", loc="center", y=1.0)  # the height of one settles those beside it


def light_grid(axes: Axes, which: Literal["both", "x", "y"] = "both") -> None:
    """Draw thin grid lines behind everything else of one panel."""
    axes.grid(True, axis=which)
    axes.set_axisbelow(True)


def name_rows(axes: Axes, names: Sequence[str], below: float, above: float = 0.6) -> None:
    """Name the rows of a panel from the top, with room below and above in units of a row."""
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(len(names) - 1 + below, -above)
    axes.spines["left"].set_visible(False)


def hollow(size: float, edge: str = INK, face: str = PAPER) -> Style:
    """Style of points that a picture tells from filled ones."""
    return {
        "linestyle": "none",
        "marker": "o",
        "markersize": size,
        "markerfacecolor": face,
        "markeredgecolor": edge,
    }


def gap_scale(axis: Axis, top: float, linear: float, low: float | None = None) -> None:
    """Name gaps in percent by decades, from the end of the linear part of an axis to its top.

    `low`: smallest gap of an axis that also has 0 and, below it, the same decades.
    """
    decades = [10.0**k for k in range(round(math.log10(linear)), 1 + math.floor(math.log10(top)))]
    ticks = list(decades)
    if low is not None:
        ticks = [*(-t for t in reversed(decades) if t <= -low), 0.0, *decades]
    axis.set_ticks(ticks, labels=[two_digits(t) for t in ticks])
    axis.axes.minorticks_off()


def _xml(text: str) -> str:
    return escape(visible(text))


def _coarser(match: re.Match[str]) -> str:
    # A hundredth of a point is far below what a screen or printer shows.
    return re.sub(r"-?\d+\.\d{3,}", lambda m: f"{round(float(m[0]), 2):g}", match[0])


def _shorter(match: re.Match[str]) -> str:
    """Path data without repeated coordinates: L becomes H or V where it can."""
    found = re.findall(r"([A-Za-z])([^A-Za-z]*)", _coarser(match)[3:-1])
    if not {command for command, _ in found} <= {"M", "L", "z"}:
        return _coarser(match)
    parts: list[str] = []
    last = ("", "")
    for command, numbers in found:
        x, y = numbers.split() if command != "z" else ("", "")
        if command != "L" or last == ("", "") or (x != last[0] and y != last[1]):
            parts.append(f"{command}{x} {y}".rstrip())
        elif x != last[0]:
            parts.append(f"H{x}")
        elif y != last[1]:
            parts.append(f"V{y}")
        elif parts[-1][0] == "M":
            # A stroke without length is a dot.
            parts.append("h0")
        last = (x, y)
    return f'd="{"".join(parts)}"'


def svg(figure: Figure) -> str:
    """Render a figure as SVG, the same bytes each time, with title and description.

    A complete SVG document. Text is drawn as outlines, so it looks the same everywhere. `figure`: a
    `Picture` brings its own title and description.
    """
    buffer = io.StringIO()
    canvas, dots = figure.canvas, figure.dpi
    with drawing():
        # `savefig` would draw twice: once to lay out what is laid out already.
        untyped: Any = FigureCanvasSVG(figure)
        untyped.print_svg(buffer, metadata={"Date": None})
    figure.set_canvas(canvas)
    figure.set_dpi(dots)
    text = buffer.getvalue()
    title = getattr(figure, "title", "") or "Picture"
    description = getattr(figure, "description", "")
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r"<!DOCTYPE.*?>\s*", "", text, count=1, flags=re.DOTALL)
    # Outlines are preceded by a comment with their text, which may close it.
    text = re.sub(r"\s*<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"\n\s+", "\n", text)
    text = re.sub(r'\bd="[^"]*"', _shorter, text)
    text = re.sub(r"translate\([^)]*\)", _coarser, text)
    opening = re.search(r"<svg [^>]*>", text)
    assert opening is not None
    tag = opening[0][:-1] + ' role="img" aria-labelledby="title desc">'
    words = f'<title id="title">{_xml(title)}</title>\n <desc id="desc">{_xml(description)}</desc>'
    return text[: opening.start()] + tag + f"\n {words}" + text[opening.end() :]


def pictured(picture: Picture, *name: str, caption: str = "", inside: bool = False) -> Drawn:
    """A picture as a block, under a name that is unique in its page."""
    return Drawn(file_name(*name), svg(picture), picture.title, caption, inside)


def picture_bytes(figure: Figure, kind: str) -> bytes:
    """Render a figure as the content of a file, the same bytes each time.

    `kind` is one of `KINDS`.
    """
    if kind == "svg":
        return svg(figure).encode()
    buffer = io.BytesIO()
    dated = {"CreationDate": None} if kind == "pdf" else {}
    with drawing():
        # 150 dots an inch: small type of a PNG is sharp on a screen and in print.
        figure.savefig(buffer, format=kind, dpi=150, metadata=dated)
    return buffer.getvalue()


def themed(document: str) -> str:
    """An SVG file that follows a dark theme where it is shown by a browser.

    Its own colours stay in place for every other program.

    `document`: what `svg` returned.
    """
    rules = "".join(
        f'[style*="{what}: {colour}"]{{{what}:{DARK[name]} !important}}'
        for name, colour in THEME.items()
        for what in ("fill", "stroke")
        if f"{what}: {colour}" in document
    )
    style = f"<style>@media (prefers-color-scheme: dark){{{rules}}}</style>"
    end = document.index("</desc>") + len("</desc>")
    return f"{document[:end]}\n {style}{document[end:]}"


def embedded(document: str, prefix: str) -> str:
    """Fit an SVG document into a page: own ids, and colours that follow the page's theme.

    `document`: what `svg` returned. `prefix`: unique in the page; made by `file_name`.
    """
    text = document[document.index("<svg ") :]
    text = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', text)
    text = re.sub(r'href="#([^"]+)"', rf'href="#{prefix}-\1"', text)
    text = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", text)
    text = text.replace(
        'aria-labelledby="title desc"', f'aria-labelledby="{prefix}-title {prefix}-desc"'
    )
    for name, colour in THEME.items():
        text = text.replace(f"{colour};", f"var(--{name});").replace(
            f'{colour}"', f'var(--{name})"'
        )
    return text
