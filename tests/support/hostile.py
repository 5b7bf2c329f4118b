"""A case whose texts attack the page that shows them."""

import tomllib
from decimal import Decimal
from importlib.resources import files

from trajgap.problem import Case
from trajgap.problem.cases.load import check_case

ID = "irb460-pso-353"

SCRIPT = "<script>alert(1)</script>"

IMAGE = '"><img src=https://example.org/x.png onerror=alert(2)>'

LINK = "[a](javascript:alert(3)) | ![b](https://example.org/y) `c` *d* $e$ 轨迹"


def hostile_case(case_id: str = ID) -> Case:
    """A shipped case, made quick and hostile: every free text tries to break out."""
    text = (files("trajgap.problem") / "published" / f"{ID}.toml").read_text("utf-8")
    raw = tomllib.loads(text, parse_float=Decimal)
    raw["id"] = case_id
    joint = f"5{SCRIPT}"
    raw["title"] = f"Title {SCRIPT}{LINK}"
    raw["source"]["note"] = IMAGE
    raw["source"]["doi"] = f"10.1/{IMAGE}"
    raw["robot"] = {"name": f"Arm {LINK}", "joints": [joint]}
    del raw["equations"]  # they are about the robot's table
    raw["claims"] = [claim for claim in raw["claims"] if claim.get("checks") != "equations"]
    for claim in raw["claims"]:
        claim["text"] = f"{claim['text']} {SCRIPT}{IMAGE}{LINK}\n# heading\n- item"
        claim["where"] = f"{claim['where']} {SCRIPT}|"
        if "joint" in claim:
            claim["joint"] = joint
        if "not_checkable" in claim:
            claim["not_checkable"] += IMAGE
    for clue in raw["clues"]:
        clue["text"] = f"{clue['text']} {SCRIPT}{IMAGE}{LINK}"
        if "joint" in clue:
            clue["joint"] = joint
    for reading in raw["readings"]:
        reading["why"] += SCRIPT + LINK
    for one in (*raw["assumptions"], *raw["not_checkable"]):
        one["what" if "what" in one else "text"] += IMAGE + LINK
    raw["algorithms"][0]["open"].append(SCRIPT + LINK)
    raw["algorithms"][0]["settings"]["iterations"] = 6
    return check_case(raw, "hostile.toml")
