"""Work and precision: every setting of a scene run, judged and timed; pages of what that shows."""
