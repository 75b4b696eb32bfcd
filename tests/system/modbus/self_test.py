"""The checks of the client, the judge and the conformance run themselves; no server is needed."""
import contextlib
import io
import json
import struct
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

from modbus import judge, protocol
from modbus.expected import Masked, Unit, expected, remember_write
from modbus.known import load
from modbus.model import LARGE, Model, Server
from modbus.requests import all_requests
from modbus.table import Table, run_frames, run_requests

MAP = """{"units": {"0": {"gateway": true, "registers": {"1": 1}},
  "5": {"registers": {"0": 1591, "2": null, "100": null, "101": null, "200": 1}, "wide": {"200": 2},
        "commands": [100, 101], "bits": {"0": 1, "1": 0, "2": null}, "writes": {"101": [[500], [4660]]}},
  "100": {"flat": {"3000": 5, "4000": 6}, "registers": {"3000": null, "4002": null}, "bits": {"3001": null}}}}"""


def hexed(text):
    return bytes.fromhex(text)


def example_unit():
    """A unit that holds what the examples of V1.1b3, section 6, read and write."""
    coils = {at: int(bit) for at, bit in enumerate(f"{0x056BCD:019b}"[::-1], 0x13)}
    inputs = {at: int(bit) for at, bit in enumerate(f"{0x35DBAC:022b}"[::-1], 0xC4)}
    registers = {0x6B: 0x022B, 0x6C: 0, 0x6D: 0x64, 8: 10, 3: 0x00FE, 4: 0x0ACD, 5: 1, 6: 3, 7: 13, 1: 1, 2: 2}
    registers.update({at: 0 for at in range(0x0E, 0x11)})
    written = {at: [[0]] for at in (1, 2, 4, 0x0E, 0x0F, 0x10)}
    return Unit(registers=registers, bits={**coils, **inputs, 0xAC: 0}, writes=written,
                bit_writes={at: [0, 1] for at in (*range(0x13, 0x1D), 0xAC)})


class Examples(unittest.TestCase):
    """The examples of MODBUS Application Protocol V1.1b3."""

    def answer(self, request):
        rule = expected({1: example_unit()}, 1, hexed(request))[0][1]
        return rule.value.hex(" ") if isinstance(rule, Masked) else rule.hex(" ")

    def test_bits(self):
        self.assertEqual(self.answer("01 00 13 00 13"), "01 03 cd 6b 05")
        self.assertEqual(self.answer("02 00 c4 00 16"), "02 03 ac db 35")
        self.assertEqual(self.answer("05 00 ac ff 00"), "05 00 ac ff 00")
        self.assertEqual(self.answer("0f 00 13 00 0a 02 cd 01"), "0f 00 13 00 0a")

    def test_registers(self):
        self.assertEqual(self.answer("03 00 6b 00 03"), "03 06 02 2b 00 00 00 64")
        self.assertEqual(self.answer("04 00 08 00 01"), "04 02 00 0a")
        self.assertEqual(self.answer("06 00 01 00 03"), "06 00 01 00 03")
        self.assertEqual(self.answer("10 00 01 00 02 04 00 0a 01 02"), "10 00 01 00 02")
        self.assertEqual(self.answer("16 00 04 00 f2 00 25"), "16 00 04 00 f2 00 25")

    def test_read_write(self):
        # The example reads 3..8, of which 8 holds 0x00FF there; here it is read up to what is held.
        self.assertEqual(self.answer("17 00 03 00 05 00 0e 00 03 06 00 ff 00 ff 00 ff"),
                         "17 0a 00 fe 0a cd 00 01 00 03 00 0d")
        self.assertEqual(self.answer("17 00 0e 00 01 00 0e 00 01 02 12 34"), "17 02 12 34")

    def test_mask_write(self):
        unit = Unit(registers={4: 0x12}, writes={4: [[0x17]]})
        remember_write(unit, hexed("16 00 04 00 f2 00 25"))
        self.assertEqual(unit.registers[4], 0x17)

    def test_exceptions(self):
        self.assertEqual(self.answer("01 04 a1 00 01"), "81 02")
        self.assertEqual(self.answer("03 00 00 00 7e"), "83 03")
        self.assertEqual(self.answer("07"), "87 01")
        self.assertEqual(self.answer("85 00"), "85 01")
        self.assertEqual(expected({}, 9, hexed("03 00 00 00 01"))[0][1], hexed("83 0a"))


class Known(unittest.TestCase):
    def test_map(self):
        signals = [{"access": access, "modbus": place and {"kind": place[0], "address": place[1], "count": place[2]}}
                   for access, place in [("read", ("register", 2, 1)), ("write", ("register", 100, 1)), ("read", None),
                                         ("readwrite", ("register", 200, 2)), ("read", ("bit", 0, 1))]]
        tree = {"buses": [{}], "drives": [{"modbus_unit": 5, "signals": signals}]}
        units = load(json.dumps(tree), '{"units": {"5": {"registers": {"2": 7}}}}')
        self.assertEqual(sorted(units), [0, 5, 255])
        self.assertEqual(units[5].registers, {2: 7, 100: None, 200: None, 201: None})
        self.assertEqual((units[5].commands, units[5].wide, units[5].bits), ({100}, {200: 2}, {0: None}))


    def test_flat(self):
        place = {"kind": "register", "address": 2, "count": 1}
        tree = {"buses": [{}], "flat_unit": 9, "drives": [
            {"modbus_unit": 5, "flat": 3000, "signals": [{"access": "read", "modbus": {**place, "flat": 3002}}]},
            {"modbus_unit": 6, "flat": 4000, "signals": [{"access": "read", "modbus": {**place, "flat": 4002}}]}]}
        units = load(json.dumps(tree), '{"units": {"6": {"offline": true}}}')

        def answer(address, quantity):
            rule = expected(units, 9, struct.pack(">BHH", 3, address, quantity))[0][1]
            return rule.show(rule.value) if isinstance(rule, Masked) else rule.hex(" ")
        self.assertEqual(answer(3001, 2), "03 04 00 00 .. ..")
        self.assertEqual(answer(3199, 1), "03 02 00 00")
        self.assertEqual(answer(3200, 1), "83 02")
        self.assertEqual(answer(3900, 1), "03 02 .. ..")  # diagnostics, 1000
        self.assertEqual(answer(3918, 1), "03 02 00 00")
        self.assertEqual(answer(2999, 1), "83 02")
        self.assertEqual(answer(3998, 3), "03 06 00 00 00 00 00 00")  # goes on at the next drive
        self.assertEqual(answer(3998, 5), "83 0b")
        self.assertEqual(answer(4900, 1), "03 02 .. ..")
        self.assertEqual(answer(5000, 1), "83 02")


class Identification(unittest.TestCase):
    BASIC = hexed("2b 0e 01 83 00 00 03 00 16") + b"Company identification" + \
        hexed("01 0f") + b"Product code XX" + hexed("02 05") + b"V2.11"

    def test_example(self):
        answer = protocol.parse_identification(1, self.BASIC)
        self.assertEqual(answer.objects, [(0, b"Company identification"), (1, b"Product code XX"), (2, b"V2.11")])
        self.assertEqual(protocol.identification_request(1), hexed("2b 0e 01 00"))

    def test_refused(self):
        wrong = {"short": self.BASIC[:-1], "long": self.BASIC + b"!", "head": self.BASIC[:6],
                 "code": self.BASIC.replace(b"\x0e\x01", b"\x0e\x02", 1), "exception": hexed("ab 02"),
                 "more": self.BASIC[:4] + b"\x01" + self.BASIC[5:], "next": self.BASIC[:5] + b"\x03" + self.BASIC[6:],
                 "conformity": self.BASIC[:3] + b"\x82" + self.BASIC[4:], "ascii": self.BASIC[:-1] + b"\xb5",
                 "empty": hexed("2b 0e 01 83 00 00 01 00 00"), "none": hexed("2b 0e 01 83 00 00 00"),
                 "count": self.BASIC[:6] + b"\x02" + self.BASIC[7:], "level": hexed("2b 0e 01 83 00 00 01 03 01 41")}
        for name, pdu in wrong.items():
            with self.subTest(name), self.assertRaises(protocol.Disagreement):
                protocol.parse_identification(1, pdu)


class Reference(unittest.TestCase):
    def test_request(self):
        self.assertEqual(protocol.object_request(5, 0x6042, 0, 0, 2), hexed("2b 0d 00 00 05 60 42 00 00 00 00 02"))
        self.assertEqual(protocol.object_request(5, 0x6042, 0, data=hexed("c8 00")),
                         hexed("2b 0d 01 00 05 60 42 00 00 00 00 02 c8 00"))

    def test_answers(self):
        request = protocol.object_request(5, 0x6042, 0)
        answer = hexed("2b 0d 00 00 05 60 42 00 00 00 00 02 c8 00")
        self.assertEqual(protocol.parse_read(request, answer), hexed("c8 00"))
        self.assertEqual(protocol.parse_abort(hexed("ab ff 00 06 0d ec 06 02 00 00")), 0x06020000)
        for wrong in ("2b 0d 00 00 05 60 42 00 00 00 00 02 c8", "2b 0d 00 00 05 60 42 01 00 00 00 01 c8", "2b 0d",
                      "ab 03", "ab ff 00 06 0d ec 06 02 00 00", "ab ff 00 05 0d ec 06 02 00 00", "ab ff 00"):
            with self.subTest(wrong), self.assertRaises(protocol.Disagreement):
                protocol.parse_read(request, hexed(wrong))
        with self.assertRaises(protocol.Disagreement):
            protocol.parse_read(protocol.object_request(5, 0x6042, 0, 0, 1), answer)


class Runs(unittest.TestCase):
    """The judge and the whole run against a right model, and against one for each rule that can be broken."""

    def judged(self, fault):
        options = SimpleNamespace(unit=5, node=5, conformity=0x83, known=(0x1018, 1, hexed("01020304")),
                                  large=(0x1008, 0), writable=(0x2000, 0, hexed("1234")), absent=(0x3000, 0),
                                  read_only=(0x1018, 1), wrong_node=6, offline_node=None, raw=True, offline=False)
        server = Server(Model(load(MAP), fault))
        connection = protocol.Connection(*server.peer)
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(protocol.read_object(connection, 5, 5, 0x1008, 0), LARGE)
                return judge.judge(connection, options)
        except (protocol.Disagreement, AssertionError):
            return False
        finally:
            connection.close()
            server.close()

    def test_judge(self):
        self.assertTrue(self.judged(""))
        for fault in ("access code", "individual", "restart", "more follows", "conformity", "control bits", "reserved",
                      "count", "abort order", "write lost", "write echo", "start ignored"):
            with self.subTest(fault):
                self.assertFalse(self.judged(fault))

    def table(self, fault, *parts):
        """What these parts of the run find at a model with this fault."""
        units = load(MAP)
        server = Server(Model(load(MAP), fault))  # of its own: what was written is remembered on each side
        options = SimpleNamespace(quiet=0.02, patience=0.15, half_request_deadline=0.4)
        table = Table(False)
        if "requests" in parts:
            run_requests(server.peer, units, table, options.patience)
        if "frames" in parts:
            run_frames(server.peer, units, options, table)
        server.close()
        return table

    def test_conformance(self):
        runs = [("", "requests", "frames"),
                *((fault, "requests") for fault in ("one bit", "high functions", "stranger", "write forgotten")),
                *((fault, "frames") for fault in ("protocol id", "no reassembly", "transaction id", "pipelining",
                                                  "half request"))]
        # They wait most of the time, so all at once.
        with contextlib.redirect_stdout(io.StringIO()) as printed, ThreadPoolExecutor(len(runs)) as pool:
            tables = list(pool.map(lambda run: self.table(*run), runs))
        right, *wrong = tables
        self.assertEqual(right.failed, 0, printed.getvalue())
        self.assertGreater(right.total, 4000)
        self.assertNotIn("wrong", right.markdown())
        for (fault, _), table in zip(runs[1:], wrong):
            with self.subTest(fault):
                self.assertGreater(table.failed, 0)
                self.assertIn("**wrong**", table.markdown())

    def test_writes_only_where_allowed(self):
        """No request of the run is taken as a write outside what the caller allows."""
        units = load(MAP)
        for section, group, number, pdu in all_requests(units):
            answers = expected(units, number, pdu)
            if pdu[0] in (5, 6, 15, 16, 22) and answers[0][0] == "echo":
                address, quantity = struct.unpack(">HH", pdu[1:5])
                last = address + (quantity if pdu[0] in (15, 16) else 1)
                self.assertEqual((number, address, last), (5, 101, 102), f"{section}, {group}")


def run():
    tests = unittest.defaultTestLoader.loadTestsFromModule(sys.modules[__name__])
    return 0 if unittest.TextTestRunner().run(tests).wasSuccessful() else 1
