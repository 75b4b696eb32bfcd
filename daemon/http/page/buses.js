// The buses: state, load, errors.
import { byId, element, reconcile, setClass, setText } from './dom.js';
import { marginText, percentText } from './words.js';

const MOODS = { active: 'good', warning: 'warn', passive: 'bad', 'bus-off': 'bad', down: 'bad' };

export class Buses {
  #rows = byId('bus-rows');
  #kept = new Map();
  #suspicions = byId('suspicions');
  #suspected = new Map();

  show(buses) {
    reconcile(this.#rows, this.#kept, buses, (bus) => bus.name, makeBus);
    reconcile(this.#suspicions, this.#suspected, buses.filter((bus) => bus.suspicion), (bus) => bus.name, makeSuspicion);
  }
}

function makeBus(bus) {
  const state = element('span');
  const meter = element('meter', { max: 1, high: 0.8, optimum: 0, 'aria-label': `load of ${bus.name}` });
  const load = element('span');
  const figures = ['highest', 'transmit', 'receive', 'frames', 'offs', 'lost', 'margin'].map(() => element('td', { className: 'number' }));
  const node = element('tr', {}, element('th', { scope: 'row' }, bus.name, element('span', { className: 'quiet' }, ` ${bus.interface}`)),
    element('td', {}, state), element('td', { className: 'load' }, meter, load), ...figures);
  const update = (now) => {
    setText(state, now.state);
    setClass(state, `badge ${MOODS[now.state] ?? 'bad'}`);
    meter.hidden = now.load === null;
    meter.value = now.load ?? 0;
    setText(load, percentText(now.load));
    const texts = [percentText(now.highest_load), now.transmit_errors, now.receive_errors,
      `${now.error_frames} of 10 000`, now.bus_off_events, now.frames_lost, marginText(now.heartbeat_margin)];
    texts.forEach((text, i) => setText(figures[i], String(text)));
  };
  return { node, update };
}

function makeSuspicion(bus) {
  const text = element('span');
  return { node: element('li', {}, element('strong', {}, bus.name), text), update: (now) => setText(text, now.suspicion) };
}
