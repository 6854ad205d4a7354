"""A scene that answers: a page in the browser whose motion the FMUs compute as one watches."""
