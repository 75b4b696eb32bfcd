// How frames of the trace are said. Nothing here knows of the page.
import { clockText } from './words.js';

/** Time of day with microseconds, the COB-ID, and what it is; a frame of the gateway's own is marked. */
export function frameCells(frame) {
  return {
    time: `${clockText(frame.ts)}.${frame.ts.slice(20, 26)}`,
    id: frame.kind === 'error' ? '' : frame.frame.split('#')[0],
    name: frame.own ? `${frame.name} (ours)` : frame.name,
  };
}

export function lostText(lost) {
  return `Up to ${lost.frames} frame${lost.frames === 1 ? ' is' : 's are'} not shown here: they came too fast.`;
}
