#!/usr/bin/env python3
"""What Home Assistant would take and show of the messages in LOG, lines of `TIME RETAINED TOPIC PAYLOAD` (mosquitto_sub
-F '%U %r %t %p'). Home Assistant itself is no package of Debian; this follows its documentation.

  home_assistant.py validate LOG             each discovery message: what is wrong with it; leaves with 1 where any is
  home_assistant.py states LOG [now]         `DEVICE KEY STATE` of each entity, when the last line came or now
  home_assistant.py command LOG DEVICE KEY [VALUE]   `TOPIC QOS PAYLOAD` that setting this entity sends
  home_assistant.py --self-test              that its mistakes are seen"""
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
    seen, wrong = 0, 0
    for _, topic, payload in lines_of(log):
        if "/device/" in topic and topic.endswith("/config") and payload:
            seen += 1
            for fault in rules.faults(topic, payload):
                wrong += 1
                print(f"{topic}: {fault}")
    print(f"{seen} messages, {wrong} faults")
    return 1 if wrong or not seen else 0


def home_of(log):
    home, last = Home(), 0.0
    for moment, topic, payload in lines_of(log):
        home.message(topic, payload, moment)
        last = moment
    return home, last


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test.run()
    verb, log, rest = arguments[0], arguments[1], arguments[2:]
    if verb == "validate":
        return validate(log)
    home, last = home_of(log)
    if verb == "states":
        for name, state in sorted(home.states(time.time() if rest else last).items()):
            print(name, state)
        return 0
    if verb == "command":
        print(*home.command(rest[0], rest[1], rest[2] if len(rest) > 2 else None))
        return 0
    raise SystemExit(__doc__)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
