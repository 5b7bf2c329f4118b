"""ROS bags, by the optional library rosbags: the trajectory of one topic."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import CaseError
from ..files import MOST, check_name, check_regular
from .ros import samples_of_message, trajectories
from .samples import Samples


def read_rosbag(path: Path, topic: str | None = None) -> Samples:
    """Read the only trajectory of a bag, or of one of its topics.

    Parameters
    ----------
    path : Path
        ``.bag`` of ROS 1; a folder, ``.mcap`` or ``.db3`` of ROS 2.
    topic : str, optional
        Needed if the bag holds more than one trajectory.

    Raises
    ------
    CaseError
        If rosbags is not installed, or the bag holds none or several.
    """
    name = str(path)
    check_name(name)
    if not path.exists():
        raise CaseError(name, "", "no such file; check the path")
    bag = path
    if path.is_dir():
        if not (path / "metadata.yaml").is_file():
            raise CaseError(name, "", "is a folder without metadata.yaml; name a bag or a file")
        files = [one for one in path.iterdir() if one.suffix in (".mcap", ".db3", ".yaml")]
    else:
        check_regular(path)
        files = [path]
        if path.suffix != ".bag":
            bag = path.parent
            if not (bag / "metadata.yaml").is_file():
                raise CaseError(name, "", "has no metadata.yaml beside it; name the bag's folder")
    for one in files:
        check_regular(one)
        if one.stat().st_size > MOST.bag_bytes:
            raise CaseError(str(one), "", "is larger than 2 GB; record the trajectory alone")
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise CaseError(
            name,
            "",
            "a bag needs rosbags; pip install trajgap[rosbag], or give the message as YAML",
        ) from None
    held: list[Mapping[str, Any]] = []
    try:
        store = get_typestore(Stores.ROS1_NOETIC if bag.suffix == ".bag" else Stores.ROS2_HUMBLE)
        with AnyReader([bag], default_typestore=store) as reader:
            wanted = [
                one
                for one in reader.connections
                if "Trajectory" in one.msgtype and topic in (None, one.topic)
            ]
            if not wanted:
                known = ", ".join(sorted({one.topic for one in reader.connections})[:5]) or "none"
                raise CaseError(name, topic or "", f"no topic with a trajectory; topics: {known}")
            for count, (connection, _, raw) in enumerate(reader.messages(connections=wanted)):
                held += trajectories(_plain(reader.deserialize(raw, connection.msgtype)))
                if count > MOST.messages or len(held) > 1:
                    break
    except CaseError:
        raise
    except Exception as error:  # whatever a damaged bag does to its reader
        reason = (str(error).splitlines() or [type(error).__name__])[0][:200]
        raise CaseError(name, "", f"no readable bag ({reason}); record it again") from None
    if len(held) != 1:
        number = "none" if not held else "more than one"
        raise CaseError(
            name, "--topic", f"the bag holds {number}; name a topic with one trajectory"
        )
    return samples_of_message(held[0], name, text=False)


def _plain(value: Any) -> Any:
    """A message of rosbags as plain values."""
    if dataclasses.is_dataclass(value):
        return {
            field.name: _plain(getattr(value, field.name))
            for field in dataclasses.fields(value)
            if not field.name.startswith("_")
        }
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return value.tolist() if hasattr(value, "tolist") else value
