"""What the tests of the alert rules and of the dashboard share: where they are, and what they ask."""
import json
import pathlib
import re

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
RULES = ROOT / "docs/monitoring/canopen-gateway.rules.yml"
DASHBOARD = ROOT / "docs/monitoring/canopen-gateway.dashboard.json"
PROMTOOL = ROOT / "build/promtool/usr/bin/promtool"
PROMETHEUS = ROOT / "build/promtool/usr/bin/prometheus"


def rules():
    return [rule for group in yaml.safe_load(RULES.read_text())["groups"] for rule in group["rules"]]


def without_comparison(expression):
    """What a rule looks at: of `up{job="x"} == 0` it is `up{job="x"}`."""
    bare, count = re.subn(r"\s(==|!=|<=|>=|<|>)\s*[0-9.]+", "", expression)
    assert count, f"nothing is compared in {expression}"
    return bare


def dashboard():
    return json.loads(DASHBOARD.read_text())


def dashboard_expressions():
    """(title of the panel, expression) with all variables set to all."""
    for panel in dashboard()["panels"]:
        for target in panel.get("targets", []):
            expression = re.sub(r"\$(instance|bus|drive)\b", ".*", target["expr"]).replace("$__rate_interval", "1m")
            assert "$" not in expression, expression
            yield panel["title"], expression
