// Zooms the page's drawings, reads values out of them, shows and hides their curves. The drawings are complete without it.
(() => {
  "use strict";

  const numbers = (text) => text.trim().split(/\s+/).map(Number);
  // hundredths: the first ones, then differences to those `width` before
  const summed = (text, width) => {
    const list = (text.match(/-?\d+/g) || []).map(Number);
    for (let i = width; i < list.length; i++) list[i] += list[i - width];
    return list.map((value) => value / 100);
  };
  const space = document.querySelector("svg.drawing").namespaceURI;
  const make = (name, attributes) => {
    const element = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  };

  // ---- numbers as the drawings have them

  const niceStep = (raw) => {
    const power = Math.pow(10, Math.floor(Math.log10(raw)));
    return power * ([1, 2, 2.5, 5].find((f) => raw / power <= f * (1 + 1e-9)) || 10);
  };
  const angleStep = (raw) =>
    raw < 1 ? niceStep(raw) : [1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720].find((s) => raw <= s * (1 + 1e-9)) || 720 * niceStep(raw / 720);
  // 1, 2 and 5 times the powers of ten
  const ratios = (low, high) => {
    const list = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
      for (const mark of [1, 2, 5]) {
        const value = Number(`${mark}e${power}`);
        if (value >= low && value <= high) list.push(value);
      }
    return list;
  };
  const written = (value, step) => {
    let decimals = 0;
    while (decimals < 9 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 * step * 10 ** decimals) decimals += 1;
    const text = value.toFixed(decimals);
    return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
  };
  const superscript = (value) => String(value).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
  const short = (value) => {
    if (value === 0) return "0";
    const size = Math.abs(value);
    const text = size >= 1e6 || size < 1e-3 ? value.toExponential(3) : String(Number(value.toPrecision(5)));
    return text.replace("e+", "e").replace(/-/g, "\u2212");
  };

  // a number read from a pixel, as exact as the drawing's hundredths of a pixel are
  const rounded = (value, pixel) => {
    const step = 10 ** Math.floor(Math.log10(Math.abs(pixel) / 50));
    return Number.isFinite(step) && step > 0 ? Number((Math.round(value / step) * step).toPrecision(12)) : value;
  };

  // ---- one pair of axes

  class Panel {
    constructor(group) {
      this.group = group;
      const data = group.dataset;
      [this.left, this.top, this.width, this.height] = numbers(data.area);
      this.x = numbers(data.x);
      this.y = numbers(data.y);
      this.data = data;
      this.log = data.yScale === "log";
      this.logX = data.xScale === "log";
      this.equal = data.equal === "yes";
      this.fixedY = data.fixedY === "yes";
      this.factor = Number(data.yFactor || 1);
      this.grid = group.querySelector(".grid");
      this.original = this.grid && [...this.grid.childNodes];
      this.curves = [...group.querySelectorAll("path.curve")].map((line) => ({
        line,
        name: line.dataset.name,
        label: line.dataset.label || line.dataset.name,
        base: line.dataset.base === undefined ? null : Number(line.dataset.base),
        angles: line.dataset.angles ? summed(line.dataset.angles, 1) : null,
        points: summed(line.getAttribute("d"), 2),
      })).filter((curve) => curve.name);
      // a curve that runs back to the left has several values at one place
      this.turns = this.curves.some(({ points }) => points.some((x, i) => i % 2 === 0 && x < points[i - 2] - 0.5));
      this.map = data.map ? this.readMap(data) : null;
      this.reset();
    }

    readMap(data) {
      const bytes = Uint8Array.from(atob(data.map), (c) => c.charCodeAt(0));
      return {
        values: new Float32Array(bytes.buffer), rows: Number(data.mapRows), edges: numbers(data.mapEdges),
        speeds: numbers(data.mapSpeeds), start: Number(data.mapStart), step: Number(data.mapStep),
      };
    }

    // the part of the whole drawing that fills the area, in pixels of the whole
    reset() {
      this.view = { left: this.left, top: this.top, width: this.width, height: this.height };
    }

    get zoomed() {
      const { view } = this;
      return view.width < this.width * 0.9999 || view.height < this.height * 0.9999;
    }

    // whole → shown
    shownX(x) { return this.left + ((x - this.view.left) / this.view.width) * this.width; }
    shownY(y) { return this.top + ((y - this.view.top) / this.view.height) * this.height; }
    // shown → whole
    wholeX(x) { return this.view.left + ((x - this.left) / this.width) * this.view.width; }
    wholeY(y) { return this.view.top + ((y - this.top) / this.height) * this.view.height; }
    // whole pixel → value
    valueX(x) {
      const pixel = (this.x[1] - this.x[0]) / this.width;
      const even = this.x[0] + (x - this.left) * pixel;
      return this.logX ? 10 ** even : rounded(even, pixel);
    }
    evenY(y) { return this.y[1] - ((y - this.top) / this.height) * (this.y[1] - this.y[0]); }
    valueY(y, base) {
      if (base !== null && base !== undefined) y += Number(this.data.front) - base;
      const even = this.evenY(y);
      return this.log ? 10 ** even : rounded(even, (this.y[1] - this.y[0]) / this.height);
    }
    pixelX(value) {
      const even = this.logX ? Math.log10(value) : value;
      return this.left + ((even - this.x[0]) / (this.x[1] - this.x[0])) * this.width;
    }
    pixelY(value) { return this.top + ((this.y[1] - value) / (this.y[1] - this.y[0])) * this.height; }

    contains([x, y]) {
      return x >= this.left && x <= this.left + this.width && y >= this.top && y <= this.top + this.height;
    }

    setView(left, top, width, height) {
      const least = 1 / 2000;
      width = Math.min(this.width, Math.max(this.width * least, width));
      height = Math.min(this.height, Math.max(this.height * least, height));
      if (this.fixedY) [top, height] = [this.top, this.height];
      left = Math.max(this.left, Math.min(this.left + this.width - width, left));
      top = Math.max(this.top, Math.min(this.top + this.height - height, top));
      this.view = { left, top, width, height };
    }

    zoomAbout(x, y, fx, fy) {
      const { view } = this;
      const [wx, wy] = [this.wholeX(x), this.wholeY(y)];
      this.setView(wx - (wx - view.left) * fx, wy - (wy - view.top) * fy, view.width * fx, view.height * fy);
    }

    draw() {
      const { view } = this;
      const [sx, sy] = [this.width / view.width, this.height / view.height];
      const [tx, ty] = [this.left - view.left * sx, this.top - view.top * sy];
      for (const group of this.group.querySelectorAll(".zoom"))
        group.setAttribute("transform", this.zoomed ? `matrix(${sx} 0 0 ${sy} ${tx} ${ty})` : "");
      for (const mark of this.group.querySelectorAll(".mark")) {
        const at = { x: mark.dataset.x, y: mark.dataset.y };
        const dx = at.x === undefined ? 0 : this.shownX(Number(at.x)) - Number(at.x);
        const dy = at.y === undefined ? 0 : this.shownY(Number(at.y)) - Number(at.y);
        mark.setAttribute("transform", `translate(${dx} ${dy})`);
        const inside = (at.x === undefined || (Number(at.x) + dx >= this.left - 1 && Number(at.x) + dx <= this.left + this.width + 1)) &&
          (at.y === undefined || (Number(at.y) + dy >= this.top - 1 && Number(at.y) + dy <= this.top + this.height + 1));
        mark.style.display = inside ? "" : "none";
      }
      if (!this.grid) return;
      if (this.zoomed) this.grid.replaceChildren(...this.lines());
      else this.grid.replaceChildren(...this.original);
    }

    // grid and numbers of a part of the drawing
    lines() {
      const made = [];
      const { view } = this;
      const numbered = this.equal || this.grid.classList.contains("numbered");
      const line = (x1, y1, x2, y2) => made.push(make("line", { x1, y1, x2, y2, stroke: "var(--grid)" }));
      const text = (x, y, anchor, content) => {
        const element = make("text", { x, y, "font-size": this.equal ? 13 : 15, fill: "var(--ink)", "text-anchor": anchor });
        element.textContent = content;
        made.push(element);
      };
      const ticks = (low, high, count, rule) => {
        if (low > high) [low, high] = [high, low];
        const step = rule((high - low) / count);
        const list = [];
        for (let i = Math.ceil(low / step - 1e-6); i * step <= high + 1e-6 * step && list.length < 40; i++) list.push(i * step);
        return [list, step];
      };
      const [from, to] = [this.valueX(view.left), this.valueX(view.left + view.width)];
      const [xs, xStep] = this.logX && to / from >= 5 ? [ratios(from, to), null] :
        ticks(from, to, this.equal ? 5 : 9, this.data.xKind === "angle" ? angleStep : niceStep);
      const bottom = this.top + this.height;
      for (const value of xs) {
        const at = this.shownX(this.pixelX(value));
        line(at, this.top, at, bottom);
        if (numbered) text(at, bottom + (this.equal ? 19 : 24), "middle", xStep === null ? short(value) : written(value, xStep));
      }
      if (this.fixedY) return made;
      const [ys, yStep] = ticks(this.evenY(view.top), this.evenY(view.top + view.height), this.equal ? 5 : 6,
        (raw) => (this.log ? Math.max(1, Math.round(raw)) : niceStep(raw)));
      for (const value of ys) {
        const at = this.shownY(this.pixelY(value));
        line(this.left, at, this.left + this.width, at);
        text(this.left - (this.equal ? 8 : 12), at + 5, "end",
          this.log ? "10" + superscript(Math.round(value)) : written(value / this.factor, yStep / this.factor));
      }
      return made;
    }

    visible() {
      return this.curves.filter((curve) => !curve.line.classList.contains("off"));
    }

    // what lies under the pointer: places of dots, parts of the readout
    at([px, py]) {
      const x = this.wholeX(px);
      const y = this.wholeY(py);
      if (this.map) return this.atMap(x, y, px, py);
      if (this.equal || this.fixedY || this.turns) return this.atNearest(x, y);
      const found = [];
      const dots = [];
      const seen = new Set();
      for (const { line, name, points } of this.visible()) {
        // points run from left to right
        if (seen.has(name) || points[0] > x + 0.5 || points[points.length - 2] < x - 0.5) continue;
        let [low, high] = [0, points.length / 2 - 1];
        while (high - low > 1) {
          const middle = (low + high) >> 1;
          if (points[2 * middle] <= x) low = middle;
          else high = middle;
        }
        const near = Math.abs(points[2 * low] - x) < Math.abs(points[2 * high] - x) ? low : high;
        seen.add(name);
        dots.push([this.shownX(points[2 * near]), this.shownY(points[2 * near + 1])]);
        found.push({
          color: line.getAttribute("stroke"),
          text: `${name}: ${short(this.valueY(points[2 * near + 1]))} ${this.data.yUnit}`,
          x: this.valueX(points[2 * near]),
        });
      }
      const own = this.data.title ? this.data.title + ", " : "";
      const place = found.length ? found[0].x : this.valueX(x);
      const frequency = this.data.speed ? `, ${short(Number((place * this.data.speed).toPrecision(5)))} Hz` : "";
      const order = this.data.turn ? `, order ${short(Number((place * this.data.turn).toPrecision(3)))}` : "";
      const here = `${own}${this.data.xName} ${short(place)} ${this.data.xUnit}${frequency}${order}`;
      return { hair: this.shownX(this.pixelX(place)), dots, parts: [{ text: here }, ...found] };
    }

    atNearest(x, y) {
      let best = null;
      let least = Infinity;
      const [sx, sy] = [this.width / this.view.width, this.height / this.view.height];
      for (const curve of this.visible()) {
        const { points } = curve;
        for (let i = 0; i < points.length; i += 2) {
          const distance = Math.hypot((points[i] - x) * sx, (points[i + 1] - y) * sy);
          if (distance < least) [least, best] = [distance, { curve, i }];
        }
      }
      if (!best || least > 40) return { dots: [], parts: [] };
      const { curve, i } = best;
      const [px, py] = [curve.points[i], curve.points[i + 1]];
      const { data } = this;
      const parts = [{ text: curve.label, color: curve.line.getAttribute("stroke") }];
      if (curve.angles) parts.push({ text: `${short(curve.angles[i / 2])} °CA` });
      parts.push({ text: `${data.xName} ${short(this.valueX(px))} ${data.xUnit}` });
      parts.push({ text: `${data.yName} ${short(this.valueY(py, curve.base))} ${data.yUnit}` });
      return { dots: [[this.shownX(px), this.shownY(py)]], parts };
    }

    atMap(x, y, px, py) {
      const { map, data } = this;
      const [speed, place] = [this.valueX(x), this.evenY(y)];
      const column = map.edges.findIndex((edge, i) => i + 1 < map.edges.length && speed >= edge && speed <= map.edges[i + 1]);
      const row = Math.floor((place - map.start) / map.step);
      if (column < 0 || row < 0 || row >= map.rows) return { dots: [], parts: [] };
      const value = map.values[column * map.rows + row];
      return {
        dots: [[px, py]],
        parts: [
          { text: `${short(map.speeds[column])} rpm` },
          { text: `${data.yName} ${short(map.start + (row + 0.5) * map.step)} ${data.yUnit}` },
          { text: `${data.mapName} ${short(value)} ${data.mapUnit}` },
        ],
      };
    }
  }

  // ---- one drawing

  function start(figure) {
    const svg = figure.querySelector("svg.drawing");
    const readout = figure.querySelector(".readout");
    const reset = figure.querySelector(".reset");
    const panels = [...svg.querySelectorAll("g.panel")].map((group) => new Panel(group));
    if (!panels.length) return;
    // panels one above the other share their axes
    const linked = (panel) => (panel.equal ? [panel] : panels);
    const cursor = make("g", { class: "cursor" });
    svg.append(cursor);

    const place = (event) => {
      const matrix = svg.getScreenCTM();
      if (!matrix) return [NaN, NaN];
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      return [point.x, point.y];
    };
    const under = (point) => panels.find((panel) => panel.contains(point));
    const clamp = (panel, [x, y]) => [
      Math.max(panel.left, Math.min(panel.left + panel.width, x)),
      Math.max(panel.top, Math.min(panel.top + panel.height, y)),
    ];

    const draw = () => {
      for (const panel of panels) panel.draw();
      reset.disabled = !panels.some((panel) => panel.zoomed);
    };
    const change = (panel, act) => {
      act(panel);
      const { view } = panel;
      for (const other of linked(panel)) {
        if (other === panel) continue;
        other.setView(
          other.left + ((view.left - panel.left) / panel.width) * other.width,
          other.top + ((view.top - panel.top) / panel.height) * other.height,
          (view.width / panel.width) * other.width, (view.height / panel.height) * other.height);
      }
      clear();
      draw();
    };
    const clear = () => {
      cursor.replaceChildren();
      readout.replaceChildren();
    };
    const show = (panel, point) => {
      const { hair, dots, parts } = panel.at(point);
      const marks = [];
      if (hair !== undefined)
        marks.push(make("line", { class: "hair", x1: hair, x2: hair, y1: panel.top, y2: panel.top + panel.height }));
      for (const dot of dots) if (panel.contains(dot)) marks.push(make("circle", { class: "dot", cx: dot[0], cy: dot[1], r: 4 }));
      cursor.replaceChildren(...marks);
      readout.replaceChildren(...parts.map(({ text, color }) => {
        const part = document.createElement("span");
        if (color) {
          const sample = document.createElement("i");
          sample.style.color = color;
          part.append(sample);
        }
        part.append(text);
        return part;
      }));
    };

    let drag = null;
    svg.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || event.target.closest(".legend-item")) return;
      const point = place(event);
      const panel = under(point);
      if (!panel) return;
      svg.focus({ preventScroll: true });
      event.preventDefault();
      drag = { panel, from: point, view: { ...panel.view }, move: event.shiftKey };
      svg.setPointerCapture(event.pointerId);
      svg.classList.add("dragging");
    });
    svg.addEventListener("pointermove", (event) => {
      const point = place(event);
      if (!drag) {
        const panel = under(point);
        if (panel) show(panel, point);
        else clear();
        return;
      }
      const { panel, from, view } = drag;
      if (drag.move) {
        change(panel, () => panel.setView(
          view.left - ((point[0] - from[0]) / panel.width) * view.width,
          view.top - ((point[1] - from[1]) / panel.height) * view.height, view.width, view.height));
        return;
      }
      const box = boxOf(panel, from, clamp(panel, point));
      cursor.replaceChildren(make("rect", { class: "band", ...box }));
    });
    // a flat or thin box zooms along one axis only; equal axes stay equal
    const boxOf = (panel, a, b) => {
      let [x, width] = [Math.min(a[0], b[0]), Math.abs(a[0] - b[0])];
      let [y, height] = [Math.min(a[1], b[1]), Math.abs(a[1] - b[1])];
      if (panel.equal) {
        const side = Math.max(width, height);
        const middle = [x + width / 2, y + height / 2];
        return { x: middle[0] - side / 2, y: middle[1] - side / 2, width: side, height: side };
      }
      if (height < 12 || panel.fixedY) [y, height] = [panel.top, panel.height];
      else if (width < 12) [x, width] = [panel.left, panel.width];
      return { x, y, width, height };
    };
    const finish = (event) => {
      if (!drag) return;
      const { panel, from, move } = drag;
      drag = null;
      svg.classList.remove("dragging");
      cursor.replaceChildren();
      if (move || event.type === "pointercancel") return;
      const to = clamp(panel, place(event));
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 8) return;
      const box = boxOf(panel, from, to);
      change(panel, () => {
        const { view } = panel;
        panel.setView(panel.wholeX(box.x), panel.wholeY(box.y),
          (box.width / panel.width) * view.width, (box.height / panel.height) * view.height);
      });
    };
    svg.addEventListener("pointerup", finish);
    svg.addEventListener("pointercancel", finish);
    svg.addEventListener("pointerleave", () => { if (!drag) clear(); });
    const all = () => {
      for (const panel of panels) panel.reset();
      clear();
      draw();
    };
    svg.addEventListener("dblclick", all);
    reset.addEventListener("click", all);
    svg.addEventListener("wheel", (event) => {
      // a page must scroll past a drawing nobody has touched
      if (document.activeElement !== svg && !event.ctrlKey) return;
      const point = place(event);
      const panel = under(point);
      if (!panel) return;
      event.preventDefault();
      const factor = Math.exp((event.deltaY || event.deltaX) * 0.0015);
      const [fx, fy] = panel.equal ? [factor, factor] : event.shiftKey ? [1, factor] : [factor, 1];
      change(panel, () => panel.zoomAbout(point[0], point[1], fx, fy));
    }, { passive: false });
    svg.addEventListener("keydown", (event) => {
      if (event.target !== svg) return;
      const panel = panels[0];
      const middle = [panel.left + panel.width / 2, panel.top + panel.height / 2];
      const zoom = (f) => change(panel, () => panel.zoomAbout(middle[0], middle[1], f, panel.equal ? f : 1));
      const move = (dx, dy) => change(panel, () => panel.setView(
        panel.view.left + dx * panel.view.width, panel.view.top + dy * panel.view.height, panel.view.width, panel.view.height));
      const act = {
        "+": () => zoom(0.8), "-": () => zoom(1.25), "0": all, Escape: all,
        ArrowLeft: () => move(-0.1, 0), ArrowRight: () => move(0.1, 0), ArrowUp: () => move(0, -0.1), ArrowDown: () => move(0, 0.1),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    });

    for (const item of svg.querySelectorAll(".legend-item")) {
      const toggle = () => {
        const shown = item.getAttribute("aria-pressed") !== "true";
        item.setAttribute("aria-pressed", String(shown));
        for (const panel of panels)
          for (const curve of panel.curves)
            if (curve.name === item.dataset.name) curve.line.classList.toggle("off", !shown);
        clear();
      };
      item.addEventListener("click", toggle);
      item.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        toggle();
      });
    }
    addEventListener("beforeprint", all);
  }

  // a page of a hundred drawings opens fast: each wakes when it comes near
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      start(target);
    }
  }, { rootMargin: "600px" });
  for (const figure of document.querySelectorAll("figure.plot")) {
    figure.querySelector(".tools").hidden = false;
    near.observe(figure);
  }
})();
