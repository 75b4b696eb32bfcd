// Lines of the journal of commands, as words.
import { NONE } from './words.js';

const shown = (value) => (value === null || value === undefined ? NONE : String(value));

/** `control_command 1, frequency_command 30` */
export function commandText(line) {
  if (line.fields) {
    return line.fields.map((field) => `${field.signal} ${shown(field.asked)}`).join(', ');
  }
  if ('nmt' in line) {
    return `NMT ${shown(line.nmt)}`;
  }
  if ('object' in line) {
    return `${shown(line.object)} = ${'bytes' in line ? `bytes ${line.bytes}` : shown(line.asked)}`;
  }
  if (line.phase === 'lost') {
    return `${line.count} lines of the journal are lost`;
  }
  return NONE;
}

/** The outcome, and how it is meant. */
export function outcomeText(line) {
  if (line.phase === 'begun') {
    return { word: 'under way', mood: 'warn' };
  }
  const words = [line.outcome, line.error, line.abort, line.note].filter(Boolean).join(': ');
  return { word: words || NONE, mood: line.outcome === 'ok' ? 'good' : 'bad' };
}

/** Who it was. */
export function writerText(line) {
  return [line.writer, line.from].filter(Boolean).join(' ') || NONE;
}

/**
 * Newest first. Of a command with two lines the second one, which tells all; of several in one line the last; what is no
 * command is left out.
 */
export function newestCommands(lines) {
  const done = new Set(lines.filter((line) => line.phase === 'done').map((line) => line.id));
  return lines.filter((line) => line.phase !== 'torn' && !(line.phase === 'begun' && done.has(line.id)))
    .map((line) => ({ ...line.last, ...line })).reverse();
}
