// Server-sent events from text as it comes, whatever its pieces (HTML Standard, section 9.2.6). A browser's own
// EventSource does not tell of the comments by which a silent stream shows that it lives.

export class EventParser {
  #rest = '';

  /** The events that are complete with this piece: `{name, data}`. */
  push(text) {
    const blocks = (this.#rest + text).split('\n\n');
    this.#rest = blocks.pop();
    return blocks.map(readEvent).filter((event) => event.data !== '');
  }
}

function readEvent(block) {
  const event = { name: 'message', data: '' };
  for (const line of block.split('\n')) {
    if (line.startsWith('event: ')) {
      event.name = line.slice(7);
    } else if (line.startsWith('data: ')) {
      event.data += line.slice(6);
    }
  }
  return event;
}
