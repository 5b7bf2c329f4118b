"""What IPOPT is asked for."""

from __future__ import annotations

import casadi as ca
import pytest
from trajgap.nlp.optimum.ipopt import ipopt_options


@pytest.mark.parametrize("warm", [False, True])
def test_nothing_is_printed_where_a_function_is_not_defined(
    warm: bool, capfd: pytest.CaptureFixture[str]
) -> None:
    x = ca.MX.sym("x")
    program = {"x": x, "f": x, "g": ca.sqrt(x - 2.0)}
    solver = ca.nlpsol("cold", "ipopt", program, ipopt_options(warm))
    solver(x0=1.0, lbg=0.0, ubg=1.0)
    assert solver.stats()["return_status"] == "Invalid_Number_Detected"
    assert capfd.readouterr() == ("", "")
