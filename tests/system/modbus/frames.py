"""Whole segments for the conformance run: headers that lie, pieces, and several requests at once.

The questions are such that every answer is known to the byte: a read of quantity 0 is 0x03 anywhere.
MODBUS Messaging on TCP/IP V1.0b, section 4.2, lets a server throw away a frame with a wrong header; whether it
closes the connection with it is its own affair, so most of these rows are open between the two.
"""
import socket
import struct
import threading
import time
from dataclasses import dataclass

QUESTION = bytes([3, 0, 0, 0, 0])
REFUSAL = bytes([0x83, 3])
OPEN, CLOSED = "open", "closed"


@dataclass
class Segments:
    """Bytes to send (a number is a pause in s), and the allowed (text, answer bytes, end states)."""

    section: str
    group: str
    parts: list
    allowed: list
    half_close: bool = False


def frame(transaction, unit, pdu, protocol=0, length=None):
    size = len(pdu) + 1 if length is None else length
    return struct.pack(">HHHB", transaction, protocol, size, unit) + pdu


def header_rows(unit):
    good, answer = frame(7, unit, QUESTION), frame(7, unit, REFUSAL)
    thrown = [("thrown away", b"", (OPEN,)), ("closed", b"", (CLOSED,))]
    for protocol in (1, 0x0100, 0xFFFF):
        bad = frame(6, unit, QUESTION, protocol)
        yield Segments("protocol id", "not 0: never answered", [bad], thrown)
        yield Segments("protocol id", "not 0, a good request behind", [bad + good],
                       [("thrown away", answer, (OPEN,)), ("closed", b"", (CLOSED,))])
    yield Segments("MBAP length", "0", [frame(6, unit, b"", 0, 0)[:6]], thrown)
    yield Segments("MBAP length", "1, no function", [frame(6, unit, b"", 0, 1)], thrown)
    for length in (255, 256, 260, 0x8000, 0xFFFF):
        yield Segments("MBAP length", "more than 254", [frame(6, unit, QUESTION, 0, length)], thrown)
    yield Segments("MBAP length", "more than 254, all there", [frame(6, unit, bytes([100]) + bytes(253))],
                   [("thrown away", b"", (OPEN, CLOSED))])
    yield Segments("MBAP length", "254", [frame(6, unit, bytes([100]) + bytes(252))],
                   [("exception 0x01", frame(6, unit, b"\xe4\x01"), (OPEN,))])
    for short in (2, 3, 5):  # the cut request has an answer; what is left over begins no request
        yield Segments("MBAP length", "shorter than what is sent", [frame(6, unit, QUESTION, 0, short)],
                       [("exception 0x03", frame(6, unit, REFUSAL), (OPEN, CLOSED)), ("closed", b"", (CLOSED,))])


def piece_rows(unit):
    good, answer = frame(0x1234, unit, QUESTION), frame(0x1234, unit, REFUSAL)
    whole = [("exception 0x03", answer, (OPEN,))]
    for size in range(1, len(good)):
        yield Segments("truncated", "then the client ends", [good[:size]], [("closed", b"", (CLOSED,))], True)
        yield Segments("pieces", "two segments", [good[:size], 0.02, good[size:]], whole)
    bytewise = [part for byte in good for part in (bytes([byte]), 0.005)]
    yield Segments("pieces", "byte by byte", bytewise, whole)
    second = frame(0x1235, unit, QUESTION)
    parts = [part for byte in good + second for part in (bytes([byte]), 0.005)]
    yield Segments("pieces", "two requests byte by byte", parts,
                   [("exception 0x03 each", answer + frame(0x1235, unit, REFUSAL), (OPEN,))])
    yield Segments("pieces", "one and a half, then the rest", [good + second[:5], 0.05, second[5:]],
                   [("exception 0x03 each", answer + frame(0x1235, unit, REFUSAL), (OPEN,))])
    yield Segments("pieces", "client ends behind a whole request", [good],
                   [("answered, then closed", answer, (CLOSED,)), ("closed", b"", (CLOSED,))], True)


def pipelined_rows(unit, stranger):
    for transaction in (0, 1, 0x7FFF, 0x8000, 0xFFFF):
        yield Segments("transaction id", "any value comes back", [frame(transaction, unit, QUESTION)],
                       [("exception 0x03", frame(transaction, unit, REFUSAL), (OPEN,))])
    for count in (2, 8, 32):
        asked = b"".join(frame(number, unit, QUESTION) for number in range(count))
        yield Segments("pipelined", f"{count} in one segment", [asked],
                       [("exception 0x03 each", b"".join(frame(n, unit, REFUSAL) for n in range(count)), (OPEN,))])
    twice = frame(9, unit, QUESTION)
    yield Segments("pipelined", "the same transaction id twice", [twice * 2],
                   [("exception 0x03 each", frame(9, unit, REFUSAL) * 2, (OPEN,))])
    mixed = [(unit, QUESTION, REFUSAL), (unit, b"\x64", b"\xe4\x01"), (stranger, QUESTION, b"\x83\x0a"),
             (unit, b"\xff\x00", b"\xff\x01"), (unit, b"\x2b\x0f", b"\xab\x01"), (unit, b"\x03\x00", REFUSAL),
             (unit, b"\x01\x00\x00\x00\x00\x00", b"\x81\x03"), (unit, QUESTION, REFUSAL)]
    asked = b"".join(frame(n, number, pdu) for n, (number, pdu, _) in enumerate(mixed))
    told = [frame(n, number, pdu) for n, (number, _, pdu) in enumerate(mixed)]
    # A stranger is asked for quantity 0: wrong twice, and the papers do not say which is told.
    told_other = told[:2] + [frame(2, stranger, REFUSAL)] + told[3:]
    yield Segments("pipelined", "good and bad ones mixed", [asked],
                   [("each its own exception", b"".join(told), (OPEN,)),
                    ("each its own exception", b"".join(told_other), (OPEN,))])


def all_segments(unit, stranger):
    yield from header_rows(unit)
    yield from piece_rows(unit)
    yield from pipelined_rows(unit, stranger)


def send(connection, segments):
    for part in segments.parts:
        if isinstance(part, bytes):
            connection.sendall(part)
        else:
            time.sleep(part)
    if segments.half_close:
        connection.shutdown(socket.SHUT_WR)


def hear(connection, wanted, quiet, patience):
    """What comes until the peer closes, or until it was quiet for so long (s): (bytes, end state).

    While less than what is wanted has come, patience (s) takes the place of quiet.
    """
    heard = b""
    deadline = time.monotonic() + 5
    while time.monotonic() < deadline:
        connection.settimeout(quiet if len(heard) >= wanted else patience)
        try:
            part = connection.recv(4096)
        except TimeoutError:
            return heard, OPEN
        except ConnectionResetError:
            return heard, CLOSED
        if not part:
            return heard, CLOSED
        heard += part
    return heard, OPEN


def in_order(answer):
    """The frames of an answer sorted: a server may answer pipelined requests in any order (Messaging 4.2.2)."""
    frames, at = [], 0
    while at + 6 <= len(answer):
        size = 6 + struct.unpack(">H", answer[at + 4:at + 6])[0]
        frames.append(answer[at:at + size])
        at += size
    return sorted(frames) + [answer[at:]]


def run_segments(peer, segments, quiet, patience):
    """(answer, end state, text, whether it is allowed) on a connection of its own."""
    # Where silence is the only answer, nothing is waited for but the silence.
    wanted = max(len(answer) for _, answer, _ in segments.allowed)
    with socket.create_connection(peer, 5) as connection:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            send(connection, segments)
        except OSError:
            pass  # closed early: hear() finds it out
        answer, end = hear(connection, wanted, quiet, patience)
    for text, allowed, ends in segments.allowed:
        if in_order(answer) == in_order(allowed) and end in ends:
            return answer, end, f"either, here: {text}" if len(segments.allowed) > 1 else text, True
    asked = " or ".join(f"{text} ({'/'.join(ends)})" for text, _, ends in segments.allowed)
    return answer, end, f"asked: {asked}", False


class HalfRequests:
    """Half requests that nobody completes, from now on: each connection is closed when the deadline (s) is over."""

    def __init__(self, peer, unit, deadline):
        self.deadline = deadline
        good = frame(1, unit, QUESTION)
        self.halves = [good[:1], good[:6], good[:7], good[:-1], frame(1, unit, QUESTION, 0, 7),
                       frame(1, unit, QUESTION, 0, 254)]
        self.ends = {}
        self.watchers = [threading.Thread(target=self.watch, args=(peer, half), daemon=True) for half in self.halves]
        for watcher in self.watchers:
            watcher.start()

    def watch(self, peer, half):
        with socket.create_connection(peer, 5) as connection:
            connection.sendall(half)
            start = time.monotonic()
            connection.settimeout(self.deadline + 2)
            try:
                self.ends[half] = connection.recv(300), time.monotonic() - start
            except OSError as error:
                self.ends[half] = str(error).encode(), 0

    def rows(self):
        """(sent, answer, how it ended, text, whether that is right); waits for the ends."""
        for watcher in self.watchers:
            watcher.join(self.deadline + 10)
        for half in self.halves:
            answer, spent = self.ends.get(half, (b"nothing happened", 0))
            good = answer == b"" and spent >= 0.8 * self.deadline
            end = CLOSED if answer == b"" else OPEN
            yield half, answer, end, f"closed without an answer after {self.deadline:.0f} s", good
