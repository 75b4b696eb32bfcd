#!/usr/bin/python3
"""Recipes whose program cannot be run here, against what the gateway publishes: recipe_topics.py <LINES

Lines are `TOPIC PAYLOAD` of all that a broker keeps. Every subscription of the pages has to find something, and every member
that they read has to be there.
"""

import json
import pathlib
import re
import sys
import tomllib

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
        for topic_filter in consumer["topics"]:
            for topic, payload in matching(kept, topic_filter).items():
                members = json.loads(payload)
                for parser in consumer["json_v2"]:
                    for field in parser.get("field", []):
                        require(field["path"] in members, f"{topic} has no {field['path']}")
                    for inner in parser.get("object", []):
                        for excluded in inner["excluded_keys"]:
                            require(excluded in members, f"{topic} has no {excluded}")
                    if parser["measurement_name"] == "drive":
                        require(not set(members) & set(members["values"]), f"{topic}: two members of one name")
            for parsing in consumer["topic_parsing"]:
                require(parsing["topic"] == topic_filter, f"{topic_filter} is parsed as {parsing['topic']}")
                require(len(parsing["tags"].split("/")) == len(topic_filter.split("/")), f"tags of {topic_filter}")


def home_assistant(kept):
    automation = recipe_files.files(page("home-assistant.md"))["/etc/home-assistant/automations.yaml"]
    for topic in re.findall(r"topic: (\S+)", automation):
        for payload in matching(kept, topic).values():
            alarms = json.loads(payload)
            require(alarms, f"{topic} lists no alarm, so nothing is known of its members")
            for alarm in alarms:
                for member in ("drive", "text"):
                    require(member in alarm, f"an alarm of {topic} has no {member}")


def main():
    kept = dict(line.rstrip("\n").split(" ", 1) for line in sys.stdin)
    telegraf(kept)
    home_assistant(kept)
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    sys.exit(1 if mistakes else 0)


if __name__ == "__main__":
    main()
