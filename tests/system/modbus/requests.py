"""The requests of the conformance run: every function with every boundary, as (section, group, unit, PDU).

Writes go only to addresses that nobody may write, or that the caller allows; a request that breaks two rules
is aimed at an unmapped address, so that a server without the rule still writes nothing.
"""
import struct

from modbus.expected import SUPPORTED, UNUSED

NOWHERE = 5000  # never mapped
READS = {1: "1, 2", 2: "1, 2", 3: "3, 4", 4: "3, 4"}  # what is answered to both is one row of the table
EDGES = [0, 1, 99, 100, 198, 199, 200, 999, 1000, 1052, 1053, 1098, 1099, 1100, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF]


def pdu(function, *words):
    return bytes([function]) + struct.pack(f">{len(words)}H", *words)


def write_many(function, address, quantity, data, count=None):
    """Functions 15 and 16; a count of its own is a lie about the bytes that follow."""
    return pdu(function, address, quantity) + bytes([len(data) if count is None else count]) + data


def read_write(read_at, read_count, write_at, write_count, data, count=None):
    head = pdu(23, read_at, read_count, write_at, write_count)
    return head + bytes([len(data) if count is None else count]) + data


def every_function(number):
    """0..255, without and with data; the data is refused or harmless for each supported function."""
    for function in range(256):
        name = "all 256" if function not in SUPPORTED else READS.get(function, str(function))
        kind = "not supported" if function < 0x80 else "from 0x80 on"
        yield name, "too short" if function in SUPPORTED else kind, number, bytes([function])
        yield name, "00 00 00 01" if function in SUPPORTED else kind, number, bytes([function, 0, 0, 0, 1])
    yield "all 256", "largest PDU", number, bytes([100]) + bytes(252)
    yield "all 256", "largest PDU", number, bytes([255]) + bytes(252)


def edges(unit):
    """Addresses where what is there changes, and their neighbours."""
    offsets = (-1, 0, 199, 200, 899, 900, 952, 953, 999, 1000)
    of_drives = [base + offset for base in unit.flat or [] for offset in offsets]
    return sorted({*EDGES, *(at for at in of_drives if 0 <= at <= 0xFFFF)})


def reads(number, unit):
    for function, name in READS.items():
        largest = 2000 if function <= 2 else 125
        for quantity in (0, largest + 1, 0x8000, 0xFFFF):
            for address in (0, 1000, NOWHERE, 0xFFFF):
                yield name, "quantity out of range", number, pdu(function, address, quantity)
        for address in edges(unit):
            for quantity in (1, 2, 16, largest):
                yield name, f"quantity {quantity}, at edges", number, pdu(function, address, quantity)
        for quantity, group in [(largest - 1, "up to the last address"), (largest, "up to the last address"),
                                (largest - 2, "beyond the last address")]:
            yield name, group, number, pdu(function, 0x10000 - quantity, min(quantity + 1, largest))
        for size in range(2, 5):
            yield name, "too short", number, pdu(function, 0, 1)[:size]
        for extra in (1, 2, 248):
            yield name, "too long", number, pdu(function, 0, 1) + bytes(extra)
        for address in sorted(unit.bits if function <= 2 else unit.registers):
            words = 1 if function <= 2 else unit.wide.get(address, 1)
            yield name, "each known address", number, pdu(function, address, words)


def unwritable(unit):
    """Registers that nobody may write: unmapped, unused and read-only ones; never 100..103, 20, 1020."""
    unused = next((at for at in range(20, 100) if at != 20 and unit.word(at) == UNUSED), NOWHERE)
    addresses = [0, 1, unused, 199, NOWHERE, 0xFFFF]
    if unit.flat is not None:
        addresses += [base + offset for base in unit.flat for offset in (0, 198, 900, 917, 919, 921, 940, 999)]
    elif not unit.gateway:
        addresses += [1000, 1017, 1019, 1021, 1040, 1099, 1100]
    return [at for at in addresses if at not in unit.writes and at not in unit.commands]


def refused_bit_writes(number, unit):
    bits = [at for at in (0, 1, 5, 199, NOWHERE, 0xFFFF) if at not in unit.bit_writes]
    for address in bits:
        for value in (0x0000, 0xFF00):
            yield "5", "not writable", number, pdu(5, address, value)
        for value in (0x0001, 0x00FF, 0xFF01, 0xFFFF, 0x8000):
            yield "5", "neither 0000 nor FF00", number, pdu(5, address, value)
        yield "15", "not writable", number, write_many(15, address, 1, b"\x00")
    for quantity, size in [(0, 0), (0, 1), (1969, 247), (0x8000, 0), (0xFFFF, 8)]:
        yield "15", "quantity out of range", number, write_many(15, NOWHERE, quantity, bytes(size))
    yield "15", "largest quantity", number, write_many(15, NOWHERE, 1968, bytes(246))
    yield "15", "beyond the last address", number, write_many(15, 0xFFFF, 2, b"\x00")
    yield from lies(15, number, 9, 2)
    yield from misshapen(5, number, pdu(5, NOWHERE, 0xFF00))


def lies(function, number, quantity, size):
    """Byte counts that do not agree with the quantity, or with what follows."""
    name = str(function)
    for count in (0, size - 1, size + 1, 255):
        yield name, "lying byte count", number, write_many(function, NOWHERE, quantity, bytes(size), count)
    for follow in (0, size - 1, size + 1):
        yield name, "byte count right, data not", number, write_many(function, NOWHERE, quantity, bytes(follow), size)
    for wrong in (size - 1, size + 1):
        yield name, "byte count agrees with data only", number, write_many(function, NOWHERE, quantity, bytes(wrong))
    yield from misshapen(function, number, write_many(function, NOWHERE, quantity, bytes(size)))


def misshapen(function, number, request):
    for size in range(1, len(request)):
        yield str(function), "too short", number, request[:size]
    for extra in (1, 2, 64):
        yield str(function), "too long", number, request + bytes(extra)


def refused_word_writes(number, unit):
    for address in unwritable(unit):
        for value in (0, 1, 0xFFFF):
            yield "6", "not writable", number, pdu(6, address, value)
        yield "16", "not writable", number, write_many(16, address, 1, b"\0\0")
        yield "22", "not writable", number, pdu(22, address, 0xFFFF, 0)
        yield "23", "write not writable", number, read_write(0, 1, address, 1, b"\0\0")
    for quantity, size in [(0, 0), (0, 2), (124, 246), (124, 0), (0x8000, 0), (0xFFFF, 2)]:
        request = write_many(16, NOWHERE, quantity, bytes(size))
        yield "16", "quantity out of range", number, request
    yield "16", "largest quantity", number, write_many(16, NOWHERE, 123, bytes(246))
    yield "16", "beyond the last address", number, write_many(16, 0xFFFF, 2, bytes(4))
    yield "16", "beyond the last address", number, write_many(16, 0xFF86, 123, bytes(246))
    yield from lies(16, number, 2, 4)
    yield from misshapen(6, number, pdu(6, NOWHERE, 0))
    yield from misshapen(22, number, pdu(22, NOWHERE, 0, 0))


def refused_read_writes(number):
    name = "23"
    for read_count, write_count in [(0, 1), (126, 1), (0xFFFF, 1), (1, 0), (1, 122), (1, 0xFFFF), (0, 0)]:
        data = bytes(2 * min(write_count, 121))
        yield name, "quantity out of range", number, read_write(0, read_count, NOWHERE, write_count, data)
    yield name, "largest quantities", number, read_write(0, 125, NOWHERE, 121, bytes(242))
    yield name, "read not mapped", number, read_write(NOWHERE, 1, NOWHERE, 1, b"\0\0")
    yield name, "beyond the last address", number, read_write(0xFFFF, 2, NOWHERE, 1, b"\0\0")
    yield name, "beyond the last address", number, read_write(0, 1, 0xFFFF, 2, bytes(4))
    for count in (0, 1, 3, 255):
        yield name, "lying byte count", number, read_write(0, 1, NOWHERE, 1, b"\0\0", count)
    for size in (0, 1, 3):
        yield name, "byte count right, data not", number, read_write(0, 1, NOWHERE, 1, bytes(size), 2)
    yield from misshapen(23, number, read_write(0, 1, NOWHERE, 1, b"\0\0"))


def encapsulated(number):
    """Function 43 as far as no drive is asked; the rest is judge.py."""
    for kind in (0x00, 0x0C, 0x0F, 0x8E, 0xFF):
        yield "43", "another MEI type", number, bytes([43, kind, 1, 0])
    for code in range(1, 5):
        yield "43/14", "basic, regular, extended, individual", number, bytes([43, 14, code, 0])
    for code in (0, 5, 0xFF):
        yield "43/14", "another access code", number, bytes([43, 14, code, 0])
    for body in (b"\x0e", b"\x0e\x01", b"\x0e\x01\x00\x00", b"\x0d", b"\x0d\x00\x00\x01"):
        yield "43", "too short or too long", number, b"\x2b" + body


def allowed_writes(number, unit):
    """What the caller allows, each value in every way, and read back; half of a wide value is refused."""
    for address, choices in sorted(unit.writes.items()):
        last = None
        for words in choices:
            data, size = struct.pack(f">{len(words)}H", *words), len(words)
            if size == 1 and last is not None:  # bits of the or-mask count only where the and-mask has a 0
                kept = last ^ words[0] ^ 0xFFFF
                request = pdu(22, address, kept, words[0] ^ kept)
                yield "22", "some bits", number, request
                yield "3, 4", "what was written", number, pdu(3, address, size)
            yield "16", "allowed value", number, write_many(16, address, size, data)
            yield "3, 4", "what was written", number, pdu(3, address, size)
            if size == 1:
                last = words[0]
                yield "6", "allowed value", number, pdu(6, address, words[0])
                yield "22", "no bit", number, pdu(22, address, 0xFFFF, 0xFFFF)
                yield "22", "all bits", number, pdu(22, address, 0, words[0])
                yield "3, 4", "what was written", number, pdu(3, address, size)
            for half in range(address, address + size) if size > 1 else ():
                yield "6", "half of a wide value", number, pdu(6, half, words[half - address])
                yield "16", "half of a wide value", number, write_many(16, half, 1, b"\0\0")
                yield "22", "half of a wide value", number, pdu(22, half, 0xFFFF, 0)
            yield "23", "allowed value", number, read_write(address, size, address, size, data)
            yield "3, 4", "what was written", number, pdu(4, address, size)
        yield from refused_values(number, unit, address)
    for address, choices in sorted(unit.bit_writes.items()):
        for value in choices:
            yield "5", "allowed value", number, pdu(5, address, 0xFF00 if value else 0)
            yield "15", "allowed value", number, write_many(15, address, 1, bytes([value]))
            yield "1, 2", "what was written", number, pdu(1, address, 1)
    yield from command_block(number, unit)


def refused_values(number, unit, address):
    """Values that a writable address does not take, of which the caller knows the answer, and what it holds then."""
    for words, _ in unit.refused.get(address, []):
        data, size = struct.pack(f">{len(words)}H", *words), len(words)
        if size == 1:
            yield "6", "refused value", number, pdu(6, address, words[0])
        yield "16", "refused value", number, write_many(16, address, size, data)
        yield "23", "refused value", number, read_write(address, size, address, size, data)
        yield "3, 4", "what was written", number, pdu(3, address, size)


def command_block(number, unit):
    """100..103 in one request: an unused one among them takes 0 beside 100, nothing else, and not alone."""
    unused = next((at for at in (101, 102, 103) if unit.word(at) == UNUSED), None)
    if unused is None or 100 not in unit.writes or any(at not in unit.writes for at in range(101, unused)):
        return
    words = [unit.writes[at][-1][0] for at in range(100, unused)]
    for last, group in [(0, "0 to an unused command register, beside 100"), (1, "1 to it")]:
        data = struct.pack(f">{len(words) + 1}H", *words, last)
        yield "16", group, number, write_many(16, 100, len(words) + 1, data)
        yield "23", group, number, read_write(100, len(words) + 1, 100, len(words) + 1, data)
    yield "16", "0 to it without 100", number, write_many(16, unused, 1, b"\0\0")
    yield "6", "0 to it without 100", number, pdu(6, unused, 0)


def all_requests(units):
    for number in range(256):
        known = "of a unit" if number in units else "of no unit"
        yield "3, 4", known, number, pdu(3, 0, 1)
        yield "16", known, number, pdu(16, NOWHERE, 1) + b"\x02\0\0"
    strangers = [number for number in (1, 100, 200, 247, 248, 254) if number not in units][-1:]
    for number in units:
        yield from every_function(number)
    for number in strangers:
        yield from ((section, "of no unit", number, request) for section, _, number, request in every_function(number))
    for number, unit in units.items():
        yield from reads(number, unit)
        yield from refused_bit_writes(number, unit)
        yield from refused_word_writes(number, unit)
        yield from refused_read_writes(number)
        yield from encapsulated(number)
    for number, unit in units.items():
        yield from allowed_writes(number, unit)
