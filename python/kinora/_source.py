"""What users write as a sequence, as keywords and as frames, for the module in Rust."""

import json
import os
from collections.abc import Iterable, Mapping

import numpy

from ._kinora import Sequence


def load(source, folder, keywords):
    """Loads a path, a text or a dict."""
    path, text = _named(source, os.fspath(folder) if folder is not None else "")
    return Sequence.load(path, text, _options(keywords))


def _named(source, folder):
    """The path of a sequence, and its text unless it is a file."""
    if isinstance(source, Mapping):
        return os.path.join(folder, "sequence.json"), json.dumps(source, indent=2, default=_plain)
    if not isinstance(source, str):
        return os.fspath(source), None
    if _is_path(source):
        return source, None
    kind = "json" if source.lstrip().startswith("{") else "ron"
    return os.path.join(folder, f"sequence.{kind}"), source


def _is_path(text):
    """Whether a string is a path: a single line with the extension of a sequence, or without brackets."""
    if "\n" in text:
        return False
    return text.lower().endswith((".ron", ".json")) or not ("(" in text or "{" in text)


def _plain(value):
    """Values of numpy and paths, for JSON."""
    if isinstance(value, (numpy.ndarray, numpy.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a sequence cannot hold a {type(value).__name__}")


def _options(keywords):
    """Keywords as options of the command. Switches have no value; None and False stand for the default."""
    return [_option(name, value) for name, value in keywords.items() if value is not None and value is not False]


def _option(name, value):
    name = name.replace("_", "-")
    if value is True:
        return name, None
    if name == "size" and not isinstance(value, str):
        width, height = value
        return name, f"{width}x{height}"
    return name, str(value)


def frames_of(sequence, frames):
    """The numbers of the frames that a user names."""
    if frames is None:
        return list(range(sequence.count))
    if isinstance(frames, str):
        return sequence.frames(frames)
    if isinstance(frames, slice):
        return list(range(sequence.count))[frames]
    numbers = [int(frame) for frame in frames] if isinstance(frames, Iterable) else [int(frames)]
    if not numbers:
        raise ValueError("no frames: give at least one")
    for number in numbers:
        if not -sequence.count <= number < sequence.count:
            raise ValueError(f"there is no frame {number}: the sequence has the frames 0 to {sequence.count - 1}")
    return [number % sequence.count for number in numbers]
