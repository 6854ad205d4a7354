"""Results for the eye: replay pages, pictures, animations and the gallery that links them."""

from .animation import Movie, write_frames, write_gif, write_mp4
from .gallery import Card, write_gallery
from .picture import write_picture
from .reading import Reading, read_result
from .replay import About, write_replay

__all__ = [
    "About",
    "Card",
    "Movie",
    "Reading",
    "read_result",
    "write_frames",
    "write_gallery",
    "write_gif",
    "write_mp4",
    "write_picture",
    "write_replay",
]
