"""Progress, as a function or as a bar of tqdm."""

from contextlib import contextmanager


@contextmanager
def reporter(progress, total):
    """A function of the finished and of all frames for `progress`, or None."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        from tqdm.auto import tqdm

        with tqdm(total=total, unit="frame") as bar:
            yield _to(bar)
    elif hasattr(progress, "update"):
        progress.total = total
        yield _to(progress)
    elif callable(progress):
        yield progress
    else:
        raise TypeError("progress is True, a bar of tqdm, or a function of the finished and of all frames")


def _to(bar):
    start = bar.n
    return lambda done, total: bar.update(done - (bar.n - start))
