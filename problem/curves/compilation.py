"""Numba's compiler with a cache that follows the sources of everything compiled together."""

from __future__ import annotations

import ast
import builtins
import hashlib
import inspect
import math
import os
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, update_wrapper
from pathlib import Path
from types import FunctionType
from typing import Any, cast

import numpy as np

LOOK = 0.1
"""Share of the time of compiling after which it is looked again whether another process did it."""
BUSY = 3.0
"""Times as long as on an idle machine that compiling may take: where less is left none begins."""
LOADING = 0.5
"""Seconds that importing numba and its first compiled function take: before what is on disk has
been interpreted for as long, it is left there unless something compiled is in use."""
_MAKING = threading.RLock()
"""Held while a function is handed to numba: two threads make one dispatcher."""
_UNTIL: ContextVar[float] = ContextVar("until", default=math.inf)
"""Reading of the clock by which everything is to have ended: none without `compiling_until`."""
_AT_ONCE: ContextVar[bool] = ContextVar("at once", default=False)
"""Whether compiling is worth it from the first call on."""


@contextmanager
def compiling_until(end: float) -> Iterator[None]:
    """Let nothing be compiled within that would not be ready in time; what is not is interpreted.

    Parameters
    ----------
    end : float
        Reading of `time.perf_counter`. Within an earlier end it has no effect.
    """
    token = _UNTIL.set(min(_UNTIL.get(), end))
    try:
        yield
    finally:
        _UNTIL.reset(token)


@contextmanager
def compiling_at_once() -> Iterator[None]:
    """Have what is called within compiled at its first call: processes that follow find it."""
    token = _AT_ONCE.set(True)
    try:
        yield
    finally:
        _AT_ONCE.reset(token)


def _left() -> float:
    return _UNTIL.get() - time.perf_counter()


def compiler(*sources: Path) -> Callable[[Callable[..., Any]], Kernel]:
    """Make a decorator for functions to be compiled, and cached where there is a writable place.

    numba's cache looks at the file of the function alone, so that a function would go on calling an
    old callee from another file. Functions that call each other are compiled by one decorator, and
    the hash of all their files stands in their names.

    Parameters
    ----------
    *sources : Path
        Every file with functions that this decorator compiles.

    Returns
    -------
    callable
    """
    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]

    def compiled(function: Callable[..., Any]) -> Kernel:
        function.__qualname__ = f"{function.__qualname__}_{stamp}"
        return Kernel(function)

    return compiled


class Kernel:
    """A function that numba compiles, and that brings numba in only when it is called or compiled.

    Parameters
    ----------
    function : callable

    Attributes
    ----------
    py_func : function
        The function itself, as of numba's dispatchers.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = cast(FunctionType, function)
        self._dispatcher: Any = None
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function."""
        made = self._dispatcher or self.dispatcher
        return made(*arguments)

    @property
    def dispatcher(self) -> Any:
        """What numba makes of the function, and the function itself where it is switched off."""
        with _MAKING:
            if self._dispatcher is None:
                # numba knows dispatchers alone where a function calls another one.
                for name, value in _globals_of(self.py_func):
                    if isinstance(value, Kernel):
                        self.py_func.__globals__[name] = value.dispatcher
                self._dispatcher = _jitted(self.py_func)
                if hasattr(self, "writes"):
                    self._dispatcher.writes = self.writes
        return self._dispatcher

    @property
    def signatures(self) -> list[Any]:
        """Forms of arguments that it is compiled for in this process."""
        return [] if self._dispatcher is None else list(getattr(self._dispatcher, "signatures", ()))


def _jitted(function: FunctionType) -> Any:
    import numba

    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # no writable place for the cache: compile in memory
        return numba.njit(nogil=True, error_model="numpy")(function)


def by_elements(*writes: str) -> Callable[[Any], Any]:
    """Mark a compiled function that touches arrays one element, or one row, at a time.

    While it is interpreted it runs on lists of plain floats, which Python reads and multiplies four
    times as fast as elements of arrays.

    Parameters
    ----------
    *writes : str
        Parameters whose elements callers read afterwards. What else it writes is room, and may be
        left as it was.

    Returns
    -------
    callable
        Returns what it is given. Whatever the function calls has to be marked too.
    """

    def marked(function: Any) -> Any:
        function.writes = writes
        return function

    return marked


@cache
def interpreted(function: Any) -> Callable[..., Any]:
    """A compiled function as Python itself runs it, with all that it calls.

    Parameters
    ----------
    function : Kernel

    Returns
    -------
    callable
        The same numbers to the last bit, where only the functions of `math` are called: neither
        way reorders or fuses an operation.
    """
    plain = getattr(function, "py_func", function)  # plain already where compiling is switched off
    names = {
        name: interpreted(value) if hasattr(value, "py_func") else value
        for name, value in _globals_of(plain)
    }
    names["__builtins__"] = builtins  # numpy looks for them where it is called
    on_arrays = FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__)
    writes = getattr(function, "writes", None)
    return on_arrays if writes is None else _through_lists(function, writes, on_arrays)


def _globals_of(plain: Any) -> list[tuple[str, Any]]:
    """The globals that a function uses, by name."""
    return [(n, value) for n, value in plain.__globals__.items() if n in plain.__code__.co_names]


def _through_lists(
    function: Any, writes: tuple[str, ...], on_arrays: Callable[..., Any]
) -> Callable[..., Any]:
    """A function that takes arrays, runs on lists of their elements, and writes back the results.

    Floats raise where arrays go on with infinity or nan; the arrays are untouched then, and the
    function runs on them.
    """
    on_lists = _on_lists(function)
    parameters = list(inspect.signature(on_arrays).parameters)
    written = [parameters.index(name) for name in writes]

    def run(*arguments: Any) -> Any:
        plain = [x.tolist() if isinstance(x, np.ndarray | np.generic) else x for x in arguments]
        try:
            found = on_lists(*plain)
        except (ArithmeticError, IndexError):
            return on_arrays(*arguments)
        for at in written:
            arguments[at][...] = plain[at]
        return found

    return run


@cache
def _on_lists(function: Any) -> Callable[..., Any]:
    """A marked function for nested lists in place of arrays, with all that it calls."""
    plain = getattr(function, "py_func", function)
    names = {
        name: _on_lists(value) if hasattr(value, "writes") else value
        for name, value in _globals_of(plain)
    }
    tree = ast.parse(textwrap.dedent(inspect.getsource(plain)))
    definition = tree.body[0]
    assert isinstance(definition, ast.FunctionDef)
    definition.decorator_list = []
    names |= {"_list_size": _list_size, "_list_shape": _list_shape}
    code = compile(
        ast.fix_missing_locations(_Nested().visit(tree)), plain.__code__.co_filename, "exec"
    )
    exec(code, names)
    return cast(Callable[..., Any], names[definition.name])


class _Nested(ast.NodeTransformer):
    """Writes ``a[i, j]`` as ``a[i][j]``, and sizes as those of nested lists."""

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.slice, ast.Tuple):
            return node
        *outer, last = node.slice.elts
        value = node.value
        for index in outer:
            value = ast.Subscript(value, index, ast.Load())
        return ast.Subscript(value, last, node.ctx)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        self.generic_visit(node)
        if node.attr not in ("size", "shape"):
            return node
        return ast.Call(ast.Name(f"_list_{node.attr}", ast.Load()), [node.value], [])


def _list_shape(nested: Any) -> tuple[int, ...]:
    """Shape of the array that a nested list was."""
    return (len(nested), *_list_shape(nested[0])) if isinstance(nested, list) else ()


def _list_size(nested: Any) -> int:
    """Number of its elements."""
    return math.prod(_list_shape(nested))


class Deferred:
    """A compiled function that Python runs until compiling it is worth the wait.

    What was compiled before, in this process or by another one that left it on disk, is used at
    once. Otherwise calls are interpreted until they have taken as long as compiling would: so
    nothing ever takes more than twice the time of the better way.

    Parameters
    ----------
    function : Kernel
    seconds : float
        Time that compiling it takes.
    plainly : callable, optional
        What runs meanwhile, with the same bits; without it the function itself is interpreted.
    """

    _in_use = False
    """Whether a compiled function is in use in this process: the next one loads quickly."""
    _waited = 0.0
    """Seconds for which functions were interpreted that a compiled form is at hand of."""

    def __init__(
        self, function: Any, seconds: float, plainly: Callable[..., Any] | None = None
    ) -> None:
        self._function, self._plainly = function, plainly
        self._seconds, self._spent, self._look = seconds, 0.0, 0.0
        self._ready = self._at_hand = False

    @property
    def compiled(self) -> bool:
        """Whether the last call was one of the compiled function."""
        return self._ready

    def ready(self) -> bool:
        """Whether the next call is one of the compiled function, which it may compile."""
        if self._ready:
            return True
        at_once = _AT_ONCE.get()
        if at_once or self._spent >= self._look:
            due = at_once or self._spent >= self._seconds
            worth = due and _left() > BUSY * self._seconds
            self._at_hand = at_hand(self._function)
            self._ready = worth
            self._look = self._spent + LOOK * self._seconds
        if self._at_hand and (Deferred._in_use or Deferred._waited >= LOADING):
            self._ready = True
        Deferred._in_use |= self._ready
        return self._ready

    def __call__(self, *arguments: Any) -> Any:
        """Call the function, one way or the other."""
        if self.ready():
            return self._function(*arguments)
        began = time.thread_time()
        with np.errstate(all="ignore"):
            found = (self._plainly or interpreted(self._function))(*arguments)
        took = time.thread_time() - began
        self._spent += took
        if self._at_hand:
            Deferred._waited += took
        return found


def at_hand(function: Any) -> bool:
    """Whether a compiled form of a function is in this process or on disk.

    Parameters
    ----------
    function : Kernel

    Returns
    -------
    bool
    """
    if not hasattr(function, "py_func") or function.signatures:
        return True  # a plain function has nothing to wait for
    place = _beside(function)
    if place is None:
        made = getattr(function, "dispatcher", function)
        if not hasattr(made, "stats"):
            return True  # compiling is switched off: it is a plain function
        place = made.stats.cache_path
    return _on_disk(function, place)


def _beside(function: Any) -> Path | None:
    """Where numba keeps compiled functions: asked without importing it; None where only it knows.

    It takes the folder that is named, with a folder in it for each of ours, else ``__pycache__``.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    if named:
        return Path(named)
    beside = Path(inspect.getfile(function.py_func)).parent / "__pycache__"
    return beside if os.access(beside, os.W_OK) else None


def _on_disk(function: Any, place: str | Path | None) -> bool:
    """Whether a folder, or one in it, has a compiled form of a function, for this Python."""
    name = f"*{function.py_func.__qualname__}-*py{sys.version_info[0]}{sys.version_info[1]}*.nbi"
    return place is not None and any(Path(place).rglob(name))
