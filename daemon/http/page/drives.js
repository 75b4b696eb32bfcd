// All drives. What is told of them is kept, the newest of each, and shown piece by piece between the browser's frames,
// so that a plant with many drives never keeps the page from answering its reader.
import { byId } from './dom.js';
import { DriveCard } from './drive_card.js';

const FEW = 4;              // drives; more are searched
const WORK_IN_FRAME = 6;    // ms
const MAKE_AT_ONCE = 10;

export class Drives {
  #list = byId('drive-list');
  #none = byId('no-drive');
  #filter = byId('drive-filter');
  #cards = new Map();
  #waiting = new Set();
  #planned = false;

  async make(map, clock) {
    byId('drive-filter-label').hidden = map.drives.length <= FEW;
    this.#filter.addEventListener('input', () => this.#showFiltered());
    for (const [i, drive] of map.drives.entries()) {
      const card = new DriveCard(drive, clock);
      this.#cards.set(drive.name, card);
      this.#list.append(card.node);
      if (i % MAKE_AT_ONCE === MAKE_AT_ONCE - 1) {
        await new Promise((resolve) => setTimeout(resolve));
      }
    }
    addEventListener('hashchange', () => this.#openTarget());
  }

  tell(drive) {
    const card = this.#cards.get(drive.name);
    if (card) {
      card.newest = drive;
      this.#waiting.add(card);
      this.#plan();
    }
  }

  /** The connection is lost: when it stands again, a drive counts as old until it is told of. */
  forget() {
    this.#cards.forEach((card) => card.markOld());
  }

  renewTrends() {
    this.#cards.forEach((card) => card.renewTrends());
  }

  #plan() {
    if (!this.#planned) {
      this.#planned = true;
      requestAnimationFrame(() => this.#work());
    }
  }

  #work() {
    this.#planned = false;
    const end = performance.now() + WORK_IN_FRAME;
    for (const card of this.#waiting) {
      this.#waiting.delete(card);
      card.show();
      if (performance.now() > end) {
        this.#plan();
        break;
      }
    }
    if (this.#filter.value !== '') {
      this.#showFiltered();
    }
  }

  #showFiltered() {
    const words = this.#filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const card of this.#cards.values()) {
      const shown = words.every((word) => card.newest && card.text.includes(word));
      card.node.hidden = !shown;
      found += shown ? 1 : 0;
    }
    this.#none.hidden = found > 0;
  }

  #openTarget() {
    const node = document.getElementById(location.hash.slice(1));
    for (const card of this.#cards.values()) {
      if (card.node === node) {
        card.open();
      }
    }
  }
}
