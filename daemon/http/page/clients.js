// Who is connected, the broker, and the gateway itself.
import { byId, element, reconcile, setText } from './dom.js';
import { clockText, durationText, NONE } from './words.js';

export class Clients {
  #lists = byId('client-lists');
  #kept = new Map();

  show(gateway) {
    const lists = [brokerFacts(gateway), modbusFacts(gateway), pageFacts(gateway), programFacts(gateway)];
    reconcile(this.#lists, this.#kept, lists, (list) => list.title, makeList);
  }
}

function brokerFacts({ health, mqtt }) {
  if (!mqtt) {
    return { title: 'MQTT', facts: [['Broker', 'not configured']] };
  }
  const facts = [['Broker', health.broker ?? 'no connection'], ['Protocol', health.protocol ?? NONE],
    ['Published', mqtt.published], ['Dropped', health.messages_dropped + health.answers_dropped],
    ['Last break', health.last_break ?? 'none']];
  if (health.refused_subscriptions.length > 0) {
    facts.push(['Refused subscriptions', health.refused_subscriptions.join(', ')]);
  }
  if (health.another_instance !== null) {
    facts.push(['Another gateway of this name', health.another_instance]);
  }
  return { title: 'MQTT', facts };
}

function modbusFacts({ modbus }) {
  return { title: 'Modbus', facts: modbus
    ? [['Clients', modbus.clients], ['Refused', modbus.refused], ['Requests', modbus.requests],
      ['Exceptions', modbus.exceptions]]
    : [['Server', 'not configured']] };
}

function pageFacts({ http, journal }) {
  return { title: 'HTTP and journal', facts: [['Clients', http.clients], ['Refused', http.refused],
    ['Journal', journal ? 'written' : 'none'], ['Lines lost', journal?.lost ?? NONE],
    ['Commands that did not wait', journal?.passed_by ?? NONE]] };
}

function programFacts({ version, health }) {
  const facts = [['Version', version], ['Up', durationText(health.uptime)], ['Gateway time', clockText(health.ts)],
    ['Memory', `${(health.memory / 1048576).toFixed(1)} MB`], ['Log messages lost', health.log_messages_lost]];
  if (health.clock === 'unset') {
    facts.push(['Clock', 'nobody has set it since the start']);
  }
  return { title: 'Gateway', facts };
}

function makeList(list) {
  const facts = element('dl');
  const kept = new Map();
  const node = element('div', {}, element('h3', {}, list.title), facts);
  const update = (now) => reconcile(facts, kept, now.facts, ([name]) => name, makeFact);
  return { node, update };
}

function makeFact([name]) {
  const value = element('dd');
  const node = element('div', {}, element('dt', {}, name), value);
  return { node, update: ([, text]) => setText(value, String(text)) };
}
