// One drive: a line that always shows, and what is under it when it is opened.
import { element, setClass, setText, timeNode } from './dom.js';
import { Trends } from './trends.js';
import { alarmText, clockText, driveState, mainSignals, NONE, notesOf, valueText, valueWithUnit } from './words.js';

export class DriveCard {
  #signals;
  #main;
  #details;
  #badge = element('span');
  #notes = element('span', { className: 'notes' });
  #mainValues;
  #body = null;
  #trends = null;

  /** `mapped`: the drive in the map. `clock` tells the gateway's time. */
  constructor(mapped, clock) {
    this.name = mapped.name;
    this.newest = null;
    this.#signals = mapped.signals.filter((signal) => signal.access !== 'write');
    this.#main = mainSignals(this.#signals);
    this.#mainValues = this.#main.map((signal) => element('span', { className: 'value', title: signal.name }));
    const place = element('span', { className: 'quiet' }, `${mapped.bus}, node ${mapped.node}`);
    const summary = element('summary', {}, element('h3', {}, mapped.name), this.#badge, place, this.#notes,
      element('span', { className: 'main-values' }, ...this.#mainValues));
    this.#details = element('details', {}, summary);
    this.#details.addEventListener('toggle', () => this.#toggle(clock));
    this.node = element('li', { id: `drive-${encodeURIComponent(mapped.name)}` }, this.#details);
  }

  open() {
    this.#details.open = true;
  }

  /** Shows what was told last. */
  show() {
    const drive = this.newest;
    const state = driveState(drive);
    setText(this.#badge, state.word);
    setClass(this.#badge, `badge ${state.mood}`);
    setClass(this.node, drive.fresh && drive.online ? '' : 'stale');
    setText(this.#notes, notesOf(drive));
    setClass(this.#notes, `notes ${state.mood}`);
    this.#main.forEach((signal, i) => setText(this.#mainValues[i], valueWithUnit(drive.values[signal.name], signal)));
    if (this.#details.open) {
      this.#body?.show(drive);
    }
  }

  markOld() {
    setClass(this.node, 'stale');
  }

  /** What is searched of it. */
  get text() {
    return `${this.name} ${this.newest.bus} ${driveState(this.newest).word}`.toLowerCase();
  }

  /** After a break of the connection: its trend lines miss what was meanwhile. */
  renewTrends() {
    this.#trends?.renew();
  }

  #toggle(clock) {
    if (!this.#details.open) {
      this.#trends?.stop();
      this.#trends = null;
      return;
    }
    if (this.#body === null) {
      this.#body = new CardBody(this.#signals);
      this.#details.append(this.#body.node);
    }
    if (this.newest) {
      this.#body.show(this.newest);
    }
    this.#trends ??= new Trends(this, this.#signals, this.#body.trends, clock);
  }
}

class CardBody {
  #values;
  #flags;
  #facts = element('dl', { className: 'values facts-line' });
  #alarms = element('ul', { className: 'card-alarms' });
  #shownFacts = '';
  #shownAlarms = '';

  constructor(signals) {
    const isFlag = (signal) => signal.type === 'bool';
    this.#values = signals.filter((signal) => !isFlag(signal)).map(makeValue);
    this.#flags = signals.filter(isFlag).map(makeValue);
    this.trends = element('div', { className: 'trends' });
    this.node = element('div', { className: 'body' }, this.#alarms,
      element('dl', { className: 'values' }, ...this.#values.map((value) => value.node)),
      element('dl', { className: 'values flags' }, ...this.#flags.map((flag) => flag.node)), this.#facts, this.trends);
  }

  show(drive) {
    for (const value of [...this.#values, ...this.#flags]) {
      value.update(drive.values[value.signal.name]);
    }
    this.#showFacts(drive);
    this.#showAlarms(drive.alarms);
  }

  #showFacts(drive) {
    const commanded = Object.entries(drive.commanded).filter(([name]) => !name.endsWith('_code'));
    const facts = [['NMT state', drive.nmt],
      ['boot', drive.boot_text === '' ? drive.boot : `${drive.boot}: ${drive.boot_text}`],
      ['commanded', commanded.map(([name, value]) => `${name} ${value}`).join(', ') || NONE]];
    if (drive.control.since !== null) {
      facts.push(['held since', clockText(drive.control.since)]);
    }
    const shown = JSON.stringify(facts);
    if (shown !== this.#shownFacts) {
      this.#shownFacts = shown;
      this.#facts.replaceChildren(...facts.map(([name, text]) =>
        element('div', {}, element('dt', {}, name), element('dd', {}, text))));
    }
  }

  #showAlarms(alarms) {
    const shown = JSON.stringify(alarms);
    if (shown !== this.#shownAlarms) {
      this.#shownAlarms = shown;
      this.#alarms.hidden = alarms.length === 0;
      this.#alarms.replaceChildren(...alarms.map((alarm) => element('li', { className: alarm.severity },
        `${alarm.severity} ${alarm.kind}: ${alarmText(alarm)}${alarm.confirmed ? '' : ' (not confirmed since)'}, since `,
        timeNode(clockText(alarm.since), alarm.since))));
    }
  }
}

function makeValue(signal) {
  const text = element('span', { className: 'value' });
  const value = element('dd', {}, text);
  if (signal.unit !== '') {
    value.append(element('span', { className: 'unit' }, ` ${signal.unit}`));
  }
  const name = element('dt', {}, signal.name);
  if (signal.unconfirmed) {
    name.append(element('span', { className: 'unit', title: 'the profile could not establish its meaning or scale' }, ' (unconfirmed)'));
  }
  const node = element('div', {}, name, value);
  const update = (now) => {
    setText(text, valueText(now, signal));
    setClass(node, now === null || now === undefined ? 'stale' : now === true ? 'on' : '');
  };
  return { node, signal, update };
}
