"""Kinora renders keyframed animation sequences from one text file.

>>> import kinora
>>> animation = kinora.render("turn.ron", size=(320, 180))     # shows itself in a notebook
>>> animation[0].shape                                          # frames are numpy arrays
(180, 320, 3)
>>> animation.save("turn.gif")

A sequence is a path, a text in RON or JSON, or a dict in the JSON notation. `sequences/README.md` of the project
describes the fields.
"""

from ._animation import Animation, render, render_files
from ._kinora import RenderError, SequenceError, __version__

__all__ = ["Animation", "RenderError", "SequenceError", "__version__", "render", "render_files"]
