"""A table of requests of function 43, wrong ones included, and what the papers ask a server to answer.

A row whose papers leave the answer open names each answer that they allow. Any other answer fails the run.
"""
import struct
from dataclasses import dataclass
from types import SimpleNamespace

from modbus import protocol as mei
from modbus.protocol import Disagreement


@dataclass
class Row:
    """A request and the answers allowed: (what the papers ask, exact bytes or a rule that raises)."""

    request: bytes
    allowed: list


# What a caller may tell of the objects, and how it is read: names of objects, values, nodes.
OPTIONS = {"known": mei.object_value, "writable": mei.object_value, "absent": mei.object_name,
           "read_only": mei.object_name, "large": mei.object_name, "wrong_node": int, "offline_node": int, "node": int,
           "raw": bool, "offline": bool}


def options_of(unit, objects):
    """Of a table {name: text or number}."""
    told = {name: OPTIONS[name](value) for name, value in objects.items()}
    return SimpleNamespace(**{**dict.fromkeys(OPTIONS), "node": unit, "raw": True, **told}, unit=unit, conformity=0x83)


def refused(*codes):
    """One alternative for each code: a plain exception."""
    return [(f"exception {code:#04x}", bytes([0xAB, code])) for code in codes]


def aborted(code):
    return (f"SDO abort {code:08x}", b"\xab\xff\x00\x06\x0d\xec" + struct.pack(">I", code))


def head_answer(request, data, why):
    """The answer to a read: the request's head, the count of what follows, the data."""
    return (why, request[:10] + struct.pack(">H", len(data)) + data)


def verdict(row, answer):
    """The text of the alternative that the answer meets, and whether it meets one."""
    problems = []
    for text, rule in row.allowed:
        try:
            if callable(rule):
                rule(answer)
            elif answer != rule:
                raise Disagreement(f"{rule.hex(' ')} is asked")
            return (f"either, here: {text}" if len(row.allowed) > 1 else text), True
        except Disagreement as error:
            problems.append(f"{text}: {error}")
    return "; ".join(problems), False


# ---- 43/14 ----


def ids_within(code, first, conformity, held):
    """A rule: an identification that begins at this object and says what the whole stream said."""
    def rule(pdu):
        answer = mei.parse_identification(code, pdu, conformity)
        if answer.objects[0][0] != first:
            raise Disagreement(f"begins at {answer.objects[0][0]:#04x}, not at {first:#04x}")
        wrong = [f"{number:#04x}" for number, value in answer.objects if held.get(number) != value]
        if wrong:
            raise Disagreement(f"{', '.join(wrong)} differ from the whole stream")
    return rule


def stream_rows(held, conformity):
    """Streams from their first object, from a later one, and from one that nobody knows."""
    unknown = next(number for number in range(0x7F, 0, -1) if number not in held)
    unknown_private = next(number for number in range(0xFF, 0x7F, -1) if number not in held)
    for code, name in mei.STREAMS.items():
        for first, why in [(0, ""), (1, ", from object 1"), (2, ", from object 2")]:
            yield Row(mei.identification_request(code, first),
                      [(f"{name}{why}", ids_within(code, first, conformity, held))])
        for first in (unknown, unknown_private):
            yield Row(mei.identification_request(code, first),
                      [(f"{name}, unknown object: restarts at 0", ids_within(code, 0, conformity, held))])
    above = next((number for number in sorted(held) if number > 2), None)
    if above is not None:
        yield Row(mei.identification_request(1, above),
                  [("basic, object of a higher level: restarts at 0", ids_within(1, 0, conformity, held)),
                   *refused(0x02)])


def individual_rows(held, conformity, offline):
    for number in range(0x100):
        request = mei.identification_request(mei.INDIVIDUAL, number)
        if number in held:
            yield Row(request, [("individual", ids_within(mei.INDIVIDUAL, number, conformity, held))])
        else:  # 0x82 to 0x84 are asked of the drive
            yield Row(request, refused(0x0B if offline and 0x82 <= number <= 0x84 else 0x02))


def wrong_identification_rows():
    for code in (0x00, 0x05, 0x7F, 0x80, 0xFF):
        yield Row(mei.identification_request(code), refused(0x03))
    for request in (b"\x2b\x0e", b"\x2b\x0e\x01", b"\x2b\x0e\x01\x00\x00", b"\x2b\x0e\x04\x00" + bytes(249)):
        yield Row(request, refused(0x03))


def identification_rows(connection, options):
    """(what it is about, rows)"""
    held = mei.read_stream(connection, options.unit, 3, options.conformity)[0]
    yield "a stream", stream_rows(held, options.conformity)
    yield "each of 256 ids alone", individual_rows(held, options.conformity, options.offline)
    yield "another access code, too short, too long", wrong_identification_rows()


# ---- 43/13 ----


def known_rows(node, known):
    """Reads of an object whose value the caller knows; it is no larger than one answer."""
    index, sub, data = known
    size = len(data)

    def read(start, count, expected, *others):
        request = mei.object_request(node, index, sub, start, count)
        return Row(request, [head_answer(request, expected, "the bytes asked for"), *others])
    yield read(0, 0, data)
    yield read(0, size, data)
    yield read(0, 1, data[:1])
    yield read(0, size + 1, data)
    yield read(0, mei.LARGEST_DATA, data)
    yield read(0, mei.LARGEST_DATA + 1, data)
    yield read(0, 0xFFFF, data)
    if size > 1:
        yield read(1, size - 1, data[1:])
        yield read(1, 1, data[1:2])
        yield read(size - 1, 2, data[-1:])
        yield read(1, 0, data[1:], *refused(0x03))  # "whole" from a start: rest, or a contradiction
    for start in (size, size + 1, 0xFFFF):  # the papers do not say what stands behind the end
        yield read(start, 1, b"", *refused(0x02, 0x03))


def malformed_rows(node, index, sub):
    """Refused before any SDO; the object is one whose writing would be refused in any case."""
    read = mei.object_request(node, index, sub)
    write = mei.object_request(node, index, sub, data=b"\x00\x00")
    for size in range(2, len(read)):
        yield Row(read[:size], refused(0x03))
    yield Row(read + b"\x00", refused(0x03))
    yield Row(read + bytes(241), refused(0x03))
    for bit in range(1, 8):
        yield Row(read[:2] + bytes([1 << bit]) + read[3:], refused(0x03))
        yield Row(write[:2] + bytes([1 << bit | 1]) + write[3:], refused(0x03))
    for reserved in (0x01, 0x80, 0xFF):  # "always 0" in CiA 309-2; V1.1b3 section 7 calls the rest 0x03
        yield Row(read[:3] + bytes([reserved]) + read[4:], refused(0x03))
        yield Row(write[:3] + bytes([reserved]) + write[4:], refused(0x03))
    for size in range(2, 12):
        yield Row(write[:size], refused(0x03))
    for count in (1, 3, 0xFFFF):
        yield Row(mei.object_request(node, index, sub, count=count, data=b"\x00\x00"), refused(0x03))


def absent_rows(node, index, sub, raw):
    gone = aborted(0x06020000)
    written = [gone] if raw else refused(0x01)  # only where the drive allows objects that are no signals
    yield Row(mei.object_request(node, index, sub), [gone])
    yield Row(mei.object_request(node, index, sub, 0, 4), [gone])
    yield Row(mei.object_request(node, index, sub, data=b"\x00\x00"), written)
    # Open: a count of 0 before data, no data at all, a write that does not begin at 0.
    yield Row(mei.object_request(node, index, sub, count=0, data=b"\x00\x00"), [*refused(0x03), *written])
    yield Row(mei.object_request(node, index, sub, data=b""), [*refused(0x03), *written])
    yield Row(mei.object_request(node, index, sub, 2, data=b"\x00\x00"), [*refused(0x03), *written])


def writable_rows(node, writable):
    index, sub, data = writable
    write = mei.object_request(node, index, sub, data=data)
    yield Row(write, [("head with count 0", write[:10] + b"\x00\x00")])
    read = mei.object_request(node, index, sub)
    yield Row(read, [head_answer(read, data, "what was written")])


def large_rows(connection, options):
    """An object that needs several answers; every window of it says what the whole says."""
    index, sub = options.large
    whole = mei.read_object(connection, options.unit, options.node, index, sub)
    if len(whole) <= mei.LARGEST_DATA:
        raise Disagreement(f"{index:04x}:{sub:02x} has {len(whole)} bytes; --large means more than 241")
    for start, count in [(0, 0), (0, 241), (0, 242), (0, 0xFFFF), (1, 241), (241, 241), (240, 2),
                         (len(whole) - 1, 1), (len(whole) - 1, 241)]:
        window = whole[start:start + min(count or 241, 241)]
        request = mei.object_request(options.node, index, sub, start, count)
        yield Row(request, [head_answer(request, window, "the bytes asked for")])


def stranger_rows(options):
    # No paper names the code for a node that is not this unit's, or that no node can be.
    strangers = [0, 128, 255] + ([options.wrong_node] if options.wrong_node is not None else [])
    for stranger in strangers:
        yield Row(mei.object_request(stranger, 0x1000, 0), refused(0x02, 0x03, 0x0A, 0x0B))


def object_rows(connection, options):
    """(what it is about, rows)"""
    node = options.node
    if options.known:
        yield "a read", known_rows(node, options.known)
    if options.absent:
        yield "malformed", malformed_rows(node, *options.absent)
        yield "an object that is not there", absent_rows(node, *options.absent, options.raw)
    if options.writable:
        yield "a write, and what it wrote", writable_rows(node, options.writable)
    if options.read_only:
        yield "a write that the drive refuses", [Row(mei.object_request(node, *options.read_only, data=b"\x00"),
                                                     [aborted(0x06010002)])]
    if options.large:
        yield "an object of more than 241 bytes", large_rows(connection, options)
    if options.offline_node is not None:
        yield "a node that is offline", [Row(mei.object_request(options.offline_node, 0x1000, 0), refused(0x0B))]
    yield "a node that is none of this unit's", stranger_rows(options)


def encapsulation_rows():
    yield Row(b"\x2b", refused(0x01, 0x03))  # no MEI type at all: unknown, or too short
    for kind in (0x00, 0x01, 0x0C, 0x0F, 0x7F, 0x8D, 0x8E, 0xFF):
        yield Row(bytes([0x2B, kind]), refused(0x01))
        yield Row(bytes([0x2B, kind, 0x01, 0x00]), refused(0x01))


def all_rows(connection, options):
    """(function, what it is about, row); a row may depend on the answers to those before."""
    for row in encapsulation_rows():
        yield "43", "another MEI type, or none", row
    for group, rows in identification_rows(connection, options):
        yield from (("43/14", group, row) for row in rows)
    for group, rows in object_rows(connection, options):
        yield from (("43/13", group, row) for row in rows)


def ask(connection, unit, row):
    """(answer, text, whether it is allowed); without an answer the next row begins on a new connection."""
    try:
        answer = connection.exchange(unit, row.request)
    except Disagreement as error:
        connection.reopen()
        return b"", f"{row.allowed[0][0]}: {error}", False
    return answer, *verdict(row, answer)


def judge(connection, options):
    """Prints a line for each row; true where no answer disagrees."""
    failed = total = 0
    for _, _, row in all_rows(connection, options):
        answer, text, good = ask(connection, options.unit, row)
        total, failed = total + 1, failed + (not good)
        print(f"{'ok  ' if good else 'FAIL'} {row.request.hex(' ')} -> {answer.hex(' ') or 'nothing'}: {text}")
    print(f"{total} requests, {failed} disagreements")
    return failed == 0
