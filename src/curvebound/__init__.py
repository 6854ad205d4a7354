"""FMI 2.0 co-simulation FMUs of bodies bound to curves, and the tools to trust and use them."""

__version__ = "0.1.0"
#: date of the sources, which dates the FMUs built from them
__date__ = "2026-11-22"
