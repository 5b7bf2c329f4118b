"""A kinematic equation as a paper prints it, held against forward kinematics of the robot."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from ..arrays import Array
from ..errors import TrajgapError
from ..files import MOST
from ..printed import Id, Strict, Text, fault
from .chain import Chain, link_frames
from .inverse import REACHED

_OPERATORS: dict[type[ast.AST], Callable[[Any, Any], Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.MatMult: np.matmul,
}
"""What may stand between two parts."""
_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "sqrt": (1, np.sqrt),
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "acos": (1, np.arccos),
    "atan2": (2, np.arctan2),
    "inv": (1, np.linalg.inv),
}
"""What may be applied, with the number of arguments."""


class Equation(Strict):
    """A kinematic equation as the text carries it, and how it may have read."""

    id: Id
    where: Text
    printed: Text
    """As the text carries it, in the words of `check_equation`."""
    mended: Text | None = None
    """With what the extraction may have lost put back."""
    mend: Text | None = None
    """What that is, in words; with `mended`."""

    @model_validator(mode="after")
    def _together(self) -> Self:
        if (self.mended is None) != (self.mend is None):
            missing = ".mend" if self.mend is None else ".mended"
            raise fault(missing, "is missing; mended and mend must be given together")
        return self


@dataclass(frozen=True)
class EquationCheck:
    """How well an equation holds."""

    text: str
    share: float
    """Share of the samples at which both sides agree, with either sign of "pm"."""
    largest: float
    """Largest difference of the sides over the samples; NaN if a side has no value."""

    @property
    def holds(self) -> bool:
        """Whether the two sides agree at every sample."""
        return self.share == 1.0


def check_equation(chain: Chain, text: str, samples: int = 200) -> EquationCheck:
    """Evaluate both sides of an equation at random joint values of a robot.

    Parameters
    ----------
    chain : Chain
        A chain of fewer than ten joints, all revolute.
    text : str
        "left = right", after definitions "K = ...;". Names: ``t1`` the angle of a joint; ``c23``
        and ``s23`` cosine and sine of the sum of the angles named; ``a2``, ``d2`` of a row of the
        table; ``px``, ``nx``, ``ox``, ``ax`` and so on of the end's pose, ``r12`` an entry of its
        rotation; ``T1`` the transform of a link, ``T`` that of the end; ``pi``; ``pm`` for ±.
        Between them ``+ - * / ** @``, and sqrt, sin, cos, tan, acos, atan2, inv. An angle that
        stands alone on the left is compared modulo whole turns.
    samples : int
        Random joint values at which it is tried: one that holds nowhere near all of them is told
        from one that holds at all.

    Raises
    ------
    TrajgapError
        If the text is not an equation of that language.

    Examples
    --------
    >>> from trajgap.problem import load_robot
    >>> check_equation(load_robot("irb460"), "py/px = tan(t1)").holds
    True
    """
    *definitions, sides = (part.split("=") for part in text.split(";"))
    if len(text) > MOST.equation or any(len(part) != 2 for part in (*definitions, sides)):
        raise TrajgapError(
            f"{_short(text)} is not an equation; write left = right, in at most "
            f"{MOST.equation} characters"
        )
    if chain.joints > 9 or not chain.revolute.all():
        raise TrajgapError("equations: apply only to chains of fewer than ten joints that all turn")
    q = np.random.default_rng(0).uniform(*chain.span(), (samples, chain.joints))
    frames = link_frames(chain, q)
    differences = []
    for sign in (1.0, -1.0):
        names = {"pm": np.float64(sign), "pi": np.float64(np.pi)}
        with np.errstate(all="ignore"):
            for name, expression in definitions:
                names[name.strip()] = _value(expression, chain, q, frames, names)
            left, right = (_value(side, chain, q, frames, names) for side in sides)
            differences.append(
                _apart(left, right, wraps=bool(re.fullmatch(r"\s*t\d\s*", sides[0])))
            )
    apart = np.broadcast_to(np.fmin(*differences), (samples,))
    # Beside the larger of both sides and 1, float64 alone leaves less.
    return EquationCheck(text, float(np.mean(apart <= REACHED)), float(apart.max()))


def _apart(left: Array, right: Array, wraps: bool) -> Array:
    """Difference of two sides beside their size, one number for each sample."""
    try:
        apart = left - right
    except ValueError:
        raise TrajgapError(
            "equations: a number is compared with a transform; compare like with like"
        ) from None
    if wraps:
        return np.asarray(np.abs(apart - 2 * np.pi * np.round(apart / (2 * np.pi))))
    size = np.maximum(1.0, np.maximum(np.abs(left), np.abs(right)))
    relative = np.abs(apart) / size
    return np.asarray(relative.max(axis=(-2, -1)) if relative.ndim == 3 else relative)


def _value(text: str, chain: Chain, q: Array, frames: Array, names: dict[str, Any]) -> Any:
    """Value of an expression at all samples."""
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError):
        raise TrajgapError(f"{_short(text)} is not an expression; see check_equation") from None

    def value(node: ast.AST) -> Any:
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return np.float64(number)
            case ast.Name(id=name):
                return names[name] if name in names else _named(name, chain, q, frames)
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return -value(inner)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                return _OPERATORS[type(op)](value(left), value(right))
            case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if (
                name in _FUNCTIONS and len(given) == _FUNCTIONS[name][0]
            ):
                return _FUNCTIONS[name][1](*map(value, given))
        raise TrajgapError(f"{_short(ast.unparse(node))} is not supported; see check_equation")

    try:
        return value(tree)
    except TrajgapError:
        raise
    except ValueError:
        raise TrajgapError(
            f"{_short(text)} mixes numbers and transforms; compare like with like"
        ) from None


def _named(name: str, chain: Chain, q: Array, frames: Array) -> Any:
    """What a name of the paper stands for, at all samples."""
    joints = [int(digit) - 1 for digit in re.sub(r"\D", "", name)]
    inside = all(0 <= joint < chain.joints for joint in joints)
    end = frames[:, -1]
    if inside and re.fullmatch(r"[cs]\d+", name):
        angle = q[:, joints].sum(axis=1)
        return np.cos(angle) if name[0] == "c" else np.sin(angle)
    if inside and re.fullmatch(r"t\d", name):
        return q[:, joints[0]]
    if inside and re.fullmatch(r"[ad]\d", name):
        return (chain.a if name[0] == "a" else chain.d)[joints[0]]
    if re.fullmatch(r"r[123]{2}", name):
        return end[:, joints[0], joints[1]]
    if re.fullmatch(r"[noap][xyz]", name):
        return end[:, "xyz".index(name[1]), "noap".index(name[0])]
    if name == "T":
        return end
    if inside and re.fullmatch(r"T\d", name):
        before = frames[:, joints[0] - 1] if joints[0] else np.eye(4)
        return np.linalg.inv(before) @ frames[:, joints[0]]
    raise TrajgapError(f"{_short(name)} is not a name of this robot; see check_equation")


def _short(text: str) -> str:
    return repr(text.strip() if len(text) <= 40 else f"{text.strip()[:37]}...")
