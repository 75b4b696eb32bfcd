"""The two functions behind Modbus function 43 on the wire: requests and strict parsers of their answers.

Written from the papers alone, by somebody who has not seen the server:
  43/14  read device identification: MODBUS Application Protocol V1.1b3, section 6.21
  43/13  CANopen general reference: CiA 309-2, in the form that docs/MODBUS.md gives
"""
import socket
import struct

STREAMS = {1: "basic", 2: "regular", 3: "extended"}
LAST_ID = {1: 0x02, 2: 0x7F, 3: 0xFF}  # section 6.21, table of the categories
INDIVIDUAL = 4
LARGEST_DATA = 241  # 253 bytes of PDU less the head of 12


class Disagreement(Exception):
    """An answer that the papers do not allow."""


class Connection:
    """One Modbus TCP connection; requests are told apart by a transaction id that counts."""

    def __init__(self, host, port, timeout=5.0):
        self.peer, self.timeout = (host, port), timeout
        self.transaction = 0xFFFD  # wraps early, so that each run sees it
        self.open()

    def open(self):
        self.socket = socket.create_connection(self.peer, self.timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self):
        self.socket.close()

    def reopen(self):
        """After a disagreement: bytes that belong to an old answer must not meet the next request."""
        self.close()
        self.open()

    def receive(self, size):
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            if not part:
                raise Disagreement(f"connection closed after {len(data)} of {size} bytes")
            data += part
        return data

    def receive_frame(self):
        """(transaction id, unit, PDU) of the next frame."""
        transaction, protocol, length = struct.unpack(">HHH", self.receive(6))
        if protocol != 0:
            raise Disagreement(f"protocol id {protocol:#06x} in an answer")
        if not 3 <= length <= 254:
            raise Disagreement(f"MBAP length {length}: a unit and a PDU of 2 to 253 bytes are 3 to 254")
        body = self.receive(length)
        return transaction, body[0], body[1:]

    def exchange(self, unit, pdu):
        self.transaction = (self.transaction + 1) & 0xFFFF
        try:
            self.socket.sendall(struct.pack(">HHHB", self.transaction, 0, len(pdu) + 1, unit) + pdu)
            transaction, answered, answer = self.receive_frame()
        except OSError as error:
            raise Disagreement(f"no answer: {error}") from error
        if (transaction, answered) != (self.transaction, unit):
            raise Disagreement(f"transaction {transaction:#06x} unit {answered} answer "
                               f"{self.transaction:#06x} unit {unit}")
        return answer


def check_exception(pdu):
    """Raises where the answer is an exception of either kind."""
    if pdu[0] != 0xAB:
        return
    if len(pdu) == 2:
        raise Disagreement(f"exception {pdu[1]:#04x}")
    raise Disagreement(f"SDO abort {parse_abort(pdu):#010x}")


def parse_abort(pdu):
    """The code in an answer that carries an SDO abort: AB FF, length 6, MEI type, class EC, code."""
    if len(pdu) != 10 or pdu[:6] != bytes.fromhex("abff00060dec"):
        raise Disagreement(f"{pdu.hex(' ')} is neither a plain exception nor an SDO abort")
    return struct.unpack(">I", pdu[6:])[0]


# ---- 43/14 ----


def identification_request(code, first=0):
    return bytes([0x2B, 0x0E, code, first])


class Identification:
    """One answer: code, conformity, more (bool), next_id and objects as (id, bytes) in order."""

    def __init__(self, pdu):
        if len(pdu) < 7:
            raise Disagreement(f"{len(pdu)} bytes: the head of an identification has 7")
        if pdu[:2] != b"\x2b\x0e":
            raise Disagreement(f"{pdu[:2].hex(' ')} where 2b 0e begins the answer")
        if pdu[4] not in (0x00, 0xFF):
            raise Disagreement(f"more follows {pdu[4]:#04x}: only 00 and FF are defined")
        self.code, self.conformity, self.more, self.next_id = pdu[2], pdu[3], pdu[4] == 0xFF, pdu[5]
        self.objects = []
        at = 7
        for _ in range(pdu[6]):
            if at + 2 > len(pdu) or at + 2 + pdu[at + 1] > len(pdu):
                raise Disagreement(f"object {len(self.objects)} of {pdu[6]} runs over the end of the answer")
            self.objects.append((pdu[at], pdu[at + 2:at + 2 + pdu[at + 1]]))
            at += 2 + pdu[at + 1]
        if at != len(pdu):
            raise Disagreement(f"{len(pdu) - at} bytes behind the last object")
        if not self.more and self.next_id != 0:
            raise Disagreement(f"next object {self.next_id:#04x} though nothing follows")


def parse_identification(code, pdu, conformity=0x83):
    """An answer to a request of this code; every rule that needs nothing but the answer."""
    check_exception(pdu)
    answer = Identification(pdu)
    if answer.code != code:
        raise Disagreement(f"read device id code {answer.code:#04x} answers {code:#04x}")
    if answer.conformity != conformity:
        raise Disagreement(f"conformity {answer.conformity:#04x} where {conformity:#04x} is held")
    if not answer.objects:
        raise Disagreement("an identification without objects")
    ids = [number for number, _ in answer.objects]
    if any(a >= b for a, b in zip(ids, ids[1:])):
        raise Disagreement("object ids do not ascend")
    if code == INDIVIDUAL and (answer.more or len(ids) != 1):
        raise Disagreement("individual access answers one object and more follows 00")
    if code in LAST_ID and ids[-1] > LAST_ID[code]:
        raise Disagreement(f"object {ids[-1]:#04x} does not belong to {STREAMS[code]}")
    if answer.more and answer.next_id <= ids[-1]:
        raise Disagreement(f"next object {answer.next_id:#04x} is not behind {ids[-1]:#04x}")
    for number, value in answer.objects:  # private objects, 0x80 and above, may be binary
        if number < 0x80 and any(byte < 0x20 or byte > 0x7E for byte in value):
            raise Disagreement(f"object {number:#04x} is not ASCII")
        if number <= 2 and not value:
            raise Disagreement(f"mandatory object {number:#04x} is empty")
    return answer


def read_stream(connection, unit, code, conformity=0x83, first=0):
    """All objects of a level as {id: bytes}, and the number of answers that it took."""
    objects, answers, following = {}, 0, first
    while True:
        answer = parse_identification(code, connection.exchange(unit, identification_request(code, following)),
                                      conformity)
        if answers and answer.objects[0][0] != following:
            raise Disagreement(f"{answer.objects[0][0]:#04x} comes where {following:#04x} was announced")
        answers += 1
        objects.update(answer.objects)
        if not answer.more:
            break
        following = answer.next_id
    if first == 0 and not {0, 1, 2} <= objects.keys():
        raise Disagreement("one of the mandatory objects 0, 1, 2 is missing")
    return objects, answers


def read_individual(connection, unit, number, conformity=0x83):
    pdu = connection.exchange(unit, identification_request(INDIVIDUAL, number))
    answer = parse_identification(INDIVIDUAL, pdu, conformity)
    if answer.objects[0][0] != number:
        raise Disagreement(f"object {answer.objects[0][0]:#04x} answers {number:#04x}")
    return answer.objects[0][1]


# ---- 43/13 ----


def object_name(text):
    """INDEX:SUB in hexadecimal digits."""
    index, _, sub = text.partition(":")
    return int(index, 16), int(sub or "0", 16)


def object_value(text):
    """INDEX:SUB=BYTES"""
    name, _, value = text.partition("=")
    return (*object_name(name), bytes.fromhex(value))


def object_request(node, index, sub, start=0, count=None, data=None):
    """Data (little-endian) makes it a write; without a count a read asks for the whole object (0)."""
    if count is None:
        count = len(data or b"")
    write = 0 if data is None else 1
    return struct.pack(">BBBBBHBHH", 0x2B, 0x0D, write, 0, node, index, sub, start, count) + (data or b"")


def parse_read(request, pdu):
    """The data of an answer to a read; head, count and length have to agree."""
    check_exception(pdu)
    if len(pdu) < 12 or pdu[:10] != request[:10]:
        raise Disagreement(f"head {pdu[:10].hex(' ')} does not repeat the request's")
    count, asked = struct.unpack(">H", pdu[10:12])[0], struct.unpack(">H", request[10:12])[0]
    if count != len(pdu) - 12:
        raise Disagreement(f"count {count}, but {len(pdu) - 12} bytes follow")
    if asked and count > asked:
        raise Disagreement(f"{count} bytes where at most {asked} were asked for")
    return pdu[12:]


def parse_write(request, pdu):
    check_exception(pdu)
    if pdu != request[:10] + b"\x00\x00":
        raise Disagreement(f"{pdu.hex(' ')} is not the request's head with count 0")


def read_object(connection, unit, node, index, sub, start=None, count=0):
    """The bytes of an object: one request with a start, else as many as the object needs."""
    if start is not None:
        request = object_request(node, index, sub, start, count)
        return parse_read(request, connection.exchange(unit, request))
    data = b""
    while len(data) <= 0xFFFF:
        request = object_request(node, index, sub, len(data), LARGEST_DATA if data else 0)
        answer = connection.exchange(unit, request)
        if data and len(answer) == 2 and answer[0] == 0xAB and answer[1] in (2, 3):
            return data  # a start right behind the last byte: the papers do not say whether it is refused
        part = parse_read(request, answer)
        data += part
        if len(part) < LARGEST_DATA:
            return data
    raise Disagreement(f"{index:04x}:{sub:02x} has no end: a start has 16 bits")


def write_object(connection, unit, node, index, sub, data):
    request = object_request(node, index, sub, data=data)
    parse_write(request, connection.exchange(unit, request))
