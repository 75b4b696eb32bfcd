"""The plant that the manual's commands are tried on: the demo, or drives and gateway on a SocketCAN interface."""

import os
import pathlib
import re
import signal
import subprocess
import time

CONFIG = "/etc/canopen-gateway/gateway.toml"
CONTROL = "/run/canopen-gateway/control"


class NotReady(Exception):
    pass


class Plant:
    """All it makes is below `work`; `root` is the source tree, `gateway` the program."""

    trace = None  # candump's lines, where there is a bus to listen to

    def __init__(self, work, root, gateway):
        self.work, self.root, self.gateway = pathlib.Path(work), pathlib.Path(root), gateway
        self.config = self.work / "gateway.toml"
        self.log = self.work / "log"
        self.out = self.work / "out"
        self.running = []
        self.control = self.work / "none"
        (self.work / "bin").mkdir(exist_ok=True)

    def launch(self, arguments, out, err, **more):
        with open(out, "wb") as stdout, open(err, "wb") as stderr:
            process = subprocess.Popen(arguments, stdout=stdout, stderr=stderr, **more)
        self.running.append(process)
        return process

    def program(self, *arguments):
        config = [] if "--config" in arguments or not self.config.exists() else ["--config", self.config]
        return [self.gateway, "--profile-dir", self.root / "config/profiles", *config, *arguments]

    def wait(self, what, ready, seconds=20):
        end = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > end:
                raise NotReady(f"not within {seconds} s: {what}\n{self.log.read_text() if self.log.exists() else ''}")
            time.sleep(0.05)

    def all_told(self):
        """Every drive is online, or has an alarm that says why not."""
        answer = subprocess.run(
            [self.gateway, "status", "--json", "--control", self.control], capture_output=True, check=False
        )
        if answer.returncode != 0:
            return False
        drives = answer.stdout.decode()
        return '"fresh":false' not in drives

    def stop(self):
        for process in reversed(self.running):
            process.send_signal(signal.SIGTERM)
        for process in self.running:
            process.wait(timeout=20)
        self.running = []
        self.control = self.work / "none"

    def order(self, line):
        before = self.out.read_text()
        os.write(self.orders, (line + "\n").encode())
        self.wait(f"the drives take '{line}'", lambda: re.search(r"^(ok|error.*)$", self.out.read_text()[len(before) :], re.M))
        if re.search(r"^error.*$", self.out.read_text()[len(before) :], re.M):
            raise NotReady(f"the drives refuse '{line}'")

    def write_wrapper(self):
        """`canopen-gateway` as the page calls it, for the files and the socket of here."""
        wrapper = self.work / "bin/canopen-gateway"
        config = f'--config "{self.config}"' if self.config.exists() else ""
        wrapper.write_text(
            "#!/bin/bash\n"
            f'program=("{self.gateway}" --profile-dir "{self.root}/config/profiles" {config})\n'
            'for word; do case "$word" in\n'
            f'  status|set|stop|nmt|sdo) exec "${{program[@]}}" "$@" --control "{self.control}";;\n'
            "  [a-z]*) break;;\n"
            'esac; done\nexec "${program[@]}" "$@"\n'
        )
        wrapper.chmod(0o755)

    def start(self, config):
        self.stop()
        if config is None:
            self.config.unlink(missing_ok=True)
        else:
            self.config.write_text(config)
        reader, self.orders = os.pipe()
        self.begin(reader)
        os.close(reader)
        self.write_wrapper()
        self.wait("every drive is online", self.all_told)

    def shown(self, text):
        """What it says, by the places and the name that the page has."""
        return text.replace(str(self.config), CONFIG).replace(str(self.control), CONTROL)

    def meant(self, command):
        return re.sub(r" --control /tmp/canopen-gateway\.\w+/control", "", command)  # the wrapper says it


class Demo(Plant):
    """Without a configuration the demo; of a configuration drives and gateway in one process (one_process.cpp)."""

    def begin(self, orders):
        if self.config.exists():
            program = pathlib.Path(self.gateway).parent / "../tests/system/one_process"
            plant = self.work / "plant"
            self.launch([program, self.config, self.root / "config/profiles", plant], self.out, self.log, stdin=orders)
            self.control = plant / "control"
            self.wait("the plant is there", self.control.exists)
            return
        self.launch(self.program("demo"), self.out, self.log, stdin=orders)
        said = re.compile(r"--control (\S+/control)")
        self.wait("the demo says where its socket is", lambda: said.search(self.out.read_text()))
        self.control = pathlib.Path(said.search(self.out.read_text())[1])


class SocketCan(Plant):
    """Drives and gateway, two programs on can0; candump writes down what they say."""

    def begin(self, orders):
        self.control = self.work / "control"
        text = self.config.read_text()
        places = f'[gateway]\ncontrol = "{self.control}"\nstate_dir = "{self.work}/state"\n'
        (self.work / "run.toml").write_text(text.replace("[gateway]\n", places, 1))
        if self.trace is None:
            self.trace = self.work / "candump"
            subprocess.run(["ip", "link", "add", "can0", "type", "vcan"], check=True)
            subprocess.run(["ip", "link", "set", "can0", "txqueuelen", "1000", "up"], check=True)
            with open(self.trace, "wb") as trace:
                self.candump = subprocess.Popen(["candump", "can0"], stdout=trace)
        self.launch(self.program("run", "--config", self.work / "run.toml"), self.work / "run.out", self.log)
        self.wait("the gateway runs", self.control.exists)
        self.launch(self.program("simulate"), self.out, self.work / "simulate.err", stdin=orders)
        self.wait("the drives are there", lambda: "simulated" in self.out.read_text())
