"""That the judge sees mistakes, and what it shows of an example."""
import copy
import json

from hass.home import Home
from hass.rules import faults

TOPIC = "homeassistant/device/canopen_line3/pump1/config"
VALUE = "value_json['values']['{0}']"
GOOD = {
    "device": {"identifiers": ["canopen/line3/pump1"], "name": "pump1", "model": "veichi-ac310"},
    "origin": {"name": "canopen-gateway", "sw_version": "0.1.0"},
    "availability": [{"topic": "canopen/line3/status"}, {"topic": "canopen/line3/pump1/status"}],
    "availability_mode": "all",
    "state_topic": "canopen/line3/pump1/state",
    "components": {
        "sensor_f": {"platform": "sensor", "unique_id": "u/f", "name": "F", "expire_after": 90,
                     "value_template": "{{ " + VALUE.format("f") + " }}", "unit_of_measurement": "Hz",
                     "device_class": "frequency", "state_class": "measurement", "suggested_display_precision": 2},
        "sensor_s": {"platform": "sensor", "unique_id": "u/s", "name": "S", "expire_after": 90, "device_class": "enum",
                     "value_template": "{{ " + VALUE.format("s") + " if " + VALUE.format("s_code") + " in [3] else None }}",
                     "options": ["stopped"]},
        "binary_sensor_r": {"platform": "binary_sensor", "unique_id": "u/r", "name": "R", "expire_after": 90,
                            "value_template": "{{ " + VALUE.format("r") + " }}", "payload_on": "True",
                            "payload_off": "False", "device_class": "running"},
        "number_c": {"platform": "number", "unique_id": "u/c", "name": "C", "value_template": "{{ None }}",
                     "command_topic": "canopen/line3/pump1/c/set", "qos": 0, "retain": False, "min": 0, "max": 50,
                     "step": 0.01, "mode": "box", "unit_of_measurement": "Hz", "device_class": "frequency"},
        "select_m": {"platform": "select", "unique_id": "u/m", "name": "M", "value_template": "{{ None }}",
                     "command_topic": "canopen/line3/pump1/m/set", "qos": 0, "retain": False,
                     "command_template": "{{ {'value': value} | tojson }}", "options": ["forward", "stop"]},
        "button_stop": {"platform": "button", "unique_id": "u/stop", "name": "Stop", "qos": 1, "retain": False,
                        "command_topic": "canopen/line3/pump1/m/set", "payload_press": "{\"value\":\"stop\"}"},
    },
}
# Where, and what stands there instead; None: nothing.
MUTANTS = [
    (("device",), None), (("device", "identifiers"), []), (("device", "identifiers"), None),
    (("device", "colour"), "red"), (("origin",), None), (("origin", "name"), None), (("availability",), None),
    (("availability_mode",), "both"), (("availability", 0, "payload"), "online"), (("availability", 0, "topic"), "a/#"),
    (("components",), {}), (("state_topic",), None), (("state_topic",), "a/+"), (("more",), 1),
    (("components", "a b"), {"platform": "sensor"}), (("components", "x"), {"platform": "thermometer"}),
    (("components", "x"), {"unique_id": "u/x"}), (("components", "sensor_f", "platform"), None),
    (("components", "sensor_f", "unique_id"), None), (("components", "sensor_f", "unique_id"), "u/s"),
    (("components", "sensor_f", "unit"), "Hz"), (("components", "sensor_f", "unit_of_measurement"), "rpm"),
    (("components", "sensor_f", "unit_of_measurement"), None), (("components", "sensor_f", "device_class"), "speed_of"),
    (("components", "sensor_f", "device_class"), "temperature"), (("components", "sensor_f", "state_class"), "total"),
    (("components", "sensor_f", "state_class"), "mean"), (("components", "sensor_f", "options"), ["a"]),
    (("components", "sensor_f", "suggested_display_precision"), 2.5), (("components", "sensor_f", "expire_after"), None),
    (("components", "sensor_f", "expire_after"), "90"), (("components", "sensor_f", "expire_after"), True),
    (("components", "sensor_f", "value_template"), "{{ value"), (("components", "sensor_f", "entity_category"), "config"),
    (("components", "sensor_f", "command_topic"), "a"), (("components", "sensor_s", "state_class"), "measurement"),
    (("components", "sensor_s", "options"), []), (("components", "sensor_s", "options"), ["a", "a"]),
    (("components", "sensor_s", "unit_of_measurement"), "V"), (("components", "binary_sensor_r", "payload_on"), True),
    (("components", "binary_sensor_r", "device_class"), "frequency"), (("components", "number_c", "min"), 50),
    (("components", "number_c", "step"), 0), (("components", "number_c", "max"), None),
    (("components", "number_c", "mode"), "wheel"), (("components", "number_c", "expire_after"), 90),
    (("components", "number_c", "command_topic"), None), (("components", "number_c", "command_topic"), "a/+/set"),
    (("components", "number_c", "retain"), True), (("components", "number_c", "retain"), None),
    (("components", "number_c", "optimistic"), True), (("components", "number_c", "value_template"), None),
    (("components", "number_c", "device_class"), "voltage"), (("components", "select_m", "options"), None),
    (("components", "select_m", "qos"), 3), (("components", "button_stop", "payload_press"), None),
    (("components", "button_stop", "payload_press"), 5), (("components", "button_stop", "value_template"), "{{ 1 }}"),
]


def mutated(path, value):
    message = copy.deepcopy(GOOD)
    table = message
    for step in path[:-1]:
        table = table[step]
    if value is None:
        del table[path[-1]]
    else:
        table[path[-1]] = value
    return message


def run():
    mistakes = [f"the example: {fault}" for fault in faults(TOPIC, json.dumps(GOOD))]
    if mutated(("availability_mode",), "all") != GOOD:
        mistakes.append("a mutant that is none")
    for path, value in MUTANTS:
        if not list(faults(TOPIC, json.dumps(mutated(path, value)))):
            mistakes.append(f"not seen: {'/'.join(map(str, path))} = {value!r}")
    for topic in ("homeassistant/sensor/a/config", "homeassistant/device/a b/config", "homeassistant/device/a/b/c/config"):
        if not list(faults(topic, json.dumps(GOOD))):
            mistakes.append(f"not seen: {topic}")
    for payload in ("{", "[]", "1", "", json.dumps(GOOD)[:-1] + ',"origin":{"name":"x"}}'):
        if not list(faults(TOPIC, payload)):
            mistakes.append(f"not seen: {payload[:40]}")
    mistakes += shows()
    for mistake in mistakes:
        print(mistake)
    print(f"{len(MUTANTS)} mutants, {len(mistakes)} mistakes")
    return 1 if mistakes else 0


def shows():
    """What the evaluator makes of the example is what stands in the documentation."""
    home = Home()
    state = "canopen/line3/pump1/state"
    steps = [
        (TOPIC, json.dumps(GOOD), {"sensor_f": "unavailable", "button_stop": "unavailable"}),
        ("canopen/line3/pump1/status", "online", {"sensor_f": "unavailable"}),
        ("canopen/line3/status", "online", {"sensor_f": "unavailable", "number_c": "unknown", "button_stop": "unknown"}),
        (state, '{"values":{"f":49.97,"s":"stopped","s_code":3,"r":true}}',
         {"sensor_f": "49.97", "sensor_s": "stopped", "binary_sensor_r": "on", "number_c": "unknown"}),
        (state, '{"values":{"f":null,"s":"unknown(7)","s_code":7,"r":false}}',
         {"sensor_f": "unknown", "sensor_s": "unknown", "binary_sensor_r": "off"}),
        (state, '{"values":{"f":1.5,"s":null,"s_code":null,"r":null}}',
         {"sensor_f": "1.5", "sensor_s": "unknown", "binary_sensor_r": "unknown"}),
        ("canopen/line3/pump1/status", "offline", {"sensor_f": "unavailable", "number_c": "unavailable"}),
        ("canopen/line3/pump1/status", "online", {"sensor_f": "1.5"}),
        (TOPIC, json.dumps(mutated(("components", "sensor_f"), {"platform": "sensor"})),
         {"sensor_f": None, "sensor_s": "unknown"}),
        (TOPIC, "", {"sensor_s": None, "button_stop": None}),
    ]
    for second, (topic, payload, expected) in enumerate(steps):
        home.message(topic, payload, second)
        shown = home.states(second)
        for key, value in expected.items():
            if shown.get("pump1 " + key) != value:
                yield f"behind {topic} {payload[:40]}: {key} shows {shown.get('pump1 ' + key)}, not {value}"
    home.message(TOPIC, json.dumps(GOOD), 10)
    home.message(state, '{"values":{"f":1.5}}', 10)
    for second, value in ((100, "1.5"), (101, "unavailable")):
        if home.states(second)["pump1 sensor_f"] != value:
            yield f"{second - 10} s behind its last message it shows {home.states(second)['pump1 sensor_f']}"
    sent = [home.command("pump1", *each) for each in (("select_m", "stop"), ("button_stop", None), ("number_c", "30"))]
    if sent != [("canopen/line3/pump1/m/set", 0, '{"value": "stop"}'), ("canopen/line3/pump1/m/set", 1, '{"value":"stop"}'),
                ("canopen/line3/pump1/c/set", 0, "30")]:
        yield f"commands are {sent}"
