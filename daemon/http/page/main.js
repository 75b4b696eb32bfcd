// Puts the page together: who is told what.
import { Alarms } from './alarms.js';
import { Buses } from './buses.js';
import { Clients } from './clients.js';
import { Commands } from './commands.js';
import { byId, setClass, setText } from './dom.js';
import { Drives } from './drives.js';
import { ask, Link } from './link.js';
import { showMap } from './map.js';
import { Trace } from './trace.js';
import { clockText } from './words.js';

const alarms = new Alarms();
const buses = new Buses();
const clients = new Clients();
const drives = new Drives();
let name = '';
let instance = '';
let version = '';
let mapText = '';
let wasLost = false;

function showHead(live) {
  const count = alarms.count;
  setText(byId('link'), live ? 'live' : 'no connection');
  setClass(byId('link'), `badge ${live ? 'good' : 'bad'}`);
  document.title = `${live ? '' : 'away: '}${count > 0 ? `(${count}) ` : ''}${name || 'canopen-gateway'}`;
}

function onGateway(gateway) {
  const life = `${gateway.health.instance} ${gateway.configuration}`;
  if (instance !== '' && instance !== life) {
    compare(gateway.version);
  }
  instance = life;
  version ||= gateway.version;
  name = gateway.name;
  setText(byId('gateway'), name);
  setText(byId('summary'), `${gateway.health.drives_online} of ${gateway.health.drives} drives online`);
  buses.show(gateway.buses.map((bus, i) => ({ ...bus, ...gateway.health.buses[i] })));
  clients.show(gateway);
}

// Another life of the gateway, and one that was reloaded, may have another configuration, or bring another page.
async function compare(newVersion) {
  try {
    const map = await ask('api/map');
    if (newVersion !== version || JSON.stringify(map) !== mapText) {
      location.reload();
    }
  } catch {
    instance = 'unknown';  // It is looked at again with the next answer.
  }
}

function onEvent(event, told) {
  if (event === 'drive') {
    drives.tell(told);
  } else if (event === 'alarms') {
    alarms.show(told);
    showHead(link.live);
  }
}

function onLive(live) {
  showHead(live);
  document.body.classList.toggle('away', !live);
  const note = byId('away');
  note.hidden = live;
  if (live) {
    drives.renewTrends();
    if (wasLost) {
      alarms.announce('The connection stands again.');
    }
  } else {
    wasLost = true;
    drives.forget();
    const since = clockText(new Date().toISOString());
    setText(note, `No connection to the gateway since ${since}. Everything below is as it was then. It is tried again.`);
    alarms.announce('The connection to the gateway is lost. What is shown is old.');
  }
}

const link = new Link({ gateway: onGateway, event: onEvent, live: onLive });

async function begin() {
  for (;;) {
    try {
      const map = await ask('api/map');
      mapText = JSON.stringify(map);
      await drives.make(map, link);
      link.start();
      new Commands().start();
      new Trace().start(map.drives);
      showMap(map);
      return;
    } catch {
      showHead(false);
      await new Promise((resolve) => setTimeout(resolve, 2000));
    }
  }
}

begin();
