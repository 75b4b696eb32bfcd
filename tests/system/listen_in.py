#!/usr/bin/env python3
"""listen_in.py PORT TO FILE: passes TCP connections to 127.0.0.1:PORT on to 127.0.0.1:TO, and writes what both sides say
as text2pcap -D reads it: I what the client says, O the answer. For where no packets can be captured."""
import asyncio
import sys

MOST = 1400  # bytes of a packet


async def pass_on(reader, writer, direction, file):
    try:
        while data := await reader.read(65536):
            for begin in range(0, len(data), MOST):
                file.write(f"{direction}\n000000 {data[begin:begin + MOST].hex(' ')}\n")
            file.flush()
            writer.write(data)
            await writer.drain()
    except ConnectionError:
        pass
    writer.close()


async def main(port, to, name):
    with open(name, "w", encoding="ascii") as file:

        async def serve(reader, writer):
            there = await asyncio.open_connection("127.0.0.1", to)
            await asyncio.gather(pass_on(reader, there[1], "I", file), pass_on(there[0], writer, "O", file))

        async with await asyncio.start_server(serve, "127.0.0.1", port) as server:
            print("listens", flush=True)
            await server.serve_forever()


asyncio.run(main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]))
