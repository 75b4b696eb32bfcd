"""What Home Assistant makes of messages: which devices and entities there are, and what each shows. Only of what the
gateway uses, after the documentation: a value that renders to None is `unknown`; to nothing, or to what is no value of
the entity, it stays as it was; without all of its availability topics at `online`, or longer than `expire_after` after
the last message of its state, an entity is `unavailable`. Kinder than it in two things: it loses nothing of a device whose last message
it is still at work on, and people have enabled what waits for that."""
import functools
import json

import jinja2

from hass.rules import TOPIC

ENVIRONMENT = jinja2.Environment()
UNKNOWN, UNAVAILABLE = "unknown", "unavailable"


@functools.lru_cache(maxsize=None)
def template(text):
    return ENVIRONMENT.from_string(text)


@functools.lru_cache(maxsize=1)
def variables(payload):
    try:
        return {"value": payload, "value_json": json.loads(payload)}
    except ValueError:
        return {"value": payload}


class Entity:
    def __init__(self, config, device):
        self.config, self.device = config, device
        self.state, self.heard = UNKNOWN, None

    def topic(self):
        return self.config.get("state_topic", self.device.get("state_topic"))

    def take(self, payload, now):
        if self.config["platform"] == "button":
            return
        self.heard = now
        self.state = self.value_of(payload)

    def value_of(self, payload):
        try:
            text = template(self.config["value_template"]).render(variables(payload)).strip()
        except jinja2.TemplateError:
            return self.state
        platform = self.config["platform"]
        if text == "None" or (platform == "select" and text.lower() == "none"):
            return UNKNOWN
        if text == "":
            return self.state
        if platform == "binary_sensor":
            return {self.config["payload_on"]: "on", self.config["payload_off"]: "off"}.get(text, self.state)
        if "options" in self.config:
            return text if text in self.config["options"] else self.state
        if platform == "number":
            return text if self.config["min"] <= float(text) <= self.config["max"] else self.state
        return text


class Home:
    """One that has been running since the first message, with the usual prefix of its discovery."""

    def __init__(self):
        self.kept = {}     # by topic: payload
        self.devices = {}  # by discovery topic: what all its entities share
        self.entities = {}  # by discovery topic, platform and key

    def message(self, topic, payload, now):
        match = TOPIC.match(topic)
        if match and match["prefix"] == "homeassistant":
            self.discover(topic, payload)
            return
        self.kept[topic] = (payload, now)
        for entity in self.entities.values():
            if entity.topic() == topic and payload != "":
                entity.take(payload, now)

    def discover(self, topic, payload):
        if payload == "":
            self.devices.pop(topic, None)
            self.entities = {key: entity for key, entity in self.entities.items() if key[0] != topic}
            return
        device = json.loads(payload)
        self.devices[topic] = device
        for key, config in device["components"].items():
            name = (topic, config["platform"], key)
            if len(config) == 1:
                self.entities.pop(name, None)
                continue
            before = self.entities.get(name)
            entity = self.entities[name] = Entity(config, device)
            if before:
                entity.state, entity.heard = before.state, before.heard
            elif entity.topic() in self.kept and self.kept[entity.topic()][0] != "":
                entity.take(*self.kept[entity.topic()])

    def is_available(self, entity, now):
        topics = [each["topic"] for each in entity.device["availability"]]
        if not all(self.kept.get(topic, ("",))[0] == "online" for topic in topics):
            return False
        lasts = entity.config.get("expire_after")
        return not lasts or (entity.heard is not None and now - entity.heard <= lasts)

    def states(self, now):
        """`DEVICE KEY`: what it shows."""
        shown = {}
        for (topic, _, key), entity in self.entities.items():
            name = f"{self.devices[topic]['device']['name']} {key}"
            shown[name] = entity.state if self.is_available(entity, now) else UNAVAILABLE
        return shown

    def command(self, device, key, value):
        """The topic, QoS and payload that setting this entity sends."""
        for (topic, platform, name), entity in self.entities.items():
            if name == key and self.devices[topic]["device"]["name"] == device:
                payload = entity.config.get("payload_press") if platform == "button" else value
                if platform == "select" and value not in entity.config["options"]:
                    raise SystemExit(f"{value} is no option of {key}")
                if platform == "number" and not entity.config["min"] <= float(value) <= entity.config["max"]:
                    raise SystemExit(f"{value} is out of the range of {key}")
                if "command_template" in entity.config:
                    payload = template(entity.config["command_template"]).render(value=value)
                return entity.config["command_topic"], entity.config["qos"], payload
        raise SystemExit(f"no {key} of {device}")
