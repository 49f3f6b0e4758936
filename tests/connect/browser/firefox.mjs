// SPDX-License-Identifier: Apache-2.0
// Firefox without a window, driven by lines of JSON: [act, ...arguments] on standard input. Each line is answered by a
// line {"value"} or {"error"} on standard output. Puppeteer drives Firefox over WebDriver BiDi.
//
//   node firefox.mjs /usr/bin/firefox-esr /path/to/puppeteer-core

import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const [program, puppeteerFolder] = process.argv.slice(2);
const entry = "lib/esm/puppeteer/puppeteer-core.js";
const { default: puppeteer } = await import(pathToFileURL(`${puppeteerFolder}/${entry}`));
let browser = await puppeteer.launch({ browser: "firefox", executablePath: program, headless: true });
const firefox = browser.process();
const endpoint = browser.wsEndpoint();
const complaints = []; // errors and warnings that the pages have caused
const tabs = [];
let page = await newTab(); // the tab in front

async function newTab() {
  const tab = watched(await browser.newPage());
  await tab.setViewport({ width: 1280, height: 800 });
  tabs.push(tab);
  return tab;
}

function watched(tab) {
  tab.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) complaints.push(message.text());
  });
  tab.on("dialog", (dialog) => dialog.accept()); // the question before a page with unsaved changes is left
  tab.on("pageerror", (error) => complaints.push(String(error)));
  return tab;
}

// The middle of an element in the window, as soon as it no longer moves. Another element may take its place meanwhile.
async function middle(selector) {
  for (let before = ""; ; ) {
    const element = await page.waitForSelector(selector, { timeout: 30000 });
    const place = await element.evaluate((each) => {
      each.scrollIntoView({ block: "nearest" });
      const { x, y, width, height } = each.getBoundingClientRect();
      return each.isConnected ? [x + width / 2, y + height / 2] : null;
    });
    if (place && place.join() === before) return place;
    before = place?.join() ?? "";
  }
}

const acts = {
  open: async (address) => void (await page.goto(address)),
  newTab: async () => {
    page = await newTab();
  },
  showTab: async (number) => {
    page = tabs[number];
    await page.bringToFront();
  },
  closeTab: async () => {
    await tabs.pop().close();
    page = tabs.at(-1);
  },
  evaluate: (expression) => page.evaluate(expression),
  click: async (selector) => page.mouse.click(...(await middle(selector))),
  hold: async (selector, ms) => {
    await page.mouse.click(...(await middle(selector)), { delay: ms });
  },
  drag: async (from, to) => {
    const start = await middle(from);
    await page.mouse.move(...start);
    await page.mouse.down();
    await page.mouse.move(start[0] + 30, start[1] + 10, { steps: 3 });
    await page.mouse.move(...(await middle(to)), { steps: 5 });
    await page.mouse.up();
  },
  focus: (selector) => page.focus(selector),
  press: (key, delay) => page.keyboard.press(key, { delay }),
  down: (key) => page.keyboard.down(key),
  up: (key) => page.keyboard.up(key),
  type: (text) => page.keyboard.type(text),
  resize: (width, height) => page.setViewport({ width, height }),
  screenshot: async (path) => void (await page.screenshot({ path })),
  follow: async (link, expression) => {
    const created = new Promise((resolve) => browser.once("targetcreated", resolve));
    await acts.click(link);
    const tab = await (await created).page();
    let value = null;
    for (let turn = 0; !value && turn < 1000; turn++) value = await tab.evaluate(expression).catch(() => null);
    await tab.close();
    return value;
  },
  complaints: () => complaints.splice(0),
  // Firefox keeps a record of each request for the program that drives it: on a live page 0.3 MB in a second.
  leave: () => browser.disconnect(),
  comeBack: async () => {
    browser = await puppeteer.connect({ browserWSEndpoint: endpoint, protocol: "webDriverBiDi" });
    const pages = await browser.pages(); // the first ones are not from newTab()
    tabs.splice(0, tabs.length, ...pages.slice(-tabs.length).map(watched));
    page = tabs.at(-1);
  },
};

for await (const line of createInterface({ input: process.stdin })) {
  const [act, ...rest] = JSON.parse(line);
  let answer;
  try {
    answer = { value: (await acts[act](...rest)) ?? null };
  } catch (error) {
    answer = { error: String(error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
await browser.close();
firefox.kill();
