"""flood.py INTERFACE KIND COUNT PER_SECOND: frames on a SocketCAN interface, evenly, twenty at a time; KIND is

data      frames that mean nothing to anybody (COB-ID 0x7F1)
errors    what a driver tells of a broken wire: stuff, form and bit errors in turn
states    the same, but each hundredth says that the controller is error-passive, or error-active again, in turn

A driver writes error frames, but a raw socket on a vcan may, too. Prints how many were sent.
"""

import socket
import struct
import sys
import time

# linux/can.h, linux/can/error.h
ERROR, CONTROLLER, PROTOCOL, BUS_ERROR, COUNTERS = 0x20000000, 0x4, 0x8, 0x80, 0x200
STUFF, FORM, BIT = 0x4, 0x2, 0x1
TX_PASSIVE, ACTIVE = 0x20, 0x40
FRAME = struct.Struct("=IB3x8s")
AT_ONCE = 20


def frame(kind, number):
    if kind == "data":
        return FRAME.pack(0x7F1, 8, struct.pack("<Q", number))
    if kind == "states" and number % 100 == 99:
        passive = number // 100 % 2 == 0
        bytes_of_it = bytes([0, TX_PASSIVE if passive else ACTIVE, 0, 0, 0, 0, 130 if passive else 90, 0])
        return FRAME.pack(ERROR | CONTROLLER | COUNTERS, 8, bytes_of_it)
    return FRAME.pack(ERROR | PROTOCOL | BUS_ERROR, 8, bytes([0, 0, (STUFF, FORM, BIT)[number % 3], 0, 0, 0, 0, 0]))


def main(interface, kind, count, per_second):
    bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    bus.bind((interface,))
    begun = time.monotonic()
    for number in range(count):
        if number % AT_ONCE == 0:
            time.sleep(max(0.0, begun + number / per_second - time.monotonic()))
        bus.send(frame(kind, number))
    print(count)


main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
