"""The versions that belong together."""

VERSION = "0.2.0"
"""Of this package: that of the library (FETIFETI_VERSION_... in fetifeti.h)."""

ABI = 0
"""Of the library's interface: the number behind ``libfetifeti.so.`` in its soname."""
