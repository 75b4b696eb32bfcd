// The active alarms, oldest first, and what is read out of their changes.
import { byId, element, reconcile, setClass, setText, timeNode } from './dom.js';
import { alarmKey, alarmNews, alarmText, clockText, placeOf } from './words.js';

export class Alarms {
  #list = byId('alarm-list');
  #none = byId('no-alarm');
  #announcer = byId('announcer');
  #kept = new Map();
  #alarms = [];
  #announced = -Infinity;

  get count() {
    return this.#alarms.length;
  }

  show(alarms) {
    const news = alarmNews(this.#alarms, alarms);
    this.#alarms = alarms;
    reconcile(this.#list, this.#kept, alarms, alarmKey, makeAlarm);
    this.#none.hidden = alarms.length > 0;
    setText(this.#none, 'No alarm is active.');
    if (news !== '') {
      this.announce(news);
    }
  }

  /** What comes within a second is told with what came before, which may not have been read yet. */
  announce(text) {
    const now = performance.now();
    const before = now - this.#announced < 1000 ? `${this.#announcer.textContent}. ` : '';
    this.#announcer.textContent = before + text;
    this.#announced = now;
  }
}

function makeAlarm(alarm) {
  const severity = element('span');
  const first = element('span', { className: 'badge first', title: 'no other fault came in the 2 s before' }, 'first');
  const place = alarm.drive === undefined ? element('strong', {}, `bus ${placeOf(alarm)}`)
    : element('a', { href: `#drive-${encodeURIComponent(alarm.drive)}` }, alarm.drive);
  const kind = element('span', { className: 'quiet' }, alarm.kind);
  const text = element('span', { className: 'text' });
  const since = element('span', { className: 'quiet since' });
  const record = element('a', { className: 'record' }, 'record');
  const node = element('li', {}, severity, first, place, kind, text, since, record);
  let shownSince = '';
  const update = (now) => {
    setText(severity, now.severity);
    setClass(severity, `badge ${now.severity === 'fault' ? 'bad' : 'warn'}`);
    setClass(node, now.severity);
    first.hidden = !now.first;
    setText(text, alarmText(now));
    record.hidden = now.record === undefined;
    if (!record.hidden) {
      record.href = `/records/${encodeURIComponent(now.record)}`;
      record.title = `frames around it: ${now.record}`;
    }
    if (shownSince !== now.since) {
      shownSince = now.since;
      since.replaceChildren('since ', timeNode(clockText(now.since), now.since));
    }
  };
  return { node, update };
}
