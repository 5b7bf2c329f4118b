"""What is drawn: a problem, durations, a waterfall, and its steps."""

import io
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.layout_engine import ConstrainedLayoutEngine
from trajgap.compare.documents import Step, Waterfall
from trajgap.compare.pictures import drawing as pictures
from trajgap.compare.pictures.drawing import Picture, svg
from trajgap.nlp import Evidence
from trajgap.problem import Limits, Problem, three_five_three

_WAY = [[0.4, -1.2], [1.3, -0.9], [1.1, 0.3], [0.2, 0.9]]
PROBLEM = Problem(_WAY, Limits([3.0, 5.0], [9.0, 14.0]), three_five_three(), 0.2)
DURATIONS = np.array([0.7, 0.5, 0.6])

LARGEST = 250_000
"""Characters of a picture."""


def sound(make: Callable[[], Picture]) -> str:
    """The document of a picture: accessible, small, without a raster, the same each time."""
    picture = make()
    document = svg(picture)
    assert document == svg(make())
    space = "{http://www.w3.org/2000/svg}"
    root = ElementTree.fromstring(document)
    assert (root.tag, root.get("role")) == (f"{space}svg", "img")
    assert root.findtext(f"{space}title") == picture.title
    assert root.findtext(f"{space}desc") == picture.description != ""
    assert not any(word in document for word in ("metadata", "DOCTYPE", matplotlib.__version__))
    assert not re.search(r'(?:href|src)="(?!#)', document), "nothing is fetched"
    assert "<image" not in document  # a page may fetch none, not even one of its own
    assert len(document) < LARGEST
    return document


def fall(*steps: Step) -> Waterfall:
    return Waterfall(problem="arm", reading="as-printed", claim="claim", steps=steps)


STEPS = (
    Step(name="published", time=1.9, low=1.895, high=1.905),
    Step(name="feasible after repair", time=2.1, note="stretched"),
    Step(
        name="each joint at its optimum, longest per segment",
        time=1.7,
        low=1.6,
        high=1.8,
        evidence=Evidence.BEST_KNOWN,
    ),
    Step(name="optimum", time=1.5, evidence=Evidence.CERTIFIED),
    Step.missing("retimed", "jerk is limited"),
    Step(name="any curve", time=0.012, evidence=Evidence.BEST_KNOWN),
)


def _marks() -> str:
    """The document of one small picture, as matplotlib writes it."""
    figure, text = Picture("Marks", "of a small one", 4.0, 3.0), io.StringIO()
    figure.subplots().plot([0, 1], [1, 0], label="line")
    FigureCanvasSVG(figure).print_svg(text)
    return text.getvalue()


@contextmanager
def sketched() -> Iterator[None]:
    """Every picture has the marks of one small one, and its own words: pages are about words."""
    marks = _marks()

    class Sketch(FigureCanvasSVG):
        def print_svg(self, file: io.StringIO, **_: object) -> None:
            file.write(marks)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "FigureCanvasSVG", Sketch)
        patch.setattr(ConstrainedLayoutEngine, "execute", lambda *_: None)
        yield
