"""The FMI face: declarations, the slave that PythonFMU runs, modelDescription and the build."""
