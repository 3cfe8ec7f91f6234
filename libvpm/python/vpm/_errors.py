"""What the library raises and says: exceptions with place and hint, warnings, and the logger of its notes."""
import logging

log = logging.getLogger("vpm")


class Error(Exception):
    """What is wrong, where, and how to mend it. str(error) is all three; parameters stand in
    backquotes.

    problem: what is wrong. where: file, line or element, as far as it is known. hint: how to
    mend it.
    """

    problem: str = ""
    where: str = ""
    hint: str = ""


class RefusedError(Error, ValueError):
    """The data cannot be used: a damaged file, an open mesh, a pose that is none."""


class ArgumentError(Error, ValueError):
    """The call means nothing: an option out of range, options that exclude each other."""


class UnavailableError(Error, RuntimeError):
    """A feature that is not built, or a device that is not there or fails."""


class WriteError(Error, OSError):
    """An output could not be written."""


class SetupWarning(UserWarning):
    """Data that were taken, though they are probably not what was meant, such as depths in
    another unit."""


for _class in (Error, RefusedError, ArgumentError, UnavailableError, WriteError, SetupWarning):
    _class.__module__ = "vpm"
