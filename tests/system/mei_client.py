#!/usr/bin/env python3
"""A client of the two functions behind Modbus function 43 and a judge of a server's answers.

43/14 reads the device identification, 43/13 reads and writes objects of the CANopen devices. Prints one line
a fact; leaves with 0 where everything agrees with the papers, else with 1.
"""
import argparse
import sys

sys.dont_write_bytecode = True  # the source tree stays as it is

from modbus import judge, self_test
from modbus.protocol import (STREAMS, Connection, Disagreement, object_name, object_value, read_individual, read_object,
                             read_stream, write_object)


def print_identification(connection, options):
    everything = {}
    for code, name in STREAMS.items():
        objects, answers = read_stream(connection, options.unit, code, options.conformity)
        print(f"{name}: {len(objects)} objects in {answers} answers")
        everything.update(objects)
    for number, value in sorted(everything.items()):
        if read_individual(connection, options.unit, number, options.conformity) != value:
            raise Disagreement(f"object {number:#04x} differs between stream and individual access")
        print(f"object {number:#04x}: {value.decode('ascii', 'backslashreplace')}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("host", nargs="?")
    parser.add_argument("port", type=int, nargs="?")
    parser.add_argument("unit", type=int, nargs="?")
    parser.add_argument("action", choices=["identification", "read-object", "write-object", "judge"], nargs="?")
    parser.add_argument("rest", nargs="*", help="INDEX:SUB [START COUNT] or INDEX:SUB HEX; all but START, COUNT in hex")
    parser.add_argument("--node", type=int, help="CANopen node; without it the unit's number")
    parser.add_argument("--conformity", type=lambda text: int(text, 0), default=0x83)
    parser.add_argument("--known", type=object_value, help="INDEX:SUB=HEX: reads as these bytes (little-endian)")
    parser.add_argument("--writable", type=object_value, help="INDEX:SUB=HEX: may be written with these bytes")
    parser.add_argument("--read-only", type=object_name, help="INDEX:SUB: the drive refuses a write (06010002)")
    parser.add_argument("--absent", type=object_name, help="INDEX:SUB: the drive has no such object (06020000)")
    parser.add_argument("--no-raw", dest="raw", action="store_false", help="only objects of signals are written (0x01)")
    parser.add_argument("--large", type=object_name, help="INDEX:SUB: readable, more than 241 bytes")
    parser.add_argument("--wrong-node", type=int, help="a node that this unit must not reach")
    parser.add_argument("--offline-node", type=int, help="a configured node of this unit that is not there now (0x0B)")
    parser.add_argument("--offline", action="store_true", help="the unit's own drive is not there now")
    parser.add_argument("--self-test", action="store_true", help="the client's own checks, without a server")
    options = parser.parse_args()
    if options.self_test:
        return options
    if options.action is None:
        parser.error("HOST PORT UNIT and what to do are missing")
    if options.node is None:
        options.node = options.unit
    if len(options.rest) not in {"read-object": (1, 3), "write-object": (2,)}.get(options.action, (0,)):
        parser.error(f"{options.action} does not take {len(options.rest)} arguments")
    return options


def act(connection, options):
    """True where everything agreed."""
    if options.action == "judge":
        return judge.judge(connection, options)
    if options.action == "identification":
        print_identification(connection, options)
        return True
    index, sub = object_name(options.rest[0])
    if options.action == "read-object":
        start, count = (int(options.rest[1]), int(options.rest[2])) if len(options.rest) == 3 else (None, 0)
        data = read_object(connection, options.unit, options.node, index, sub, start, count)
        print(f"{index:04x}:{sub:02x} {len(data)} bytes: {data.hex(' ')}")
    else:
        write_object(connection, options.unit, options.node, index, sub, bytes.fromhex(options.rest[1]))
        print(f"{index:04x}:{sub:02x} written")
    return True


def main():
    options = arguments()
    if options.self_test:
        return self_test.run()
    try:
        connection = Connection(options.host, options.port)
        return 0 if act(connection, options) else 1
    except (Disagreement, OSError) as error:
        print(f"FAIL: {error}")
        return 1


if __name__ == "__main__":
    sys.exit(main())
