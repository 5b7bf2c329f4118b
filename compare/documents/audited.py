"""What `audit` answers: findings, verdicts, where the time goes, readings, instances."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...nlp import Evidence
from ...verify import Subject
from .benched import Reached
from .card import VerdictCard
from .entry import Count, Document, Entry, Fact, OrWhy
from .finding import Finding, Judgement
from .vocabulary import Effect, Severity, Urgency
from .waterfall import ReadingsSummary, Waterfall


class StatedAnswer(Entry):
    """What the authors were asked about a claim, and what they said."""

    sent: str
    """Day on which they were asked."""
    answered: OrWhy[str]
    """Day of their answer."""
    outcome: str
    """What came of it; empty if nothing has yet."""


class StatedClaim(Entry):
    """One claim: its words, its place in the paper, its digits."""

    claim: str
    """Its id, which findings, verdicts and causes name."""
    quantity: str
    """What kind of claim it is."""
    text: str
    """What the paper says, in our words."""
    where: str
    """Place in the paper: section, table, row."""
    printed: str
    """The printed digits with their unit; empty if it prints none."""
    objective: OrWhy[str]
    """What was minimised for a printed time, where that is not time alone."""
    answer: OrWhy[StatedAnswer]
    """Of the authors, where they were asked."""


class StatedSource(Entry):
    """Where the numbers were printed; an empty text is not named in the case file."""

    kind: str
    """``paper``, ``teaching``, ``software`` or ``unpublished``."""
    authors: str
    title: str
    journal: str
    year: OrWhy[int]
    doi: str
    note: str
    transcribed_by: OrWhy[str]
    """Who typed the numbers of the case file, and from what."""
    checked_by: OrWhy[str]
    """Who compared them with the paper, and how."""


class Consequence(Entry):
    """What follows from a cause and is not a fault of its own."""

    rule: str
    """Permanent id of the rule that saw it."""
    claim: str | None
    """Null where it is about no claim."""
    says: str
    """One or two sentences with the numbers."""


class Explanation(Entry):
    """An innocent reason that the printed numbers allow, tried by computing."""

    change: str
    """What would have to be otherwise in print."""
    effect: str
    """What that would settle, and what it would leave."""
    settles: bool = True
    """Whether it would settle the whole of it."""
    in_any: str = Field(default="", exclude=True)
    """The effect without its reading; the effect itself if empty; not in JSON."""
    brief: str = Field(default="", exclude=True)
    """The effect in fewer words, for a card; the effect itself if empty; not in JSON."""


class Cause(Entry):
    """One thing that speaks against something printed; findings that follow from it stand below."""

    severity: Severity
    """The gravest of its findings."""
    rule: str
    """Permanent id of the rule that saw it first."""
    claim: str | None
    """What it is about; null if it is about the case or a table."""
    says: str
    """One or two sentences with the numbers, under the first of its readings."""
    head: Finding | None = Field(default=None, exclude=True)
    """Its finding under that reading; None if a cause is made by hand; not in JSON."""
    readings: tuple[str, ...]
    """The readings under which it holds; empty if it depends on none."""
    elsewhere: str = Field(default="", exclude=True)
    """What contradicts the same claim under all other readings; empty if nothing does or there
    are none; not in JSON."""
    explanations: tuple[Explanation, ...]
    """The most charitable first; empty if none that was tried fits the numbers."""
    consequences: tuple[Consequence, ...]


class Edit(Entry):
    """One printed thing that is to read otherwise; all edits of a draft hold together."""

    claim: str | None
    """Id of the claim; null if the text as a whole is to say something."""
    key: str
    """Key of the claim in the case file; `claim` where it is to be left out as a whole, `readings`
    where the text is to say which reading is meant."""
    printed: tuple[str, ...]
    """What stands there."""
    becomes: tuple[str, ...]
    """What is to stand there; empty if nothing is."""
    trigger: str | None
    """Id of the claim that is wrong without it; null if it follows from other edits alone."""


class Advice(Entry):
    """One thing to change in a draft, in the second person."""

    urgency: Urgency
    where: str
    """Place in the draft."""
    claim: str | None
    """Id of the claim; null if it is about the case, a table or an algorithm."""
    says: str
    """What was found."""
    change: str
    """How to fix it; numbers that it names were computed and checked."""
    edits: tuple[Edit, ...]
    """The same as facts; empty if no number mends it. After all edits of the draft, an audit
    finds nothing but what has none."""


class UsedCertificate(Entry):
    """A certificate that the audit proved again and rests on."""

    file: str
    """Name of the file."""
    sha256: str
    """Of the file."""
    subject: Subject
    """Curves that it speaks about."""


class Provenance(Entry):
    """Date, versions, hashes and the command that makes the audit again."""

    date: str
    """Day of the audit in UTC, such as "2026-01-31"; that of SOURCE_DATE_EPOCH where it is set."""
    trajgap: str
    """Version."""
    commit: OrWhy[str]
    """Of the git checkout that it ran from; ends with "+changes" where files differ from it."""
    libraries: dict[str, str]
    """Versions of Python and of the libraries that can move a digit or a pixel."""
    seeds: Count
    """Seeds of each replay, from 0 on."""
    case_sha256: OrWhy[str]
    """Hash of the case file."""
    certificates: tuple[UsedCertificate, ...]
    command: str
    """What makes the audit again."""
    citation: str
    """BibTeX entry for this audit."""


class Procedure(Entry):
    """A curve and the algorithm that searches its durations, as the paper names them."""

    problem: str
    algorithm: str


class Reduction(Entry):
    """Quantiles of the reductions of the total over pairs of answers, as shares of the slower."""

    reading: str
    effect: Effect
    objective: str | None
    """Null for the curve alone, at the best known optima."""
    step: float | None
    """Step length; null for all of them."""
    pairs: Count
    missing: Count
    """Pairs without two answers."""
    lowest: OrWhy[float]
    lower_quarter: OrWhy[float]
    median: OrWhy[float]
    upper_quarter: OrWhy[float]
    highest: OrWhy[float]
    shorter: OrWhy[float]
    """Share of the pairs with a reduction above 0."""
    median_from: OrWhy[float]
    """Lower end of the 95 % interval of an instance's median, instances resampled."""
    median_to: OrWhy[float]
    """Its upper end."""


class KnownOptimum(Entry):
    """The best known total of one curve on one instance."""

    total_time: OrWhy[float]
    """s"""
    evidence: Evidence
    status: str


class Totals(Entry):
    """Reported totals of all runs of each procedure, s; null if a run has no answer."""

    objective: str
    slower: tuple[float | None, ...]
    slower_algorithm_on_faster_curve: tuple[float | None, ...]
    faster: tuple[float | None, ...]


class InstanceUnderReading(Entry):
    """One instance under one reading."""

    reading: str
    slower_optimum: KnownOptimum
    faster_optimum: KnownOptimum
    totals: tuple[Totals, ...]


class Instance(Entry):
    """Way-points that were drawn, and what the two procedures make of them."""

    step: float
    instance: Count
    waypoints: tuple[tuple[float, ...], ...]
    """One row per way-point, rad; m of joints that slide."""
    readings: tuple[InstanceUnderReading, ...]


class ExaminedInstances(Entry):
    """A relative claim examined on instances drawn from the robot's workspace."""

    id: str
    claim: str
    why: str
    """Why such instances say something about the claim."""
    kind: Literal["joint", "end"]
    unit: str
    """Of the steps."""
    steps: tuple[float, ...]
    instances_per_step: Count
    seed: Count
    samples: Count
    """Positions of the workspace that way-points are drawn from."""
    runs: Count
    """Runs of each algorithm on each instance."""
    objectives: tuple[str, ...]
    readings: tuple[str, ...]
    slower: Procedure
    """The one that is said to be slower."""
    faster: Procedure
    """The paper's."""
    printed_lowest: OrWhy[float]
    """Smallest reduction that the printed digits allow."""
    printed_highest: OrWhy[float]
    """Largest one."""
    reductions: tuple[Reduction, ...]
    instances: tuple[Instance, ...]


class AuditedCase(Entry):
    """What was found of one case."""

    case: str
    title: str
    source: StatedSource
    card: VerdictCard
    errors: Count
    """How many causes have severity error."""
    causes: tuple[Cause, ...]
    """Evidence against printed statements, each once; the gravest first."""
    advice: OrWhy[tuple[Advice, ...]]
    """With `--draft`: what its author can change before submitting, the gravest first."""
    claims: tuple[StatedClaim, ...]
    """What the paper states; the other keys name a claim by its id."""
    findings: tuple[Finding, ...]
    verdicts: tuple[Judgement, ...]
    """On every claim."""
    waterfalls: tuple[Waterfall, ...]
    """Where the time goes, for each problem and reading."""
    reached: tuple[Reached, ...]
    """How near each of the paper's algorithms gets, from committed runs at the paper's budget."""
    readings: OrWhy[ReadingsSummary]
    """The readings side by side."""
    left_out: Annotated[tuple[str, ...], Fact("not certified")]
    """What the time budget left uncertified."""
    not_replayed: Annotated[tuple[str, ...], Fact("not replayed")]
    """Algorithms that no implementation here replays, and why."""
    families: tuple[ExaminedInstances, ...]
    """Relative claims on instances drawn from the robot's workspace."""
    provenance: Provenance


class AuditDocument(Document):
    """What `trajgap audit --json` prints."""

    cases: tuple[AuditedCase, ...]
