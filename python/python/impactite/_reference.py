"""Keys and words of scene files."""

from __future__ import annotations

import builtins
import json
from typing import Any, NamedTuple

from . import _impactite


class Item(NamedTuple):
    """A word of scene files."""

    name: str
    #: Meaning.
    what: str
    #: Its options; optional ones end with ``?``.
    options: tuple[str, ...]


def schema() -> dict[str, Any]:
    """JSON Schema of scene files, with the meaning of every key."""
    tree: dict[str, Any] = json.loads(_impactite.schema())
    return tree


def list(topic: str) -> builtins.list[Item]:
    """Words of scene files on a topic.

    Topics are ``methods``, ``laws``, ``materials``, ``contacts``, ``conditions``, ``shapes``, ``measures``, ``templates``.
    """
    return [Item(name, what, tuple(options)) for name, what, options in _impactite.items(topic)]
