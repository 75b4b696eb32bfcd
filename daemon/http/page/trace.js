// The decoded frames of one drive, while somebody wants to see them: nothing is asked for before. The newest stands on top.
import { byId, element, setText, timeNode } from './dom.js';
import { EventParser } from './events.js';
import { frameCells, lostText } from './frames.js';

const KEPT = 300;       // lines
const AT_ONCE = 100;    // that wait for the browser's next frame; of a fast bus the rest is passed over, and counted

export class Trace {
  #drive = byId('trace-drive');
  #kind = byId('trace-kind');
  #button = byId('trace-run');
  #note = byId('trace-note');
  #rows = byId('trace-rows');
  #stop = null;
  #waiting = [];
  #passedOver = 0;

  start(drives) {
    this.#drive.append(...drives.map((drive) => element('option', { value: drive.name }, `${drive.name} (${drive.bus}, node ${drive.node})`)));
    this.#button.addEventListener('click', () => (this.#stop ? this.#pause('Paused.') : this.#run()));
    for (const choice of [this.#drive, this.#kind]) {
      choice.addEventListener('change', () => this.#stop && this.#run());
    }
  }

  #pause(why) {
    this.#stop?.abort();
    this.#stop = null;
    setText(this.#button, 'Show');
    setText(this.#note, why);
  }

  async #run() {
    this.#stop?.abort();
    const stop = new AbortController();
    this.#stop = stop;
    this.#rows.replaceChildren();
    this.#waiting = [];
    setText(this.#button, 'Pause');
    setText(this.#note, 'Live.');
    let why = 'The stream has ended.';
    try {
      await this.#read(stop);
    } catch (error) {
      why = `No trace: ${error.message}`;
    }
    if (this.#stop === stop) {
      this.#pause(why);
    }
  }

  async #read(stop) {
    const wanted = new URLSearchParams({ drive: this.#drive.value, kind: this.#kind.value });
    const answer = await fetch(`api/trace?${wanted}`, { cache: 'no-store', signal: stop.signal });
    if (!answer.ok) {
      throw new Error((await answer.json()).error);
    }
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    const parser = new EventParser();
    for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
      parser.push(piece.value).forEach((event) => this.#take(event));
    }
  }

  #take(event) {
    if (this.#waiting.length === 0) {
      requestAnimationFrame(() => this.#show());
    }
    this.#waiting.push({ name: event.name, told: JSON.parse(event.data) });
    if (this.#waiting.length > AT_ONCE) {
      this.#waiting.shift();
      this.#passedOver += 1;
    }
  }

  #show() {
    if (this.#passedOver > 0) {
      this.#waiting.unshift({ name: 'lost', told: { frames: this.#passedOver } });
      this.#passedOver = 0;
    }
    this.#rows.prepend(...this.#waiting.reverse().map(makeRow));
    this.#waiting = [];
    while (this.#rows.childElementCount > KEPT) {
      this.#rows.lastElementChild.remove();
    }
  }
}

function makeRow({ name, told }) {
  if (name === 'lost') {
    return element('tr', {}, element('td', { className: 'text outcome warn', colSpan: 4 }, lostText(told)));
  }
  const cells = frameCells(told);
  return element('tr', {}, element('td', {}, timeNode(cells.time, told.ts)), element('td', {}, cells.id),
    element('td', {}, cells.name), element('td', { className: 'text' }, told.text));
}
