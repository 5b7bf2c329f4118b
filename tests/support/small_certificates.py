"""Small certificates written by hand."""

from typing import Any

from trajgap.verify import CERTIFICATE_FORMAT, seal

Document = dict[str, Any]
REST = [[1, "0"], [2, "0"]]


def sealed(data: Document) -> Document:
    """A document with both hashes made right."""
    data["problem_hash"] = seal(data["problem"])
    data["seal"] = seal({key: x for key, x in data.items() if key != "seal"})
    return data


def rest_to_rest() -> Document:
    """Two quintics from rest to rest; |φ′| = 15/8 at the middle, so 1.875·|Δq|/V is least."""
    return sealed(
        {
            "format": CERTIFICATE_FORMAT,
            "made_by": "by hand",
            "question": {
                "case": "a-case",
                "problem": "first",
                "reading": None,
                "joint": None,
                "case_sha256": None,
            },
            "problem": {
                "unit": "rad",
                "joints": ["1"],
                "degrees": [5, 5],
                "continuity": [0],
                "prescribed": [REST, REST, REST],
                "virtual": [],
                "waypoints": [["0.5"], ["1.5"], ["-0.5"]],
                "limits": [["1", None, None]],
                "position_lower": [None],
                "position_upper": [None],
                "duration_lower": ["0", "0"],
                "duration_upper": [None, "4"],
            },
            "problem_hash": "",
            "claim": {
                "subject": "the declared curve",
                "infeasible": False,
                "lower": "5.625",
                "upper": "5.625",
                "durations": ["1.875", "3.75"],
                "speeds": None,
            },
            "proof": {
                "kind": "rest-to-rest",
                "total": "5.625",
                "tree": [[".", [0, 1, 2**19, "1.875"], [0, 1, 2**19, "3.75"]]],
            },
            "seal": "",
        }
    )
