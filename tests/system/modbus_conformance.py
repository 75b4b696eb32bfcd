#!/usr/bin/env python3
"""A conformance run against a Modbus TCP server: every function with every boundary, byte for byte.

What has to be answered comes from MODBUS Application Protocol V1.1b3, MODBUS Messaging on TCP/IP V1.0b and the
gateway's map (docs/MODBUS.md) alone; modbus/expected.py works it out without looking at the server. Prints what
disagrees; leaves with 0 where every answer agrees. What the server holds is told by JSON files, later ones
over earlier ones; a file is either what `canopen-gateway map --format json` prints or

  {"units": {
    "0":   {"gateway": true, "buses": 1, "registers": {"1": 4}},
    "5":   {"registers": {"0": 1591, "2": null}, "wide": {"200": 2}, "commands": [100, 101],
            "bits": {"0": 1}, "writes": {"101": [[500], [0]]}, "bit_writes": {"16": [1, 0]},
            "refused": {"101": [[[5001], 3]]}, "offline": false, "writer": true,
            "objects": {"known": "1000:0=92010100", "writable": "2f00:0=41"}},
    "100": {"flat": {"3000": 5}, "registers": {"3000": null}}}}

`registers` lists every mapped signal, null where the value moves; one left out of 0..199 has to read 0, one left
out of 200..999 has to be refused. Only `writes` and `bit_writes` are ever written; each ends at its last value.
`refused` are words that a writable address does not take, and the exception. `objects` are the options of
mei_client.py, for functions 43/13 and 43/14. Unit 255 is unit 0 unless it is given.
"""
import argparse
import sys

sys.dont_write_bytecode = True  # the source tree stays as it is

from modbus import self_test
from modbus.known import load
from modbus.table import Table, run_frames, run_objects, run_requests


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("host", nargs="?")
    parser.add_argument("port", type=int, nargs="?")
    parser.add_argument("map", nargs="*", help="the JSON files")
    parser.add_argument("--all", action="store_true", help="print every row, not only what disagrees")
    parser.add_argument("--table", help="the Markdown table goes here: a row for each group of requests and answer")
    parser.add_argument("--quiet", type=float, default=0.1, help="s without a byte that count as silence")
    parser.add_argument("--patience", type=float, default=2.0, help="s to wait for an answer that is due")
    parser.add_argument("--half-request-deadline", type=float, default=5.0, help="s")
    parser.add_argument("--self-test", action="store_true", help="the run's own checks, without a server")
    options = parser.parse_args()
    if not options.self_test and not options.map:
        parser.error("HOST PORT MAP are missing")
    return options


def main():
    options = arguments()
    if options.self_test:
        return self_test.run()
    texts = []
    for name in options.map:
        with open(name, encoding="utf-8") as file:
            texts.append(file.read())
    units = load(*texts)
    table = Table(options.all)
    peer = (options.host, options.port)
    run_requests(peer, units, table, options.patience)
    run_objects(peer, units, table, options.patience)
    run_frames(peer, units, options, table)
    table.summary()
    if options.table:
        with open(options.table, "w", encoding="utf-8") as file:
            file.write(table.markdown())
    return 1 if table.failed else 0


if __name__ == "__main__":
    sys.exit(main())
