"""Make the pictures that the documents show: `python docs/make_pictures.py`."""

from collections.abc import Iterator
from pathlib import Path

from trajgap.compare.audits.study import Study
from trajgap.compare.audits.waterfall import waterfalls
from trajgap.compare.pages.blocks import Drawn
from trajgap.compare.pages.exhibits import exhibits_of_motion, exhibits_of_search
from trajgap.compare.pictures.drawing import svg
from trajgap.compare.pictures.waterfall import waterfall_picture
from trajgap.problem import file_name, load_case

PICTURES = Path(__file__).parent / "pictures"


def waterfall_puma560() -> str:
    """Where the time goes in the puma560 paper, under its default reading."""
    case = load_case("puma560-mnam-pso-353")
    study = Study(case, seeds=2, reading=case.default_reading.id)
    (waterfall,) = waterfalls(study)
    return svg(waterfall_picture(waterfall, title="PUMA 560, 3-5-3: where the time goes"))


EXHIBITS = {
    "jumps-irb1600": ("irb1600-ga-cubic-bspline", file_name("jumps", "nine-segments", "after")),
    "polygon-irb1600": ("irb1600-ga-cubic-bspline", "polygon-control-vertices"),
    "workspace-irb460": ("irb460-pso-353", "workspace-modified"),
    "tent-z1": ("z1-woa-bspline", "tent-improved-woa"),
}
"""Pictures of the report pages that the documents show too: case, and name in its page."""


def exhibits() -> Iterator[tuple[str, str]]:
    """Name and document of each picture in `EXHIBITS`."""
    found = {}
    for case_id in dict.fromkeys(case for case, _ in EXHIBITS.values()):
        study = Study(load_case(case_id), seeds=2)
        for section in (*exhibits_of_motion(study), *exhibits_of_search(study)):
            for block in section.blocks:
                if isinstance(block, Drawn):
                    found[case_id, block.name] = block.document
    return ((name, found[place]) for name, place in EXHIBITS.items())


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    (PICTURES / "waterfall-puma560.svg").write_text(waterfall_puma560(), encoding="utf-8")
    for name, document in exhibits():
        (PICTURES / f"{name}.svg").write_text(document, encoding="utf-8")
