"""Where the checkout lies, so no test counts the folders above it."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def write_arm(folder: Path) -> None:
    """The URDF that README and guide read, as the guide shows it, into a folder."""
    guide = (ROOT / "docs/guides/check-a-trajectory.md").read_text("utf-8")
    _, _, rest = guide.partition(":caption: arm.urdf\n\n")
    (folder / "arm.urdf").write_text(rest.partition("```")[0], "utf-8")
