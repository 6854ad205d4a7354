"""Time integration: one method per file behind one interface (base.Method)."""
