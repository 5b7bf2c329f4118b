"""Committed results, single values of them, and certificates: the build verifies each again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from pathlib import Path
from typing import Any

from ...problem import TrajgapError
from ...problem.suite import BenchmarkInstance, list_instances, select_curve
from ...verify import CertificateVerdict, Refused, read_document, verify_certificate
from ..blocks import Prose
from ..documents import AuditedCase, Caveat, Why, capital, worth

LOCK = "lock.json"
"""File beside the results with the hash of each, and of what they were made from."""


@dataclass(frozen=True)
class Results:
    """A folder of JSON documents that `trajgap` printed."""

    folder: Path
    """Holds ``NAME.json``, one document each: what `trajgap audit --json` prints for one case."""

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the documents, in order."""
        return tuple(sorted(p.stem for p in self.folder.glob("*.json") if p.name != LOCK))

    def document(self, name: str) -> dict[str, Any]:
        """One document."""
        path = self.folder / f"{name}.json"
        if name not in self.names:
            known = ", ".join(self.names) or "none"
            raise TrajgapError(f"{path}: there is no such result; known: {known}")
        try:
            read = json.loads(path.read_text(encoding="utf-8"))
        except ValueError:
            raise TrajgapError(f"{path}: is not JSON; recreate it") from None
        if not isinstance(read, dict):
            raise TrajgapError(f"{path}: is not a document of trajgap; recreate it")
        return read

    def case(self, name: str) -> dict[str, Any]:
        """The audit of one case."""
        cases = self.document(name).get("cases")
        if not isinstance(cases, list) or len(cases) != 1:
            raise TrajgapError(
                f"{self.folder / name}.json: does not contain the audit of one case; print it "
                "with `trajgap audit CASE --json`"
            )
        found: dict[str, Any] = cases[0]
        return found

    def audited(self, name: str) -> AuditedCase:
        """The same as the audit had it before it was printed."""
        return AuditedCase.model_validate(_read(self.case(name)))

    def value(self, key: str) -> Any:
        """One value, such as ``"puma560-mnam-pso-353:card.optimum"``.

        After the name of the document stand keys, and in lists places from 0 or
        ``[key=value]`` for the one entry that says so.
        """
        name, _, path = key.partition(":")
        here: Any = self.document(name)
        if isinstance(here.get("cases"), list) and len(here["cases"]) == 1:
            here = here["cases"][0]
        for part in filter(None, path.split(".")):
            here = _inside(here, part, key)
        return here

    @cached_property
    def hashes(self) -> dict[str, str]:
        """SHA-256 of each document."""
        return {
            name: hashlib.sha256((self.folder / f"{name}.json").read_bytes()).hexdigest()
            for name in self.names
        }


def _inside(here: Any, part: str, key: str) -> Any:
    try:
        if isinstance(here, Mapping):
            return here[part]
        if part.startswith("[") and part.endswith("]"):
            name, _, wanted = part[1:-1].partition("=")
            (found,) = [one for one in here if str(one[name]) == wanted]
            return found
        return here[int(part)]
    except (KeyError, IndexError, TypeError, ValueError):
        raise TrajgapError(f"{key}: there is nothing at {part!r}; see the JSON") from None


def _read(value: Any) -> Any:
    """A part of a document as it was before it was printed."""
    if isinstance(value, list):
        return [_read(one) for one in value]
    if not isinstance(value, Mapping):
        return value
    whys = {
        key: value[f"{key}_why"] for key in value if value[key] is None and f"{key}_why" in value
    }
    found = {key: _read(one) for key, one in value.items() if key.removesuffix("_why") not in whys}
    for key, why in whys.items():
        found[key] = inf if why == "unbounded" else Why(why)
    if "message" in value:  # of a finding; JSON has its sentences in one text
        found["sentences"] = (value["message"],)
    if "caveats" in value:
        pairs = zip(value["caveats"], value["caveats_in_short"], strict=True)
        found["caveats"] = [Caveat(None, says, whole[len(says) + 2 :]) for whole, says in pairs]
    return found


def instances_of(curve: str | None) -> Sequence[BenchmarkInstance]:
    """Instances of a curve by its whole name, or by a word as `trajgap suite --curve` takes it."""
    every = list_instances()
    if curve is None:
        return every
    chosen = [one for one in every if one.curve == curve] or select_curve(curve)
    if not chosen:
        known = ", ".join(sorted({one.curve for one in every}))
        raise TrajgapError(f":curve: no curve is called {curve!r}; known: {known}")
    return chosen


def proved_again(path: Path, sha256: str | None = None) -> CertificateVerdict:
    """What a certificate proves.

    `sha256`: of the file that a result or a table was made from.
    """
    try:
        if sha256 is not None and hashlib.sha256(path.read_bytes()).hexdigest() != sha256:
            raise TrajgapError(
                f"{path}: is not the certificate with SHA-256 {sha256}; recreate the result"
            )
        verdict = verify_certificate(read_document(path))
    except (Refused, OSError) as error:
        raise TrajgapError(f"{path}: {error}") from None
    if not verdict.proves:
        raise TrajgapError(f"{path}: its claim is not proved: {verdict.reason}")
    return verdict


def proof_said(path: Path, sha256: str | None = None, name: str = "") -> Prose:
    """What a certificate proves, in a paragraph; parameters as there, and its name if not empty."""
    verdict = proved_again(path, sha256)
    shown = f" ({name})" if name else ""
    said = f"{capital(verdict.reason)}. Verified when this page was built{shown}."
    return Prose(said, word=worth(verdict))
