#!/usr/bin/python3
"""slow_readers.py PORT COUNT TARGET: as many clients that ask for TARGET and take nothing of it, from two addresses, each
of which may have half of the connections. Says so, and stays for a minute."""
import socket
import sys
import time

port, count, target = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
clients = []
for i in range(count):
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    client.bind((f"127.0.0.{2 + i % 2}", 0))
    client.connect(("127.0.0.1", port))
    client.sendall(f"GET {target} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    clients.append(client)
print("connected", flush=True)
time.sleep(60)
