#!/usr/bin/python3
"""A real Prometheus scrapes the demo with the alert rules: every expression of the rules (without its comparison) and of
the dashboard gives data, every label that an annotation names is there, and what is wrong in the demo is told.

GATEWAY_BIN is the program. The dashboard is read as Grafana does, as far as that can be known without one."""
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.parse
import urllib.request

import rules

PROGRAM = os.environ.get("GATEWAY_BIN", rules.ROOT / "build/release/daemon/canopen-gateway")
PROFILES = ["--profile-dir", str(rules.ROOT / "config/profiles")]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(what, look, limit=90):
    end = time.monotonic() + limit
    while not (found := look()):
        assert time.monotonic() < end, f"not within {limit} s: {what}"
        time.sleep(0.2)
    return found


def fetch(url):
    try:
        with urllib.request.urlopen(url, timeout=10) as answer:
            return json.load(answer)
    except (OSError, ValueError):
        return None


class Demo:
    """The gateway and four simulated drives in one process."""

    def __init__(self, folder):
        self.http, self.modbus = free_port(), free_port()
        site = (rules.ROOT / "config/demo.toml").read_text().replace("127.0.0.1:9465", f"127.0.0.1:{self.http}")
        site = site.replace("127.0.0.1:1502", f"127.0.0.1:{self.modbus}").replace("127.0.0.1:1883", "127.0.0.1:9")
        (folder / "site.toml").write_text(site)
        self.out = folder / "demo.out"
        self.process = subprocess.Popen([PROGRAM, *PROFILES, "--config", folder / "site.toml", "demo"], text=True,
                                        stdin=subprocess.PIPE, stdout=self.out.open("w"), stderr=(folder / "demo.err").open("w"))

    def health(self):
        return fetch(f"http://127.0.0.1:{self.http}/health")

    def order(self, words):
        self.process.stdin.write(words + "\n")
        self.process.stdin.flush()

    def command(self, *words):
        control = until("the control socket is named", lambda: re.search(r"(/\S+/control)\b", self.out.read_text()))
        return subprocess.run([PROGRAM, *words, "--control", control[1]], capture_output=True, text=True)

    def read_registers(self):
        subprocess.run(["mbpoll", "-m", "tcp", "-p", str(self.modbus), "-a", "5", "-0", "-r", "0", "-c", "4", "-1", "127.0.0.1"],
                       capture_output=True)


class Prometheus:
    """Debian's, which scrapes the demo each second."""

    def __init__(self, folder, demo):
        self.port = free_port()
        (folder / "prometheus.yml").write_text(json.dumps({
            "global": {"scrape_interval": "1s", "evaluation_interval": "1s"}, "rule_files": [str(rules.RULES)],
            "scrape_configs": [{"job_name": "canopen-gateway", "static_configs": [{"targets": [f"127.0.0.1:{demo.http}"]}]}]}))
        self.process = subprocess.Popen(
            [rules.PROMETHEUS, f"--config.file={folder}/prometheus.yml", f"--storage.tsdb.path={folder}/data",
             f"--web.listen-address=127.0.0.1:{self.port}", "--log.level=warn"], stderr=(folder / "prometheus.err").open("w"))

    def ask(self, what, **parameters):
        answer = fetch(f"http://127.0.0.1:{self.port}/api/v1/{what}?{urllib.parse.urlencode(parameters)}")
        return answer and answer["data"]

    def series(self, expression):
        return (self.ask("query", query=expression) or {}).get("result", [])


def has_data(result):
    return any(one["value"][1] != "NaN" for one in result)


def check_dashboard(dashboard):
    """Its structure, by Grafana's own documentation of the JSON model."""
    assert dashboard["schemaVersion"] >= 36 and dashboard["title"] and dashboard["uid"] and dashboard["id"] is None
    variables = {one["name"]: one for one in dashboard["templating"]["list"]}
    assert variables["datasource"]["type"] == "datasource" and variables["datasource"]["query"] == "prometheus"
    panels = dashboard["panels"]
    assert len({panel["id"] for panel in panels}) == len(panels)
    taken = set()
    for panel in panels:
        place = panel["gridPos"]
        assert place["x"] + place["w"] <= 24, panel["title"]
        cells = {(x, y) for x in range(place["x"], place["x"] + place["w"]) for y in range(place["y"], place["y"] + place["h"])}
        assert not cells & taken, f"{panel['title']} lies on another panel"
        taken |= cells
        if panel["type"] == "row":
            continue
        assert panel["type"] in ("stat", "timeseries", "state-timeline", "table"), panel["title"]
        assert panel["datasource"]["uid"] == "${datasource}", panel["title"]
        assert len({target["refId"] for target in panel["targets"]}) == len(panel["targets"]) > 0, panel["title"]
        for target in panel["targets"]:
            assert target["datasource"]["uid"] == "${datasource}", panel["title"]
            assert set(re.findall(r"\$(\w+)", target["expr"])) <= {*variables, "__rate_interval"}, target["expr"]


def check_variables(prometheus, dashboard):
    for one in dashboard["templating"]["list"]:
        if one["type"] == "query":
            series, label = re.fullmatch(r"label_values\((.*), (\w+)\)", one["query"]["query"]).groups()
            found = prometheus.series(series.replace("$instance", ".*"))
            assert found and all(label in series["metric"] for series in found), one["name"]


def expressions():
    for rule in rules.rules():
        yield rule["alert"], rules.without_comparison(rule["expr"])
    yield from rules.dashboard_expressions()


def keep_commanding(demo, count):
    demo.command("set", "fan1", f"frequency_command={10 + count % 30}", "torque_command=0", "control_command=forward")
    demo.command("set", "pump1", "frequency_command=999")  # out of its range
    demo.command("sdo", "read", "fan1", "0x5FFF:01", "u16")  # no such object
    demo.read_registers()


def check(folder):
    dashboard = rules.dashboard()
    check_dashboard(dashboard)
    demo = Demo(folder)
    prometheus = None
    try:
        until("all drives are online", lambda: (demo.health() or {}).get("drives_online") == 4)
        prometheus = Prometheus(folder, demo)
        until("Prometheus has scraped it", lambda: has_data(prometheus.series("up == 1")))
        demo.order("5 fault 5")
        demo.order("9 sdo-flaw abort")  # no boot of it succeeds
        demo.order("9 reboot")
        asked = dict.fromkeys(expressions())
        empty, count = list(asked), 0

        def all_have_data():
            nonlocal empty, count
            keep_commanding(demo, count)
            count += 1
            empty = [one for one in empty if not has_data(prometheus.series(one[1]))]
            return not empty

        try:
            until("every expression gives data", all_have_data)
        finally:
            for title, expression in empty:
                print(f"no data: {title}: {expression}")
        print(f"{len(asked) - len(empty)} of {len(asked)} expressions give data, after {count} rounds of commands")
        check_variables(prometheus, dashboard)
        check_rules(prometheus)
    finally:
        for process in (prometheus.process if prometheus else None, demo.process):
            if process:
                process.terminate()
                process.wait(30)


def check_rules(prometheus):
    """Labels of the annotations, and what is told of the demo: a fault, a failed boot, no broker, refused commands."""
    for rule in rules.rules():
        found = prometheus.series(rules.without_comparison(rule["expr"]))
        named = set(re.findall(r"\$labels\.(\w+)", json.dumps(rule["annotations"])))
        for series in found[:1]:
            assert named <= set(series["metric"]), f"{rule['alert']} names {named}, and has {set(series['metric'])}"
    loaded = [rule for group in prometheus.ask("rules")["groups"] for rule in group["rules"]]
    assert len(loaded) == len(rules.rules())
    for rule in loaded:
        assert rule["health"] == "ok", f"{rule['name']}: {rule.get('lastError')}"
    alerts = {alert["labels"]["alertname"]: alert for alert in prometheus.ask("alerts")["alerts"]}
    for expected in ("CanopenFault", "CanopenDriveAlarm", "CanopenDriveBoot", "CanopenMqttDisconnected",
                     "CanopenCommandsRefused"):
        assert expected in alerts, f"{expected} is not among {sorted(alerts)}"
    for alert in alerts.values():
        for text in alert["annotations"].values():
            assert "no value" not in text and "error" not in text.lower().replace("errors", ""), text
    print("told:", *(alert["annotations"]["summary"] for alert in alerts.values()), sep="\n  ")


work = pathlib.Path(tempfile.mkdtemp(prefix="monitoring-test."))
check(work)
shutil.rmtree(work)
