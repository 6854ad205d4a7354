"""What is compiled: models, their moving frame, and the methods that integrate them in time."""
