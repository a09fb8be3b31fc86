// Films the live page while its person is dragged, as an animated PNG: node film.mjs ADDRESS FILE [frames].
// `. browser.sh; in_browser film.mjs …` runs it; the program must run: live --port 8000, say.

import { writeFileSync } from "node:fs";
import { deflateSync, inflateSync } from "node:zlib";
import { chromium } from "playwright-core";

const [address, file, count = "26"] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--enable-unsafe-swiftshader", "--no-sandbox", "--disable-background-networking"],
});
const page = await browser.newPage({ viewport: { width: 900, height: 640 }, colorScheme: "light" });
await page.goto(address);
await page.addStyleTag({
  content: `.over, header, footer, .hint, .right, #guide, #person { display: none !important; }
    main { display: block; } #stage { width: 400px; height: 260px; border: 0; border-radius: 0; }
    #pointer { position: fixed; width: 16px; height: 16px; margin: -8px; border-radius: 50%; z-index: 9;
      background: #c2389acc; border: 2px solid #fff; pointer-events: none; }`,
});
await page.waitForFunction(() => window.live?.picture?.phase.label === "working" && live.picture.calm < 0.05, null, { timeout: 60000 });
await page.evaluate(() => {
  // Sharp, however long a picture takes.
  live.quality.note = () => {};
  live.quality.moving = 1;
  live.camera.distance = 3.1;
  live.camera.turn = -1.25;
  const pointer = document.createElement("i");
  pointer.id = "pointer";
  document.body.append(pointer);
  addEventListener("pointermove", (event) => Object.assign(pointer.style, { left: `${event.clientX}px`, top: `${event.clientY}px` }));
});
await page.waitForTimeout(1500);

const box = await page.locator("#view").boundingBox();
const seen = async (point) => {
  const [x, y] = await page.evaluate((point) => live.pixels(point), point);
  return [box.x + x, box.y + y];
};
const { floor } = await page.evaluate(() => live.picture);
const base = await page.evaluate(() => live.run.place("base_link"));
const away = Math.atan2(floor[1] - base[1], floor[0] - base[0]);
const from = await seen([floor[0], floor[1], 1.6]);
const to = await seen([floor[0] + 0.9 * Math.cos(away + 0.5), floor[1] + 0.9 * Math.sin(away + 0.5), 1.6]);
await page.mouse.move(...from);
await page.mouse.down();
const [frames, times] = [[], []];
for (let frame = 0; frame < Number(count); frame++) {
  const share = Math.min(frame / 8, 1);
  await page.mouse.move(from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]));
  if (frame === 10) await page.mouse.up();
  times.push(performance.now());
  frames.push(await page.screenshot({ clip: { ...box, width: Math.round(box.width), height: Math.round(box.height) } }));
  await page.waitForTimeout(60);
}
await browser.close();

/** The chunks of a PNG: name and data. */
function chunks(png) {
  const found = [];
  for (let at = 8; at < png.length; ) {
    const size = png.readUInt32BE(at);
    found.push([png.toString("latin1", at + 4, at + 8), png.subarray(at + 8, at + 8 + size)]);
    at += size + 12;
  }
  return found;
}
const table = Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c >>> 0;
});
function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
  let crc = 0xffffffff;
  for (const byte of body) crc = table[(crc ^ byte) & 255] ^ (crc >>> 8);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE((crc ^ 0xffffffff) >>> 0, body.length + 4);
  return out;
}
const words = (...values) => {
  const out = Buffer.alloc(4 * values.length);
  values.forEach((value, k) => out.writeUInt32BE(value, 4 * k));
  return out;
};
const header = chunks(frames[0]).find(([name]) => name === "IHDR")[1];
const parts = [frames[0].subarray(0, 8), chunk("IHDR", header), chunk("acTL", words(frames.length, 0))];
let number = 0;
frames.forEach((png, index) => {
  const delay = Math.round((times[index + 1] ?? times[index] + 1200) - times[index]);
  const control = Buffer.concat([words(number++), header.subarray(0, 8), words(0, 0), Buffer.from([delay >> 8, delay & 255, 3, 232, 0, 0])]);
  parts.push(chunk("fcTL", control));
  const data = chunks(png).filter(([name]) => name === "IDAT").map(([, data]) => data);
  const pixels = deflateSync(inflateSync(Buffer.concat(data)), { level: 9 });
  parts.push(index === 0 ? chunk("IDAT", pixels) : chunk("fdAT", Buffer.concat([words(number++), pixels])));
});
parts.push(chunk("IEND", Buffer.alloc(0)));
writeFileSync(file, Buffer.concat(parts));
console.log(`${file}: ${frames.length} frames, ${((times.at(-1) - times[0]) / 1000).toFixed(1)} s`);
