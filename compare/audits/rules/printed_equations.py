"""TG603: printed kinematic equations against forward kinematics of the printed table."""

from __future__ import annotations

from collections.abc import Iterator

from ....problem.cases import StatementClaim
from ....problem.robots import Chain, Equation, EquationCheck, check_equation
from ...documents import Basis, ClaimVerdict, Finding
from ..study import Study
from .rule_group import Explained, rule_group


@rule_group(
    TG603=Explained(
        "Printed kinematic equations hold on the printed chain",
        "Do the printed kinematic equations hold on the printed robot? Both sides are computed at "
        "random joint angles.",
        "Supported if all hold as the text carries them. Otherwise not checkable, with what would "
        "make each of them hold: signs, exponents and indices are easily lost in extracted text.",
        "13 of 16 equations hold; another holds with a plus sign that the text lacks.",
    ),
    without_waypoints=True,
)
def judge_equations(study: Study) -> Iterator[Finding]:
    """One finding for the statement that the equations of the file hold.

    Nothing is ever held against a paper: whether a sign was lost in print or in the extraction
    cannot be told from the text.
    """
    for claim in study.claims:
        if isinstance(claim, StatementClaim) and claim.checks == "equations":
            chain = study.case.chain()
            assert chain is not None
            yield _judged(claim, study.case.document.equations, chain)


def _judged(claim: StatementClaim, equations: tuple[Equation, ...], chain: Chain) -> Finding:
    held, mended, apart = [], [], []
    for equation in equations:
        found = check_equation(chain, equation.printed)
        if found.holds:
            held.append(_name(equation))
        elif equation.mended is not None and check_equation(chain, equation.mended).holds:
            mended.append(f"{_name(equation)} {_partly(found)}with {equation.mend}")
        else:
            apart.append(_name(equation))
    listed = f": {', '.join(held)}" if held else ""
    said = [
        f"{len(held)} of {len(equations)} equations hold at every pose tried, as the text has them"
        f"{listed}."
    ]
    if mended:
        said.append(f"Others hold once mended: {'; '.join(mended)}.")
    if apart:
        said.append(f"Not as the text has them: {', '.join(apart)}.")
    if mended or apart:
        said.append("Whether the paper or the extraction lost what is missing cannot be told.")
    return Finding(
        rule="TG603",
        verdict=ClaimVerdict.NOT_CHECKABLE if mended or apart else ClaimVerdict.SUPPORTED,
        basis=Basis.KINEMATICS,
        claim=claim.id,
        printed="; ".join(equation.where for equation in equations),
        computed=f"{len(held)} hold as they are, {len(mended)} once mended",
        kind="in part" if mended or apart else "all",
        sentences=tuple(said),
    )


def _name(equation: Equation) -> str:
    return equation.where.removeprefix("equation ")


def _partly(found: EquationCheck) -> str:
    """How often it holds as it is, where it does at some poses."""
    return f"({found.share:.0%} of the poses as it is) " if found.share else ""
