// A headless Chromium, driven by its debugging pipe.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

// An expression: the point of a figure's curves that is nearest to the middle of the window, in its pixels; without curves the middle
// of its first panel. `figure` is an expression, too.
export const pointOf = (figure) => `(() => {
  const middle = innerHeight / 2;
  let best = null;
  for (const line of ${figure}.querySelectorAll('path.curve[data-name]')) {
    const matrix = line.getScreenCTM();
    for (let k = 1; k < 40; k++) {
      const p = line.getPointAtLength((line.getTotalLength() * k) / 40).matrixTransform(matrix);
      if (!best || Math.abs(p.y - middle) < Math.abs(best[1] - middle)) best = [p.x, p.y];
    }
  }
  if (best) return best;
  const box = ${figure}.querySelector('.panel').getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
})()`;

// Starts the browser, opens a page, calls `act` with its tools and ends the browser. After `limit` ms it gives up.
export async function withPage(browser, page, limit, act) {
  const profile = mkdtempSync(join(tmpdir(), "eng-browser-"));
  const child = spawn(browser, [
    "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-pipe", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-extensions", "--mute-audio",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
    `--user-data-dir=${profile}`, "about:blank",
  ], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  let next = 0;
  let rest = "";
  const waiting = new Map();
  const heard = [];
  child.stdio[4].on("data", (data) => {
    rest += data;
    for (let end; (end = rest.indexOf("\0")) >= 0; rest = rest.slice(end + 1)) {
      const message = JSON.parse(rest.slice(0, end));
      if (message.id === undefined) heard.push(message);
      else {
        const { resolve, reject } = waiting.get(message.id);
        waiting.delete(message.id);
        if (message.error) reject(new Error(JSON.stringify(message.error)));
        else resolve(message.result);
      }
    }
  });
  const send = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
    const id = ++next;
    waiting.set(id, { resolve, reject });
    child.stdio[3].write(JSON.stringify({ id, method, params, sessionId }) + "\0");
  });
  const timer = setTimeout(() => {
    console.error("the browser did not finish in time");
    child.kill("SIGKILL");
    process.exit(2);
  }, limit);
  try {
    const { targetId } = await send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
    const call = (method, params) => send(method, params, sessionId);
    const evaluate = async (expression) => {
      const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
      if (exceptionDetails) throw new Error(expression + ": " + JSON.stringify(exceptionDetails.exception || exceptionDetails));
      return result.value;
    };
    const size = (width, height) => call("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    const mouse = (type, [x, y], more = {}) => call("Input.dispatchMouseEvent", { type, x, y, ...more });
    for (const domain of ["Page", "Runtime", "Log", "Network", "DOM"]) await call(domain + ".enable");
    await size(1280, 900);
    await call("Page.navigate", { url: pathToFileURL(resolve(page)).href });
    for (let i = 0; i < 600 && (await evaluate("document.readyState")) !== "complete"; i++) await sleep(50);
    await sleep(500);
    // what the console and the network have seen
    const errors = () => heard.flatMap(({ method, params }) => {
      if (method === "Runtime.exceptionThrown") return [params.exceptionDetails.exception?.description || params.exceptionDetails.text];
      if (method === "Runtime.consoleAPICalled" && ["error", "assert"].includes(params.type)) return [JSON.stringify(params.args)];
      if (method === "Log.entryAdded" && params.entry.level === "error") return [params.entry.text];
      return [];
    });
    const requests = () => heard
      .filter(({ method }) => method === "Network.requestWillBeSent")
      .map(({ params }) => params.request.url)
      .filter((url) => !/^(file|blob|data):/.test(url));
    await act({ call, evaluate, size, mouse, errors, requests });
  } finally {
    clearTimeout(timer);
    const ended = new Promise((done) => child.once("exit", done));
    child.kill("SIGTERM");
    await Promise.race([ended, sleep(3000)]);
    child.kill("SIGKILL");
    try {
      rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 200 });
    } catch {
      // a child of the browser still writes; the system clears its folder of temporary files
    }
  }
}
