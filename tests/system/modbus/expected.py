"""What a Modbus request must be answered, from MODBUS Application Protocol V1.1b3 and from the gateway's map.

An answer is given as alternatives (what the papers ask, rule): more than one where the papers leave it open.
The order of the checks is that of the state diagrams of V1.1b3: function, quantity and structure (0x03),
address (0x02), then the device (0x0B).
"""
import struct
from dataclasses import dataclass, field, replace

from modbus import protocol as mei
from modbus.judge import aborted
from modbus.protocol import Disagreement

SUPPORTED = {1, 2, 3, 4, 5, 6, 15, 16, 22, 23, 43}
WRITES = {5, 6, 15, 16, 22, 23}
UNUSED, ANY, UNMAPPED, OPEN = "unused", "any", "unmapped", "open"
NMT_COMMAND = 1020
DIAGNOSTICS = {*range(1000, 1018), 1020, *range(1040, 1053)}


@dataclass
class Unit:
    """What the caller knows of a unit. A value None is mapped, but moves."""

    gateway: bool = False
    buses: int = 1
    offline: bool = False
    writer: bool = True  # whether this client may write here at all
    registers: dict = field(default_factory=dict)  # address: word or None
    wide: dict = field(default_factory=dict)  # first address: words that belong together
    commands: set = field(default_factory=set)  # their reads never fail
    bits: dict = field(default_factory=dict)  # address: 0, 1 or None
    writes: dict = field(default_factory=dict)  # address: lists of words that may be written
    bit_writes: dict = field(default_factory=dict)  # address: list of 0 and 1
    refused: dict = field(default_factory=dict)  # address: lists of (words, exception) that it does not take
    objects: dict = field(default_factory=dict)  # what judge.py may know of them, by the names of its options
    flat: dict = None  # of the flat unit: base: the unit of that drive
    absent: set = field(default_factory=set)  # of the flat unit: bases of drives that are offline

    def base(self, address):
        """Of the flat unit: the base of the drive that is shown there, or None."""
        return next((base for base in self.flat if base <= address < base + 1000), None)

    def own(self, address):
        """What this is on a drive's own unit; None: the flat unit shows nothing there."""
        if self.flat is None:
            return address
        base = self.base(address)
        if base is None:
            return None
        return address - base if address < base + 900 else address - base + 100

    def away(self, address):
        """Whether the drive that this address belongs to is offline."""
        return self.offline or (self.flat is not None and self.base(address) in self.absent)

    def word(self, address):
        """A word, or one of ANY, UNUSED (reads 0), OPEN (0 or refused), UNMAPPED."""
        if address in self.registers:
            value = self.registers[address]
            return ANY if value is None else value
        address = self.own(address)
        if address is None:
            return UNMAPPED
        if self.gateway:
            block = range(100, 100 + 20 * self.buses)
            if address <= 7 or address == 20 or address in block:
                return ANY
            if 1000 <= address < 1100:  # the papers speak of 0..199 and 1000..1099 without naming the unit
                return OPEN
        elif address in DIAGNOSTICS:
            return ANY
        elif 1000 <= address < 1100:
            return UNUSED
        return UNUSED if address < 200 else UNMAPPED

    def bit(self, address):
        if address in self.bits:
            value = self.bits[address]
            return ANY if value is None else value
        own = self.own(address)
        return UNUSED if own is not None and own < 200 else UNMAPPED

    def live(self, address):
        """Whether a read needs the drive: its signals, not commands, unused registers or diagnostics."""
        own = self.own(address)
        return own is not None and address in self.registers and own < 1000 and address not in self.commands

    def halves(self, address, quantity):
        """Whether the range cuts a wide value."""
        end = address + quantity
        return any(first < address < first + words or first < end < first + words
                   for first, words in self.wide.items())


class Masked:
    """A rule: the answer equals these bytes where the mask has a 1."""

    def __init__(self, value, mask):
        self.value, self.mask = value, mask

    def __call__(self, pdu):
        wrong = len(pdu) != len(self.value)
        if wrong or any((a ^ b) & m for a, b, m in zip(pdu, self.value, self.mask)):
            raise Disagreement(f"{self.show(self.value)} is asked")

    def show(self, pdu):
        """The bytes in hex, those that move as dots: two runs print the same."""
        return " ".join(f"{byte:02x}" if mask else ".." for byte, mask in zip(pdu, self.mask))


def exception(function, *codes):
    return [(f"exception {code:#04x}", bytes([function | 0x80, code])) for code in codes]


def words_of(pdu, at, count):
    return struct.unpack(f">{count}H", pdu[at:at + 2 * count])


def read_words(unit, function, address, quantity):
    if not 1 <= quantity <= 125:
        return exception(function, 0x03)
    if address + quantity > 0x10000:
        return exception(function, 0x02)
    words = [unit.word(number) for number in range(address, address + quantity)]
    if UNMAPPED in words:
        return exception(function, 0x02)
    if any(unit.live(number) and unit.away(number) for number in range(address, address + quantity)):
        return exception(function, 0x0B)
    value = b"".join(struct.pack(">H", word if isinstance(word, int) else 0) for word in words)
    mask = b"".join(b"\x00\x00" if word == ANY else b"\xff\xff" for word in words)
    head = bytes([function, 2 * quantity])
    answer = [("the words", Masked(head + value, b"\xff\xff" + mask))]
    # Open: half of a wide value is refused to a writer; nothing is said of a reader.
    return answer + (exception(function, 0x02) if OPEN in words or unit.halves(address, quantity) else [])


def read_bits(unit, function, address, quantity):
    if not 1 <= quantity <= 2000:
        return exception(function, 0x03)
    if address + quantity > 0x10000:
        return exception(function, 0x02)
    bits = [unit.bit(number) for number in range(address, address + quantity)]
    if UNMAPPED in bits:
        return exception(function, 0x02)
    if any(number in unit.bits and unit.away(number) for number in range(address, address + quantity)):
        return exception(function, 0x0B)
    value, mask = bytearray((quantity + 7) // 8), bytearray(b"\xff" * ((quantity + 7) // 8))
    for number, bit in enumerate(bits):
        if bit == ANY:
            mask[number // 8] &= ~(1 << number % 8)
        elif bit == 1:
            value[number // 8] |= 1 << number % 8
    head = bytes([function, len(value)])
    answer = [("the bits", Masked(head + bytes(value), b"\xff\xff" + bytes(mask)))]
    return answer + (exception(function, 0x02) if OPEN in bits else [])


def takes_ignored_zero(unit, first, at):
    """Whether this is an unused one of 101..103 of a request that begins at `first` and also writes 100."""
    own = unit.own(at)
    return own in (101, 102, 103) and unit.word(at) == UNUSED and first <= at - (own - 100)


def writable(unit, address, words):
    """Whether these words may be written: whole allowed values, and 0 to unused 101..103 beside 100."""
    at, end = address, address + len(words)
    if not words or unit.halves(address, len(words)):
        return False
    while at < end:
        if at in unit.writes:
            at += unit.wide.get(at, 1)
        elif takes_ignored_zero(unit, address, at) and words[at - address] == 0:
            at += 1
        else:
            return False
    return True


def write_words(unit, function, address, words, echo):
    """Whole values at allowed addresses are echoed; everything else is no writable address."""
    if address + len(words) > 0x10000 or not writable(unit, address, words):
        return exception(function, 0x02)
    if unit.away(address):
        # Open for function 22: which is told where the drive is not there and its bits are not known.
        return exception(function, 0x0B, *([0x03] if function == 22 and words[0] else []))
    if function == 22 and words[0] and unit.own(address) == NMT_COMMAND:
        return exception(22, 0x03)  # a command that was given once holds no bits to keep
    refused = [code for value, code in unit.refused.get(address, []) if tuple(value) == tuple(words)]
    return exception(function, *refused) if refused else [("echo", echo)]


def write_bits(unit, function, address, quantity, echo):
    allowed = all(number in unit.bit_writes for number in range(address, address + quantity))
    if address + quantity > 0x10000 or not allowed:
        return exception(function, 0x02)
    return exception(function, 0x0B) if unit.away(address) else [("echo", echo)]


def write_and_read(unit, pdu):
    """Function 23: the write comes first; the answer is that of the read."""
    if len(pdu) < 10:
        return exception(23, 0x03)
    read_at, read_count, write_at, write_count = words_of(pdu, 1, 4)
    sized = pdu[9] == 2 * write_count and len(pdu) == 10 + pdu[9]
    if not (1 <= read_count <= 125 and 1 <= write_count <= 121 and sized):
        return exception(23, 0x03)
    words = dict(enumerate(words_of(pdu, 10, write_count), write_at))
    written = write_words(unit, 23, write_at, tuple(words.values()), pdu)
    overlaid = {at: words.get(at, word) for at, word in unit.registers.items()}
    after = replace(unit, registers=overlaid)
    answer = read_words(after, 23, read_at, read_count)
    # Open: which one is told where the address is wrong and the drive is not there.
    refusals = {part[0][1]: part[0] for part in (written, answer) if part[0][0].startswith("exception")}
    return list(refusals.values()) or answer


def remember_write(unit, pdu):
    """After a write that was accepted: what its registers and bits read from now on."""
    function = pdu[0]
    address = words_of(pdu, 5 if function == 23 else 1, 1)[0]
    if function == 5:
        unit.bits[address] = int(pdu[3] == 0xFF)
    elif function == 15:
        for number in range(words_of(pdu, 3, 1)[0]):
            unit.bits[address + number] = pdu[6 + number // 8] >> number % 8 & 1
    else:
        first = {6: 3, 22: 3, 16: 6, 23: 10}[function]
        words = words_of(pdu, first, (len(pdu) - first) // 2)
        if function == 22:  # section 6.16: (current AND and-mask) OR (or-mask AND NOT and-mask)
            current, (kept, new) = unit.registers[address], words
            words = [None if current is None and kept else (current or 0) & kept | new & ~kept]
        for number, word in enumerate(words, address):
            if number in unit.registers:
                unit.registers[number] = word


def write_answer(unit, pdu):
    function, size = pdu[0], len(pdu)
    fixed = {5: 5, 6: 5, 22: 7}.get(function)
    if function == 23:
        return write_and_read(unit, pdu)
    if fixed is not None:
        if size != fixed or (function == 5 and pdu[3:] not in (b"\x00\x00", b"\xff\x00")):
            return exception(function, 0x03)
        address = words_of(pdu, 1, 1)[0]
        if function == 5:
            return write_bits(unit, function, address, 1, pdu)
        return write_words(unit, function, address, words_of(pdu, 3, 1), pdu)
    if size < 6:
        return exception(function, 0x03)
    address, quantity = words_of(pdu, 1, 2)
    limit, expected = (1968, (quantity + 7) // 8) if function == 15 else (123, 2 * quantity)
    if not (1 <= quantity <= limit and pdu[5] == expected and size == 6 + pdu[5]):
        return exception(function, 0x03)
    if function == 15:
        return write_bits(unit, function, address, quantity, pdu[:5])
    return write_words(unit, function, address, words_of(pdu, 6, quantity), pdu[:5])


def encapsulated(unit, pdu):
    """Function 43 as far as no object of a drive is needed; the rest is judge.py."""
    if len(pdu) == 1:
        return exception(43, 0x01, 0x03)
    if pdu[1] == 0x0D and len(pdu) < 12:
        return exception(43, 0x03)
    if pdu[1] == 0x0E:
        if len(pdu) != 4 or not 1 <= pdu[2] <= 4:
            return exception(43, 0x03)
        if pdu[2] == 4 and pdu[3] > 2:
            return [("one object", lambda answer: mei.parse_identification(4, answer)), *exception(43, 0x02)]
        return [("an identification", lambda answer: mei.parse_identification(pdu[2], answer))]
    if pdu[1] == 0x0D:
        return [("a value", lambda answer: mei.parse_read(pdu, answer)), *exception(43, 0x02, 0x03, 0x0A, 0x0B),
                aborted(0x06020000)]
    return exception(43, 0x01)


def known_unit_answer(unit, pdu):
    function = pdu[0]
    if function not in SUPPORTED:
        return exception(function, 0x01)
    if function == 43:
        return encapsulated(unit, pdu)
    if function in WRITES:
        return write_answer(unit, pdu)
    if len(pdu) != 5:
        return exception(function, 0x03)
    read = read_bits if function in (1, 2) else read_words
    return read(unit, function, *words_of(pdu, 1, 2))


def expected(units, number, pdu):
    """The alternatives for a request to this unit; a unit that nobody has answers 0x0A."""
    function = pdu[0]
    if number in units:
        answer = known_unit_answer(units[number], pdu)
        # Open: whether the writer or the request is judged first.
        forbidden = function in WRITES and not units[number].writer
        return exception(function, 0x01) + answer if forbidden else answer
    wrong = [pair for pair in known_unit_answer(Unit(), pdu) if pair[1] in (bytes([function | 0x80, 1]),
                                                                           bytes([function | 0x80, 3]))]
    # Open: a wrong request to a unit that nobody has is wrong twice.
    return exception(function, 0x0A) + wrong
