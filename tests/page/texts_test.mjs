// What the page makes of the journal, the map, and the stream.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { EventParser } from '../../daemon/http/page/events.js';
import { frameCells, lostText } from '../../daemon/http/page/frames.js';
import { commandText, newestCommands, outcomeText, writerText } from '../../daemon/http/page/journal.js';
import { findRows, mapRows, modbusText } from '../../daemon/http/page/search.js';
import { rangeOf } from '../../daemon/http/page/trends.js';

test('a command is told once, newest first, with what became of it', () => {
  const fields = [{ signal: 'control_command', before: 5, asked: 1 }, { signal: 'frequency_command', asked: null }];
  const lines = [{ phase: 'begun', id: 'a', writer: 'modbus', from: '192.0.2.7', fields },
    { phase: 'done', id: 'a', writer: 'modbus', from: '192.0.2.7', outcome: 'ok', fields }, { phase: 'torn' },
    { phase: 'begun', id: 'b', writer: 'local', from: 'anna', fields },
    { phase: 'done', writer: 'mqtt', count: 7, first: { id: 'c', outcome: 'ok', fields: [] },
      last: { id: 'd', outcome: 'range', error: 'out of range 0..50', fields: [{ signal: 'f', asked: 60 }] } }];
  const commands = newestCommands(lines);
  assert.deepEqual(commands.map((line) => line.id), ['d', 'b', 'a']);
  assert.deepEqual(commands.map((line) => outcomeText(line).word), ['range: out of range 0..50', 'under way', 'ok']);
  assert.deepEqual(commands.map(commandText), ['f 60', 'control_command 1, frequency_command —', 'control_command 1, frequency_command —']);
  assert.deepEqual(commands.map(writerText), ['mqtt', 'local anna', 'modbus 192.0.2.7']);
});

test('other lines of the journal', () => {
  assert.equal(commandText({ nmt: 'start' }), 'NMT start');
  assert.equal(commandText({ object: '0x2021:02', type: 'u16', asked: 7 }), '0x2021:02 = 7');
  assert.equal(commandText({ object: '0x2021:02', bytes: '0700' }), '0x2021:02 = bytes 0700');
  assert.equal(commandText({ phase: 'lost', count: 12 }), '12 lines of the journal are lost');
});

test('events come whole, however the stream is cut', () => {
  const text = 'event: alarms\ndata: []\n\n:\n\nevent: drive\ndata: {"name":"é"}\n\n';
  const whole = new EventParser().push(text);
  assert.deepEqual(whole, [{ name: 'alarms', data: '[]' }, { name: 'drive', data: '{"name":"é"}' }]);
  for (let cut = 0; cut <= text.length; ++cut) {
    const parser = new EventParser();
    assert.deepEqual([...parser.push(text.slice(0, cut)), ...parser.push(text.slice(cut))], whole, `cut at ${cut}`);
  }
});

test('the map is found by any of its words', () => {
  const signal = (name, modbus) => ({ name, unit: 'Hz', object: '0x2021:02', type: 'u16', scale: 0.01, access: 'read', source: 'tpdo1',
    modbus, mqtt: { topic: `canopen/x/${name}`, set: null } });
  const map = { flat_unit: 1, drives: [{ name: 'pump1', modbus_unit: 5, signals: [signal('speed', { kind: 'register', address: 2, count: 2, flat: 3002 }),
    signal('running', { kind: 'bit', address: 0, count: 1 }), signal('hidden', null)] }] };
  const rows = mapRows(map);
  assert.deepEqual(rows.map((row) => row.cells[3]), ['5: register 2–3; 1: register 3002–3003', '5: bit 0', '']);
  assert.deepEqual(findRows(rows, '  PUMP1 speed ').map((row) => row.cells[1]), ['speed']);
  assert.equal(findRows(rows, '').length, 3);
  assert.equal(findRows(rows, 'pump1 nothing').length, 0);
  assert.equal(modbusText({ modbus_unit: null }, map.drives[0].signals[0], 1), '');
});

test('a chart of what hardly moves shows no mountains', () => {
  const range = (values, scale) => rangeOf(values.map((value, i) => [i, value]), scale);
  assert.deepEqual(range([null, null], 0.1), [0, 1]);
  const [low, high] = range([50, 50.01], 0.01);
  assert.ok(high - low >= 2.5 && low < 50 && high > 50.01);
  assert.equal(range([0, 0], 0.01)[0], 0, 'nothing below zero where there is nothing');
  const wide = range([-100, 100], 1);
  assert.ok(wide[0] < -100 && wide[1] > 100);
});

test('foreign text never becomes markup, and functions stay short', () => {
  const folder = new URL('../../daemon/http/page/', import.meta.url);
  const names = fs.readdirSync(folder).filter((name) => name.endsWith('.js'));
  assert.ok(names.length > 10);
  for (const name of names) {
    const text = fs.readFileSync(new URL(name, folder), 'utf8');
    assert.doesNotMatch(text, /innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(|new Function|setHTML|DOMParser/, name);
    assert.ok(text.split('\n').length < 300, name);
  }
  const page = fs.readFileSync(new URL('index.html', folder), 'utf8');
  assert.doesNotMatch(page, /<style|style=|<script(?![^>]* src=)|\son[a-z]+=|https?:/, 'nothing inline, nothing from elsewhere');
});

test('frames', () => {
  const frame = { ts: '2026-01-02T03:04:05.678123Z', frame: '605#4021', own: true, kind: 'sdo', name: 'SDO' };
  const cells = frameCells(frame);
  assert.match(cells.time, /\d\d:\d\d:05\.678123$/);
  assert.deepEqual([cells.id, cells.name], ['605', 'SDO (ours)']);
  assert.deepEqual(frameCells({ ...frame, own: false, kind: 'error', name: 'error', frame: '20000040#' }).id, '');
  assert.equal(lostText({ frames: 1 }), 'Up to 1 frame is not shown here: they came too fast.');
  assert.equal(lostText({ frames: 7 }), 'Up to 7 frames are not shown here: they came too fast.');
});
