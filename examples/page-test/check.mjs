// Opens the page of a run in headless Chromium, from disk and without a network: it plays, seeks, says nothing
// on the console, and its numbers are those of the program's table. Prints what it measured as JSON.
//
// Usage: node check.mjs PAGE OUTPUT [least pictures a second]; OUTPUT is what `follow --json` or
// `experiment … --json` printed when it wrote the page.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, statSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [path, output, least = "0"] = process.argv.slice(2);
const printed = readFileSync(output, "utf8").trimEnd().split("\n");
const line = JSON.parse(printed.at(-1));
// An experiment has many cases, of which the page shows one.
const summary = line.shown ?? line;
const file = resolve(path);
const folder = dirname(file);
const address = pathToFileURL(file).href;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  // The processor draws, as on a machine without a graphics card.
  args: ["--enable-unsafe-swiftshader"],
});
const context = await browser.newContext({ viewport: { width: 1500, height: 950 }, offline: true });
const page = await context.newPage();
const system = await browser.newBrowserCDPSession();
/** What all processes of the browser have taken of the processor (s). */
async function processorTime() {
  const { processInfo } = await system.send("SystemInfo.getProcessInfo");
  return processInfo.reduce((sum, process) => sum + process.cpuTime, 0);
}
const said = [];
page.on("console", (message) => {
  // Without a graphics card the browser itself reads pictures back, and its driver warns of that.
  if (!message.text().includes("GL Driver Message")) said.push(`${message.type()}: ${message.text()}`);
});
page.on("pageerror", (error) => said.push(`error: ${error.message}`));
const requests = [];
page.on("request", (request) => {
  if (!request.url().startsWith("data:")) requests.push(request.url());
});

try {
  await page.goto(address);
  await page.waitForFunction(() => window.viewer?.complete, null, { timeout: 60000 });
  const firstPicture = await page.evaluate(() => viewer.firstPicture);
  assert.equal(await page.locator("#flat").textContent(), "", "the scene is drawn");

  // Its numbers are the table's.
  const held = await page.evaluate(() => viewer.page.results.summary);
  for (const [key, value] of Object.entries(held)) assert.deepEqual(value, summary[key], key);
  const cell = (row, column) =>
    page.locator("#results tbody tr").nth(row).locator("td").nth(column).textContent();
  const both = summary.score_mean_off !== null;
  assert.equal(await cell(0, 0), summary.score_mean_on.toFixed(2));
  if (both) assert.equal(await cell(0, 1), summary.score_mean_off.toFixed(2));
  if (line.shown) {
    const table = printed.slice(0, -1).join("\n").trimEnd();
    assert.equal(await page.locator("#cases").textContent(), table, "the table of all cases");
  }
  // The states of each run, and the changes of phase that the program prints of the first case.
  const lanes = await page.evaluate(() => viewer.page.runs.map((run) => run.lanes));
  for (const lane of lanes)
    for (const name of ["phase", "intention", "safety", "base"])
      assert.ok(lane.find((one) => one.name === name)?.spans.length > 0, `the states of ${name}`);
  const times = (lines) => lines.map((one) => one.match(/^ *(\d+\.\d{3}) s  \w+.* -> /)?.[1]);
  const end = printed.findIndex((one, index) => index > 0 && !times([one])[0]);
  const changes = summary.case === 0 ? times(printed.slice(1, end)) : [];
  const phases = lanes[0].find((one) => one.name === "phase").spans.slice(1);
  if (changes.length)
    assert.deepEqual(phases.map((span) => span.begin.toFixed(3)), changes, "changes of phase");
  // The mean of what the curves show, sample by sample.
  const means = await page.evaluate(() =>
    viewer.page.runs.map((run) => {
      const [scores, together] = ["e_s", "working together"].map((name) => run.series(name));
      const known = [...scores].filter((score, i) => together[i] > 0.5 && !Number.isNaN(score));
      return known.length ? known.reduce((sum, score) => sum + score, 0) / known.length : 0;
    }),
  );
  for (const [index, key] of ["score_mean_on", "score_mean_off"].slice(0, both ? 2 : 1).entries()) {
    assert.ok(
      Math.abs(means[index] - summary[key]) < 0.02,
      `${key}: ${means[index]} of the curve, ${summary[key]}`,
    );
  }

  // It seeks: by the slider's keys, by a click on the plots, by the address.
  const time = () => page.evaluate(() => viewer.player.time);
  const [begin, last] = await page.evaluate(() => [viewer.page.begin, viewer.page.end]);
  await page.keyboard.press("End");
  assert.equal(await time(), last);
  await page.keyboard.press("Home");
  assert.equal(await time(), begin);
  await page.keyboard.press("ArrowRight");
  assert.ok(Math.abs((await time()) - begin - 1) < 1e-9);
  const plot = await page.locator(".track .picture").nth(6).boundingBox();
  await page.mouse.click(plot.x + plot.width / 2, plot.y + plot.height / 2);
  assert.ok(Math.abs((await time()) - (begin + last) / 2) < 0.2, `a click in the middle: ${await time()}`);
  const late = 0.25 * (begin + 3 * last);
  await page.evaluate((hash) => (location.hash = hash), `time=${late}&run=${lanes.length}`);
  await page.waitForFunction(() => viewer.current === viewer.page.runs.at(-1));
  await page.waitForFunction((late) => Math.abs(viewer.player.time - late) < 1e-6, late);
  assert.equal(await page.locator("#now").textContent(), `${(await time()).toFixed(2)} s`);

  // What is under the cursor is the sample's.
  const row = await page.evaluate(() => {
    const { runs } = viewer.page;
    return runs.map((run) => run.at(viewer.player.time, "e_s"));
  });
  await page.waitForTimeout(250);
  const shown = await page.locator(".values .value.run-0, .values .value.run-1").allTextContents();
  const text = (value) => (Number.isNaN(value) ? "–" : value.toFixed(2));
  assert.deepEqual(shown.slice(0, row.length), row.map(text));

  // Views, layers and themes draw without a word on the console.
  for (const key of ["m", "m", "p", "v", "v", "v", "n", "n", "1", "[", "]", "?", "Escape"]) {
    await page.keyboard.press(key);
    await page.waitForTimeout(30);
  }
  const canvas = await page.locator("#view").boundingBox();
  const turned = await page.evaluate(() => viewer.camera.turn);
  await page.mouse.move(canvas.x + 200, canvas.y + 200);
  await page.mouse.down();
  await page.mouse.move(canvas.x + 320, canvas.y + 210);
  await page.mouse.up();
  assert.notEqual(await page.evaluate(() => viewer.camera.turn), turned, "dragging turns the view");

  // It plays.
  await page.keyboard.press("Home");
  await page.keyboard.press(" ");
  await page.waitForTimeout(1500);
  await page.evaluate(() => (viewer.player.frames = { count: 0, since: performance.now() }));
  const before = await time();
  const taken = await processorTime();
  await page.waitForTimeout(2500);
  const { rate, count } = await page.evaluate(() => {
    return { rate: viewer.player.rate(), count: viewer.player.frames.count };
  });
  const picture = (1000 * ((await processorTime()) - taken)) / Math.max(count, 1);
  assert.ok((await time()) > before + 1, "the time goes on");
  await page.keyboard.press(" ");
  assert.equal(await page.evaluate(() => viewer.player.playing), false);
  assert.ok(rate >= Number(least), `${rate} pictures a second`);

  // On a phone.
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(200);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `a phone has to scroll sideways: ${wide}`);
  await page.setViewportSize({ width: 1500, height: 950 });
  await page.waitForTimeout(300);

  // The scene is not of one colour.
  const colours = await page.evaluate(() => {
    viewer.settle();
    const { gl } = viewer.renderer;
    const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const seen = new Set();
    for (let i = 0; i < pixels.length; i += 4 * 97)
      seen.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
    return seen.size;
  });
  assert.ok(colours > 100, `${colours} colours`);

  // On paper.
  const paper = await page.pdf({ format: "A4", path: process.env.PAPER });
  assert.ok(paper.length > 20000, "it prints");

  // The pictures are well formed, and move.
  for (const name of readdirSync(folder).filter((name) => name.endsWith(".svg"))) {
    const picture = readFileSync(resolve(folder, name), "utf8");
    const broken = await page.evaluate((source) => {
      const parsed = new DOMParser().parseFromString(source, "image/svg+xml");
      return parsed.querySelector("parsererror")?.textContent ?? null;
    }, picture);
    assert.equal(broken, null, name);
  }

  assert.deepEqual(said, []);
  assert.deepEqual(requests, [address], "nothing is asked for from elsewhere");
  const bytes = statSync(file).size;
  console.log(
    JSON.stringify({
      bytes,
      bytes_a_minute: Math.round((60 * bytes) / (last - begin)),
      first_picture_ms: Math.round(firstPicture),
      processor_ms_a_picture: Math.round(picture),
      pictures_a_second: Math.round(10 * rate) / 10,
      share_of_pixels: await page.evaluate(() => viewer.quality.moving),
    }),
  );
} finally {
  await browser.close();
}
