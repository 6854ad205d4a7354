"""From plain typed Python to extension modules for every CPython from 3.10 on."""
