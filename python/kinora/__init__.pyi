from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from os import PathLike
from typing import Any, Literal, Protocol, TypedDict, overload

from numpy import dtype, float32, ndarray, uint8
from typing_extensions import Unpack

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

class Settings(TypedDict, total=False):
    size: tuple[int, int] | str | None
    fps: float | str | Fraction | None
    samples: int | None
    noise: float | None
    max_samples: int | None
    denoise: bool | Literal["auto", "alone"]
    no_denoise: bool
    seed: int | None
    vary_noise: bool
    threads: int | None
    integrator: Literal["whitted", "path"] | None
    bounces: int | None
    antialias: int | None
    reuse: Literal["zoom", "off"] | None
    exposure: float | None
    tonemap: Literal["srgb", "none", "reinhard", "filmic"] | None
    transparent: bool
    caption: str | None
    draft: bool
    max_size: str | None
    quality: int | None
    film_cache: str | None
    no_reuse: bool
    allow_outside: bool

class FileSettings(Settings, total=False):
    bits: Literal[8, 16] | None
    no_metadata: bool

def render(
    source: Source,
    *,
    frames: Frames | None = None,
    progress: Progress | None = None,
    linear: bool = False,
    folder: str | PathLike[str] | None = None,
    **settings: Unpack[Settings],
) -> Animation: ...
def render_files(
    source: Source,
    *outputs: str | PathLike[str],
    frames: Frames | None = None,
    progress: Progress | None = None,
    replace: bool = False,
    folder: str | PathLike[str] | None = None,
    **settings: Unpack[FileSettings],
) -> list[str]: ...
