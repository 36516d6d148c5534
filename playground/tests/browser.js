// The page in Chromium, as a visitor uses it: `node browser.js SITE PICTURE`. PICTURE.png shows it at the end.
import assert from "node:assert/strict";
import { createReadStream, existsSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import test, { after, before } from "node:test";
import { chromium } from "playwright-core";

const [site, picture] = process.argv.slice(2);
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, "http://localhost").pathname);
    const file = join(site, path === "/" ? "index.html" : path);
    if (!existsSync(file)) {
        response.writeHead(404).end();
        return;
    }
    response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
    createReadStream(file).pipe(response);
});

let browser;
let page;
let address;
const outside = [];
const faults = [];

before(async () => {
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    address = `http://127.0.0.1:${server.address().port}/`;
    browser = await chromium.launch({
        executablePath: "/usr/bin/chromium",
        args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
    });
    page = await browser.newPage({ viewport: { width: 1500, height: 950 } });
    page.on("request", (request) => request.url().startsWith(address) || /^(blob|data):/.test(request.url()) || outside.push(request.url()));
    page.on("pageerror", (error) => faults.push(error.message));
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    await page.goto(address);
    await page.locator("#run:enabled").waitFor({ timeout: 60_000 });
});

after(async () => {
    await browser.close();
    server.close();
});

// Replaces a part of the text, by keys.
async function retype(old, text) {
    await page.evaluate((old) => {
        const line = [...document.querySelectorAll(".cm-line")].find((line) => line.textContent.includes(old));
        const from = line.textContent.indexOf(old);
        // the text is in several nodes, one for each colour
        const place = (at) => {
            const walker = document.createTreeWalker(line, NodeFilter.SHOW_TEXT);
            let rest = at;
            for (let node = walker.nextNode(); node; node = walker.nextNode()) {
                if (rest <= node.length) {
                    return [node, rest];
                }
                rest -= node.length;
            }
            throw new Error("beyond the line");
        };
        document.querySelector(".cm-content").focus();
        getSelection().setBaseAndExtent(...place(from), ...place(from + old.length));
    }, old);
    await page.waitForTimeout(100);
    await page.keyboard.type(text);
}

test("a mistake is told while typing, and its repair too", async () => {
    await retype("Length = 2 m", "Length = 2 mn");
    const message = page.locator(".message.error").first();
    await message.waitFor({ timeout: 60_000 });
    assert.match(await message.innerText(), /error E\d{4}.*mn/s);
    await page.locator(".cm-lint-marker-error").first().waitFor();
    assert.equal(await page.locator("#run").isDisabled(), true);
    if (picture) {
        await page.screenshot({ path: `${picture}-message.png` });
    }
    await page.keyboard.press("Backspace");
    await page.locator("#messages .ok").waitFor({ timeout: 60_000 });
    assert.equal(await page.locator("#run").isDisabled(), false);
});

test("a run shows figures and values with units", async () => {
    await page.locator("#run").click();
    const values = page.locator("table.values");
    await values.first().waitFor({ timeout: 60_000 });
    assert.match(await values.first().innerText(), /Time to the other side.*\s1\.\d+ s/);
    const images = page.locator("#results .report img");
    assert.equal(await images.count(), 2);
    const sizes = await images.evaluateAll((all) => Promise.all(all.map(async (image) => (await image.decode(), image.naturalWidth))));
    assert.ok(sizes.every((width) => width > 100));
    assert.match(await page.locator(".analysis pre").first().innerText(), /steps, \d+ rejected/);
    if (picture) {
        await page.screenshot({ path: `${picture}.png` });
    }
});

test("the columns are saved as CSV", async () => {
    await page.locator(".analysis details summary").first().click();
    const [download] = await Promise.all([page.waitForEvent("download"), page.locator("button.save").first().click()]);
    assert.equal(download.suggestedFilename(), "release[1].csv");
    const chunks = [];
    for await (const chunk of await download.createReadStream()) {
        chunks.push(chunk);
    }
    const lines = Buffer.concat(chunks).toString().split("\r\n");
    assert.match(lines[0], /^time,/);
    assert.match(lines[1], /^s,/);
    assert.equal(lines.length, 2 + 501 + 1);
});

test("the page of the report opens", async () => {
    await page.locator("#report").click();
    await page.locator("dialog[open]").waitFor({ timeout: 60_000 });
    const frame = page.frameLocator("dialog iframe");
    await frame.locator("h1").first().waitFor({ timeout: 30_000 });
    assert.match(await frame.locator("h1").first().innerText(), /swing\.eng/);
    if (picture) {
        await page.waitForTimeout(1500);
        await page.screenshot({ path: `${picture}-report.png` });
    }
    await page.locator("dialog form button").click();
});

test("a long run is stopped, and another one begins", async () => {
    await retype("duration: 2.5 s", "duration: 2000 s");
    await page.locator("#run:enabled").waitFor();
    await page.waitForFunction(() => document.querySelector("#state").innerText.startsWith("checked"));
    await page.locator("#run").click();
    await page.waitForFunction(() => /^running: \d+ steps/.test(document.querySelector("#state").innerText), undefined, { timeout: 30_000 });
    // the page answers while the worker computes
    await page.locator("#stop").click({ timeout: 2000 });
    await page.waitForFunction(() => document.querySelector("#state").innerText === "stopped");
    await page.locator("#limit").selectOption("10");
    await page.locator("#run").click();
    await page.locator(".stopped").waitFor({ timeout: 60_000 });
    assert.match(await page.locator(".stopped").innerText(), /^stopped at \d+\.\d % of the run/);
});

test("a link carries the text", async () => {
    await page.locator("#link").click();
    await page.waitForFunction(() => location.hash.startsWith("#t="));
    const other = await browser.newPage();
    await other.goto(page.url());
    await other.locator("#run:enabled").waitFor({ timeout: 60_000 });
    assert.match(await other.locator(".cm-content").innerText(), /duration: 2000 s/);
    await other.close();
});

test("an engine of the examples runs", async () => {
    await page.locator("#example").selectOption({ label: "slider-crank" });
    await page.waitForFunction(() => /SliderCrank/.test(document.querySelector(".cm-content").innerText));
    await page.locator("#run:enabled").waitFor();
    await page.locator("#limit").selectOption("60");
    await page.locator("#run").click();
    await page.locator("#results .report h2", { hasText: "What the force on the wall depends on" }).waitFor({ timeout: 60_000 });
    if (picture) {
        await page.screenshot({ path: `${picture}-slider-crank.png` });
    }
});

test("the page asks no other server, and has no faults", () => {
    assert.deepEqual(outside, []);
    assert.deepEqual(faults, []);
});
