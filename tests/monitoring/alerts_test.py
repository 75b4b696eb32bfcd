#!/usr/bin/python3
"""The alert rules, by promtool: each is accepted, is silent beside a plant that is well, is pending while the trouble is
shorter than its `for`, and fires after it. And each says what to do first."""
import re
import subprocess
import sys
import tempfile

import yaml

import rules

STEP = 15  # seconds
BAD = 3600  # when the trouble begins
JOB = 'job="canopen-gateway",instance="a"'
BUS = f'{JOB},bus="can0"'
DRIVE = f'{JOB},drive="pump1"'

# A plant that is well, for an hour and a half. `_`: no sample.
WELL = {
    f"up{{{JOB}}}": "1",
    f"process_start_time_seconds{{{JOB}}}": "1000",
    f"process_open_fds{{{JOB}}}": "30",
    f"process_max_fds{{{JOB}}}": "1024",
    f"canopen_gateway_healthy{{{JOB}}}": "1",
    f"canopen_gateway_clock_set{{{JOB}}}": "1",
    f"canopen_gateway_log_messages_lost_total{{{JOB}}}": "3",
    **{f'canopen_gateway_bus_state{{{BUS},state="{state}"}}': "1" if state == "active" else "0"
       for state in ("active", "warning", "passive", "bus-off", "down")},
    f"canopen_gateway_bus_off_events_total{{{BUS}}}": "1",
    f"canopen_gateway_bus_error_frames_ratio{{{BUS}}}": "0.0005",
    f"canopen_gateway_bus_load_ratio{{{BUS}}}": "0.6",
    f"canopen_gateway_bus_frames_lost_total{{{BUS}}}": "7",
    f"canopen_gateway_bus_alarm_active{{{BUS}}}": "0",
    f'canopen_gateway_drive_info{{{DRIVE},bus="can0",node="5",profile="p"}}': "1",
    f"canopen_gateway_drive_enabled{{{DRIVE}}}": "1",
    f"canopen_gateway_drive_online{{{DRIVE}}}": "1",
    f"canopen_gateway_drive_operational{{{DRIVE}}}": "1",
    f'canopen_gateway_drive_boot_result{{{DRIVE},result="ok"}}': "1",
    f'canopen_gateway_drive_boot_result{{{DRIVE},result="B"}}': "_",
    f'canopen_gateway_alarms_active{{{JOB},kind="emcy",severity="fault"}}': "0",
    f'canopen_gateway_alarms_active{{{JOB},kind="emcy",severity="warning"}}': "1",
    f'canopen_gateway_drive_alarm_active{{{DRIVE},kind="emcy"}}': "0",
    f"canopen_gateway_drive_heartbeat_age_seconds{{{DRIVE}}}": "0.4",
    f"canopen_gateway_drive_heartbeat_losses_total{{{DRIVE}}}": "2",
    f"canopen_gateway_drive_boot_ups_total{{{DRIVE}}}": "2",
    f"canopen_gateway_drive_values_fresh{{{DRIVE}}}": "1",
    f'canopen_gateway_drive_sdo_aborts_total{{{DRIVE},code="0x06020000"}}': "_",
    f'canopen_gateway_commands_total{{{DRIVE},writer="modbus",outcome="ok"}}': "9",
    f'canopen_gateway_commands_total{{{DRIVE},writer="modbus",outcome="range"}}': "_",
    f'canopen_gateway_commands_total{{{DRIVE},writer="modbus",outcome="timeout"}}': "4",
    f'canopen_gateway_command_confirmation_seconds_bucket{{{DRIVE},writer="modbus",le="1"}}': "9",
    f'canopen_gateway_command_confirmation_seconds_bucket{{{DRIVE},writer="modbus",le="5"}}': "9",
    f'canopen_gateway_command_confirmation_seconds_bucket{{{DRIVE},writer="modbus",le="+Inf"}}': "9",
    f"canopen_gateway_journal_lines_lost_total{{{JOB}}}": "0",
    f"canopen_gateway_journal_passed_by_total{{{JOB}}}": "0",
    f"canopen_gateway_recorder_works{{{JOB}}}": "1",
    f"canopen_gateway_mqtt_connected{{{JOB}}}": "1",
    f"canopen_gateway_mqtt_messages_dropped_total{{{JOB}}}": "0",
    f"canopen_gateway_mqtt_answers_dropped_total{{{JOB}}}": "0",
    f"canopen_gateway_mqtt_refused_subscriptions{{{JOB}}}": "0",
    f"canopen_gateway_mqtt_topics_put_right_total{{{JOB}}}": "0",
    f"canopen_gateway_modbus_refused_clients_total{{{JOB}}}": "0",
    f'canopen_gateway_modbus_exceptions_total{{{JOB},code="0x02"}}': "0",
    f"canopen_gateway_modbus_requests_total{{{JOB}}}": "0+5",
}

# By alert, what is different from BAD on: metric (its first series, or the one with these words) and values.
TROUBLE = {
    "CanopenGatewayDown": [("up{", "0")],
    "CanopenGatewayNotWell": [("healthy", "0")],
    "CanopenGatewayRestarts": [("process_start_time", "2000+15")],
    "CanopenGatewayClockUnset": [("clock_set", "0")],
    "CanopenGatewayLogLost": [("log_messages_lost", "4")],
    "CanopenGatewayDescriptors": [("open_fds", "900")],
    "CanopenBusDown": [('state="down"', "1")],
    "CanopenBusOff": [('state="bus-off"', "1")],
    "CanopenBusOffRepeats": [("bus_off_events", "5")],
    "CanopenBusPassive": [('state="passive"', "1")],
    "CanopenBusErrors": [("error_frames", "0.002")],
    "CanopenBusLoad": [("load_ratio", "0.8")],
    "CanopenBusFramesLost": [("frames_lost", "8")],
    "CanopenBusAlarm": [("bus_alarm", "1")],
    "CanopenDriveOffline": [("drive_online", "0")],
    "CanopenDriveBoot": [('result="B"', "1")],
    "CanopenDriveNotOperational": [("operational", "0")],
    "CanopenFault": [('severity="fault"', "2")],
    "CanopenDriveAlarm": [("drive_alarm_active", "1")],
    "CanopenDriveHeartbeatLate": [("heartbeat_age", "6+15")],
    "CanopenDriveHeartbeatLosses": [("heartbeat_losses", "7")],
    "CanopenDriveReboots": [("boot_ups", "7")],
    "CanopenDriveStale": [("values_fresh", "0")],
    "CanopenDriveSdoAborts": [("sdo_aborts", "20")],
    "CanopenCommandsRefused": [('outcome="range"', "1")],
    "CanopenCommandsSlow": [('le="5"', "10+1"), ('le="+Inf"', "10+1")],
    "CanopenJournalLost": [("lines_lost", "1")],
    "CanopenJournalSlow": [("passed_by", "1")],
    "CanopenRecorder": [("recorder_works", "0")],
    "CanopenMqttDisconnected": [("mqtt_connected", "0")],
    "CanopenMqttDropped": [("answers_dropped", "1")],
    "CanopenMqttSubscriptions": [("refused_subscriptions", "1")],
    "CanopenMqttOverwritten": [("put_right", "1")],
    "CanopenModbusExceptions": [("modbus_exceptions", "0+1")],
    "CanopenModbusRefused": [("refused_clients", "1")],
}
# What is no trouble although it looks like one.
HARMLESS = {
    "a drive that is out of service is offline": [("drive_enabled", "0"), ("drive_online", "0"), ("operational", "0"),
                                                  ("values_fresh", "0"), ("heartbeat_age", "6+15")],
    "one restart": [("process_start_time", "2000")],
    "a few refused SDO transfers": [("sdo_aborts", "5")],
    "commands of before, counted anew by another life of the gateway": [('outcome="timeout"', "0")],
}


def seconds(duration):
    number, unit = re.fullmatch(r"(\d+)([smh])", duration).groups()
    return int(number) * {"s": 1, "m": 60, "h": 3600}[unit]


def test_of(trouble, checks):
    """One of promtool's tests: the plant that is well until BAD, and then with this trouble."""
    different = {}
    for words, values in trouble:
        different[next(series for series in WELL if words in series)] = values
    series = []
    for name, values in WELL.items():
        notation = f"_x{BAD // STEP}" if values == "_" else f"{values}x{BAD // STEP - 1}"
        if values.startswith("0+"):
            notation += f" {BAD // STEP * int(values[2:])}+{values[2:]}x250"
        elif name in different:
            notation += f" {different[name]}x250"
        else:
            notation += f" {values}x250"
        series.append({"series": name, "values": notation})
    return {"interval": f"{STEP}s", "input_series": series, "promql_expr_test": [
        {"expr": f"count(ALERTS{{{which}}}) or vector(0)", "eval_time": f"{time}s",
         "exp_samples": [{"labels": "{}", "value": count}]} for which, time, count in checks]}


def tests():
    firing = 'alertstate="firing"'
    yield test_of([], [("", BAD - STEP, 0), ("", 2 * BAD, 0)])
    for trouble in HARMLESS.values():
        yield test_of(trouble, [(firing, BAD + 1200, 0)])
    for rule in rules.rules():
        name = f'alertname="{rule["alert"]}"'
        # Where a rate has to rise first, it is pending some minutes later.
        late = 480 if rule["alert"] in ("CanopenCommandsSlow", "CanopenModbusExceptions", "CanopenGatewayRestarts") else 15
        wait = seconds(rule["for"])
        checks = [(name, BAD - STEP, 0), (f"{name},{firing}", BAD + late + wait + STEP, 1)]
        if wait > STEP:
            checks.append((f"{name},{firing}", BAD + wait - STEP, 0))
        yield test_of(TROUBLE[rule["alert"]], checks)


def check_words():
    for rule in rules.rules():
        name = rule["alert"]
        assert rule["labels"]["severity"] in ("critical", "warning", "info"), name
        assert seconds(rule["for"]) > 0, name
        assert "instance }}" in rule["annotations"]["summary"], f"{name}: of which gateway?"
        assert "First: " in rule["annotations"]["description"], f"{name}: what is to be done first?"
    names = [rule["alert"] for rule in rules.rules()]
    assert sorted(names) == sorted(TROUBLE), set(names) ^ set(TROUBLE)
    told = (rules.ROOT / "docs/MONITORING.md").read_text()
    rows = {rule["alert"]: f"| `{rule['alert']}` | {rule['labels']['severity']} | {rule['for']} |" for rule in rules.rules()}
    missing = [name for name, row in rows.items() if row not in told]
    assert not missing, f"not in the table of docs/MONITORING.md: {missing}"


check_words()
with tempfile.NamedTemporaryFile("w", suffix=".yml") as file:
    written = list(tests())
    yaml.safe_dump({"rule_files": [str(rules.RULES)], "evaluation_interval": f"{STEP}s", "tests": written}, file)
    file.flush()
    subprocess.run([rules.PROMTOOL, "check", "rules", rules.RULES], check=True)
    done = subprocess.run([rules.PROMTOOL, "test", "rules", file.name])
    print(f"{len(written)} tests of {len(TROUBLE)} rules")
    sys.exit(done.returncode)
