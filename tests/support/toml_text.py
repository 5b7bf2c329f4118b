"""TOML written from plain values, whatever they hold; the standard library only reads it."""

from typing import Any

_KEY = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_")
"""Characters of a key that needs no quotes."""


class Bare(str):
    """A token that goes into the file as it is: a number with its digits, a date, or rubbish."""

    __slots__ = ()


def toml_text(document: dict[str, Any]) -> str:
    """Text of a whole document: plain keys first, then tables, then lists of tables."""
    return "".join(_table(document, ()))


def block(head: str, entries: dict[str, Any]) -> str:
    """A head such as ``[units]`` with its plain keys."""
    return "\n".join([head, *(f"{_key(key)} = {_value(value)}" for key, value in entries.items())])


def _table(table: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    lines, below = [], []
    for key, value in table.items():
        if isinstance(value, dict):
            below.append(f"\n[{_dotted((*path, key))}]\n")
            below += _table(value, (*path, key))
        elif isinstance(value, list) and value and all(isinstance(x, dict) for x in value):
            for item in value:
                below.append(f"\n[[{_dotted((*path, key))}]]\n")
                below += _table(item, (*path, key))
        elif value is not None:
            lines.append(f"{_key(key)} = {_value(value)}\n")
    return lines + below


def _dotted(path: tuple[str, ...]) -> str:
    return ".".join(map(_key, path))


def _key(key: str) -> str:
    return key if key and set(key) <= _KEY else _string(key)


def _value(value: object) -> str:
    if isinstance(value, Bare):
        return str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(k)} = {_value(v)}' for k, v in value.items())} }}"
    raise TypeError(f"no TOML for {value!r}")


def _string(text: str) -> str:
    escaped = []
    for c in text:
        if c in '"\\':
            escaped.append("\\" + c)
        elif c < " " or c == "\x7f" or "\ud800" <= c <= "\udfff":
            escaped.append(f"\\u{ord(c):04x}" if c < "\ud800" or c > "\udfff" else "\\ufffd")
        else:
            escaped.append(c)
    return f'"{"".join(escaped)}"'
