"""The cheapest setting that meets the bounds of a scene, found with few runs."""
