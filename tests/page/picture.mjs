// Makes docs/page.png, the picture of the page in the README: `node tests/page/picture.mjs`, two minutes long.
import path from 'node:path';
import { setTimeout as rest } from 'node:timers/promises';
import { Demo, demoSite, openBrowser, openPage, root, until } from './support.mjs';

const demo = await Demo.start((...ports) => demoSite(...ports).replace('name = "demo"', 'name = "line3"'));
const browser = await openBrowser();
try {
  await until('all drives are online', async () => (await demo.get('health')).drives_online === 4);
  for (const frequency of [30, 42, 18, 35]) {
    await demo.command('set', 'pump1', `frequency_command=${frequency}`, 'torque_command=0', 'control_command=forward');
    await demo.command('set', 'hoist1', `frequency_command=${60 - frequency}`, 'control_command=forward');
    await rest(25000);
  }
  demo.order('3 fault 5');
  demo.order('9 unplug on');
  const { page } = await openPage(browser, demo.url, { viewport: { width: 1100, height: 780 } });
  await until('the alarms are shown', async () => await page.locator('#alarm-list > li').count() === 2);
  await page.locator('#drive-pump1 summary').click();
  await page.mouse.move(0, 0);
  await until('charts', async () => await page.locator('#drive-pump1 canvas').count() === 12);
  await until('the records are there', async () => await page.locator('a.record:visible').count() === 2);
  await rest(4000);
  await page.evaluate(() => document.activeElement.blur());
  await page.screenshot({ path: path.join(root, 'docs/page.png') });
} finally {
  await browser.close();
  await demo.end();
}
