#!/usr/bin/env python3
"""idle_mqtt.py GATEWAY: what fail-over and TLS cost while nothing happens, as ratios to one broker without TLS.

Four gateways, each with the four simulated drives of the demo on a virtual bus, stand beside each other for a minute at a
time (SECONDS), ROUNDS (5) times, so whatever else the machine does meets all of them:

    one     mqtt://
    two     two brokers, the first in use
    tls     mqtts:// with a client certificate
    second  two brokers with mqtts://, the second in use: the first is looked for each 30 s, and is not there

Of each: CPU time of the process, and of all its threads but the first, where neither the loop nor the simulated drives are;
voluntary context switches; memory. Medians of the rounds; fails where one of them costs more than LIMITS allow.
"""
import os
import pathlib
import socket
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SECONDS = int(os.environ.get("SECONDS_EACH", "60"))
ROUNDS = int(os.environ.get("ROUNDS", "5"))
SETTLED = 30  # seconds until what a start costs is over
FIGURES = ("CPU ms/min", "its threads", "switches/s", "RSS KiB", "anonymous KiB")
# Times what one broker costs. Of the threads that is some ten milliseconds a minute.
LIMITS = {
    "two": (1.25, 2.0, 1.1, 1.05, 1.1),
    "tls": (1.25, 2.0, 1.1, 1.2, 1.2),
    "second": (1.25, 3.0, 1.1, 1.2, 1.2),
}
DRIVES = (ROOT / "config/demo.toml").read_text().split("[[drive]]")[1:]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def test_ca(directory, *words):
    subprocess.run([ROOT / "scripts/test-ca", directory, *words], check=True, stdout=subprocess.DEVNULL)


def write_broker(work, plain, other, tls):
    (work / "mosquitto.conf").write_text(f"""
per_listener_settings true
listener {plain} 127.0.0.1
allow_anonymous true
listener {other} 127.0.0.1
allow_anonymous true
listener {tls} 127.0.0.1
allow_anonymous true
cafile {work}/ca/ca.crt
certfile {work}/ca/localhost.crt
keyfile {work}/ca/localhost.key
require_certificate true
user root
""")


def write_site(work, name, brokers):
    tls = f'ca_file = "{work}/ca/ca.crt"\ncert_file = "{work}/ca/line3.crt"\nkey_file = "{work}/ca/line3.key"\n'
    uses_tls = any(each.startswith("mqtts") for each in brokers)
    site = work / f"{name}.toml"
    site.write_text(f"""
[gateway]
name = "{name}"
[[bus]]
name = "can0"
interface = "virtual"
[mqtt]
brokers = {brokers}
{tls if uses_tls else ""}
[[drive]]""" + "[[drive]]".join(DRIVES))
    return site


def is_online(port, name):
    heard = subprocess.run(["mosquitto_sub", "-h", "127.0.0.1", "-p", str(port), "-W", "2", "-C", "1", "-t",
                            f"canopen/{name}-demo/status"], capture_output=True, text=True, check=False)
    return heard.stdout == "online\n"


def status_of(path):
    return dict(line.split(":", 1) for line in path.read_text().splitlines() if ":" in line)


def switches(pid):
    tasks = pathlib.Path(f"/proc/{pid}/task").iterdir()
    return sum(int(status_of(task / "status")["voluntary_ctxt_switches"]) for task in tasks)


def look(pid):
    """CPU time in seconds, likewise of all threads but the first, context switches; since the start."""
    # The process's CPU clock (clock_getcpuclockid(3)) counts in nanoseconds, and keeps what threads used that ended.
    whole = time.clock_gettime((~pid << 3) | 2)
    first = int(pathlib.Path(f"/proc/{pid}/task/{pid}/schedstat").read_text().split()[0]) / 1e9
    return whole, whole - first, switches(pid)


def memory(pid):
    rollup = status_of(pathlib.Path(f"/proc/{pid}/smaps_rollup"))
    return int(rollup["Rss"].split()[0]), int(rollup["Pss_Anon"].split()[0])


def measure(gateways):
    """One round: the FIGURES of each gateway."""
    begun = time.monotonic()
    before = {name: look(process.pid) for name, process in gateways.items()}
    time.sleep(SECONDS)
    passed = time.monotonic() - begun
    figures = {}
    for name, process in gateways.items():
        whole, threads, count = (after - was for after, was in zip(look(process.pid), before[name]))
        figures[name] = (whole * 60000 / passed, threads * 60000 / passed, count / passed, *memory(process.pid))
    return figures


def tell(rounds):
    """Prints the table; returns what is over its limit."""
    print(" " * 8 + "".join(f"{figure:>15}   ratio" for figure in FIGURES))
    over = []
    for name in rounds[0]:
        line = f"{name:<8}"
        for i, figure in enumerate(FIGURES):
            ratio = statistics.median(each[name][i] / each["one"][i] for each in rounds)
            line += f"{statistics.median(each[name][i] for each in rounds):15.1f}{ratio:8.3f}"
            if name in LIMITS and ratio > LIMITS[name][i]:
                over.append(f"{name}: {figure} {ratio:.2f} times that of one broker, at most {LIMITS[name][i]}")
        print(line)
    print("ratios of CPU time in each round:")
    for name in rounds[0]:
        print(f"{name:<8}", *(f"{each[name][0] / each['one'][0]:.3f}" for each in rounds))
    return over


def main():
    binary = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="idle-mqtt.") as directory:
        work = pathlib.Path(directory)
        test_ca(work / "ca", "server", "localhost")
        test_ca(work / "ca", "client", "line3")
        plain, other, tls, nobody = free_ports(4)
        write_broker(work, plain, other, tls)
        brokers = {
            "one": [f"mqtt://127.0.0.1:{plain}"],
            "two": [f"mqtt://127.0.0.1:{plain}", f"mqtt://127.0.0.1:{other}"],
            "tls": [f"mqtts://localhost:{tls}"],
            "second": [f"mqtts://localhost:{nobody}", f"mqtts://localhost:{tls}"],
        }
        started = [subprocess.Popen(["mosquitto", "-c", work / "mosquitto.conf"], stderr=subprocess.DEVNULL)]
        try:
            gateways = {}
            for name, where in brokers.items():
                command = [binary, "--profile-dir", ROOT / "config/profiles", "--config", write_site(work, name, where),
                           "demo"]
                with open(work / f"{name}.log", "w", encoding="utf-8") as log:
                    gateways[name] = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                                      stderr=log)
                started.append(gateways[name])
            end = time.monotonic() + 60
            while not all(is_online(plain, name) for name in brokers):
                if time.monotonic() > end:
                    for name in brokers:
                        print((work / f"{name}.log").read_text())
                    sys.exit("not all are online within a minute")
            time.sleep(SETTLED)
            over = tell([measure(gateways) for _ in range(ROUNDS)])
        finally:
            for process in reversed(started):
                process.terminate()
                process.wait()
    sys.exit("\n".join(over))


if __name__ == "__main__":
    main()
