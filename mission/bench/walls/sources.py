"""Which source text a module depends on: what it computed is out of date when any of that changes."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

OURS = ("mission", "sim", "detector", "assets")


@lru_cache
def source_digest(module: str) -> str:
    """SHA-256 of the source of a module and of everything of ours that it imports, however deep, in hexadecimal.

    Imports for the type checker alone do not count.
    """
    digest = hashlib.sha256()
    for name, path in sorted(imported_files(module).items()):
        digest.update(name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def imported_files(module: str) -> dict[str, Path]:
    """Source files of a module and of all modules of ours that it imports, by their names."""
    files: dict[str, Path] = {}
    pending = [module]
    while pending:
        name = pending.pop()
        path = _file_of(name)
        if name in files or path is None:
            continue
        files[name] = path
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        pending += [package, *_imports(ast.parse(path.read_text()))]
    return files


def _file_of(name: str) -> Path | None:
    """None for what is no module of ours: a function that was imported, or another's package."""
    if name.partition(".")[0] not in OURS:
        return None
    try:
        spec = find_spec(name)
    except ModuleNotFoundError:  # the parent is a module, not a package: this is something in it
        return None
    return Path(spec.origin) if spec and spec.origin else None


def _imports(tree: ast.AST) -> Iterator[str]:
    """Names that are imported anywhere in a module when it runs; of `from a import b` both a and a.b."""
    for node in ast.iter_child_nodes(tree):
        match node:
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                continue
            case ast.Import(names=names):
                yield from (name.name for name in names)
            case ast.ImportFrom(module=str(module), names=names):
                yield from (module, *(f"{module}.{name.name}" for name in names))
        yield from _imports(node)
