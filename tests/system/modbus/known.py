"""What the caller knows of the server, read from JSON."""
import json

from modbus.expected import Unit


def empty_unit():
    return {"registers": {}, "wide": {}, "commands": [], "bits": {}}


def put_signal(unit, signal, address):
    place = signal["modbus"]
    unit["bits" if place["kind"] == "bit" else "registers"][str(address)] = None
    if place["kind"] != "bit" and place["count"] > 1:
        unit["wide"][str(address)] = place["count"]
    if place["kind"] != "bit" and signal["access"] == "write":
        unit["commands"] += range(address, address + place["count"])


def from_map(tree):
    """The units of `canopen-gateway map --format json`, in the form of the caller's own JSON; no value is known."""
    units = {"0": {"gateway": True, "buses": len(tree["buses"])}}
    bases = {str(drive["flat"]): drive["modbus_unit"] for drive in tree["drives"] if "flat" in drive}
    flat = {**empty_unit(), "flat": bases}
    for drive in tree["drives"]:
        unit = empty_unit()
        for signal in drive["signals"]:
            if signal["modbus"] is None:
                continue
            put_signal(unit, signal, signal["modbus"]["address"])
            if "flat" in signal["modbus"]:
                put_signal(flat, signal, signal["modbus"]["flat"])
        if drive["modbus_unit"] is not None:
            units[str(drive["modbus_unit"])] = unit
    if "flat_unit" in tree:
        units[str(tree["flat_unit"])] = flat
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
    unit = Unit(**{key: numbers(value) if isinstance(value, dict) and key != "objects" else value
                   for key, value in given.items()})
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
    for unit in units.values():
        unit.absent = {base for base, number in (unit.flat or {}).items() if number in units and units[number].offline}
    if 0 in units:
        units.setdefault(255, units[0])
    return units
