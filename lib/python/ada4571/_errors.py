# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The library's failures as exceptions: each says the library's sentence."""


class Error(Exception):
    """A failure of libada4571. `status` is its name in the C API."""

    status = "ADA4571_ERROR_INTERNAL"


class InvalidArgumentError(Error, ValueError):
    """Out of range, or an unknown name: the caller's mistake."""


class StateError(Error, RuntimeError):
    """The right call at the wrong moment."""


class NoMemoryError(Error, MemoryError):
    """There is no memory for it."""


class InputOutputError(Error, OSError):
    """The system refused; the sentence has its reason."""


class FormatError(Error, ValueError):
    """A file or stream is not what it should be; the sentence names the place."""


class NotFoundError(Error, FileNotFoundError):
    """No such file, device, channel or line."""


class DeniedError(Error, PermissionError):
    """The system does not allow it."""


class BusyError(Error, OSError):
    """Somebody else has it."""


class DisconnectedError(Error, ConnectionError):
    """The device was removed or the server is gone; start again to open it anew."""


class UnsupportedError(Error, RuntimeError):
    """Built without it, or the device cannot do it."""


class UnusableDataError(Error, ValueError):
    """The data cannot carry what was asked; the sentence has the reason."""


_CLASSES = {
    "ADA4571_ERROR_INVALID_ARGUMENT": InvalidArgumentError,
    "ADA4571_ERROR_STATE": StateError,
    "ADA4571_ERROR_NO_MEMORY": NoMemoryError,
    "ADA4571_ERROR_IO": InputOutputError,
    "ADA4571_ERROR_FORMAT": FormatError,
    "ADA4571_ERROR_NOT_FOUND": NotFoundError,
    "ADA4571_ERROR_PERMISSION": DeniedError,
    "ADA4571_ERROR_BUSY": BusyError,
    "ADA4571_ERROR_DISCONNECTED": DisconnectedError,
    "ADA4571_ERROR_UNSUPPORTED": UnsupportedError,
    "ADA4571_ERROR_UNUSABLE_DATA": UnusableDataError,
}


def from_status(status: str, sentence: str) -> Error:
    """The exception that belongs to a status of the C API."""
    error = _CLASSES.get(status, Error)(sentence)
    error.status = status
    return error


class LostSamplesWarning(UserWarning):
    """Samples are missing before or within the block that comes next."""
