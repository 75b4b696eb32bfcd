"""What the caller knows of the server, read from JSON."""
import json

from modbus.expected import Unit


def from_map(tree):
    """The units of `canopen-gateway map --format json`, in the form of the caller's own JSON; no value is known."""
    units = {"0": {"gateway": True, "buses": len(tree["buses"])}}
    for drive in tree["drives"]:
        unit = {"registers": {}, "wide": {}, "commands": [], "bits": {}}
        for signal in drive["signals"]:
            place = signal["modbus"]
            if place is None:
                continue
            unit["bits" if place["kind"] == "bit" else "registers"][str(place["address"])] = None
            if place["kind"] != "bit" and place["count"] > 1:
                unit["wide"][str(place["address"])] = place["count"]
            if place["kind"] != "bit" and signal["access"] == "write":
                unit["commands"] += range(place["address"], place["address"] + place["count"])
        units[str(drive["modbus_unit"])] = unit
    return units


def merge(below, above):
    """The second's values over the first's; tables are joined, also those inside."""
    joined = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(joined.get(key), dict)
        joined[key] = merge(joined[key], value) if both else value
    return joined


def read_unit(number, given):
    def numbers(table):
        return {int(key): value for key, value in table.items()}
    unit = Unit(**{key: numbers(value) if isinstance(value, dict) else value for key, value in given.items()})
    unit.commands = set(unit.commands)
    missing = [at for at in [*unit.writes, *unit.wide] if at not in unit.registers]
    if missing:
        raise ValueError(f"unit {number}: {missing} are written or wide, but no registers")
    for first, words in unit.wide.items():
        for address in range(first, first + words):
            unit.registers.setdefault(address, None)
    return unit


def load(*texts):
    """{unit number: Unit} of several JSON texts, later ones over earlier ones."""
    given = {}
    for text in texts:
        tree = json.loads(text)
        given = merge(given, from_map(tree) if "drives" in tree else tree["units"])
    units = {int(number): read_unit(number, unit) for number, unit in given.items()}
    if 0 in units:
        units.setdefault(255, units[0])
    return units
