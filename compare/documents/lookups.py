"""What `cases`, `show`, `case diff`, `explain` and `suite` answer: what is shipped and written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, get_args

from pydantic import PlainSerializer, SkipValidation, WithJsonSchema
from pydantic.json_schema import JsonSchemaValue

from ...problem import Case
from ...problem.cases import (
    AlgorithmBlock,
    AnyClaim,
    Assumption,
    InstancesBlock,
    NotCheckable,
    ProblemBlock,
    Reading,
    Robot,
    Source,
    Table,
)
from ...problem.suite import BenchmarkInstance, BoundEvidence, suite_version
from .entry import Count, Document, Entry, OrWhy, known


class ListedCase(Entry):
    """A published case."""

    id: str
    title: str
    problems: tuple[str, ...]
    """Ids."""
    readings: tuple[str, ...]
    """Ids."""
    claims: int
    """Their number."""


class CasesDocument(Document):
    """What `trajgap cases --json` prints."""

    cases: tuple[ListedCase, ...]


def cases_document(cases: Iterable[Case]) -> CasesDocument:
    """Document of `cases`: what is shipped."""

    def listed(case: Case) -> ListedCase:
        problems, readings = tuple(p.id for p in case.problems), tuple(r.id for r in case.readings)
        return ListedCase.of(case, problems=problems, readings=readings, claims=len(case.claims))

    return CasesDocument(cases=tuple(map(listed, cases)))


_WRITTEN = PlainSerializer(
    lambda block: block.model_dump(mode="json", exclude_none=True, exclude_unset=True)
)
"""Writes a block of a case file with the keys that stand in the file."""


def _keys(*texts: str, **others: JsonSchemaValue) -> WithJsonSchema:
    """JSON Schema of a block: the keys that every such block has, most of them texts."""
    keys = {**{key: {"type": "string"} for key in texts}, **others}
    description = "As in the case file, digits as printed: case.schema.json."
    return WithJsonSchema(
        {"type": "object", "description": description, "required": [*keys], "properties": keys}
    )


_QUANTITIES = {
    "enum": [
        get_args(kind.model_fields["quantity"].annotation)[0]
        for kind in get_args(get_args(AnyClaim)[0])
    ]
}
"""JSON Schema of what a claim is about: one word for each kind of claim."""


class ShowDocument(Document):
    """What `trajgap show --json` prints."""

    id: str
    title: str
    source: Annotated[SkipValidation[Source], _WRITTEN, _keys()]
    robot: Annotated[
        SkipValidation[Robot],
        _WRITTEN,
        _keys("name", joints={"type": "array", "items": {"type": "string"}}),
    ]
    problems: tuple[Annotated[SkipValidation[ProblemBlock], _WRITTEN, _keys("id")], ...]
    readings: tuple[
        Annotated[
            SkipValidation[Reading], _WRITTEN, _keys("id", "why", default={"type": "boolean"})
        ],
        ...,
    ]
    claims: tuple[
        Annotated[SkipValidation[AnyClaim], _WRITTEN, _keys("id", "where", quantity=_QUANTITIES)],
        ...,
    ]
    assumptions: tuple[
        Annotated[SkipValidation[Assumption], _WRITTEN, _keys("id", "text", "choice")], ...
    ]
    algorithms: tuple[Annotated[SkipValidation[AlgorithmBlock], _WRITTEN, _keys("id")], ...]
    families: tuple[Annotated[SkipValidation[InstancesBlock], _WRITTEN, _keys("id")], ...]
    tables: tuple[Annotated[SkipValidation[Table], _WRITTEN, _keys("id")], ...]
    not_checkable: tuple[Annotated[SkipValidation[NotCheckable], _WRITTEN, _keys("id")], ...]


def show_document(
    case: Case, problem: str | None = None, reading: str | None = None
) -> ShowDocument:
    """Document of `show`: one case file, its numbers as printed.

    `problem, reading`: keep only this one, and the claims that speak about it.
    """
    pairs = case.selections(problem, reading)
    problems = {pid for pid, _ in pairs}
    readings = {rid for _, rid in pairs}
    default = case.default_reading.id
    return ShowDocument.of(
        case,
        problems=tuple(p for p in case.problems if p.id in problems),
        readings=tuple(
            r.model_copy(update={"default": r.id == default})
            for r in case.readings
            if r.id in readings
        ),
        claims=tuple(c for c in case.claims if c.problem is None or c.problem in problems),
        families=case.instances,
    )


class DifferingField(Entry):
    """One place at which two transcriptions differ."""

    field: str
    """Where, such as "claims.total.value"."""
    first: str
    """What stands there in the first file; digits in quotes are printed ones."""
    second: str
    """The same of the second file."""


class CaseDiffDocument(Document):
    """What `trajgap case diff --json` prints."""

    first: str
    """Name of the first file."""
    second: str
    """Name of the second file."""
    differences: tuple[DifferingField, ...]
    """Empty if the transcriptions agree."""


class ExplainedRule(Entry):
    """A rule of the audit."""

    id: str
    """Permanent id, e.g. "TG101"."""
    title: str
    """What it looks at."""
    asks: str
    """What it compares, and how."""
    concludes: str
    """What it may say of a claim, and what it never says."""
    example: str
    """With made-up numbers."""


class ExplainedWord(Entry):
    """A word of the reports."""

    word: str
    about: str
    """What the word is said of, such as "on a claim"."""
    meaning: str


class ExplainDocument(Document):
    """What `trajgap explain --json` prints."""

    rules: tuple[ExplainedRule, ...]
    words: tuple[ExplainedWord, ...]


class MeasuredHardness(Entry):
    """How hard an instance is to solve."""

    starts: Count
    """Descents from random starts within the bounds of the durations."""
    basins: Count
    """Different totals that they ended in."""
    best_basin_share: float
    """Share of them that ended within 0.1 % of the best known total."""
    drawn: Count
    """Durations drawn uniformly within their bounds."""
    feasible_share: float
    """Share of them that keep the limits."""
    baselines: Mapping[str, float]
    """Share of its runs in which a baseline ends within 1 % of the best known total."""
    baseline_runs: Count
    baseline_budget: Count
    """Number of evaluations of each run."""


class SuiteInstance(Entry):
    """An instance, in the words of the suite's table."""

    name: str
    curve: str
    joints: Count
    segments: Count
    tight: tuple[str, ...]
    """Limits that the best known answer reaches."""
    lower: float
    """No feasible total is below it, s; rounded down."""
    upper: float
    """Total of the best known answer, s; rounded up."""
    width: float
    """(upper - lower)/upper"""
    evidence: BoundEvidence
    lower_subject: str
    """Over which curves the lower bound is proved."""
    segment_durations: tuple[float, ...]
    """Durations of the best known answer, s."""
    case_sha256: str
    certificate: OrWhy[str]
    """Its file, as the suite ships it."""
    certificate_sha256: OrWhy[str]
    command: str
    """Command that creates the certificate."""
    hardness: OrWhy[MeasuredHardness]


class SuiteDocument(Document):
    """What `trajgap suite --json` prints."""

    version: str
    """Of the suite."""
    instances: tuple[SuiteInstance, ...]


class SuiteShowDocument(Document):
    """What `trajgap suite show --json` prints."""

    version: str
    """Of the suite."""
    instance: SuiteInstance
    title: str
    source: str
    """Where way-points and limits come from."""
    verify: OrWhy[str]
    """Command that proves the bounds again, with one file."""


def _entry(one: BenchmarkInstance) -> SuiteInstance:
    large = "too large to ship; `command` makes it"
    hardness = one.hardness and MeasuredHardness.of(one.hardness)
    return SuiteInstance.of(
        one,
        segment_durations=one.durations,
        certificate=known(one.certificate, large),
        certificate_sha256=known(one.certificate_sha256, "nothing is proved"),
        hardness=known(hardness, "not measured yet"),
    )


def suite_document(instances: Iterable[BenchmarkInstance]) -> SuiteDocument:
    """Document of `suite`: the table."""
    return SuiteDocument(version=suite_version(), instances=tuple(map(_entry, instances)))


def instance_document(one: BenchmarkInstance, file: str | None) -> SuiteShowDocument:
    """Document of `suite show`: one instance.

    `file` is where its certificate lies.
    """
    case = one.case()
    return SuiteShowDocument(
        version=suite_version(),
        instance=_entry(one),
        title=case.title,
        source=case.source.title,
        verify=known(
            None if file is None else f"python -m trajgap.verify {file}",
            f"no certificate is shipped; create it: {one.command}",
        ),
    )
