"""IPOPT's own iterations look at the clock, where compiling its limit in would cost too much."""

from __future__ import annotations

from functools import cache
from typing import Any

from .clock import time_up
from .symbolic import ca


@cache
def _kind() -> Any:
    """The class of the callbacks; made on first use, since CasADi is imported then."""

    class LookAtClock(ca.Callback):  # type: ignore[misc]
        """Called by IPOPT after every iteration; ends the call where the time is up."""

        def __init__(self, variables: int, rows: int) -> None:
            ca.Callback.__init__(self)
            self._sizes = {"x": variables, "lam_x": variables, "g": rows, "lam_g": rows, "f": 1}
            self.construct("look_at_clock", {})

        def get_n_in(self) -> int:
            return int(ca.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, i: int) -> str:
            return str(ca.nlpsol_out(i))

        def get_sparsity_in(self, i: int) -> Any:
            size = self._sizes.get(ca.nlpsol_out(i), 0)
            return ca.Sparsity.dense(size, 1) if size else ca.Sparsity(0, 0)

        def eval(self, _: Any) -> list[int]:
            return [int(time_up())]

    return LookAtClock


def look_at_clock(variables: int, rows: int) -> Any:
    """A callback for an NLP of this size; whoever gives it to a solver keeps it.

    Parameters
    ----------
    variables, rows : int

    Returns
    -------
    casadi.Callback
    """
    return _kind()(variables, rows)
