"""What can be said about the pages without following them: links, languages of blocks, commands inside sentences."""

import re
import tomllib

import pytest
import typer
from tests.docs.pages import PAGES, ROOT, fences, name

from vasculo.cli import app

LANGUAGES = {"console", "python", "output", "text", "toml", "json", "bibtex"}
DIRECTIVE = re.compile(r"\{[\w-]+\}")
SETUP = [line for line in (ROOT / "README.md").read_text().splitlines() if line.startswith("pip install -c")]


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    links = [link for link in re.findall(r"\]\(([^)#:]+?)(?:#[\w-]+)?\)", text) if link]
    assert not [link for link in links if not (page.parent / link).exists() and "auto_gallery" not in link]


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_blocks_say_what_they_are(page):
    for language, text, line, _ in fences(page.read_text()):
        known = language in LANGUAGES or DIRECTIVE.fullmatch(language)
        assert known or text.strip() in SETUP, f"{name(page)}:{line}: language {language!r}"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_toml_can_be_read(page):
    for language, text, _, _ in fences(page.read_text()):
        if language == "toml":
            tomllib.loads(text)


def test_commands_in_sentences_are_there():
    known = {command: options(command) for command in subcommands()}
    wrong = []
    for page in PAGES:
        text = page.read_text()
        for line in re.findall(r"`(vasculo [^`\n]*)`", text) + re.findall(r"^(vasculo [a-z].*)$", text, re.MULTILINE):
            command = line.split()[1]
            if command.startswith("-"):
                continue
            words = re.findall(r"(?<![\w-])--[a-z][\w-]*", line)
            if command not in known or not set(words) <= known[command]:
                wrong.append(f"{name(page)}: {line}")
    assert not wrong


def test_every_option_is_told():
    """On the page of the command line, or on the page that it sends the reader to."""
    text = "".join(page.read_text() for page in PAGES)
    untold = [
        f"{command} {option}"
        for command in subcommands()
        for option in options(command)
        if option not in text and option != "--help"
    ]
    assert not untold


def subcommands():
    return typer.main.get_command(app).commands


def options(command):
    """Long options of a command, as they are typed."""
    found = subcommands()[command].params
    return {option for parameter in found for option in parameter.opts if option.startswith("--")} | {"--help"}


def test_set_up_lines_are_two():
    assert SETUP == [
        "pip install -c constraints.txt '.[draw,fast]' && vasculo run",
        "pip install -c constraints.txt -e '.[test]' && pytest",
    ]
