// The connection to the gateway. It counts as standing while the stream is open and a question is answered every other
// second; else everybody is told that what is shown is old.
import { EventParser } from './events.js';

const ASK_EVERY = 2000;
const ANSWER_WITHIN = 3000;
const OLD_AFTER = 6500;
const SILENCE = 20000;  // a stream tells something every 15 s
const AGAIN_AFTER = 1500;

/** An answer of the API, or an error where there is none in time. */
export async function ask(path) {
  const answer = await fetch(path, { cache: 'no-store', signal: AbortSignal.timeout(ANSWER_WITHIN) });
  if (!answer.ok) {
    throw new Error(`${path}: ${answer.status}`);
  }
  return answer.json();
}

export class Link {
  #told;
  #streaming = false;
  #answered = 0;  // when, 0: not yet
  #live = false;
  #ahead = 0;     // of the gateway's clock, in ms
  #asking = false;

  /** `told`: {gateway(json), event(name, json), live(yes)} */
  constructor(told) {
    this.#told = told;
  }

  start() {
    this.#stream();
    this.#ask();
    setInterval(() => this.#ask(), ASK_EVERY);
    setInterval(() => this.#judge(), 1000);
    document.addEventListener('visibilitychange', () => {
      this.#judge();
      this.#ask();
    });
  }

  get live() {
    return this.#live;
  }

  /** The gateway's time of day, in ms. */
  now() {
    return Date.now() + this.#ahead;
  }

  async #ask() {
    if (this.#asking) {
      return;
    }
    this.#asking = true;
    try {
      const gateway = await ask('api/gateway');
      this.#answered = Date.now();
      this.#ahead = Date.parse(gateway.health.ts) - this.#answered;
      this.#told.gateway(gateway);
    } catch {
      this.#answered = 0;
    }
    this.#asking = false;
    this.#judge();
  }

  // A page in the background is asked rarely, and nobody looks at it.
  #judge() {
    const old = this.#answered === 0 || (!document.hidden && Math.abs(Date.now() - this.#answered) > OLD_AFTER);
    const live = this.#streaming && !old;
    if (live !== this.#live) {
      this.#live = live;
      this.#told.live(live);
    }
  }

  async #stream() {
    for (;;) {
      try {
        await this.#readStream();
      } catch {
        // Whatever it was: it is begun again.
      }
      this.#streaming = false;
      this.#judge();
      await new Promise((resolve) => setTimeout(resolve, AGAIN_AFTER));
    }
  }

  async #readStream() {
    const stop = new AbortController();
    let silence = setTimeout(() => stop.abort(), SILENCE);
    try {
      const answer = await fetch('api/live', { cache: 'no-store', signal: stop.signal });
      if (!answer.ok) {
        return;
      }
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      const parser = new EventParser();
      for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
        clearTimeout(silence);
        silence = setTimeout(() => stop.abort(), SILENCE);
        for (const event of parser.push(piece.value)) {
          this.#told.event(event.name, JSON.parse(event.data));
        }
        this.#streaming = true;
        this.#judge();
      }
    } finally {
      clearTimeout(silence);
      stop.abort();
    }
  }
}
