// Drives a page in a headless Chromium and prints what it found as JSON.
// Usage: node browser.mjs CHROMIUM PAGE FOLDER; screenshots go to the folder.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pointOf, sleep, withPage } from "./chromium.mjs";

const [browser, page, folder] = process.argv.slice(2);
const found = {};
await withPage(browser, page, 300000, async ({ call, evaluate, size, mouse, errors, requests }) => {
  const shot = async (name) => {
    const { data } = await call("Page.captureScreenshot", { format: "png" });
    writeFileSync(join(folder, name), Buffer.from(data, "base64"));
  };
  // the whole page, a window's height at a time: a browser can't draw one as long as it
  const whole = async (name) => {
    await size(1280, 1600);
    const height = await evaluate("document.documentElement.scrollHeight");
    for (let i = 0; i * 1600 < height; i++) {
      await evaluate(`scrollTo({ top: ${i * 1600}, behavior: "instant" })`);
      await sleep(250);
      await shot(`${name}-${i + 1}.png`);
    }
  };
  found.figures = await evaluate("document.querySelectorAll('figure.plot svg.drawing').length");
  found.animations = await evaluate("document.querySelectorAll('figure.animation').length");
  // each link of the contents lands with its heading at the top, before anything was drawn on the way
  found.links = await evaluate("document.querySelectorAll('nav a').length");
  found.missed_links = [];
  for (let i = found.links - 1; i >= 0; i--) {
    await evaluate("scrollTo({ top: 0, behavior: 'instant' })");
    await evaluate(`document.querySelectorAll('nav a')[${i}].click()`);
    await sleep(600);
    const [title, off] = await evaluate(`(() => {
      const heading = document.querySelector(document.querySelectorAll('nav a')[${i}].getAttribute("href"));
      const end = scrollY + innerHeight >= document.documentElement.scrollHeight - 2;
      return [heading.textContent, end ? 0 : heading.getBoundingClientRect().top - 16];
    })()`);
    if (Math.abs(off) > 40) found.missed_links.push([title, off]);
  }
  await evaluate("scrollTo({ top: 0, behavior: 'instant' })");
  found.overflow_wide = await evaluate("document.documentElement.scrollWidth - innerWidth");

  // a point inside of a drawing, in its own units, as pixels of the window
  const at = async (figure, x, y) => {
    await evaluate(`document.querySelector('#${figure} svg').scrollIntoView({ block: 'center', behavior: 'instant' })`);
    // it wakes when it comes near
    await sleep(150);
    return evaluate(`(() => {
      const svg = document.querySelector('#${figure} svg');
      const [left, top, width, height] = svg.querySelector('.panel').dataset.area.split(' ').map(Number);
      const p = new DOMPoint(left + ${x} * width, top + ${y} * height).matrixTransform(svg.getScreenCTM());
      return [p.x, p.y];
    })()`);
  };
  const click = async (place, clickCount = 1) => {
    await mouse("mousePressed", place, { button: "left", buttons: 1, clickCount });
    await mouse("mouseReleased", place, { button: "left", clickCount });
  };
  // the page answers when it comes to it: while the readout is empty, the pointer goes there again
  const readout = async (figure, place) => {
    let text = "";
    for (let i = 0; i < 50 && text === ""; i++) {
      const [x, y] = await place();
      await mouse("mouseMoved", [x + (i % 2), y]);
      await sleep(100);
      text = await evaluate(`document.querySelector('#${figure} .readout').innerText`);
    }
    return text;
  };
  const step = () => evaluate(`(() => {
    const t = [...document.querySelectorAll('#figure-1 .grid.numbered text[text-anchor=middle]')].map((t) => Number(t.textContent));
    return t[1] - t[0];
  })()`);

  // readouts
  for (const [name, figure, x, y] of [
    ["history", "figure-1", 0.3, 0.5], ["map", "figure-7", 0.5, 0.5], ["waterfall", "figure-6", 0.1, 0.8],
  ]) {
    found["readout_" + name] = await readout(figure, () => at(figure, x, y));
  }
  await at("figure-3", 0.5, 0.5);
  found.readout_orbit = await readout("figure-3", () => evaluate(pointOf("document.querySelector('#figure-3')")));
  await shot("orbit-readout.png");

  // wheel, drag, double click
  found.ticks_step = await step();
  let middle = await at("figure-1", 0.5, 0.5);
  await click(middle);
  middle = await at("figure-1", 0.5, 0.5);
  for (let i = 0; i < 4; i++) await mouse("mouseWheel", middle, { deltaX: 0, deltaY: -300 });
  await sleep(200);
  found.ticks_step_zoomed = await step();
  await mouse("mouseMoved", middle);
  await sleep(100);
  await shot("zoomed.png");
  await click(middle, 1);
  await click(middle, 2);
  await sleep(200);
  found.reset = Math.abs((await step()) - found.ticks_step) < 1e-9;
  const [from, to] = [await at("figure-2", 0.1, 0.2), await at("figure-2", 0.4, 0.6)];
  await mouse("mousePressed", from, { button: "left", buttons: 1, clickCount: 1 });
  await mouse("mouseMoved", [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2], { button: "left", buttons: 1 });
  await shot("dragging.png");
  await mouse("mouseMoved", to, { button: "left", buttons: 1 });
  await mouse("mouseReleased", to, { button: "left", clickCount: 1 });
  await sleep(100);
  found.zoomed_by_drag = await evaluate("!document.querySelector('#figure-2 .reset').disabled");
  await shot("zoomed-by-drag.png");

  // legend, by keyboard
  const shown = "[...document.querySelectorAll('#figure-1 path.curve')].filter((c) => getComputedStyle(c).display !== 'none').length";
  found.curves = await evaluate(shown);
  await evaluate("document.querySelector('#figure-1 .legend-item').focus()");
  for (const type of ["keyDown", "keyUp"])
    await call("Input.dispatchKeyEvent", { type, key: "Enter", code: "Enter", windowsVirtualKeyCode: 13, text: type === "keyDown" ? "\r" : undefined });
  found.curves_after_hiding = await evaluate(shown);
  await shot("hidden-curve.png");

  // the animation
  await evaluate("document.querySelector('figure.animation').scrollIntoView({ behavior: 'instant' })");
  await sleep(1500);
  found.webgl = await evaluate("document.querySelector('figure.animation').classList.contains('alive')");
  if (found.webgl) {
    const picture = () => evaluate(`(async () => {
      const bytes = new TextEncoder().encode(document.querySelector('figure.animation canvas').toDataURL());
      let sum = 0;
      for (const b of bytes) sum = (sum * 31 + b) % 4294967291;
      return bytes.length + ":" + sum;
    })()`);
    const set = async (name, value) => {
      await evaluate(`(() => { const s = document.querySelector('.animation .${name}'); s.value = ${JSON.stringify(value)};
        s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()`);
      await sleep(400);
    };
    const clock = () => evaluate("document.querySelector('.animation .clock').textContent");
    found.glb_bytes = await evaluate("Number(document.querySelector('figure.animation').dataset.bytes)");
    // films are there, and their pressure is the first choice
    found.colors = await evaluate("document.querySelector('.animation .color').value");
    await set("color", "body");
    await set("time", 20);
    found.picture_start = await picture();
    await shot("animation.png");
    await set("scale", 0);
    found.picture_undeformed = await picture();
    await set("scale", 1);
    await set("color", "displacement");
    await shot("animation-displacement.png");
    await set("color", "field:von Mises, largest over the cycle");
    await shot("animation-field.png");
    await set("color", "film");
    found.film = await evaluate("document.querySelector('.animation .high').textContent");
    await shot("animation-film.png");
    await set("color", "body");
    await evaluate("document.querySelector('.animation canvas').focus()");
    for (const type of ["keyDown", "keyUp"])
      await call("Input.dispatchKeyEvent", { type, key: "ArrowRight", code: "ArrowRight", windowsVirtualKeyCode: 39 });
    await sleep(400);
    found.picture_turned = await picture();
    await evaluate("document.querySelector('.animation .home').click()");
    await sleep(300);
    found.clock_before = await clock();
    await evaluate("document.querySelector('.animation .play').click()");
    await sleep(1500);
    found.clock_after = await clock();
    await evaluate("document.querySelector('.animation .play').click()");
    await sleep(300);
    found.picture_later = await picture();
    found.drawn = await evaluate("Number(document.querySelector('figure.animation').dataset.drawn)");
  }

  // accessibility, where axe-core is installed
  try {
    const paths = (process.env.NODE_PATH || folder).split(":");
    const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js", { paths }), "utf8");
    await evaluate(axe + ";0");
    found.accessibility = {};
    for (const scheme of ["light", "dark"]) {
      await call("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
      await sleep(200);
      found.accessibility[scheme] = await evaluate(`axe.run(document, { resultTypes: ["violations"] }).then((r) =>
        r.violations.map((v) => v.id + ": " + v.nodes.map((n) => n.html.slice(0, 160) + " " + n.failureSummary).slice(0, 3).join(" | ")))`);
    }
    await call("Emulation.setEmulatedMedia", { media: "", features: [] });
  } catch (error) {
    if (error.code !== "MODULE_NOT_FOUND") throw error;
  }

  // looks
  await evaluate("scrollTo(0, 0)");
  await whole("page-light");
  await call("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: "dark" }] });
  await sleep(500);
  await whole("page-dark");
  await call("Emulation.setEmulatedMedia", { media: "", features: [] });
  const { data } = await call("Page.printToPDF", { printBackground: true });
  writeFileSync(join(folder, "page.pdf"), Buffer.from(data, "base64"));
  await size(420, 800);
  await sleep(300);
  found.overflow_narrow = await evaluate("document.documentElement.scrollWidth - innerWidth");
  await shot("page-narrow.png");

  // without scripts: pictures, no controls that do nothing
  await call("Emulation.setScriptExecutionDisabled", { value: true });
  await call("Page.reload");
  await sleep(1500);
  await size(1280, 900);
  const { root } = await call("DOM.getDocument", { depth: 0 });
  const boxes = async (selector) => {
    const { nodeIds } = await call("DOM.querySelectorAll", { nodeId: root.nodeId, selector });
    const shown = await Promise.all(nodeIds.map((nodeId) => call("DOM.getBoxModel", { nodeId }).then(() => 1, () => 0)));
    return shown.reduce((sum, one) => sum + one, 0);
  };
  found.without_scripts = {
    drawings: await boxes("svg.drawing"), posters: await boxes("img.poster"), controls: await boxes(".controls, .tools"),
  };

  found.errors = errors();
  found.requests = requests();
  console.log(JSON.stringify(found));
});
