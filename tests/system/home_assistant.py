#!/usr/bin/env python3
"""What Home Assistant would take and show of the messages in LOG, lines of `TIME RETAINED TOPIC PAYLOAD` (mosquitto_sub
-F '%U %r %t %p'). Home Assistant itself is no package of Debian; this follows its documentation.

  home_assistant.py validate LOG             each discovery message: what is wrong with it; leaves with 1 where any is
  home_assistant.py states LOG [now]         `DEVICE KEY STATE` of each entity, when the last line came or now
  home_assistant.py follow LOG OUT           writes to OUT what `states LOG now` would print, as it changes, until killed
  home_assistant.py commands LOG             of each line `DEVICE|KEY|VALUE` of the input (VALUE may be empty) the line,
                                             a blank and `TOPIC QOS PAYLOAD` that setting this entity sends
  home_assistant.py --self-test              that its mistakes are seen"""
import os
import sys
import time

sys.dont_write_bytecode = True  # the source tree stays as it is

from hass import rules, self_test
from hass.home import Home


def lines_of(name):
    with open(name, encoding="utf-8") as log:
        for line in log:
            moment, _, topic, payload = (line.rstrip("\n").split(" ", 3) + [""])[:4]
            yield float(moment), topic, payload


def validate(log):
    seen, wrong = set(), 0
    for _, topic, payload in lines_of(log):
        if "/device/" in topic and topic.endswith("/config") and payload:
            seen.add(topic)
            for fault in rules.faults(topic, payload):
                wrong += 1
                print(f"{topic}: {fault}")
    print(f"{len(seen)} devices, {wrong} faults")
    return 1 if wrong or not seen else 0


def home_of(log):
    home, last = Home(), 0.0
    for moment, topic, payload in lines_of(log):
        home.message(topic, payload, moment)
        last = moment
    return home, last


def states_text(home, now):
    return "".join(f"{name} {state}\n" for name, state in sorted(home.states(now).items()))


def follow(log, out):
    """Without a start of Python for each look, of which most of a test's time would go."""
    home, shown, rest = Home(), None, ""
    with open(log, encoding="utf-8") as lines:
        while True:
            *whole, rest = (rest + lines.read()).split("\n")
            for line in whole:
                moment, _, topic, payload = (line.split(" ", 3) + [""])[:4]
                home.message(topic, payload, float(moment))
            text = states_text(home, time.time())
            if text != shown:
                shown = text
                with open(out + ".new", "w", encoding="utf-8") as fresh:
                    fresh.write(text)
                os.replace(out + ".new", out)
            time.sleep(0.1)


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test.run()
    verb, log, rest = arguments[0], arguments[1], arguments[2:]
    if verb == "validate":
        return validate(log)
    if verb == "follow":
        return follow(log, rest[0])
    home, last = home_of(log)
    if verb == "states":
        print(states_text(home, time.time() if rest else last), end="")
        return 0
    if verb == "commands":
        for line in map(str.strip, sys.stdin):
            print(line, *home.command(*line.split("|")))
        return 0
    raise SystemExit(__doc__)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
