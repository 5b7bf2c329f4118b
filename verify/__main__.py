"""Command line of the verifier, from the installed package or from the folder alone."""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType


def _package() -> ModuleType:
    """The package that this file belongs to, also if its folder was run by name."""
    if __package__:
        return importlib.import_module(__package__)
    folder = Path(__file__).resolve().parent
    # Its modules must not be found under names of their own.
    sys.path[:] = [entry for entry in sys.path if Path(entry).resolve() != folder]
    found = importlib.util.spec_from_file_location(
        "trajgap_verify", folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert found is not None
    assert found.loader is not None
    package = importlib.util.module_from_spec(found)
    sys.modules["trajgap_verify"] = package
    found.loader.exec_module(package)
    return package


def main() -> int:
    """Judge every file that is named; 0 if all prove their claims, else 1."""
    package = _package()
    parser = argparse.ArgumentParser(
        prog="verify", description="Verify certificates without any solver."
    )
    parser.add_argument("files", nargs="+", metavar="FILE", help="a certificate, or a state")
    parser.add_argument(
        "--time",
        type=float,
        default=package.SECONDS,
        metavar="SECONDS",
        help="for each file (default: %(default)g)",
    )
    arguments = parser.parse_args()
    proved = True
    for name in arguments.files:
        verdict = package.verify_certificate(name, seconds=arguments.time)
        proved &= verdict.proves
        print(f"{package.shown(name, 500)}: {verdict}")
        if verdict.problem_hash is not None:
            print(f"    {verdict.asked}")
    return 0 if proved else 1


if __name__ == "__main__":
    sys.exit(main())
