// Leads the person of a live page in headless Chromium: by the mouse, the keys and the buttons of the page. Prints
// what it measured as JSON.
//
// Usage: node live.mjs ADDRESS STARTED OUTPUT SOAK PROCESS. STARTED is when the program was started (ms), SOAK for how
// long to drag at random (s), PROCESS the program's id.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { request } from "node:http";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [address, started, output, soak, program] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  // The processor draws, as on a machine without a graphics card.
  args: ["--enable-unsafe-swiftshader", "--no-sandbox", "--disable-background-networking"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
const said = [];
page.on("console", (message) => {
  if (!message.text().includes("GL Driver Message")) said.push(`${message.type()}: ${message.text()}`);
});
page.on("pageerror", (error) => said.push(`error: ${error.message}`));
const elsewhere = [];
page.on("request", (asked) => {
  if (!asked.url().startsWith(address) && !asked.url().startsWith("data:")) elsewhere.push(asked.url());
});

/** The newest picture. */
const picture = () => page.evaluate(() => live.picture);
/** Waits until the page agrees. */
const until = (what, timeout = 20000) => page.waitForFunction(what, null, { timeout, polling: 50 });
const click = (name) => page.getByRole("button", { name, exact: true }).click();
const slide = (id, value) =>
  page.evaluate(
    ([id, value]) => {
      const slider = document.getElementById(id);
      slider.value = value;
      slider.dispatchEvent(new Event("input"));
    },
    [id, value],
  );
/** Where a point of the world is on the page. */
async function seen(point) {
  const box = await page.locator("#view").boundingBox();
  const [x, y] = await page.evaluate((point) => live.pixels(point), point);
  return [box.x + x, box.y + y];
}
/** Grabs the person where nothing hides them, and moves the pointer to where they are to go, in steps. */
async function pull(to, steps) {
  const { floor } = await picture();
  for (const height of [1.6, 1.2, 0.8, 0.3]) {
    const from = await seen([floor[0], floor[1], height]);
    await page.mouse.move(...from);
    await page.mouse.down();
    if ((await page.evaluate(() => live.grab?.kind)) === "worker") {
      await page.mouse.move(...(await seen([to[0], to[1], height])), { steps });
      await page.mouse.up();
      return true;
    }
    await page.mouse.up();
  }
  return false;
}
/** Drags the person to a place on the floor. */
async function drag(to, steps = 20) {
  // The eye has come along.
  await page.waitForFunction(() => live.still < 0.3);
  assert.ok(await pull(to, steps), "the person is grabbed");
}
const tool = () => page.evaluate(() => live.run.place("tool"));
/** The status of a request with these fields. */
const status = (fields, path = "/") =>
  new Promise((done, fail) => {
    const asked = request(new URL(path, address), { headers: fields }, (answer) => {
      answer.resume();
      done(answer.statusCode);
    });
    asked.on("error", fail).end();
  });
const memory = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${program}/status`, "utf8"))[1]) / 1024;

try {
  const opened = Date.now() - Number(started);
  await page.goto(address);
  await until(() => window.live?.picture);
  assert.equal(await page.locator("#flat").textContent(), "", "the scene is drawn");
  const begin = await tool();
  await page.waitForFunction((begin) => Math.hypot(...live.run.place("tool").map((x, k) => x - begin[k])) > 0.01, begin);
  const moves = Date.now() - Number(started);

  // It comes to work, and follows who is dragged.
  await until(() => live.picture.phase.label === "working" && live.picture.grasps);
  const [before, { floor }] = [await tool(), await picture()];
  const base = await page.evaluate(() => live.run.place("base_link"));
  const away = Math.atan2(floor[1] - base[1], floor[0] - base[0]);
  const along = (way, turn) => [floor[0] + way * Math.cos(away + turn), floor[1] + way * Math.sin(away + turn)];
  // Away from the robot, and then a little aside.
  const path = [along(0.5, 0), along(0.9, 0.3)];
  for (const place of path) await drag(place);
  await page.waitForFunction((to) => Math.hypot(live.picture.floor[0] - to[0], live.picture.floor[1] - to[1]) < 0.1, path[1]);
  await page.waitForFunction((before) => Math.hypot(...live.run.place("tool").map((x, k) => x - before[k])) > 0.5, before);

  // Pictures while it is dragged to and fro, and from drag to picture.
  const here = (await picture()).floor;
  await page.evaluate(() => Object.assign(live, { lags: [], pictures: 0, since: performance.now() }));
  const side = (way) => [here[0] - way * Math.sin(away), here[1] + way * Math.cos(away)];
  for (const way of [0.3, -0.3, 0.3]) await drag(side(way), 60);
  const rate = await page.evaluate(() => (1000 * live.pictures) / (performance.now() - live.since));
  const lags = (await page.evaluate(() => live.lags)).sort((a, b) => a - b);
  assert.ok(lags.length > 20, `${lags.length} drags were answered`);

  // The same robot with the other choice of ergonomics, beside it.
  await click("Both runs");
  await until(() => live.picture.beside && document.getElementById("reading-the-other-run").textContent.includes("ergonomics off"));
  await drag(side(-0.4));
  await page.waitForFunction(() => Math.hypot(...live.other.place("tool").map((x, k) => x - live.run.place("tool")[k])) > 0.02);
  await click("Both runs");
  await until(() => !live.picture.beside);

  // Keys walk as well.
  const stood = (await picture()).floor;
  // Away from the robot, where nothing stands in the way.
  const turn = await page.evaluate(() => live.camera.turn);
  const ways = { ArrowRight: [-Math.sin(turn), Math.cos(turn)], ArrowUp: [-Math.cos(turn), -Math.sin(turn)] };
  const goes = ([x, y]) => x * Math.cos(away) + y * Math.sin(away);
  const keys = { ...ways, ArrowLeft: ways.ArrowRight.map((x) => -x), ArrowDown: ways.ArrowUp.map((x) => -x) };
  const key = Object.keys(keys).sort((a, b) => goes(keys[b]) - goes(keys[a]))[0];
  await page.keyboard.down(key);
  await page.waitForFunction((from) => Math.hypot(live.picture.floor[0] - from[0], live.picture.floor[1] - from[1]) > 0.2, stood);
  await page.keyboard.up(key);
  await page.waitForTimeout(600);

  // And so does a gamepad's stick, which a stand-in for the hardware moves.
  const sticks = { ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowLeft: [-1, 0], ArrowDown: [0, 1] };
  await page.evaluate(() => {
    window.axes = [0, 0, 0, 0];
    navigator.getGamepads = () => [null, { axes: window.axes }];
  });
  await page.waitForTimeout(300);
  const rests = (await picture()).floor;
  await page.evaluate((stick) => (window.axes = [...stick, 0, 0]), sticks[key].map((axis) => 0.5 * axis));
  await page.waitForFunction((from) => Math.hypot(live.picture.floor[0] - from[0], live.picture.floor[1] - from[1]) > 0.2, rests);
  assert.ok(Math.abs((await page.evaluate(() => live.controls.leads.worker.speed)) - 0.6) < 0.01, "half a stick is half the speed");
  await page.evaluate(() => (window.axes = [0, 0, 0, 0]));
  let walked = (await picture()).floor;
  let stands = false;
  for (const end = Date.now() + 3000; !stands && Date.now() < end; ) {
    await page.waitForTimeout(400);
    const { floor } = await picture();
    stands = Math.hypot(floor[0] - walked[0], floor[1] - walked[1]) < 0.05;
    walked = floor;
  }
  assert.ok(stands, "a stick at rest stops");
  await page.evaluate(() => (navigator.getGamepads = () => []));

  // Who bends over it with empty hands: it keeps away.
  await click("empty hands");
  const near = await tool();
  await drag([near[0] + 0.35 * (walked[0] > near[0] ? 1 : -1), near[1]]);
  await slide("slider-lean", 1.1);
  await until(() => live.picture.safety.tone !== "quiet");
  await page.waitForTimeout(1500);
  assert.equal((await picture()).too_near, 0, "it keeps its distance");
  await slide("slider-lean", 0);

  // Cut measurements stop it with the fault's name, and acknowledging lets it go on.
  await click("measurements cut");
  await until(() => live.picture.stopped && live.picture.safety.label.includes("measurement missing"));
  await click("all well");
  await page.waitForTimeout(300);
  await click("Acknowledge, and go on").catch(() => {});
  await until(() => !live.picture.stopped);

  // Without the levels that the paper does not have it begins anew, and so it does with them.
  const levels = () => page.evaluate(() => live.controls.levels);
  assert.equal(await levels(), "extended");
  for (const [wanted, number] of [["paper", 2], ["extended", 3]]) {
    await click("The paper's three levels");
    await page.waitForFunction((number) => live.picture.head === number && live.picture.phase.label === "working", number, { timeout: 30000 });
    assert.equal(await levels(), wanted);
    assert.equal((await picture()).limits, 0, `limits with the ${wanted} levels`);
  }

  // What says nothing moves nothing.
  const told = await page.evaluate(() => {
    for (const text of ["", "nonsense", '{"do":"lead","speed":99}', '{"do":"fly"}', "[".repeat(5000)]) {
      live.link.socket.send(text);
      live.link.sent += 1;
    }
    live.link.socket.send(new Uint8Array([1, 2, 3]));
    live.link.sent += 1;
    return live.errors.length;
  });
  await page.waitForFunction((told) => live.errors.length >= told + 6, told);

  // One steers, others watch; and no other page may ask.
  const other = await browser.newPage();
  await other.goto(address);
  await other.waitForFunction(() => window.live?.picture);
  await other.evaluate(() => live.controls.lead("worker", { lean: 1 }));
  await other.waitForFunction(() => live.errors.some((error) => error.includes("another page steers")));
  await other.close();
  assert.equal(await status({ Host: "evil.example" }), 403);
  const socket = { Upgrade: "websocket", Connection: "Upgrade", "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==" };
  assert.equal(await status({ ...socket, Origin: "http://evil.example" }, "/live"), 403);

  // Random dragging, for as long as it was asked for.
  const first = memory();
  const { pace: undragged } = await picture();
  const end = Date.now() + 1000 * Number(soak);
  await click("use drill");
  while (Date.now() < end) {
    const random = (low, high) => low + (high - low) * Math.random();
    const at = await tool();
    await pull([at[0] + random(-1.2, 1.2), at[1] + random(-1.2, 1.2)], Math.ceil(random(3, 30)));
    await slide("slider-walking-speed", random(0.1, 1.2));
    if (random(0, 1) < 0.3) await slide("slider-lean", random(0, 1.2));
    else await slide("slider-lean", 0);
    await click(["empty hands", "use drill", "use polisher", "hold drill"][Math.floor(random(0, 4))]);
    await page.waitForTimeout(random(100, 2500));
  }
  const last = await picture();
  assert.equal(last.limits, 0, "limits");
  assert.equal(last.too_near, 0, "too near to the true person");
  for (const [path, name] of [["recording.jsonl", "live.jsonl"], ["truth.jsonl", "live-truth.jsonl"], ["settings.toml", "live.toml"]]) {
    const answer = await fetch(new URL(path, address));
    assert.equal(answer.status, 200, path);
    writeFileSync(join(output, name), Buffer.from(await answer.arrayBuffer()));
  }
  assert.deepEqual([...new Set(said)], []);
  assert.deepEqual(elsewhere, [], "nothing is asked for from elsewhere");
  const quantile = (share) => Math.round(lags[Math.floor(share * (lags.length - 1))]);
  const { pace } = last;
  console.log(
    JSON.stringify({
      opened_after_ms: opened,
      moves_after_ms: moves,
      pictures_a_second: Math.round(10 * rate) / 10,
      drag_to_picture_ms: { p50: quantile(0.5), p95: quantile(0.95) },
      ticks: pace.ticks,
      late: pace.late,
      lost: pace.lost,
      random_dragging: { ticks: pace.ticks - undragged.ticks, late: pace.late - undragged.late, lost: pace.lost - undragged.lost },
      tick_us: { p50: Math.round(pace.median), p99: Math.round(pace.p99) },
      memory_mib: [first, memory()].map(Math.round),
      counts: { limits: last.limits, too_near: last.too_near, unsolved: last.unsolved, by_the_person: last.by_the_person },
    }),
  );
} finally {
  if (process.env.PICTURE) await page.screenshot({ path: process.env.PICTURE });
  await browser.close();
}
