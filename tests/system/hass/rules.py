"""What Home Assistant takes in a device's discovery message, after its documentation: of the MQTT integration
(https://www.home-assistant.io/integrations/mqtt/, "Device discovery payload", "Using availability topics"), of the
platforms sensor, binary_sensor, number, select and button there, and of the classes, units and state classes of the
sensor integration. Stricter than it in one thing: it ignores keys that it does not know, here they are mistakes."""
import json
import re

import jinja2

TOPIC = re.compile(r"^(?P<prefix>.+)/device/(?:(?P<node>[a-zA-Z0-9_-]+)/)?(?P<object>[a-zA-Z0-9_-]+)/config$")
# Units of each device class, and which state classes go with it: some of those that home-assistant/core has in
# homeassistant/components/sensor/const.py, read at commit 00eb6680fbf6bdf7af2499095f2e74fca980a148.
CLASSES = {
    "current": ({"A", "mA"}, {"measurement"}),
    "duration": ({"d", "h", "min", "s", "ms"}, {"measurement", "total", "total_increasing"}),
    "energy": ({"J", "kJ", "MJ", "GJ", "mWh", "Wh", "kWh", "MWh", "GWh", "TWh"}, {"total", "total_increasing"}),
    "frequency": ({"Hz", "kHz", "MHz", "GHz"}, {"measurement"}),
    "power": ({"W", "kW", "MW", "GW", "TW"}, {"measurement"}),
    "pressure": ({"Pa", "hPa", "kPa", "bar", "cbar", "mbar", "psi"}, {"measurement"}),
    "temperature": ({"°C", "°F", "K"}, {"measurement"}),
    "voltage": ({"V", "mV", "µV", "kV", "MV"}, {"measurement"}),
    "humidity": ({"%"}, {"measurement"}),
    "battery": ({"%"}, {"measurement"}),
    "enum": ({None}, set()),
}
BINARY_CLASSES = {"running", "problem", "power", "connectivity", "moving", "safety", "heat"}
STATE_CLASSES = {"measurement", "total", "total_increasing"}


def is_text(value):
    return isinstance(value, str) and value != ""


def is_whole(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_flag(value):
    return isinstance(value, bool)


def is_topic(value):
    return is_text(value) and not re.search(r"[+#\x00]", value) and len(value.encode()) <= 65535


def is_template(value):
    try:
        jinja2.Environment().parse(value)
        return is_text(value)
    except (jinja2.TemplateError, TypeError):
        return False


def are_texts(value):
    return isinstance(value, list) and value != [] and all(map(is_text, value))


COMMON = {"platform": is_text, "unique_id": is_text, "name": is_text, "enabled_by_default": is_flag,
          "entity_category": is_text, "qos": lambda value: value in (0, 1, 2) and not is_flag(value)}
READ = {"state_topic": is_topic, "value_template": is_template, "expire_after": is_whole, "device_class": is_text}
WRITE = {"command_topic": is_topic, "command_template": is_template, "retain": is_flag}
SHOW = {"state_topic": is_topic, "value_template": is_template, "optimistic": is_flag}
PLATFORMS = {
    "sensor": COMMON | READ | {"unit_of_measurement": is_text, "state_class": is_text, "options": are_texts,
                               "suggested_display_precision": is_whole},
    "binary_sensor": COMMON | READ | {"payload_on": is_text, "payload_off": is_text},
    "number": COMMON | WRITE | SHOW | {"min": is_number, "max": is_number, "step": is_number, "mode": is_text,
                                       "unit_of_measurement": is_text, "device_class": is_text},
    "select": COMMON | WRITE | SHOW | {"options": are_texts},
    "button": COMMON | WRITE | {"payload_press": is_text, "device_class": is_text},
}


def of_keys(what, table, known, required):
    if not isinstance(table, dict):
        yield f"{what} is no mapping"
        return
    for key, value in table.items():
        if key not in known:
            yield f"{what}: {key} is not known"
        elif not known[key](value):
            yield f"{what}: {key} cannot be {value!r}"
    for key in required:
        if key not in table:
            yield f"{what}: {key} is missing"


def of_class(what, component):
    kind, unit = component.get("device_class"), component.get("unit_of_measurement")
    state_class = component.get("state_class")
    if state_class is not None and state_class not in STATE_CLASSES:
        yield f"{what}: no state class {state_class}"
    if "options" in component and (kind != "enum" or state_class is not None or unit is not None):
        yield f"{what}: options go with the class enum alone"
    if kind is None:
        return
    if kind not in CLASSES:
        yield f"{what}: no device class {kind}"
        return
    units, state_classes = CLASSES[kind]
    if unit not in units:
        yield f"{what}: the device class {kind} does not take the unit {unit}"
    if state_class is not None and state_class not in state_classes:
        yield f"{what}: the device class {kind} does not take the state class {state_class}"


def of_component(what, component, has_state_topic):
    platform = component.get("platform") if isinstance(component, dict) else None
    if platform not in PLATFORMS:
        yield f"{what}: no platform {platform}"
        return
    if list(component) == ["platform"]:
        return  # it removes one
    required = ["unique_id", "name"] + (["command_topic", "retain", "qos"] if "command_topic" in PLATFORMS[platform]
                                        else ["value_template", "expire_after"])
    yield from of_keys(what, component, PLATFORMS[platform], required)
    if platform != "button" and not has_state_topic and "state_topic" not in component:
        yield f"{what}: state_topic is missing"
    if platform in ("number", "select") and ("value_template" not in component or component.get("optimistic")):
        yield f"{what}: it would show what was asked for"
    if component.get("retain"):
        yield f"{what}: a retained command"
    if component.get("entity_category") not in (None, "diagnostic", "config") or (
            platform in ("sensor", "binary_sensor") and component.get("entity_category") == "config"):
        yield f"{what}: no category {component['entity_category']} there"
    if platform in ("sensor", "number"):
        yield from of_class(what, component)
    if platform == "binary_sensor" and component.get("device_class") not in BINARY_CLASSES | {None}:
        yield f"{what}: no device class {component['device_class']}"
    options = component.get("options", [])
    if platform == "select" and "options" not in component:
        yield f"{what}: options are missing"
    if isinstance(options, list) and len(set(map(str, options))) != len(options):
        yield f"{what}: an option twice"
    if platform == "number":
        limits = [component.get(key) for key in ("min", "max", "step")]
        if not all(map(is_number, limits)) or limits[0] >= limits[1] or limits[2] < 0.001:
            yield f"{what}: limits {limits}"
        if component.get("mode") not in ("box", "slider", "auto"):
            yield f"{what}: no mode {component.get('mode')}"
    if platform == "button" and "payload_press" not in component:
        yield f"{what}: payload_press is missing"


def faults(topic, payload):
    """What is wrong with this message; nothing: all of it is taken."""
    if not TOPIC.match(topic):
        yield f"{topic} is no topic of a device"
    try:
        message = json.loads(payload, object_pairs_hook=without_twins)
    except ValueError as mistake:
        yield f"no JSON: {mistake}"
        return
    yield from of_keys("the message", message, {
        "device": lambda value: isinstance(value, dict), "origin": lambda value: isinstance(value, dict),
        "components": lambda value: isinstance(value, dict) and value != {},
        "availability": lambda value: isinstance(value, list) and value != [],
        "availability_mode": lambda value: value in ("all", "any", "latest"), "state_topic": is_topic,
    }, ["device", "origin", "components", "availability", "availability_mode"])
    if not isinstance(message, dict):
        return
    yield from of_keys("device", message.get("device", {}), {
        "identifiers": are_texts, "name": is_text, "model": is_text, "sw_version": is_text, "serial_number": is_text},
        ["identifiers", "name"])
    yield from of_keys("origin", message.get("origin", {}), {"name": is_text, "sw_version": is_text}, ["name"])
    for each in message.get("availability", []):
        yield from of_keys("availability", each, {"topic": is_topic}, ["topic"])
    seen = set()
    for key, component in dict(message.get("components", {})).items():
        if not re.fullmatch(r"\S+", key):
            yield f"{key!r} cannot be an id"
        yield from of_component(key, component, "state_topic" in message)
        unique = isinstance(component, dict) and (component.get("platform"), component.get("unique_id"))
        if unique and unique[1] is not None and unique in seen:
            yield f"{key}: {unique[1]} twice"
        seen.add(unique)


def without_twins(pairs):
    table = dict(pairs)
    if len(table) != len(pairs):
        raise ValueError("a key twice: " + ", ".join(sorted(key for key, _ in pairs)))
    return table
