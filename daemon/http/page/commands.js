// The newest commands of the journal. Nobody tells of new ones, so it is asked while one can see them.
import { byId, element, timeNode } from './dom.js';
import { commandText, newestCommands, outcomeText, writerText } from './journal.js';
import { ask } from './link.js';
import { clockText } from './words.js';

const ASK_EVERY = 3000;

export class Commands {
  #rows = byId('command-rows');
  #none = byId('no-command');
  #seen = false;
  #shown = '';

  start() {
    new IntersectionObserver(([entry]) => {
      this.#seen = entry.isIntersecting;
      this.#ask();
    }).observe(byId('commands'));
    setInterval(() => this.#ask(), ASK_EVERY);
  }

  async #ask() {
    if (!this.#seen || document.hidden) {
      return;
    }
    try {
      this.#show(await ask('api/commands?count=100'));
    } catch (error) {
      if (error.message.endsWith(' 404')) {
        this.#none.textContent = 'This gateway keeps no journal of commands.';
      }
      // Otherwise what is shown stays; the link tells that it is old.
    }
  }

  #show(lines) {
    const commands = newestCommands(lines).slice(0, 50);
    const shown = JSON.stringify(commands);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.#rows.replaceChildren(...commands.map(makeRow));
    this.#none.hidden = commands.length > 0;
  }
}

function makeRow(line) {
  const outcome = outcomeText(line);
  const count = line.count > 1 && line.phase === 'done' ? ` (${line.count} times)` : '';
  return element('tr', {}, element('td', {}, timeNode(clockText(line.ts), line.ts)),
    element('td', {}, line.drive ?? ''), element('td', {}, writerText(line)),
    element('td', { className: 'text' }, commandText(line) + count),
    element('td', { className: `text outcome ${outcome.mood}` }, outcome.word),
    element('td', { className: 'number' }, line.ms === undefined ? '' : `${line.ms} ms`));
}
