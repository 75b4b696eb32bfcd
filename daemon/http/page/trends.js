// Trend lines of the last ten minutes, of the drives that are open. Drawn by dygraphs; where the gateway's machine does
// not have it, there are none.
import { element } from './dom.js';
import { ask } from './link.js';
import { clockText, decimalsOf } from './words.js';

const SAMPLES = 600;
const SPAN = SAMPLES * 1000;
const LEAST_SPAN = 60000;
const DRAW_EVERY = 2;  // samples
const MOST_CHARTS = 6;

let library = null;

// Its legend sets inline styles, which this page's policy refuses.
function loadLibrary() {
  library ??= new Promise((resolve) => {
    const loaded = () => {
      const Dygraph = globalThis.Dygraph ?? null;
      if (Dygraph) {
        Dygraph.PLUGINS = Dygraph.PLUGINS.filter((plugin) => plugin !== Dygraph.Plugins.Legend);
      }
      resolve(Dygraph);
    };
    const script = element('script', { src: 'page/dygraph.js', onload: loaded, onerror: loaded });
    document.head.append(script);
  });
  return library;
}

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const rest = () => new Promise((resolve) => setTimeout(resolve, 0));

/** Of one drive. */
export class Trends {
  #card;
  #signals;
  #place;
  #clock;
  #charts = [];
  #samples = 0;
  #renewal = 0;  // the newest; an older one that is under way ends
  #timer;
  #scheme = matchMedia('(prefers-color-scheme: dark)');
  #recolour = () => this.#charts.forEach((chart) => chart.recolour());

  constructor(card, signals, place, clock) {
    this.#card = card;
    this.#signals = signals;
    this.#place = place;
    this.#clock = clock;
    this.#scheme.addEventListener('change', this.#recolour);
    this.#timer = setInterval(() => this.#sample(), 1000);
    this.renew();
  }

  stop() {
    clearInterval(this.#timer);
    ++this.#renewal;
    this.#scheme.removeEventListener('change', this.#recolour);
    this.#clear();
  }

  /** Asks for the past again. */
  async renew() {
    const renewal = ++this.#renewal;
    const Dygraph = await loadLibrary();
    let history = null;
    try {
      history = Dygraph && await ask(`api/history?drive=${encodeURIComponent(this.#card.name)}`);
    } catch {
      // The link begins again, and then this is asked again.
    }
    if (!history || renewal !== this.#renewal) {
      return;
    }
    this.#clear();
    const shown = this.#signals.filter((signal) => signal.unit !== '' && history.signals.includes(signal.name));
    for (const signal of shown.slice(0, MOST_CHARTS)) {
      await rest();  // A chart takes some milliseconds; nobody waits for all of them.
      if (renewal === this.#renewal) {
        this.#charts.push(new Chart(Dygraph, this.#card.name, signal, rowsOf(history, signal), this.#place));
      }
    }
  }

  #clear() {
    this.#charts.forEach((chart) => chart.remove());
    this.#charts = [];
  }

  #sample() {
    const draw = ++this.#samples % DRAW_EVERY === 0 && !document.hidden;
    const values = this.#clock.live ? this.#card.newest?.values : undefined;
    this.#charts.forEach((chart, i) => {
      chart.add(this.#clock.now(), values?.[chart.signal.name] ?? null);
      if (draw) {
        setTimeout(() => chart.draw(), 20 * i);
      }
    });
  }
}

function rowsOf(history, signal) {
  const column = history.signals.indexOf(signal.name) + 1;
  return history.samples.map((sample) => [Date.parse(sample[0]), sample[column]]);
}

/** From the least to the greatest value, but never less than some steps of it: noise is no event. */
export function rangeOf(rows, scale) {
  const values = rows.map((row) => row[1]).filter((value) => value !== null);
  const low = Math.min(...values);
  const high = Math.max(...values);
  if (values.length === 0) {
    return [0, 1];
  }
  const least = Math.max(20 * scale, Math.abs(high) * 0.05);
  const room = Math.max(least - (high - low), (high - low) * 0.1) / 2;
  return [low >= 0 && low - room < 0 ? 0 : low - room, high + room];
}

class Chart {
  #rows;
  #graph;
  #canvas;
  #seen = false;
  #observer;

  constructor(Dygraph, drive, signal, rows, place) {
    this.signal = signal;
    this.#rows = rows;
    this.#canvas = element('div', { className: 'chart', role: 'img' });
    this.node = element('figure', {}, element('figcaption', {}, `${signal.name}, ${signal.unit}`), this.#canvas);
    place.append(this.node);
    this.#graph = new Dygraph(this.#canvas, rows.length > 0 ? rows : [[Date.now(), null]], this.#options());
    this.#describe(drive);
    this.#observer = new IntersectionObserver(([entry]) => {
      this.#seen = entry.isIntersecting;
    });
    this.#observer.observe(this.#canvas);
  }

  add(time, value) {
    this.#rows.push([time, value]);
    if (this.#rows.length > SAMPLES) {
      this.#rows.shift();
    }
  }

  draw() {
    if (this.#seen && this.node.isConnected && this.#rows.length > 0) {
      this.#graph.updateOptions({ file: this.#rows, ...this.#window() });
    }
  }

  recolour() {
    this.#graph.updateOptions(this.#options());
  }

  remove() {
    this.#observer.disconnect();
    this.#graph.destroy();
    this.node.remove();
  }

  // Once: whoever listens to a page wants no figure that moves by itself. The values stand above.
  #describe(drive) {
    const values = this.#rows.map((row) => row[1]).filter((value) => value !== null);
    const text = (value) => value.toFixed(decimalsOf(this.signal.scale));
    const range = values.length > 0 ? `from ${text(Math.min(...values))} to ${text(Math.max(...values))} ${this.signal.unit}` : 'no values';
    this.#canvas.setAttribute('aria-label', `${drive}: ${this.signal.name} of the last ten minutes, ${range}`);
  }

  #window() {
    const end = this.#rows.at(-1)?.[0] ?? Date.now();
    const begin = Math.min(this.#rows[0]?.[0] ?? end, end - LEAST_SPAN);
    return { dateWindow: [Math.max(begin, end - SPAN), end], valueRange: rangeOf(this.#rows, this.signal.scale) };
  }

  #options() {
    const grid = colour('--edge');
    return { labels: ['time', 'value'], legend: 'never', colors: [colour('--line')], strokeWidth: 1.6,
      highlightCircleSize: 0, gridLineColor: grid, axisLineColor: grid, interactionModel: {}, ...this.#window(),
      axes: { x: { axisLabelFormatter: (time) => clockText(time).slice(-8, -3), drawGrid: false, pixelsPerLabel: 70 },
        y: { axisLabelWidth: 44, pixelsPerLabel: 26 } } };
  }
}
