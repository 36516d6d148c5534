// Goes through a whole report in a headless Chromium and prints what it found as JSON: wakes, zooms and reads every figure, moves every
// animation and shows it in all its colours. Usage: node report.mjs CHROMIUM PAGE
import { pointOf, sleep, withPage } from "../../report/tests/report/chromium.mjs";

const [browser, page] = process.argv.slice(2);
await withPage(browser, page, 540000, async ({ evaluate, mouse, errors, requests }) => {
  const found = {};
  found.opened_in = await evaluate("performance.getEntriesByType('navigation')[0].loadEventEnd");
  const inside = (kind, index) => `document.querySelectorAll('figure.${kind}')[${index}]`;
  const count = (selector) => evaluate(`document.querySelectorAll(${JSON.stringify(selector)}).length`);
  const until = async (condition) => {
    for (let i = 0; i < 150; i++) {
      if (await evaluate(condition)) return true;
      await sleep(100);
    }
    return false;
  };

  // what screen readers and paper need
  found.headings = await evaluate("[...document.querySelectorAll('h1,h2,h3,h4')].map((h) => Number(h.tagName[1]))");
  found.tables = await count("table");
  found.tables_without_headers = await evaluate(
    "[...document.querySelectorAll('table')].filter((t) => !t.caption || !t.querySelector('thead th[scope=col]') || !t.querySelector('tbody th[scope=row]')).length");
  found.unnamed_figures = await evaluate(
    "[...document.querySelectorAll('figure')].filter((f) => !document.getElementById(f.getAttribute('aria-labelledby'))?.textContent.trim()).length");
  found.dead_links = await evaluate(
    "[...document.querySelectorAll('nav a')].filter((a) => !document.getElementById(a.getAttribute('href').slice(1))).length");

  found.figures = await count("figure.plot");
  found.asleep = [];
  found.not_zoomed = [];
  found.not_reset = [];
  found.silent = [];
  found.odd_readouts = [];
  for (let index = 0; index < found.figures; index++) {
    const figure = inside("plot", index);
    await evaluate(`${figure}.querySelector('svg').scrollIntoView({ block: 'center', behavior: 'instant' })`);
    // awake, it draws its own grid when it is zoomed
    const grid = `${figure}.querySelector('.grid').innerHTML`;
    const before = await evaluate(grid);
    const key = (key) => evaluate(`${figure}.querySelector('svg').dispatchEvent(new KeyboardEvent('keydown', { key: '${key}', bubbles: true }))`);
    await sleep(60);
    for (let i = 0; i < 40 && (await evaluate(`${figure}.querySelector('.reset').disabled`)); i++) {
      for (let k = 0; k < 4; k++) await key("+");
      await sleep(50);
    }
    if (await evaluate(`${figure}.querySelector('.reset').disabled`)) found.asleep.push(index + 1);
    if ((await evaluate(grid)) === before) found.not_zoomed.push(index + 1);
    await key("0");
    if ((await evaluate(grid)) !== before) found.not_reset.push(index + 1);
    // a point of a curve near the middle of what is seen, or of a map
    const place = await evaluate(pointOf(figure));
    await mouse("mouseMoved", place);
    await sleep(40);
    const text = await evaluate(`${figure}.querySelector('.readout').innerText`);
    if (!text) found.silent.push(index + 1);
    if (/NaN|undefined|Infinity/.test(text)) found.odd_readouts.push(text);
  }

  found.animations = await count("figure.animation");
  found.moved = [];
  found.colours = [];
  found.webgl = true;
  for (let index = 0; index < found.animations; index++) {
    const figure = inside("animation", index);
    await evaluate(`${figure}.scrollIntoView({ behavior: 'instant' })`);
    if (!(await until(`${figure}.classList.contains('alive') || !${figure}.querySelector('.trouble').hidden`))) break;
    if (!(await evaluate(`${figure}.classList.contains('alive')`))) {
      found.webgl = false;
      break;
    }
    await until(`Number(${figure}.dataset.drawn) > 0`);
    const picture = `(() => {
      let sum = 0;
      for (const c of ${figure}.querySelector('canvas').toDataURL()) sum = (sum * 31 + c.charCodeAt(0)) % 4294967291;
      return sum;
    })()`;
    const pictures = new Set();
    const choices = await evaluate(`[...${figure}.querySelectorAll('.color option')].map((o) => o.value)`);
    for (const choice of choices) {
      const drawn = await evaluate(`${figure}.dataset.drawn`);
      await evaluate(`(() => { const s = ${figure}.querySelector('.color'); s.value = ${JSON.stringify(choice)};
        s.dispatchEvent(new Event('change')); })()`);
      await until(`${figure}.dataset.drawn !== '${drawn}'`);
      pictures.add(await evaluate(picture));
    }
    found.colours.push({ choices, pictures: pictures.size });
    const still = await evaluate(picture);
    const clock = await evaluate(`${figure}.querySelector('.clock').textContent`);
    await evaluate(`${figure}.querySelector('.play').click()`);
    await until(`${figure}.querySelector('.clock').textContent !== ${JSON.stringify(clock)}`);
    await sleep(300);
    await evaluate(`${figure}.querySelector('.play').click()`);
    await sleep(300);
    found.moved.push((await evaluate(picture)) !== still);
  }

  found.errors = errors();
  found.requests = requests();
  console.log(JSON.stringify(found));
});
