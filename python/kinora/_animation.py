"""Rendering, and what it returns."""

import base64
import os
import tempfile
from collections.abc import Sequence
from fractions import Fraction

import numpy

from ._progress import reporter
from ._source import frames_of, load

_MIMES = {
    "gif": "image/gif",
    "png": "image/png",
    "apng": "image/apng",
    "webp": "image/webp",
    "jpg": "image/jpeg",
    "mp4": "video/mp4",
}


def render(source, *, frames=None, progress=None, linear=False, folder=None, **settings):
    """Renders a sequence into memory.

    `source` is a path, a text in RON or JSON, or a dict in the JSON notation. A string is a path if it is a single line
    that ends with `.ron` or `.json`, or that has no brackets. Texts and dicts find their meshes and images in `folder`,
    by default the working directory.

    `frames` selects frames: a number, a slice, numbers in any order, or a text such as "0-47:2"; negative numbers
    count from the end. `linear=True` also keeps the radiance of every pixel, see `Animation.linear`.

    `progress` is a function that is called with the numbers of finished and of all frames, a bar of tqdm, or True for a
    new bar of tqdm. Ctrl-C, or an exception of the function, ends the call at once; the current frame is finished in
    the background and dropped.

    All other keywords are options of the command `kinora render`, with underscores:
    size=(320, 180), fps, samples, noise, max_samples, seed, threads, integrator, bounces, antialias, exposure, tonemap,
    transparent, caption, draft, allow_outside, ... Pictures are the same bytes as those of the command.

    Raises `SequenceError` for mistakes in the sequence, `RenderError` if a frame cannot be rendered, and ValueError or
    TypeError for wrong keywords.
    """
    sequence = load(source, folder, settings)
    numbers = frames_of(sequence, frames)
    with reporter(progress, len(numbers)) as report:
        rendered = sequence.render(numbers, bool(linear), report)
    return Animation(sequence, rendered)


def render_files(source, *outputs, frames=None, progress=None, replace=False, folder=None, **settings):
    """Renders a sequence into files, as the command `kinora render` does, and returns their names.

    The extensions say the formats: "turn.gif", "turn.mp4", "frame_####.png", "frame_####.exr", ... Existing frames that
    are complete and current are kept, unless `replace` is true. After Ctrl-C, finished frames remain. The other
    keywords are those of `render`.
    """
    sequence = load(source, folder, settings)
    numbers = frames_of(sequence, frames)
    if not outputs:
        raise TypeError("name at least one file, such as \"turn.gif\" or \"frame_####.png\"")
    with reporter(progress, len(numbers)) as report:
        files, _ = sequence.render_files(numbers, [os.fspath(output) for output in outputs], bool(replace), report)
    return [os.fspath(file) for file in files]


class Animation(Sequence):
    """Rendered frames: a sequence of numpy arrays that a notebook shows as a GIF, and one frame as a PNG.

    Each frame has the shape (height, width, 3) and the type uint8, row by row from the top left; with a transparent
    background, (height, width, 4). The arrays may be changed: `save` writes what they hold.
    """

    def __init__(self, sequence, rendered):
        self._sequence = sequence
        width, height = sequence.size
        shape = (height, width, sequence.channels)
        self._frames = [numpy.frombuffer(codes, numpy.uint8).reshape(shape) for _, codes, _ in rendered]
        self.numbers = [number for number, _, _ in rendered]
        """The numbers of the frames in the sequence."""
        light = [light for _, _, light in rendered if light is not None]
        self.linear = [numpy.frombuffer(each, numpy.float32).reshape(height, width, 3) for each in light] or None
        """With `linear=True`: each frame's radiance as float32, before exposure, tone map and annotations."""
        self.notes = sequence.notes()
        """Things in the sequence that are valid but may not be intended."""

    @property
    def name(self):
        """The name of the sequence's file without its extension."""
        return self._sequence.name

    @property
    def size(self):
        """Width and height in pixels."""
        return self._sequence.size

    @property
    def fps(self):
        """Frames per second, as an exact fraction."""
        return Fraction(*self._sequence.rate)

    @property
    def times(self):
        """When each frame starts, in seconds, as exact fractions."""
        return [number / self.fps for number in self.numbers]

    def __len__(self):
        return len(self._frames)

    def __getitem__(self, index):
        return self._frames[index]

    def __array__(self, dtype=None, copy=None):
        """All frames as one array: (frames, height, width, channels)."""
        if copy is False:
            raise ValueError("all frames as one array are a copy")
        stacked = numpy.stack(self._frames)
        return stacked if dtype is None else stacked.astype(dtype)

    def __repr__(self):
        width, height = self.size
        count = "1 frame" if len(self) == 1 else f"{len(self)} frames"
        return f"<kinora.Animation {self.name!r}: {count}, {width}x{height}, {float(self.fps):g} fps>"

    def save(self, path):
        """Writes the frames: into an animation (.gif, .mp4, .webp, .apng), or into a still for each of them
        ("frame_####.png", .jpg, .ppm). Returns notes, such as those of reduced GIFs."""
        pictures = [self._codes(frame) for frame in self._frames]
        return self._sequence.save(os.fspath(path), self.numbers, self.size, pictures)

    def _codes(self, frame):
        width, height = self.size
        if frame.dtype != numpy.uint8 or frame.shape[:2] != (height, width):
            raise ValueError("frames need the size of the sequence and the type uint8")
        return frame.tobytes()

    def encode(self, format="gif"):
        """The bytes of a file in this format: "gif", "png", "apng", "webp", "jpg" or "mp4"."""
        if format not in _MIMES:
            raise ValueError(f"unknown format {format!r}; write one of {', '.join(_MIMES)}")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, f"frames.{format}")
            self.save(path)
            with open(path, "rb") as file:
                return file.read()

    def html(self, format=None):
        """An element of HTML that holds the animation: "gif" (the default), "webp", "apng" or "mp4"; for a single frame
        "png" (the default) or "jpg"."""
        format = format or ("png" if len(self) == 1 else "gif")
        data = f"data:{_MIMES[format] if format in _MIMES else ''};base64,{self._base64(format)}"
        width, height = self.size
        size = f'width="{width}" height="{height}"'
        if format == "mp4":
            return f'<video {size} src="{data}" autoplay loop muted playsinline controls></video>'
        return f'<img {size} src="{data}">'

    def _base64(self, format):
        return base64.b64encode(self.encode(format)).decode("ascii")

    def _repr_html_(self):
        return self.html()

    def _repr_mimebundle_(self, include=None, exclude=None):
        bundle = {"text/plain": repr(self), "text/html": self.html()}
        if len(self) == 1:
            bundle["image/png"] = self._base64("png")
        return bundle
