// How things are said. Nothing here knows of the page, so it can be tested alone.

export const NONE = '—';

/** Of a scale of 0.01 two. */
export function decimalsOf(scale) {
  const text = String(scale);
  return text.includes('e') ? 6 : Math.min((text.split('.')[1] ?? '').length, 6);
}

/** A value as the API has it: null is one that is not fresh. */
export function valueText(value, signal) {
  if (value === null || value === undefined) {
    return NONE;
  }
  if (typeof value === 'boolean') {
    return value ? 'yes' : 'no';
  }
  return typeof value === 'number' ? value.toFixed(decimalsOf(signal?.scale ?? 1)) : String(value);
}

/** With its unit, where there is a value. */
export function valueWithUnit(value, signal) {
  const text = valueText(value, signal);
  return text === NONE || !signal?.unit ? text : `${text} ${signal.unit}`;
}

const two = (number) => String(number).padStart(2, '0');

/** Of this machine's time zone; with the day where it is not the one of `now`. */
export function clockText(iso, now = new Date()) {
  const time = new Date(iso);
  if (Number.isNaN(time.getTime())) {
    return NONE;
  }
  const clock = `${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}`;
  const day = `${time.getFullYear()}-${two(time.getMonth() + 1)}-${two(time.getDate())}`;
  return time.toDateString() === now.toDateString() ? clock : `${day} ${clock}`;
}

/** 93784 is "1 d 2 h". */
export function durationText(seconds) {
  const parts = [[Math.floor(seconds / 86400), 'd'], [Math.floor(seconds / 3600) % 24, 'h'],
    [Math.floor(seconds / 60) % 60, 'min'], [Math.floor(seconds) % 60, 's']];
  const first = parts.findIndex(([count]) => count > 0);
  return parts.slice(first < 0 ? 3 : first).slice(0, 2).map(([count, unit]) => `${count} ${unit}`).join(' ');
}

export function percentText(share) {
  return share === null || share === undefined ? NONE : `${(share * 100).toFixed(1)} %`;
}

/** Of the drive that has the least. */
export function marginText(margin) {
  return margin ? `${(margin.least * 100).toFixed(0)} % (${margin.drive ?? `node ${margin.node}`})` : NONE;
}

/** What a drive does, in a word, and how that is meant: good, busy, warn, bad, off. */
export function driveState(drive) {
  if (!drive.enabled) {
    return { word: 'out of service', mood: 'off' };
  }
  if (!drive.online) {
    return { word: 'offline', mood: 'bad' };
  }
  if (drive.alarms.some((alarm) => alarm.severity === 'fault')) {
    return { word: 'fault', mood: 'bad' };
  }
  if (drive.nmt !== 'operational') {
    return { word: drive.nmt, mood: 'warn' };
  }
  if (drive.values.running === true) {
    return { word: 'running', mood: 'busy' };
  }
  return { word: drive.values.running === false ? 'stopped' : 'operational', mood: 'good' };
}

/** In its line: why it does not run, and what else one should know of it. */
export function notesOf(drive) {
  const notes = drive.alarms.filter((alarm) => alarm.severity === 'fault').slice(0, 1).map(alarmText);
  if (notes.length === 0 && drive.online && drive.values.running === false) {
    notes.push(`commanded: ${drive.commanded.control_command ?? 'nothing'}`);
  }
  const warnings = drive.alarms.filter((alarm) => alarm.severity === 'warning').length;
  if (warnings > 0) {
    notes.push(warnings === 1 ? '1 warning' : `${warnings} warnings`);
  }
  if (drive.online && !drive.fresh) {
    notes.push('values missing');
  }
  if (drive.control.timeout) {
    notes.push('command timeout');
  }
  if (drive.control.holder !== null) {
    notes.push(`held by ${drive.control.holder}`);
  }
  return notes.join(', ');
}

/** Up to three signals that tell most: the first one of each unit. */
export function mainSignals(signals) {
  const units = new Set();
  return signals.filter((signal) => {
    const take = signal.unit !== '' && signal.access !== 'write' && !units.has(signal.unit) && units.size < 3;
    if (take) {
      units.add(signal.unit);
    }
    return take;
  });
}

/** `0x0005 Overcurrent` */
export function alarmText(alarm) {
  return [alarm.code === '0x0000' ? alarm.reason : alarm.code, alarm.text].filter(Boolean).join(': ');
}

export function placeOf(alarm) {
  return alarm.drive ?? alarm.bus ?? '';
}

/** One alarm of a drive and kind at a time. */
export function alarmKey(alarm) {
  return `${alarm.drive === undefined ? 'bus' : 'drive'} ${placeOf(alarm)} ${alarm.kind}`;
}

const MOST_TOLD = 3;

/** What a listener is told of the change from one list of alarms to the next; empty: nothing. */
export function alarmNews(before, after) {
  const told = new Set(before.map((alarm) => `${alarmKey(alarm)} ${alarmText(alarm)}`));
  const there = new Set(after.map(alarmKey));
  const begun = after.filter((alarm) => !told.has(`${alarmKey(alarm)} ${alarmText(alarm)}`));
  const over = before.filter((alarm) => !there.has(alarmKey(alarm)));
  const name = (alarm) => `${placeOf(alarm)}, ${alarmText(alarm)}${alarm.first ? ', came first' : ''}`;
  const list = (what, alarms) => alarms.length > MOST_TOLD
    ? [`${what}: ${alarms.length} alarms`] : alarms.map((alarm) => `${what}: ${name(alarm)}`);
  return [...list('Alarm', begun), ...list('Over', over)].join('. ');
}
