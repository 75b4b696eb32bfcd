"""What the pages of the manual hold, in their order, and what is wrong with them as texts.

Before each block of `console` or `sh` stands how it is tried, as a comment that readers do not see:

    <!-- run -->                          the commands behind "$ " are run, and answer what the page shows
    <!-- run, varying: REGEX -->          likewise; what REGEX matches may be another text each time
    <!-- not run: REASON -->              cannot be run here

Before a block of `text`:

    <!-- in the log -->                   each line stands in the gateway's log, in this order
    <!-- on the bus -->                   each line is one of candump's, in this order

Elsewhere: `<!-- type: 5 fault 5 -->` makes a simulated drive misbehave, `<!-- demo -->` starts the demo anew. A block
whose line before begins with `/etc/canopen-gateway/gateway.toml` in backquotes and ends with a colon is from there on the
configuration.
"""

import dataclasses
import pathlib
import re

MARK = re.compile(r"<!-- (run|not run|in the log|on the bus|type|demo)(?:, varying: (.+?)|: (.+?))? -->")
FILE = re.compile(r"`(/etc/canopen-gateway/gateway\.toml)`.*:$")
# The pages that are written to be followed step by step.
MANUAL = ["README", "QUICKSTART", "COMMISSIONING", "OPERATIONS", "TROUBLESHOOTING", "COMPARISON"]
LIMITS = "## Limits"


@dataclasses.dataclass
class Step:
    what: str  # of MARK, or "file"
    where: str  # page:line
    text: str  # of the block, or behind the colon of the mark
    varying: str = ""


class Mistake(Exception):
    pass


def blocks(page):
    """(line number, language, text, lines before back to the block before) of each block of code."""
    before, lines = [], enumerate(page.read_text(encoding="utf-8").splitlines(), 1)
    for number, line in lines:
        fence = re.fullmatch(r" *```(\w*)", line)
        if not fence:
            before.append((number, line))
            continue
        inside = []
        for _, inner in lines:
            if inner.strip() == "```":
                break
            inside.append(inner)
        else:
            raise Mistake(f"{page}:{number}: a block without an end")
        yield number, fence[1], "\n".join(inside) + "\n", before
        before = []
    yield None, None, None, before


def steps(page, name, strict=True):
    """The page's steps; a block that must say how it is tried and does not is a mistake. `strict`: so is one that does not
    say what it is, for in it commands could hide."""
    for number, language, text, before in blocks(page):
        mark = None
        for line_number, line in before:
            for found in MARK.finditer(line):
                if found[1] in ("type", "demo"):
                    yield Step(found[1], f"{name}:{line_number}", found[3] or "")
                else:
                    mark = found
        if number is None:
            return
        where = f"{name}:{number}"
        told = [line for _, line in before if line.strip()]
        near = bool(told) and MARK.search(told[-1])
        if told and FILE.match(told[-1]):
            yield Step("file", where, text)
        elif language in ("console", "sh") and not near:
            raise Mistake(f"{where}: nothing says how this block is tried")
        elif near and mark:
            if mark[1] == "not run":
                if not mark[3]:
                    raise Mistake(f"{where}: nothing says why this block is not run")
            else:
                yield Step(mark[1], where, text, mark[2] or "")
        elif not language and strict:
            raise Mistake(f"{where}: a block without a language")


def anchors(page):
    """As GitHub makes them of headings."""
    found, inside = set(), False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.lstrip().startswith("```"):
            inside = not inside
        heading = None if inside else re.match(r"#+ +(.*)", line)
        if heading:
            text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            found.add(re.sub(r"[^\w\- ]", "", text).strip().replace(" ", "-"))
    return found


def broken_links(page, root):
    inside = False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
        if inside:
            continue
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            if re.match(r"\w+:", target):
                continue
            path, _, anchor = target.partition("#")
            other = (page.parent / path).resolve() if path else page
            if not other.exists():
                yield f"{page.relative_to(root)}:{number}: there is no {path}"
            elif anchor and other.suffix == ".md" and anchor not in anchors(other):
                yield f"{page.relative_to(root)}:{number}: {path or page.name} has no heading #{anchor}"


def without_limits(page, root):
    """The last heading of the second level is the limits."""
    headings = [line for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("## ")]
    if not headings or headings[-1] != LIMITS:
        yield f"{page.relative_to(root)}: does not end with '{LIMITS}'"


def all_pages(root):
    return sorted((root / "docs").rglob("*.md"))


def mistakes(root):
    for page in all_pages(root):
        yield from without_limits(page, root)
    for page in [root / "README.md", *all_pages(root)]:
        yield from broken_links(page, pathlib.Path(root))
