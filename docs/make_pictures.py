"""Make the pictures that the documents show: `python docs/make_pictures.py`."""

from pathlib import Path

from trajgap.compare.drawing import svg
from trajgap.compare.study import Study
from trajgap.compare.waterfall import waterfalls
from trajgap.compare.waterfall_picture import waterfall_picture
from trajgap.problem import load_case

PICTURES = Path(__file__).parent / "pictures"


def waterfall_puma560() -> str:
    """Where the time goes in the puma560 paper, under its default reading."""
    case = load_case("puma560-mnam-pso-353")
    study = Study(case, reading=case.default_reading.id)
    (waterfall,) = waterfalls(study)
    return svg(waterfall_picture(waterfall, title="PUMA 560, 3-5-3: where the time goes"))


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    (PICTURES / "waterfall-puma560.svg").write_text(waterfall_puma560(), encoding="utf-8")
