"""A simulation lab for underwater acoustic sensing: the code behind the notebooks."""

__version__ = "0.1.0"
