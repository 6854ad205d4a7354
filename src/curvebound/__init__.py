"""FMI 2.0 co-simulation FMUs of bodies bound to curves, and the tools to trust and use them."""

__version__ = "0.1.0"
