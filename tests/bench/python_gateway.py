#!/usr/bin/python3
"""python_gateway.py INTERFACE PORT: what anybody writes in an hour. Each TPDO2 of a Goodrive600 becomes a retained JSON
state at the broker on this machine, QoS 1, like the gateway's own, by python3-can and paho-mqtt as Debian has them."""

import json
import socket
import struct
import sys
from datetime import datetime, timezone

import can
import paho.mqtt.client

TPDO2 = 0x280
NODE_BITS = 0x7F
TPDO2_LAYOUT = struct.Struct("<HHHH")


def decode(message):
    status, frequency, set_frequency, voltage = TPDO2_LAYOUT.unpack(message.data)
    code = status & 0xFF
    return {
        "status_word": status,
        "running": code in (1, 2, 6),
        "reverse": code == 2,
        "fault": code == 4,
        "warning": bool(status & 0x1000),
        "ready": bool(status & 0x0100),
        "remote": status & 0x6000 == 0x4000,
        "output_frequency": frequency / 100,
        "set_frequency": set_frequency / 100,
        "dc_bus_voltage": voltage / 10,
    }


def state(message):
    received = datetime.fromtimestamp(message.timestamp, timezone.utc)
    return {
        "ts": received.strftime("%Y-%m-%dT%H:%M:%S.") + f"{received.microsecond // 1000:03}Z",
        "online": True,
        "nmt": "operational",
        "fresh": True,
        "values": decode(message),
    }


def main():
    interface, port = sys.argv[1], int(sys.argv[2])
    client = paho.mqtt.client.Client(client_id="python-gateway")
    client.connect("127.0.0.1", port)
    client.loop_start()
    only_tpdo2 = [{"can_id": TPDO2, "can_mask": 0x7FF & ~NODE_BITS, "extended": False}]
    with can.Bus(interface="socketcan", channel=interface, can_filters=only_tpdo2) as bus:
        # As large as ours, so that it loses nothing while it is late.
        bus.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
        for message in bus:
            node = message.arbitration_id & NODE_BITS
            payload = json.dumps(state(message), separators=(",", ":"))
            client.publish(f"canopen/python/fan{node}/state", payload, qos=1, retain=True)


if __name__ == "__main__":
    main()
