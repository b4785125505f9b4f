"""Every command and every line of Python in the documentation works, and prints what the page shows.

Words of the output must be the same; numbers may differ, since times and machines do. ``...`` stands for anything.
"""

import contextlib
import io
import re
import warnings

import pytest
from tests.docs.pages import PAGES, blocks, file_name, name

from vasculo.pillars.responses import known_responses, restore_responses
from vasculo.study.laws import forget_laws
from vasculo.study.watchers import forget, registered

NUMBER = r"(?:[-+]?(?:(?:\d{1,3}(?:,\d{3})+|\d+)\.?\d*|\.\d+)(?:e[-+]?\d+)?|nan|inf)"
FOLLOWED = [page for page in PAGES if any(not block.skip for block in blocks(page))]


@pytest.fixture
def registries():
    laws, watchers = known_responses(), len(registered())
    yield
    forget_laws()
    restore_responses(laws)
    forget(watchers)


@pytest.mark.slow
@pytest.mark.usefixtures("registries")
@pytest.mark.parametrize("page", FOLLOWED, ids=name)
def test_page(page, shell, monkeypatch):
    monkeypatch.chdir(shell.folder)
    monkeypatch.syspath_prepend(str(shell.folder))
    names = {"__name__": "page"}
    for block in blocks(page):
        if block.skip:
            continue
        where = f"{name(page)}:{block.line}"
        for line in re.findall(r"^\$ (.*)$", block.given, re.MULTILINE):
            code, printed = shell(line)
            assert code == 0, printed
        execute(re.sub(r"^\$ .*$", "", block.given, flags=re.MULTILINE), names, where)
        if block.kind == "file":
            (shell.folder / file_name(block)).write_text(block.run)
        elif block.kind == "code":
            printed = execute(block.run, names, where)
            compare(block.output, printed, where)
        else:
            code, printed = shell(block.run)
            wrong = any(line.startswith("vasculo: ") for line in block.output.splitlines())
            assert bool(code) == wrong, f"{where}: {block.run} ends with {code}:\n{printed}"
            compare(block.output, printed, where)


def execute(text, names, where):
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), warnings.catch_warnings():
        warnings.simplefilter("error")
        exec(compile(text, where, "exec"), names)  # noqa: S102
    return printed.getvalue()


def compare(shown, printed, where):
    """Compare what a page shows, if it shows anything, with what was printed."""
    if not shown.strip():
        return
    pieces = [pattern(piece.strip()) for piece in shown.strip().split("...")]
    pieces[0] = rf"\A{pieces[0]}"
    pieces[-1] = rf"{pieces[-1]}\Z" if pieces[-1] else ""
    start = 0
    for piece in pieces:
        found = re.compile(piece).search(printed.strip(), start)
        assert found, f"{where} shows\n{shown}\nbut it is\n{printed}"
        start = found.end()


def pattern(text):
    """Regular expression for a text in which numbers may differ, and spaces."""
    parts = re.split(rf"((?<![\w.]){NUMBER}|\s+)", text)
    return "".join(
        r"\s+" if part.isspace() else NUMBER if re.fullmatch(NUMBER, part) else re.escape(part) for part in parts
    )


def test_output_is_compared():
    compare("pillars 29 to 26, 4.3 s", "pillars 31   to 27, 12.9 s", "here")
    compare("first\n...\nlast 1", "first\nand\nmore\nlast 2", "here")
    compare("...\nlast", "last", "here")
    wrong = [
        ("pillars 29", "voids 29"),
        ("a 1", "a one"),
        ("a\n...\nb", "a\nc"),
        ("a", "a\nb"),
        ("a", "b\na"),
        ("...\nb", "b\nc"),
        ("b\n...", "a\nb"),
    ]
    for shown, printed in wrong:
        with pytest.raises(AssertionError, match="but it is"):
            compare(shown, printed, "here")


def test_few_blocks_are_left_out():
    left_out = [(name(page), block.line, block.skip) for page in PAGES for block in blocks(page) if block.skip]
    assert all(len(reason) > 10 for _, _, reason in left_out), left_out
    assert len(left_out) <= 12, left_out
