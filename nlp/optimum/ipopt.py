"""A formulation with its solvers: the choice of its form, and the options of IPOPT."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np

from ...problem import Interpolant, Problem, TrajgapError
from ...problem.curves import layout
from .clock import call_cap
from .formulation import Form, Formulation, Structure, build
from .symbolic import ca

ADAPTIVE_VARIABLES = 1000
"""Up to here the adaptive barrier needs far fewer iterations, beyond it sometimes very many; with
virtual breaks, whose segments may vanish, it needs more."""
QUICK_VARIABLES = 60
"""Up to here a call of IPOPT ends by itself: 300 iterations of a millisecond or less."""


@dataclass(frozen=True, eq=False)
class Compiled:
    """A formulation with its solvers: cold from a start, warm from a neighbouring solution."""

    formulation: Formulation
    build_seconds: float
    _solver: Callable[[bool, float | None], Any]

    @property
    def cold(self) -> Any:
        """From a start; ends with the time that `clock.stopping_after` leaves."""
        return self._solver(False, self._cap())

    @property
    def warm(self) -> Any:
        """From a neighbouring solution."""
        return self._solver(True, self._cap())

    def _cap(self) -> float | None:
        return call_cap() if self.formulation.sizes["variables"] > QUICK_VARIABLES else None


def ipopt_options(warm: bool, adaptive: bool = False, cap: float | None = None) -> dict[str, Any]:
    """Options of IPOPT that reach 1e-9, from a cold or a warm start, in ``cap`` seconds a call."""
    options: dict[str, Any] = {
        "print_time": False,
        "show_eval_warnings": False,  # the status says where a function is not defined
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-9,
        "ipopt.constr_viol_tol": 1e-10,
        "ipopt.dual_inf_tol": 1e-8,
        "ipopt.compl_inf_tol": 1e-9,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.honor_original_bounds": "yes",
        "ipopt.acceptable_iter": 0,
        "ipopt.max_iter": 300,
        "ipopt.mu_strategy": "adaptive" if adaptive and not warm else "monotone",
    }
    if warm:
        options |= {
            "ipopt.tol": 1e-12,
            "ipopt.constr_viol_tol": 1e-12,
            "ipopt.compl_inf_tol": 1e-12,
            "ipopt.max_iter": 60,
            "ipopt.warm_start_init_point": "yes",
            "ipopt.warm_start_bound_push": 1e-9,
            "ipopt.warm_start_bound_frac": 1e-9,
            "ipopt.warm_start_slack_bound_push": 1e-9,
            "ipopt.warm_start_slack_bound_frac": 1e-9,
            "ipopt.warm_start_mult_bound_push": 1e-9,
            "ipopt.mu_init": 1e-7,
            "ipopt.nlp_scaling_method": "none",
        }
    return options if cap is None else options | {"ipopt.max_wall_time": cap}


@lru_cache(maxsize=64)
def compiled(structure: Structure) -> Compiled:
    """Build a structure and its solvers once; later problems of the same shape reuse them."""
    began = time.perf_counter()
    f = build(structure)
    nlp = {
        "x": f.variables,
        "p": f.parameters,
        "f": f.objective,
        "g": ca.vertcat(f.equalities, f.inequalities),
    }
    adaptive = f.sizes["variables"] <= ADAPTIVE_VARIABLES and not structure.interpolant.virtual

    @cache
    def solver(warm: bool, cap: float | None) -> Any:
        name = "warm" if warm else "cold"
        return ca.nlpsol(name, "ipopt", nlp, ipopt_options(warm, adaptive, cap))

    built = Compiled(f, 0.0, solver)
    _ = built.cold, built.warm
    return replace(built, build_seconds=time.perf_counter() - began)


def best_form(interpolant: Interpolant, joints: int) -> Form:
    """Reduced where few coefficients are eliminated, lifted otherwise (benchmarks/nlp_forms.py)."""
    small = layout(interpolant).unknowns <= 16 and interpolant.free * joints <= 6
    return Form.REDUCED if small else Form.LIFTED


def structure_of(problem: Problem, form: Form | None = None) -> Structure:
    """The shape of a problem's NLP: curve, joints, and which derivatives are limited.

    Raises
    ------
    TrajgapError
        If ratios of the durations are fixed: in the NLP each duration is free.
    """
    if problem.ratios is not None:
        raise TrajgapError(
            "ratios: the NLP frees each duration; `solve` gives the shortest total at fixed ratios"
        )
    limits = problem.limits.sides
    usable = np.array(np.isfinite(limits) & (limits > 0)).max(axis=0)
    orders = tuple(r for r in (1, 2, 3) if usable[:, r - 1].any())
    if problem.limits.limits_position:
        orders = (0, *orders)
    joints = problem.waypoints.shape[1]
    chosen = form or best_form(problem.piecewise, joints)
    return Structure(problem.piecewise, joints, orders, chosen, problem.limits.uneven)
