"""The exceptions of the package. Their text is the text that `eng` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._diagnostics import Diagnostic, parsed

if TYPE_CHECKING:
    from ._table import Run


class Error(Exception):
    """An error of Eng. `diagnostics` has its messages with places, as far as it comes from a text."""

    diagnostics: tuple[Diagnostic, ...] = ()


class ModelError(Error):
    """The text is wrong."""


class SettingError(Error, ValueError):
    """A name that is not there, or a value that does not fit."""


class RunError(Error):
    """The model cannot be assembled or run. `partial` has the results up to the failure, if there are any."""

    partial: Run | None = None

    def __reduce__(self) -> tuple[object, ...]:
        # results stay in their process
        state = {name: value for name, value in self.__dict__.items() if name != "partial"}
        return (type(self), self.args, state)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C has stopped a run. `partial` has its results up to there, if there are any."""

    partial: Run | None = None


_CLASSES: dict[str, type[BaseException]] = {
    made.__name__: made for made in (Error, ModelError, SettingError, RunError, Interrupted)
}


def made(name: str, message: str, messages: str | None, partial: Run | None) -> BaseException:
    """The exception for an error of the native part."""
    error = _CLASSES[name](message)
    if isinstance(error, Error) and messages is not None:
        error.diagnostics = parsed(messages)
    if isinstance(error, (RunError, Interrupted)):
        error.partial = partial
    return error
