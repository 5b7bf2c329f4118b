"""What `trajgap` says without a command."""

import re

from support.command_line import program


def test_three_commands_to_begin_with() -> None:
    said = program()
    assert said.returncode == 0
    begin = said.stdout.partition("Usage:")[0]
    assert re.findall(r"^  trajgap (\w+)", begin, re.MULTILINE) == ["audit", "new", "check"]
