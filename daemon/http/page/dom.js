// Nodes are made and changed here. Text is only ever set as text: names and texts of drives and clients are foreign.

/** A new node: properties of the node, else attributes; then its children, nodes or text. */
export function element(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in node) {
      node[name] = value;
    } else {
      node.setAttribute(name, value);
    }
  }
  node.append(...children);
  return node;
}

export function byId(id) {
  return document.getElementById(id);
}

/** Sets text that differs. A node that stays as it is costs no layout. */
export function setText(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

export function setClass(node, name) {
  if (node.className !== name) {
    node.className = name;
  }
}

/** A time of day, with the whole of it for programs. */
export function timeNode(text, iso) {
  return element('time', { dateTime: iso }, text);
}

/**
 * Has one child of `parent` for each item, in their order. Children stay where their item does: `make(item)` gives
 * `{node, update(item)}`; `kept` is a map of key to these, owned by the caller.
 */
export function reconcile(parent, kept, items, keyOf, make) {
  const keys = new Set(items.map(keyOf));
  for (const [key, child] of kept) {
    if (!keys.has(key)) {
      child.node.remove();
      kept.delete(key);
    }
  }
  let place = parent.firstElementChild;
  for (const item of items) {
    const key = keyOf(item);
    let child = kept.get(key);
    if (!child) {
      child = make(item);
      kept.set(key, child);
    }
    child.update(item);
    if (child.node === place) {
      place = place.nextElementSibling;
    } else {
      parent.insertBefore(child.node, place);
    }
  }
}
