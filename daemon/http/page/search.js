// The register and topic map, as rows that can be searched.

/** `5: register 2`, and where it stands in the flat unit. */
export function modbusText(drive, signal, flatUnit) {
  if (!signal.modbus || drive.modbus_unit === null) {
    return '';
  }
  const { kind, address, count, flat } = signal.modbus;
  const range = (from) => (count > 1 ? `${from}–${from + count - 1}` : String(from));
  const own = `${drive.modbus_unit}: ${kind} ${range(address)}`;
  return flat === undefined ? own : `${own}; ${flatUnit}: ${kind} ${range(flat)}`;
}

/** Everything of the map, row by row; `text` is what is searched. */
export function mapRows(map) {
  return map.drives.flatMap((drive) => drive.signals.map((signal) => {
    const cells = [drive.name, signal.name, signal.unit, modbusText(drive, signal, map.flat_unit), signal.object,
      signal.type, String(signal.scale), signal.access, signal.source,
      [signal.mqtt.topic, signal.mqtt.set].filter(Boolean).join('\n')];
    return { cells, text: cells.join(' ').toLowerCase() };
  }));
}

/** The rows that have every word of the question. */
export function findRows(rows, question) {
  const words = question.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter((row) => words.every((word) => row.text.includes(word)));
}
