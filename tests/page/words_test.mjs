// How things are said on the page.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as words from '../../daemon/http/page/words.js';

const drive = (more = {}) => ({ enabled: true, online: true, nmt: 'operational', fresh: true, values: {}, alarms: [], commanded: {},
  control: { holder: null, timeout: false }, ...more });
const alarm = (more = {}) => ({ drive: 'pump1', kind: 'emcy', code: '0x0005', reason: '', text: 'Overcurrent', severity: 'fault',
  since: '2026-01-02T03:04:05.678Z', first: false, ...more });

test('a value has the decimals of its scale', () => {
  assert.equal(words.valueText(30, { scale: 0.01 }), '30.00');
  assert.equal(words.valueText(49.97, { scale: 0.1 }), '50.0');
  assert.equal(words.valueText(1500, { scale: 1 }), '1500');
  assert.equal(words.valueText('running', { scale: 1 }), 'running');
  assert.equal(words.valueText(false, { scale: 1 }), 'no');
});

test('a value that is not fresh is no number, and has no unit', () => {
  for (const nothing of [null, undefined]) {
    assert.equal(words.valueText(nothing, { scale: 1 }), words.NONE);
    assert.equal(words.valueWithUnit(nothing, { scale: 1, unit: 'Hz' }), words.NONE);
  }
  assert.equal(words.valueWithUnit(0, { scale: 0.1, unit: 'A' }), '0.0 A');
});

test('the margin of the drive that has the least, by its name where it has one', () => {
  assert.equal(words.marginText({ node: 5, drive: 'pump1', least: 0.4123 }), '41 % (pump1)');
  assert.equal(words.marginText({ node: 7, drive: null, least: 0 }), '0 % (node 7)');
  assert.equal(words.marginText(null), words.NONE);
});

test('a time has its day where it is another one', () => {
  const time = new Date(2026, 0, 2, 3, 4, 5);
  assert.equal(words.clockText(time.toISOString(), new Date(2026, 0, 2, 23)), '03:04:05');
  assert.equal(words.clockText(time.toISOString(), new Date(2026, 0, 3, 0)), '2026-01-02 03:04:05');
  assert.equal(words.clockText('no time'), words.NONE);
});

test('a duration has its two greatest parts', () => {
  assert.deepEqual([0, 59, 60, 3605, 93784].map(words.durationText), ['0 s', '59 s', '1 min 0 s', '1 h 0 min', '1 d 2 h']);
});

test('the state of a drive: what matters most', () => {
  const state = (more) => words.driveState(drive(more)).word;
  assert.equal(state({ enabled: false, online: false }), 'out of service');
  assert.equal(state({ online: false, alarms: [alarm()] }), 'offline');
  assert.equal(state({ alarms: [alarm()] }), 'fault');
  assert.equal(state({ alarms: [alarm({ severity: 'warning' })], values: { running: true } }), 'running');
  assert.equal(state({ nmt: 'pre-operational', values: { running: true } }), 'pre-operational');
  assert.equal(state({ values: { running: false } }), 'stopped');
  assert.equal(state({ values: { running: null } }), 'operational');
});

test('the line of a drive says why it does not run', () => {
  const notes = (more) => words.notesOf(drive(more));
  const still = { values: { running: false } };
  assert.equal(notes({ values: { running: true }, commanded: { control_command: 'forward' } }), '');
  assert.equal(notes(still), 'commanded: nothing');
  assert.equal(notes({ ...still, commanded: { control_command: 'stop' } }), 'commanded: stop');
  assert.equal(notes({ online: false, alarms: [alarm({ code: '0x0000', reason: 'lost', text: 'no heartbeat for 1500 ms' })] }),
    'lost: no heartbeat for 1500 ms');
  assert.equal(notes({ ...still, commanded: { control_command: 'forward' }, alarms: [alarm(), alarm({ severity: 'warning' })] }),
    '0x0005: Overcurrent, 1 warning');
  assert.equal(notes({ fresh: false, control: { holder: 'modbus 192.0.2.7', timeout: true } }),
    'values missing, command timeout, held by modbus 192.0.2.7');
});

test('main signals: the first readable of each unit, three at most', () => {
  const signal = (name, unit, access = 'read') => ({ name, unit, access });
  const names = words.mainSignals([signal('status', ''), signal('set', 'Hz', 'write'), signal('f', 'Hz'), signal('g', 'Hz'),
    signal('i', 'A'), signal('n', 'rpm'), signal('u', 'V')]).map(({ name }) => name);
  assert.deepEqual(names, ['f', 'i', 'n']);
});

test('news of alarms: what began, what is over, and no more than a listener can bear', () => {
  assert.equal(words.alarmNews([], [alarm({ first: true })]), 'Alarm: pump1, 0x0005: Overcurrent, came first');
  assert.equal(words.alarmNews([alarm()], [alarm()]), '');
  assert.equal(words.alarmNews([alarm()], []), 'Over: pump1, 0x0005: Overcurrent');
  assert.equal(words.alarmNews([alarm()], [alarm({ text: 'Overvoltage' })]), 'Alarm: pump1, 0x0005: Overvoltage');
  const many = ['a', 'b', 'c', 'd'].map((name) => alarm({ drive: name }));
  assert.equal(words.alarmNews([], many), 'Alarm: 4 alarms');
  const bus = { bus: 'can0', kind: 'bus', code: '0x0000', reason: 'down', text: 'the interface is missing', severity: 'fault' };
  assert.equal(words.alarmNews([alarm()], [alarm(), bus]), 'Alarm: can0, down: the interface is missing');
});
