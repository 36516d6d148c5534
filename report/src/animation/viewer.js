// Shows the glTF files of a page's animations: only what eng writes into them, nothing else.
(() => {
  "use strict";

  // base64, deflated, and the four bytes of each number in planes of their own
  const bytesOf = async (text) => {
    const packed = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer());
    const bytes = new Uint8Array(planes.length);
    const length = planes.length / 4;
    for (let plane = 0; plane < 4; plane++)
      for (let i = 0; i < length; i++) bytes[4 * i + plane] = planes[plane * length + i];
    return bytes;
  };

  // ---- reading

  function readModel(bytes) {
    const view = new DataView(bytes.buffer);
    if (view.getUint32(0, true) !== 0x46546c67) throw new Error("not a glTF file");
    const jsonLength = view.getUint32(12, true);
    const document = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonLength)));
    const start = 20 + jsonLength + 8;
    const sizes = { SCALAR: 1, VEC3: 3, VEC4: 4 };
    const array = (index) => {
      const accessor = document.accessors[index];
      const data = document.bufferViews[accessor.bufferView];
      const Kind = accessor.componentType === 5125 ? Uint32Array : Float32Array;
      return new Kind(bytes.buffer, start + data.byteOffset, accessor.count * sizes[accessor.type]);
    };
    const scene = document.scenes[0];
    const root = document.nodes[scene.nodes[0]];
    const animation = (document.animations || [{ channels: [], samplers: [] }])[0];
    const tracks = new Map();
    for (const channel of animation.channels) {
      const sampler = animation.samplers[channel.sampler];
      const track = tracks.get(channel.target.node) || {};
      track[channel.target.path] = array(sampler.output);
      tracks.set(channel.target.node, track);
    }
    const bodies = [];
    for (const index of root.children || []) {
      const node = document.nodes[index];
      if (node.mesh === undefined) continue;
      for (const primitive of document.meshes[node.mesh].primitives) {
        const color = document.materials[primitive.material].pbrMetallicRoughness.baseColorFactor;
        bodies.push({
          name: node.name,
          lines: primitive.mode === 1,
          base: array(primitive.attributes.POSITION),
          indices: primitive.indices === undefined ? null : array(primitive.indices),
          targets: (primitive.targets || []).map((t) => array(t.POSITION)),
          fields: ((node.extras && node.extras.fields) || []).map((f) => ({
            ...f,
            values: array(primitive.attributes[f.attribute]),
          })),
          film: (node.extras && node.extras.film) || null,
          largest: (node.extras && node.extras.largest_displacement) || 0,
          color: color.slice(0, 3).map((c) => Math.pow(c, 1 / 2.2)),
          translation: node.translation,
          rotation: node.rotation,
          track: tracks.get(index) || {},
        });
      }
    }
    return { bodies, root: root.rotation, ...scene.extras };
  }

  // ---- small matrices, by columns

  const multiply = (a, b) => {
    const c = new Float32Array(16);
    for (let i = 0; i < 4; i++)
      for (let j = 0; j < 4; j++)
        for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    return c;
  };

  const placed = ([x, y, z, w], [tx, ty, tz]) =>
    new Float32Array([
      1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
      2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
      2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
      tx, ty, tz, 1,
    ]);

  const perspective = (angle, ratio, near, far) => {
    const f = 1 / Math.tan(angle / 2);
    return new Float32Array([
      f / ratio, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
      0, 0, (2 * far * near) / (near - far), 0,
    ]);
  };

  const unit = (v) => {
    const length = Math.hypot(...v) || 1;
    return v.map((c) => c / length);
  };
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
  ];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  const lookAt = (eye, target) => {
    const back = unit([0, 1, 2].map((i) => eye[i] - target[i]));
    const right = unit(cross([0, 1, 0], back));
    const up = cross(back, right);
    return new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
    ]);
  };

  // ---- drawing

  const VERTEX = `#version 300 es
    in vec3 place; in float value;
    uniform mat4 model, view, projection;
    out vec3 seen; out float level;
    void main() {
      vec4 p = view * model * vec4(place, 1.0);
      seen = p.xyz; level = value;
      gl_Position = projection * p;
    }`;
  // flat shading: the surface's normal from how its place changes between pixels
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 seen; in float level;
    uniform vec3 color; uniform bool lit, colored;
    out vec4 shown;
    vec3 cividis(float t) {
      vec3 c[5] = vec3[5](vec3(0.0, 0.133, 0.306), vec3(0.255, 0.302, 0.42), vec3(0.486, 0.482, 0.471),
        vec3(0.737, 0.678, 0.424), vec3(0.996, 0.91, 0.22));
      float s = clamp(t, 0.0, 1.0) * 4.0;
      int i = min(int(s), 3);
      return mix(c[i], c[i + 1], s - float(i));
    }
    void main() {
      vec3 tone = colored ? cividis(level) : color;
      float light = 1.0;
      if (lit) {
        vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
        light = 0.4 + 0.6 * abs(dot(normal, normalize(vec3(0.25, 0.4, 1.0))));
      }
      shown = vec4(tone * light, 1.0);
    }`;

  function program(gl) {
    const made = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    return made;
  }

  const number = (value) => (value === 0 ? "0" : Number(value.toPrecision(3)).toString());

  async function start(figure) {
    const find = (name) => figure.querySelector("." + name);
    const canvas = figure.querySelector("canvas");
    const trouble = (text) => {
      const place = find("trouble");
      place.textContent = text;
      place.hidden = false;
    };
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) {
      trouble("This browser has no WebGL 2: the picture above stands still. The animation can be saved as a glTF file.");
    }
    let bytes, model;
    try {
      bytes = await bytesOf(find("model").textContent);
      model = readModel(bytes);
      figure.dataset.bytes = bytes.length;
    } catch (error) {
      trouble("The animation cannot be read: " + error.message);
      return;
    }
    const save = find("save");
    save.addEventListener("click", () => {
      if (!save.href.startsWith("blob:"))
        save.href = URL.createObjectURL(new Blob([bytes], { type: "model/gltf-binary" }));
    });
    find("controls").hidden = false;
    if (!gl) {
      for (const control of figure.querySelectorAll(".controls button, .controls label, .controls output"))
        control.hidden = true;
      return;
    }
    figure.classList.add("alive");

    const shader = program(gl);
    const at = (name) => gl.getUniformLocation(shader, name);
    const uniforms = Object.fromEntries(
      ["model", "view", "projection", "color", "lit", "colored"].map((n) => [n, at(n)]));
    const slots = ["place", "value"].map((n) => gl.getAttribLocation(shader, n));
    for (const body of model.bodies) {
      body.places = new Float32Array(body.base);
      body.moved = new Float32Array(body.base.length);
      body.values = new Float32Array(body.base.length / 3);
      body.layout = gl.createVertexArray();
      gl.bindVertexArray(body.layout);
      body.buffers = [body.places, body.values].map((data, i) => {
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
        gl.enableVertexAttribArray(slots[i]);
        gl.vertexAttribPointer(slots[i], i === 0 ? 3 : 1, gl.FLOAT, false, 0, 0);
        return buffer;
      });
      if (body.indices) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, body.indices, gl.STATIC_DRAW);
      }
    }
    gl.bindVertexArray(null);

    // choices of colour: fields of one name are one choice
    const select = find("color");
    const fields = [...new Set(model.bodies.flatMap((b) => b.fields.map((f) => f.name)))];
    for (const name of fields) {
      const option = document.createElement("option");
      option.value = "field:" + name;
      option.textContent = name;
      select.append(option);
    }
    // all films have one scale
    const film = (model.bodies.find((b) => b.film) || {}).film;
    if (film) {
      const option = document.createElement("option");
      option.value = "film";
      option.textContent = film.name;
      select.append(option);
      select.value = "film";
    }
    // bodies of one kind have one colour
    const kinds = new Map(model.bodies.filter((b) => !b.film).map((b) => [b.name.split("[")[0], b.color]));
    if (kinds.size > 1) {
      find("kinds").append(...[...kinds].map(([name, color]) => {
        const entry = document.createElement("span");
        const patch = document.createElement("i");
        patch.style.background = `rgb(${color.map((c) => Math.round(255 * c))})`;
        entry.append(patch, name);
        return entry;
      }));
    }
    const largest = Math.max(0, ...model.bodies.map((b) => b.largest));

    const last = model.times.length - 1;
    const state = { frame: 0, playing: false, rate: 1, factor: 1, color: select.value, drawn: 0 };
    const first = unit(figure.dataset.view.split(" ").map(Number));
    const home = () => {
      state.azimuth = Math.atan2(first[0], first[2]);
      state.height = Math.asin(first[1]);
      // all of it, on a narrow screen, too
      state.distance = model.radius * 2.6 * Math.max(1, (1.25 * canvas.clientHeight) / (canvas.clientWidth || 1));
      state.target = model.center.slice();
    };
    home();

    const frameOf = () => {
      const index = Math.min(Math.floor(state.frame), Math.max(last - 1, 0));
      return [index, Math.min(index + 1, last), state.frame - index];
    };
    const between = (values, size) => {
      const [a, b, t] = frameOf();
      const result = new Array(size);
      for (let i = 0; i < size; i++) result[i] = values[a * size + i] * (1 - t) + values[b * size + i] * t;
      return result;
    };

    const scales = new Map();
    function scaleOf(color) {
      if (color === "film") return film;
      if (color === "displacement") return { low: 0, high: largest, unit: "m", name: "displacement" };
      const all = model.bodies.flatMap((b) => b.fields.filter((f) => "field:" + f.name === color));
      if (!all.length) return null;
      if (!scales.has(color)) {
        // a few sharp edges must not take the colours from all the rest
        const sorted = Float32Array.from(all.flatMap((f) => [...f.values])).sort();
        const largest = Math.max(...all.map((f) => f.high));
        const most = sorted[Math.floor(0.99 * (sorted.length - 1))];
        const clipped = most > 0 && most < 0.5 * largest;
        scales.set(color, {
          low: Math.min(...all.map((f) => f.low)), high: clipped ? most : largest, largest, clipped,
          unit: all[0].unit, name: all[0].name,
        });
      }
      return scales.get(color);
    }

    function deform(body) {
      const weights = body.targets.length ? between(body.track.weights, body.targets.length) : [];
      const { base, places, values } = body;
      const moved = body.moved.fill(0);
      body.targets.forEach((target, mode) => {
        const weight = weights[mode];
        if (weight !== 0) for (let i = 0; i < moved.length; i++) moved[i] += weight * target[i];
      });
      // the hill of a film is a pressure, no displacement
      const factor = body.film ? 1 : state.factor;
      for (let i = 0; i < places.length; i++) places[i] = base[i] + factor * moved[i];
      body.colored = Boolean(body.film);
      const range = scaleOf(state.color);
      if (body.film) {
        for (let n = 0; n < values.length; n++)
          values[n] = Math.hypot(moved[3 * n], moved[3 * n + 1], moved[3 * n + 2]) / body.film.height;
      } else if (range && state.color === "displacement" && body.targets.length) {
        const shown = model.deformation_scale * (range.high || 1);
        for (let n = 0; n < values.length; n++)
          values[n] = Math.hypot(moved[3 * n], moved[3 * n + 1], moved[3 * n + 2]) / shown;
        body.colored = true;
      } else if (range) {
        const field = body.fields.find((f) => "field:" + f.name === state.color);
        if (field) {
          const width = range.high - range.low || 1;
          for (let n = 0; n < values.length; n++) values[n] = (field.values[n] - range.low) / width;
          body.colored = true;
        }
      }
      [places, values].forEach((data, i) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, body.buffers[i]);
        gl.bufferSubData(gl.ARRAY_BUFFER, 0, data);
      });
    }

    function draw() {
      const ratio = window.devicePixelRatio || 1;
      const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
      const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
      gl.viewport(0, 0, width, height);
      const sheet = getComputedStyle(canvas).backgroundColor.match(/[\d.]+/g) || [255, 255, 255];
      gl.clearColor(sheet[0] / 255, sheet[1] / 255, sheet[2] / 255, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.useProgram(shader);
      const { azimuth, height: up, distance, target } = state;
      const eye = [
        target[0] + distance * Math.cos(up) * Math.sin(azimuth),
        target[1] + distance * Math.sin(up),
        target[2] + distance * Math.cos(up) * Math.cos(azimuth),
      ];
      gl.uniformMatrix4fv(uniforms.view, false, lookAt(eye, target));
      gl.uniformMatrix4fv(uniforms.projection, false,
        perspective(0.7, width / height, distance / 100, distance + 20 * model.radius));
      const root = placed(model.root, [0, 0, 0]);
      for (const body of model.bodies) {
        const { track } = body;
        const translation = track.translation ? between(track.translation, 3) : body.translation;
        const rotation = track.rotation ? unit(between(track.rotation, 4)) : body.rotation;
        gl.bindVertexArray(body.layout);
        deform(body);
        gl.uniformMatrix4fv(uniforms.model, false, multiply(root, placed(rotation, translation)));
        gl.uniform3fv(uniforms.color, body.color);
        gl.uniform1i(uniforms.lit, body.lines ? 0 : 1);
        gl.uniform1i(uniforms.colored, body.colored ? 1 : 0);
        if (body.indices) gl.drawElements(gl.TRIANGLES, body.indices.length, gl.UNSIGNED_INT, 0);
        else gl.drawArrays(body.lines ? gl.LINES : gl.TRIANGLES, 0, body.base.length / 3);
      }
      gl.bindVertexArray(null);
      state.drawn += 1;
      figure.dataset.drawn = state.drawn;
      tell();
    }

    const sliders = { time: find("time"), scale: find("scale"), rate: find("rate") };
    function tell() {
      const [a, b, t] = frameOf();
      const mix = (list) => list[a] * (1 - t) + list[b] * t;
      let text = (mix(model.times) * 1000).toFixed(2) + " ms";
      if (model.crank_angles.length) text += ", " + mix(model.crank_angles).toFixed(1).replace(/^-(0\.0)$/, "$1") + " °CA";
      find("clock").textContent = text;
      find("scale-value").textContent = "× " + number(model.deformation_scale * state.factor);
      find("rate-value").textContent = "1 : " + number(model.slowdown / state.rate);
      const range = scaleOf(state.color);
      find("colors").hidden = !range;
      find("kinds").hidden = Boolean(range) || kinds.size < 2;
      if (range) {
        const micro = range.unit === "m";
        const text = (v) => number(micro ? v * 1e6 : v) + (micro ? " µm" : " " + range.unit);
        find("low").textContent = text(range.low);
        find("high").textContent = range.clipped
          ? `${text(range.high)} and more, ${range.name}; at most ${text(range.largest)}`
          : `${text(range.high)}, ${range.name}`;
      }
      if (document.activeElement !== sliders.time) sliders.time.value = state.frame;
      sliders.time.setAttribute("aria-valuetext", text);
    }

    // one drawing a picture of the screen, and none where nothing changes
    let asked = false;
    let before = 0;
    const ask = () => {
      if (asked) return;
      asked = true;
      requestAnimationFrame((now) => {
        asked = false;
        if (state.playing) {
          const seconds = Math.min((now - before) / 1000, 0.1);
          before = now;
          const duration = model.times[last] - model.times[0];
          // times need not be evenly spaced
          const [a, b, t] = frameOf();
          let time = model.times[a] * (1 - t) + model.times[b] * t;
          time += (seconds * state.rate) / model.slowdown;
          if (time >= model.times[last]) time -= duration || 0;
          let low = 0;
          let high = last;
          while (high - low > 1) {
            const middle = (low + high) >> 1;
            if (model.times[middle] <= time) low = middle;
            else high = middle;
          }
          const width = model.times[high] - model.times[low];
          state.frame = width > 0 ? low + (time - model.times[low]) / width : 0;
          if (document.activeElement === sliders.time) sliders.time.value = state.frame;
        }
        draw();
        if (state.playing) ask();
      });
    };

    const play = find("play");
    const setPlaying = (playing) => {
      state.playing = playing && last > 0;
      play.textContent = state.playing ? "Pause" : "Play";
      play.setAttribute("aria-pressed", String(state.playing));
      before = performance.now();
      ask();
    };
    play.addEventListener("click", () => setPlaying(!state.playing));
    sliders.time.addEventListener("input", () => {
      setPlaying(false);
      state.frame = Number(sliders.time.value);
      ask();
    });
    // 0…2: nothing, as stored at 1, ten times at 2
    sliders.scale.addEventListener("input", () => {
      const at = Number(sliders.scale.value);
      state.factor = at <= 1 ? at : Math.pow(10, at - 1);
      ask();
    });
    sliders.rate.addEventListener("input", () => {
      state.rate = Math.pow(10, Number(sliders.rate.value));
      ask();
    });
    select.addEventListener("change", () => {
      state.color = select.value;
      ask();
    });
    find("home").addEventListener("click", () => {
      home();
      ask();
    });

    const turn = (dx, dy) => {
      state.azimuth -= dx;
      state.height = Math.max(-1.55, Math.min(1.55, state.height + dy));
      ask();
    };
    const move = (dx, dy) => {
      const [sine, cosine] = [Math.sin(state.azimuth), Math.cos(state.azimuth)];
      const step = state.distance * 0.7;
      state.target[0] -= step * dx * cosine;
      state.target[2] += step * dx * sine;
      state.target[1] += step * dy;
      ask();
    };
    const approach = (factor) => {
      state.distance = Math.max(model.radius * 0.2, Math.min(model.radius * 20, state.distance * factor));
      ask();
    };
    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = event;
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      const size = canvas.clientHeight || 1;
      const dx = (event.clientX - held.clientX) / size;
      const dy = (event.clientY - held.clientY) / size;
      if (event.shiftKey || event.buttons === 2) move(dx, dy);
      else turn(dx * 4, dy * 4);
      held = event;
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (held = null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      // a page must scroll past a picture nobody has touched
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      approach(Math.exp(event.deltaY * 0.001));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const act = {
        ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0),
        ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
        "+": () => approach(0.9), "-": () => approach(1.1), "0": () => { home(); ask(); },
        " ": () => setPlaying(!state.playing),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    });
    new ResizeObserver(ask).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", ask);
    addEventListener("beforeprint", draw);
    canvas.addEventListener("webglcontextlost", () => {
      figure.classList.remove("alive");
      trouble("The browser has taken the drawing away; reload the page to see it move again.");
    });
    ask();
  }

  // unpacked when it comes near, so that the page opens fast
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      start(target).catch((error) => {
        console.error(error);
        const place = target.querySelector(".trouble");
        place.textContent = "The animation cannot be shown: " + error.message;
        place.hidden = false;
      });
    }
  }, { rootMargin: "400px" });
  for (const figure of document.querySelectorAll("figure.animation")) near.observe(figure);
})();
