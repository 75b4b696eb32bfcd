"""A small server that the judge and the conformance run are tried against: a right one, and wrong ones.

It knows no device. Its answers to plain functions are the first ones that modbus/expected.py allows, so it says
nothing about that file; it shows that a run against a right server finds nothing and against a wrong one something.
Function 43 it answers by code of its own.
"""
import socket
import struct
import threading

from modbus.expected import WRITES, Masked, expected, remember_write

LARGE = bytes(number % 251 for number in range(600))


class Model:
    """Answers PDUs; `fault` names one rule that it breaks."""

    def __init__(self, units, fault=""):
        self.units, self.fault = units, fault
        self.names = {0: b"Maker", 1: b"Code", 2: b"1.0", 4: b"x" * 120, 5: b"y" * 120, 0x80: b"drive", 0x82: b"0042"}
        self.objects = {(5, 0x1018, 1): b"\x01\x02\x03\x04", (5, 0x2000, 0): b"\x00\x00", (5, 0x1008, 0): LARGE}

    def answer(self, number, pdu):
        if pdu[0] == 0x2B and number in self.units and len(pdu) > 1:
            kinds = {0x0E: self.identify, 0x0D: self.refer}
            return kinds[pdu[1]](pdu) if pdu[1] in kinds else b"\xab\x01"
        rule = expected(self.units, number, pdu)[0][1]
        if pdu[0] in WRITES and getattr(rule, "value", rule)[0] == pdu[0] and self.fault != "write forgotten":
            remember_write(self.units[number], pdu)
        if isinstance(rule, Masked):
            if pdu[0] == 3 and pdu[1:] == b"\x00\x00\x00\x01" and self.fault == "one bit":
                return rule.value[:-1] + bytes([rule.value[-1] ^ 1])
            return rule.value
        if pdu[0] >= 0x80 and self.fault == "high functions":
            return bytes([pdu[0] & 0x7F, 1])
        if rule == b"\x83\x0a" and self.fault == "stranger":
            return b"\x83\x0b"
        return rule

    def identify(self, pdu):
        if len(pdu) != 4 or not 1 <= pdu[2] <= 4:
            return b"\xab\x03" if self.fault != "access code" else b"\xab\x02"
        if pdu[2] == 4:
            if pdu[3] not in self.names:
                return b"\xab\x02" if self.fault != "individual" else b"\xab\x03"
            ids = [pdu[3]]
        else:
            level = [number for number in self.names if number <= (0x02, 0x7F, 0xFF)[pdu[2] - 1]]
            known = pdu[3] in level or self.fault == "restart"
            ids = [number for number in level if number >= pdu[3]] if known else level
        body, taken = b"", 0
        for number in ids:
            more = bytes([number, len(self.names[number])]) + self.names[number]
            if 7 + len(body) + len(more) > 253:
                break
            body, taken = body + more, taken + 1
        rest = ids[taken:]
        if self.fault == "more follows":
            rest = []
        conformity = 0x03 if self.fault == "conformity" else 0x83
        return bytes([0x2B, 0x0E, pdu[2], conformity, 0xFF if rest else 0, rest[0] if rest else 0, taken]) + body

    def refer(self, pdu):
        if len(pdu) < 12:
            return b"\xab\x03"
        control, reserved, node, index, sub, start, count = struct.unpack(">BBBHBHH", pdu[2:12])
        data, bits = pdu[12:], 0 if self.fault == "control bits" else 0xFE
        wrong_count = count != len(data) if control & 1 else len(data) != 0
        if control & bits or (reserved and self.fault != "reserved") or (wrong_count and self.fault != "count"):
            return b"\xab\x03"
        if not 1 <= node <= 127 or node != 5:
            return b"\xab\x02"
        held = self.objects.get((node, index, sub))
        if held is None:
            code = 0x06020000
            return b"\xab\xff\x00\x06\x0d\xec" + struct.pack("<I" if self.fault == "abort order" else ">I", code)
        if control & 1:
            if index == 0x1018:
                return b"\xab\xff\x00\x06\x0d\xec\x06\x01\x00\x02"
            self.objects[node, index, sub] = data if self.fault != "write lost" else held
            return pdu[:10] + (b"\0\0" if self.fault != "write echo" else pdu[10:12])
        part = held[start:][:min(count or 241, 241)]
        if self.fault == "start ignored":
            part = held[:min(count or 241, 241)]
        return pdu[:10] + struct.pack(">H", len(part)) + part


class Server:
    """Serves a model on a port of the loopback, a thread for each connection."""

    def __init__(self, model, deadline=0.4):
        self.model, self.deadline = model, deadline
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.peer = self.listener.getsockname()
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def serve(self, connection):
        with connection:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            buffer = b""
            while True:
                connection.settimeout(self.deadline if buffer and self.model.fault != "half request" else None)
                try:
                    part = connection.recv(4096)
                except OSError:
                    return
                if not part:
                    return
                buffer += part
                if self.model.fault == "no reassembly" and len(buffer) < 8:
                    buffer = b""
                try:
                    buffer = self.drain(connection, buffer)
                except (ValueError, OSError):
                    return

    def drain(self, connection, buffer):
        while len(buffer) >= 6:
            transaction, protocol, length = struct.unpack(">HHH", buffer[:6])
            if (protocol and self.model.fault != "protocol id") or not 2 <= length <= 254:
                raise ValueError("header")
            if len(buffer) < 6 + length:
                break
            pdu = self.model.answer(buffer[6], buffer[7:6 + length])
            if self.model.fault == "transaction id" and transaction == 0:
                transaction = 1
            connection.sendall(struct.pack(">HHHB", transaction, 0, len(pdu) + 1, buffer[6]) + pdu)
            buffer = b"" if self.model.fault == "pipelining" else buffer[6 + length:]
        return buffer
