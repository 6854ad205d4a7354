"""The one exception that is meant for users."""

__all__ = ["CurveboundError"]


class CurveboundError(Exception):
    """Something the user can mend: the message names the thing, its value and the remedy."""
