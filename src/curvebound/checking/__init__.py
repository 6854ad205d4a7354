"""Checks of finished FMUs, ours and other people's, and of scenes: what CI runs after building."""
