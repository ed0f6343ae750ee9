from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from os import PathLike
from typing import Any, Literal, Protocol, TypedDict, overload

from numpy import dtype, float32, ndarray, uint8

__all__ = ["Animation", "RenderError", "SequenceError", "__version__", "render", "render_files"]
__version__: str

Frame = ndarray[tuple[int, int, int], dtype[uint8]]
Light = ndarray[tuple[int, int, int], dtype[float32]]
Source = str | PathLike[str] | Mapping[str, Any]
Frames = int | str | slice | Iterable[int]
Format = Literal["gif", "png", "apng", "webp", "jpg", "mp4"]

class Bar(Protocol):
    total: Any
    n: Any
    def update(self, n: int) -> Any: ...

Progress = bool | Callable[[int, int], object] | Bar

class Fault(TypedDict):
    path: str
    line: int
    column: int
    field: str | None
    message: str

class SequenceError(ValueError):
    path: str | None
    line: int | None
    column: int | None
    field: str | None
    faults: list[Fault]

class RenderError(RuntimeError): ...

class Animation(Sequence[Frame]):
    numbers: list[int]
    linear: list[Light] | None
    notes: list[str]
    @property
    def name(self) -> str: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def fps(self) -> Fraction: ...
    @property
    def times(self) -> list[Fraction]: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> list[Frame]: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> ndarray[Any, Any]: ...
    def save(self, path: str | PathLike[str]) -> list[str]: ...
    def encode(self, format: Format = "gif") -> bytes: ...
    def html(self, format: Format | None = None) -> str: ...

def render(
    source: Source,
    *,
    frames: Frames | None = None,
    progress: Progress | None = None,
    linear: bool = False,
    folder: str | PathLike[str] | None = None,
    size: tuple[int, int] | str | None = None,
    fps: float | str | Fraction | None = None,
    samples: int | None = None,
    noise: float | None = None,
    max_samples: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    integrator: Literal["whitted", "path"] | None = None,
    bounces: int | None = None,
    antialias: int | None = None,
    reuse: Literal["zoom", "off"] | None = None,
    exposure: float | None = None,
    tonemap: Literal["srgb", "none", "reinhard", "filmic"] | None = None,
    transparent: bool = False,
    caption: str | None = None,
    draft: bool = False,
    max_size: str | None = None,
    quality: int | None = None,
    film_cache: str | None = None,
    no_reuse: bool = False,
    allow_outside: bool = False,
) -> Animation: ...
def render_files(
    source: Source,
    *outputs: str | PathLike[str],
    frames: Frames | None = None,
    progress: Progress | None = None,
    replace: bool = False,
    folder: str | PathLike[str] | None = None,
    size: tuple[int, int] | str | None = None,
    fps: float | str | Fraction | None = None,
    samples: int | None = None,
    noise: float | None = None,
    max_samples: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    integrator: Literal["whitted", "path"] | None = None,
    bounces: int | None = None,
    antialias: int | None = None,
    reuse: Literal["zoom", "off"] | None = None,
    exposure: float | None = None,
    tonemap: Literal["srgb", "none", "reinhard", "filmic"] | None = None,
    transparent: bool = False,
    caption: str | None = None,
    bits: Literal[8, 16] | None = None,
    draft: bool = False,
    max_size: str | None = None,
    quality: int | None = None,
    no_metadata: bool = False,
    film_cache: str | None = None,
    no_reuse: bool = False,
    allow_outside: bool = False,
) -> list[str]: ...
