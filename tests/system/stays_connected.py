#!/usr/bin/env python3
"""stays_connected.py HOST PORT UNIT ADDRESS: one Modbus TCP connection that asks for a register ten times a second, until
SIGTERM. A line for each answer: the number, or `exception N`. Ends with 1 where the connection does.
"""
import socket
import struct
import sys
import time


def receive(connection, size):
    data = b""
    while len(data) < size:
        piece = connection.recv(size - len(data))
        if not piece:
            sys.exit("the connection was closed")
        data += piece
    return data


def main():
    host, port, unit, address = sys.argv[1], *map(int, sys.argv[2:5])
    connection = socket.create_connection((host, port), timeout=5)
    number = 0
    while True:
        number = number % 65535 + 1
        connection.sendall(struct.pack(">HHHBBHH", number, 0, 6, unit, 3, address, 1))
        head = receive(connection, 8)
        transaction, _, length, _, function = struct.unpack(">HHHBB", head)
        rest = receive(connection, length - 2)
        if transaction != number:
            sys.exit("an answer to another question")
        print(f"exception {rest[0]}" if function & 0x80 else struct.unpack(">H", rest[1:3])[0], flush=True)
        time.sleep(0.1)


main()
