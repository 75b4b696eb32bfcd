// The register and topic map: a table that is searched. More rows than anybody reads are not made.
import { byId, element } from './dom.js';
import { findRows, mapRows } from './search.js';

const MOST_ROWS = 100;
const ROWS_UNASKED = 12;

export function showMap(map) {
  const rows = mapRows(map);
  const table = byId('map-rows');
  const count = byId('map-count');
  const field = byId('map-search');
  const show = () => {
    const found = findRows(rows, field.value);
    const most = field.value.trim() === '' ? ROWS_UNASKED : MOST_ROWS;
    table.replaceChildren(...found.slice(0, most).map(makeRow));
    count.textContent = found.length > most ? `the first ${most} of ${found.length}` : `${found.length} found`;
  };
  field.addEventListener('input', show);
  show();
}

function makeRow(row) {
  const [drive, ...cells] = row.cells;
  return element('tr', {}, element('th', { scope: 'row' }, drive),
    ...cells.map((cell, i) => element('td', i === cells.length - 1 ? { className: 'topics' } : {}, cell)));
}
