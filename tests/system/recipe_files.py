#!/usr/bin/python3
"""The files and commands of a recipe in docs/recipes, so that the tests run the text that people copy.

recipe_files.py PAGE DIRECTORY      writes every file of the page below DIRECTORY and prints their names
recipe_files.py PAGE                 prints their names only
recipe_files.py PAGE --sh HEADING    prints the shell commands below that heading

A file is a block of code whose line before begins with its absolute path in backquotes and ends with a colon:

    `/etc/mosquitto/acl`, any words:

What replaces the table [mqtt] of a file, or comes behind the lines of another page, is written beside it, as FILE.mqtt
and FILE.further:

    `/etc/canopen-gateway/gateway.toml`, in place of the `[mqtt]` of another page:
    `/etc/mosquitto/acl`, further lines:
"""

import pathlib
import re
import sys


def blocks(text):
    """(heading, line before, language, content) of each block of code."""
    heading = before = ""
    lines = iter(text.splitlines())
    for line in lines:
        fence = re.fullmatch(r"```(\w*)", line)
        if fence:
            content = []
            for inner in lines:
                if inner == "```":
                    break
                content.append(inner)
            else:
                sys.exit(f"a block of code without an end: {before}")
            yield heading, before, fence[1], "\n".join(content) + "\n"
            before = ""
        elif line.startswith("#"):
            heading, before = line.lstrip("# "), ""
        elif line.strip():
            before = line


def files(text):
    """By path; a path twice is a mistake of the page."""
    found = {}
    for _, before, _, content in blocks(text):
        match = re.match(r"`(/[^`]+)`(?P<part>, in place of the `\[mqtt\]`|, further lines)?.*:$", before)
        if match:
            name = match[1] + {None: "", ", further lines": ".further"}.get(match["part"], ".mqtt")
            if name in found:
                sys.exit(f"twice: {name}")
            found[name] = content
    return found


def commands(text, wanted):
    found = [content for heading, _, language, content in blocks(text) if heading == wanted and language == "sh"]
    if not found:
        sys.exit(f"no commands below '{wanted}'")
    return "".join(found)


def main(arguments):
    text = pathlib.Path(arguments[0]).read_text(encoding="utf-8")
    if len(arguments) == 3 and arguments[1] == "--sh":
        sys.stdout.write(commands(text, arguments[2]))
        return
    for name, content in files(text).items():
        print(name)
        if len(arguments) > 1:
            place = pathlib.Path(arguments[1] + name)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(content, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3, 4):
        sys.exit(__doc__)
    main(sys.argv[1:])
