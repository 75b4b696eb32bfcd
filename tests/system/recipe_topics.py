#!/usr/bin/python3
"""What the pages of recipes say, against what the gateway publishes.

recipe_topics.py topics <LINES         recipes whose program cannot be run here. Lines are `TOPIC PAYLOAD` of all that a
                                       broker keeps: every subscription of the pages has to find something, and every
                                       member that they read has to be there, or to be optional.
recipe_topics.py times EXPIRY DEFAULT  the times on the pages. EXPIRY: the seconds that a live topic lives, by the
                                       configuration of the pages; DEFAULT: where it has no `expiry`.
"""

import json
import pathlib
import re
import sys
import tomllib

import jinja2
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import recipe_files  # noqa: E402

PAGES = pathlib.Path(__file__).parents[2] / "docs" / "recipes"
mistakes = []


def require(true, what):
    if not true:
        mistakes.append(what)


def page(name):
    return (PAGES / name).read_text(encoding="utf-8")


def matching(kept, topic_filter):
    pattern = re.compile("".join("[^/]+" if part == "+" else re.escape(part) for part in re.split(r"(\+)", topic_filter)) + "$")
    found = {topic: payload for topic, payload in kept.items() if pattern.match(topic)}
    require(found, f"nothing is published on {topic_filter}")
    return found


def telegraf(kept):
    site = tomllib.loads(recipe_files.files(page("telegraf.md"))["/etc/telegraf/telegraf.d/canopen.conf"])
    for consumer in site["inputs"]["mqtt_consumer"]:
        optional, seen = set(), set()
        for topic_filter in consumer["topics"]:
            for topic, payload in matching(kept, topic_filter).items():
                members = json.loads(payload)
                for parser in consumer["json_v2"]:
                    seen |= set(members)
                    for field in parser.get("field", []):
                        if field.get("optional"):
                            optional.add(field["path"])
                        else:
                            require(field["path"] in members, f"{topic} has no {field['path']}")
                    for inner in parser.get("object", []):
                        for excluded in inner["excluded_keys"]:
                            require(excluded in members, f"{topic} has no {excluded}")
                    if parser["measurement_name"] == "drive":
                        require(not set(members) & set(members["values"]), f"{topic}: two members of one name")
            for parsing in consumer["topic_parsing"]:
                require(parsing["topic"] == topic_filter, f"{topic_filter} is parsed as {parsing['topic']}")
                require(len(parsing["tags"].split("/")) == len(topic_filter.split("/")), f"tags of {topic_filter}")
        for path in optional - seen:
            require(False, f"no message of {consumer['topics']} has {path}")


def home_assistant(kept):
    automations = yaml.safe_load(recipe_files.files(page("home-assistant.md"))["/etc/home-assistant/automations.yaml"])
    for automation in automations:
        message = jinja2.Template(automation["actions"][0]["data"]["message"])
        for trigger in automation["triggers"]:
            if trigger["trigger"] != "mqtt":
                continue
            for payload in matching(kept, trigger["topic"]).values():
                if "payload" in trigger:
                    continue
                alarms = json.loads(payload)
                require(alarms, f"{trigger['topic']} lists no alarm, so nothing is known of its members")
                words = message.render(trigger={"payload_json": alarms})
                for alarm in alarms:
                    require(f"{alarm['drive']}: {alarm['text']}" in words, f"an alarm is told as {words}")
                words = message.render(trigger={"payload_json": []})
                require(words.strip() == "no alarm", f"the end of all alarms is told as {words}")


def times(expiry, default):
    """Each page says these words, with what follows from the two."""
    silent, silent_by_default = 2 * expiry // 3 + 5, 2 * default // 3 + 5
    for name, words in {
        "mosquitto.md": [
            f"told anew each {expiry // 3} s; by default {default} s and {default // 3} s",
            f"expire after `expiry` ({expiry} s)",
        ],
        "mosquitto-bridge.md": [f"were published ({expiry} s)"],
        "mosquitto-pair.md": [f"expire after `expiry` ({expiry} s)"],
        "nats.md": [f"told anew each {expiry // 3} s", f"never older than {expiry // 3} s"],
        "node-red.md": [
            f'"duration": "{silent}"',
            f'"silent for {silent} s"',
            f"*silent for {silent} s*",
            f"default of {default} s to {silent_by_default} s",
        ],
        "telegraf.md": [
            f"older than {silent} s: they come each {expiry // 3} s at least",
            f"default of {default} s, older than {silent_by_default} s",
        ],
        "../SECURITY.md": [f"a third of `expiry` (by default {default // 3} s)"],
    }.items():
        text = " ".join(page(name).split())
        for each in words:
            require(each in text, f"{name} does not say: {each}")
    for path in PAGES.glob("*.md"):
        for name, content in recipe_files.files(page(path.name)).items():
            if "brokers = " in content:
                said = tomllib.loads(content)["mqtt"].get("expiry")
                require(said == f"{expiry}s", f"{path.name} has expiry {said} in {name}")


def main(arguments):
    if arguments[:1] == ["times"]:
        times(*(int(each) for each in arguments[1:]))
    else:
        kept = dict(line.rstrip("\n").split(" ", 1) for line in sys.stdin)
        telegraf(kept)
        home_assistant(kept)
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    sys.exit(1 if mistakes else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
