#!/usr/bin/python3
"""Runs the commands of the manual and compares the answers with what its pages show. How a block says what is to be done
with it stands in pages.py.

manual.py texts             links of all pages, their limits, and that every block of the manual's pages has its mark
manual.py demo PAGE...      runs the pages' steps on the demo, in a network of its own (tests/system/recipe_run)
manual.py bus PAGE...       runs them on SocketCAN (tests/vcan/run), and looks for the pages' frames in candump's
manual.py --self-test       that a wrong answer is one
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True

import pages
import plant

ROOT = pathlib.Path(__file__).resolve().parents[2]
# What is another one each time: stamps, ages, loads, ids of commands, hashes, temporary files.
ALWAYS_VARYING = [
    r"\d{4}-\d\d-\d\d(?:T\d\d:\d\d:\d\d\.\d+Z?|\.jsonl)",
    r"\d+(?:\.\d+)? s\b",
    r"load \d+(?:\.\d+)? %",
    r"in \d+ ms|after \d+ ms",
    r"\b[0-9A-F]{8}-\d+\b",
    r"\b[0-9a-f]{64}\b",
]
# Commands that change something are run once.
ONCE = re.compile(r"\bset\b|\bstop\b|\bnmt\b|\bwrite\b|mosquitto_pub|mosquitto_rr|mbpoll.* 127\.0\.0\.1 -?\d")


def plain(line, varying):
    line = re.sub(r"  heartbeat margin \d+ % \(\w+\)$", "", line)  # it comes once enough heartbeats were heard
    for pattern in [*([varying] if varying else []), *ALWAYS_VARYING]:
        line = re.sub(pattern, "#", line)
    return re.sub(r"[ \t]+", " ", line).strip()


def agrees(shown, answered, varying=""):
    """All lines are alike; `...` stands for any lines."""
    pattern = "".join(
        r"(?:.*\n)*?" if line == "..." else re.escape(plain(line, varying)) + r"\n" for line in shown
    )
    return re.fullmatch(pattern, "".join(plain(line, varying) + "\n" for line in answered)) is not None


def in_order(shown, happened, varying=""):
    """The first line that does not come after the one before it, or None."""
    rest = iter(plain(line, varying) for line in happened)
    for line in shown:
        wanted = plain(line, varying)
        if wanted and not any(wanted in other for other in rest):
            return line
    return None


def commands(text):
    """(command, lines of its answer) of a console block."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        if line.startswith("$ "):
            found.append((re.sub(r"^sudo ", "", line[2:]), []))
        elif found:
            found[-1][1].append(line)
    return found


def answer(command, at):
    """What it says on both outputs. Of mbpoll only registers and mistakes: all else is its own greeting."""
    path = f"{at.work}/bin:{os.environ['PATH']}:/usr/sbin"
    done = subprocess.run(
        ["bash", "-c", at.meant(command)], cwd=at.work, env={**os.environ, "PATH": path}, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=20, check=False,
    )
    lines = at.shown(done.stdout.decode()).splitlines()
    if command.startswith("mbpoll"):
        lines = [line for line in lines if re.match(r"\[\d|Written|.*failed", line)]
    return lines


def run(step, at):
    for command, shown in commands(step.text):
        end = time.monotonic() + (0 if ONCE.search(command) else 8)
        while True:
            answered = answer(command, at)
            if agrees(shown, answered, step.varying):
                break
            if time.monotonic() > end:
                raise pages.Mistake(
                    "\n".join([f"{step.where}: $ {command}", "the page shows:", *shown, "the answer is:", *answered])
                )
            time.sleep(0.2)


def look_in_log(step, at):
    end = time.monotonic() + 8
    while missing := in_order(step.text.splitlines(), at.shown(at.log.read_text()).splitlines(), step.varying):
        if time.monotonic() > end:
            raise pages.Mistake(f"{step.where}: not in the log, or not there: {missing}\n{at.log.read_text()}")
        time.sleep(0.1)


def look_on_bus(step, at):
    missing = in_order(step.text.splitlines(), at.trace.read_text().splitlines(), step.varying)
    if missing:
        raise pages.Mistake(f"{step.where}: not on the bus, or not there: {missing}")


def try_page(name, at):
    done, config, running = 0, None, False
    for step in pages.steps(ROOT / name, name):
        if step.what in ("file", "demo"):
            config, running = step.text if step.what == "file" else None, True
            at.start(config)
        elif not running and step.what != "on the bus":
            at.start(None)
            running = True
        if step.what == "run":
            run(step, at)
        elif step.what == "in the log":
            look_in_log(step, at)
        elif step.what == "on the bus" and at.trace is not None:
            look_on_bus(step, at)
        elif step.what == "type":
            at.order(step.text)
        done += 1
    return done


def try_pages(kind, names):
    work = tempfile.mkdtemp(prefix="gateway-manual.")
    at = (plant.SocketCan if kind == "bus" else plant.Demo)(work, ROOT, os.environ["GATEWAY_BIN"])
    broker = subprocess.Popen(
        ["bash", "-c", "exec mosquitto -p 1883"], env={**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin"},
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    try:
        for name in names:
            begin = time.monotonic()
            done = try_page(name, at)
            print(f"{name}: {done} steps, {time.monotonic() - begin:.1f} s", flush=True)
            if done == 0:
                raise pages.Mistake(f"{name}: nothing to try")
    finally:
        at.stop()
        broker.terminate()
        broker.wait()
        shutil.rmtree(work, ignore_errors=True)


def look_at_texts():
    found = list(pages.mistakes(ROOT))
    for page in [ROOT / "README.md", *pages.all_pages(ROOT)]:
        if page.parent.name != "recipes":  # these have tests of their own
            strict = page.stem in pages.MANUAL or page.parent.name == "commissioning"
            list(pages.steps(page, str(page.relative_to(ROOT)), strict))
    if found:
        raise pages.Mistake("\n".join(found))


def self_test():
    assert agrees(["a 2.0 s", "...", "z"], ["a  3.5 s", "b", "c", "z"])
    assert agrees(["a 7 V"], ["a 8 V"], r"\d V")
    assert not agrees(["a 7 V"], ["a 8 V"])
    assert not agrees(["a"], ["a", "b"])
    assert not agrees(["a", "b"], ["a"])
    assert in_order(["a", "c"], ["x a", "b", "c"]) is None
    assert in_order(["c", "a"], ["a", "b", "c"]) == "a"
    assert commands("$ sudo x \\\n  y\nz\n") == [("x    y", ["z"])]
    with tempfile.TemporaryDirectory() as directory:
        page = pathlib.Path(directory) / "page.md"
        page.write_text("# A\n[b](#none) [c](no.md)\n```console\n$ x\n```\n")
        assert len(list(pages.broken_links(page, page.parent))) == 2
        assert len(list(pages.without_limits(page, page.parent))) == 1
        try:
            list(pages.steps(page, "page"))
        except pages.Mistake:
            return
        raise AssertionError("a block without a mark passes")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
    elif arguments == ["texts"]:
        look_at_texts()
    elif len(arguments) > 1 and arguments[0] in ("demo", "bus"):
        try_pages(arguments[0], arguments[1:])
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (pages.Mistake, plant.NotReady) as mistake:
        sys.exit(str(mistake))
