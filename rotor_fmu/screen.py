"""Tables and progress on the screen, each in one way."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress, TextColumn
from rich.table import Table
from rich.text import Text

_FIRST = 20  # characters that the first column has at least on a narrow screen
_LINE_EVERY, _BAR_EVERY = 10.0, 0.1  # seconds, without and with a terminal

# Of how much is done, and of what gives the text beside it; whether it is the end.
Update = Callable[[float, Callable[[], str], bool], None]


def text_table(
    title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], folds: Sequence[str] = ()
) -> Table:
    """Return a table whose first column, of names, may fold, and those whose heads `folds` lists;
    the others are flush right. Heads and cells are shown as they are: "[mil]" is no markup."""
    table = Table(title=title or None, box=box.SIMPLE_HEAD, padding=0, pad_edge=False)
    table.title_justify, table.title_style = "left", "bold"
    for k, head in enumerate(heads):
        if k == 0 or head in folds:
            table.add_column(Text(head), overflow="fold", min_width=_FIRST)
        else:
            table.add_column(Text(head), justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))
    return table


@contextmanager
def progress_of(label: str, total: float, first: float) -> Iterator[Update]:
    """A bar with a text on a terminal; else a line now and then, after `first` [s]; on stderr."""
    console = Console(stderr=True)
    every = _BAR_EVERY if console.is_terminal else _LINE_EVERY
    due = time.monotonic() + (0.0 if console.is_terminal else first)

    def when_due(show: Callable[[float, str], None]) -> Update:
        """Return what shows the work done and its text, every now and then and at the end."""

        def update(done: float, text: Callable[[], str], is_end: bool = False) -> None:
            nonlocal due
            now = time.monotonic()
            if now >= due or is_end:
                due = now + every
                show(done, text())

        return update

    if not console.is_terminal:
        yield when_due(
            lambda _, text: console.print(f"{label}: {text}", soft_wrap=True, markup=False)
        )
        return
    columns = (*Progress.get_default_columns()[:-1], TextColumn("{task.fields[text]}"))
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(escape(label), total=total, text="")
        yield when_due(lambda done, text: bar.update(task, completed=done, text=text))
