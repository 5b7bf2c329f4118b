"""Settings of algorithms as annotated fields: pydantic checks them, one line says what is wrong."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from difflib import get_close_matches
from enum import StrEnum
from functools import lru_cache
from typing import Annotated, Any, get_args, get_type_hints

import numpy as np
from pydantic import AfterValidator, Field, TypeAdapter, ValidationError

from ..problem import TrajgapError


def nearest(word: str, known: Iterable[str] | Mapping[str, str]) -> str:
    """How to fix an unknown word: the known one that is spelt most like it.

    A mapping names what is meant by each.
    """
    pairs = known.items() if isinstance(known, Mapping) else ((one, one) for one in known)
    meant = {folded(one): said for one, said in pairs}
    close = get_close_matches(folded(word), meant, n=1, cutoff=0.0)
    return f"did you mean {meant[close[0]]!r}?"


def folded(word: str) -> str:
    """A word without the case, hyphens and underscores that people write as they like."""
    return word.casefold().replace("-", "").replace("_", "")


# Each returns a pydantic Field; its description is what the message says was expected.


def whole(least: int) -> Any:
    """Whole numbers from ``least`` on."""
    return Field(strict=True, ge=least, description=f"a whole number of {least} or more")


COUNT = Annotated[int, whole(1)]
"""A number of evaluations or of processes."""
SEED = Annotated[int, whole(0)]
"""What numpy takes as entropy, in one line."""


def number(*, infinite: bool = False) -> Any:
    """Numbers of 0 or more; infinite only if allowed."""
    return Field(strict=True, ge=0, allow_inf_nan=infinite, description="a number of 0 or more")


def positive(*, infinite: bool = False) -> Any:
    """Numbers above 0; infinite only if allowed."""
    return Field(strict=True, gt=0, allow_inf_nan=infinite, description="a positive number")


def above(bound: float) -> Any:
    """Finite numbers above a bound."""
    words = f"a number above {bound:g}"
    return Field(strict=True, gt=bound, allow_inf_nan=False, description=words)


def share(*, ends: bool = True) -> Any:
    """Numbers from 0 to 1, the ends included or not."""
    if ends:
        return Field(strict=True, ge=0, le=1, description="a number from 0 to 1")
    return Field(strict=True, gt=0, lt=1, description="a number between 0 and 1")


def switch() -> Any:
    """True or false."""
    return Field(strict=True, description="true or false")


def _ascending(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] > ends[1]:
        raise ValueError("the larger one comes first")
    return ends


_Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]

Span = Annotated[
    tuple[_Finite, _Finite],
    AfterValidator(_ascending),
    Field(description="two numbers, the smaller first"),
]
"""A range: two finite numbers in ascending order."""


@lru_cache(maxsize=64)
def _adapter(hint: Any) -> TypeAdapter[Any]:
    return TypeAdapter(hint)


def _expected(hint: Any, value: object) -> str:
    """What a setting's annotation asks for, beside what came."""
    shown = repr(str(value) if isinstance(value, str) else value)
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        words = [str(option) for option in hint]
        if isinstance(value, str):
            return f"{shown} is unknown; {nearest(value, words)}"
        return f"expected one of {', '.join(words)}, got {shown}"
    words = [m.description for m in get_args(hint) if getattr(m, "description", None)]
    return f"expected {words[-1]}, got {shown}"


def checked(hint: Any, name: str, value: object) -> Any:
    """Clean value of one setting.

    Parameters
    ----------
    hint : Any
        Its annotation: an enumeration, or a type with one of the fields of this module.
    name : str
        Words for the message.

    Raises
    ------
    TrajgapError
        One line: the name, what was expected and what came.
    """
    given = value.item() if isinstance(value, np.generic) else value
    try:
        return _adapter(hint).validate_python(given)
    except ValidationError:
        raise TrajgapError(f"{name}: {_expected(hint, value)}") from None


@lru_cache(maxsize=64)
def _hints(record: Hashable) -> dict[str, Any]:
    """Annotations of the settings of a record: enumerations, and types with a field."""
    hints = get_type_hints(record, include_extras=True)
    return {
        name: hint
        for name, hint in hints.items()
        if hasattr(hint, "__metadata__") or (isinstance(hint, type) and issubclass(hint, StrEnum))
    }


def clean(settings: Any) -> None:
    """Replace the settings of a frozen record by their clean values.

    Raises
    ------
    TrajgapError
        One line: the algorithm's kind, the field, what was expected and what came.
    """
    record: Any = type(settings)
    for name, hint in _hints(record).items():
        value = checked(hint, f"{settings.kind}: {name}", getattr(settings, name))
        object.__setattr__(settings, name, value)


def reject(kind: str, name: str, reason: str) -> TrajgapError:
    """Error for a field whose value contradicts another one."""
    return TrajgapError(f"{kind}: {name}: {reason}")
