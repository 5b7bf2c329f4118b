"""Interpolants that papers name: how many degrees, how smooth, and what holds at the ends."""

from __future__ import annotations

from dataclasses import replace

from ..errors import TrajgapError
from .interpolant import Interpolant
from .kind import Derivatives, merged_values


def piecewise(
    degrees: tuple[int, ...],
    continuity: int = 2,
    ends: Derivatives = ((1, 0.0), (2, 0.0)),
    name: str | None = None,
    finish: Derivatives | None = None,
    virtual: tuple[int, ...] = (),
) -> Interpolant:
    """Polynomials of the given degrees, equally continuous at all via-points.

    Parameters
    ----------
    degrees : tuple of int
        Degree of each segment.
    continuity : int
        Highest continuous derivative order at the via-points.
    ends : tuple of (order, value)
        Derivatives prescribed at both ends, rad/sᵒʳᵈᵉʳ: one value for all joints, or one for each.
    finish : tuple of (order, value), optional
        Derivatives at the last way-point, if they differ; ``ends`` then applies to the start.
    virtual : tuple of int
        Breaks without a way-point, counted among all breaks with the first way-point as 0.

    Returns
    -------
    Interpolant
    """
    n = len(degrees)
    inner: tuple[Derivatives, ...] = ((),) * max(n - 1, 0)
    own = name or "-".join(map(str, degrees)) + f" polynomials, C{continuity}"
    return Interpolant(
        tuple(degrees),
        (continuity,) * max(n - 1, 0),
        (tuple(ends), *inner, tuple(ends if finish is None else finish)),
        virtual=tuple(sorted(virtual)),
        name=own + _virtual_words(virtual),
    )


def _virtual_words(virtual: tuple[int, ...]) -> str:
    if not virtual:
        return ""
    return f", {len(virtual)} virtual way-point{'s' if len(virtual) > 1 else ''}"


def three_five_three() -> Interpolant:
    """3-5-3 polynomials, C2, at rest with zero acceleration at both ends (puma560 (1)–(8))."""
    return piecewise((3, 5, 3), 2, name="3-5-3 polynomials")


def cubic_spline(
    segments: int,
    ends: Derivatives = ((1, 0.0),),
    finish: Derivatives | None = None,
    virtual: tuple[int, ...] = (),
) -> Interpolant:
    """C2 cubic spline; clamped (velocity 0 at the ends) unless ``ends`` says otherwise.

    Parameters
    ----------
    segments : int
        Those at virtual breaks included.
    ends : tuple of (order, value)
        Derivatives prescribed at both ends, rad/sᵒʳᵈᵉʳ: one value for all joints, or one for each.
    finish : tuple of (order, value), optional
        Derivatives at the last way-point, if they differ; ``ends`` then applies to the start.
    virtual : tuple of int
        As `piecewise` takes them.

    Examples
    --------
    Two joints that start at 0.5 and −0.2 rad/s and come to rest:

    >>> cubic_spline(3, ((1, (0.5, -0.2)),), finish=((1, 0.0),)).prescribed
    (((1, (0.5, -0.2)),), (), (), ((1, 0.0),))
    """
    return piecewise((3,) * segments, 2, ends, _spline_name(ends, finish), finish, virtual)


def _spline_name(ends: Derivatives, finish: Derivatives | None) -> str:
    """What tells a cubic spline from others: what holds at its ends."""
    if merged_values(ends) == merged_values(ends if finish is None else finish):
        if merged_values(ends) == ((1, 0.0),):
            return "clamped C2 cubic spline"
        if merged_values(ends) == ((2, 0.0),):
            return "natural C2 cubic spline"
        return f"C2 cubic spline with {_derivative_names(ends)} given at the ends"
    start, last = _derivative_names(ends), _derivative_names(finish or ())
    if start == last:
        return f"C2 cubic spline with {start} given at the ends"
    return f"C2 cubic spline with {start} given at the start, {last} at the finish"


def _derivative_names(at: Derivatives) -> str:
    words = ("", "velocity", "acceleration", "jerk")
    return " and ".join(words[order] for order, _ in at if order < len(words)) or "nothing"


def quintic_spline(
    segments: int,
    ends: Derivatives = ((1, 0.0), (2, 0.0)),
    finish: Derivatives | None = None,
    virtual: tuple[int, ...] = (),
) -> Interpolant:
    """C4 quintic spline; velocity and acceleration are 0 at both ends unless others are given.

    Arguments are those of `cubic_spline`.
    """
    return piecewise((5,) * segments, 4, ends, "C4 quintic spline", finish, virtual)


def septic_spline(
    segments: int,
    ends: Derivatives = ((1, 0.0), (2, 0.0), (3, 0.0)),
    finish: Derivatives | None = None,
    virtual: tuple[int, ...] = (),
) -> Interpolant:
    """C6 spline of degree 7; v = a = j = 0 at both ends unless others are given.

    Arguments are those of `cubic_spline`.
    """
    return piecewise((7,) * segments, 6, ends, "C6 septic spline", finish, virtual)


def cubic_spline_virtual(waypoints: int) -> Interpolant:
    """C2 cubic spline with two virtual way-points and v = a = 0 at both ends.

    The virtual breaks follow the first and precede the last way-point.
    """
    spline = cubic_spline(*_with_two_virtual(waypoints, 2))
    return replace(spline, name="C2 cubic spline with two virtual way-points")


def quintic_spline_virtual(waypoints: int) -> Interpolant:
    """C4 quintic spline with two virtual way-points and v = a = j = 0 at both ends.

    The virtual breaks follow the first and precede the last way-point.
    """
    spline = quintic_spline(*_with_two_virtual(waypoints, 3))
    return replace(spline, name="C4 quintic spline with two virtual way-points")


def _with_two_virtual(
    waypoints: int, orders: int
) -> tuple[int, Derivatives, Derivatives, tuple[int, ...]]:
    """Segments, both ends and virtual breaks: each makes room for one more derivative that is 0."""
    if waypoints < 2:
        raise TrajgapError("interpolant: at least two way-points are needed")
    ends = tuple((order, 0.0) for order in range(1, orders + 1))
    return waypoints + 1, ends, ends, (1, waypoints)


def rest_to_rest(segments: int, degree: int) -> Interpolant:
    """Polynomials of odd degree that stand still at every way-point.

    Degree 3: velocity 0; degree 5: also acceleration 0; degree 7: also jerk 0.
    """
    if degree not in (3, 5, 7, 9):
        raise TrajgapError("interpolant.degree: rest-to-rest needs degree 3, 5, 7 or 9")
    orders = tuple((r, 0.0) for r in range(1, (degree + 1) // 2))
    return Interpolant(
        (degree,) * segments,
        (0,) * (segments - 1),
        (orders,) * (segments + 1),
        name=f"rest-to-rest polynomials of degree {degree}",
    )


def jtraj(segments: int) -> Interpolant:
    """Quintic from rest to rest in every segment, as the robot toolboxes' ``jtraj`` joins points.

    The same curve as ``rest_to_rest(segments, 5)`` under the name that papers compare with:
    velocity and acceleration are 0 at every way-point.
    """
    return replace(rest_to_rest(segments, 5), name="jtraj (rest-to-rest quintics)")
