"""What `suite` and `suite show` answer: instances with proved bounds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...problem.suite import BenchmarkInstance, BoundEvidence, suite_version
from .entry import Count, Document, Entry, OrWhy, known


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
