"""What a scene does in truth: solved twice in extended precision, with stated uncertainty."""
