"use strict";
/* A mechanism in motion and its channels.  All text goes through textContent, so that names with markup are harmless. */
const MOVING = (() => {
  const COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];
  const DASHES = [[], [7, 4], [9, 3, 2, 3], [2, 3], [14, 4], [8, 2, 2, 2, 2, 2]];
  const LEVELS = 65535;

  async function unpacked(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  function column(numbers, at) {
    const found = new Float32Array(at.length);
    let level = 0;
    for (let k = 0; k < at.length; k++) {
      level = (level + numbers[at.start + k]) & LEVELS;
      found[k] = level === LEVELS ? NaN : at.low + at.step * level;
    }
    return found;
  }

  async function read(head, numbers) {
    const [text, raw] = await Promise.all([unpacked(head), unpacked(numbers)]);
    const data = JSON.parse(new TextDecoder().decode(text));
    const packed = new Uint16Array(raw);
    for (const run of data.runs) {
      for (const part of [run.bodies, run.forces]) {
        for (const name of Object.keys(part)) part[name] = part[name].map((at) => column(packed, at));
      }
    }
    if (data.channels) data.channels.columns.forEach((c) => (c.values = column(packed, c)));
    return data;
  }

  const make = (tag, parent, fields = {}, attributes = {}) => {
    const element = Object.assign(document.createElement(tag), fields);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (parent) parent.append(element);
    return element;
  };

  /* Time: what plays, and who wants to know. */
  function clock(start, end) {
    const listeners = [];
    const it = {
      start, end, t: start, playing: false, speed: 1,
      on: (f) => listeners.push(f),
      set(t) { it.t = Math.min(Math.max(t, start), end); listeners.forEach((f) => f(it.t)); },
      toggle() { if (!it.playing && it.t >= end) it.set(start); it.playing = !it.playing; listeners.forEach((f) => f(it.t)); },
    };
    return it;
  }

  /* The pose of a body of a run at a time, between the instants that are known. */
  function posed(run, body, t, point, turn) {
    const columns = run.bodies[body];
    if (!columns) { point.set(0, 0, 0); turn.set(0, 0, 0, 1); return; }
    const place = Math.min(Math.max((t - run.start) / (run.end - run.start || 1), 0), 1) * (run.count - 1);
    const k = Math.min(Math.floor(place), run.count - 2), part = place - k;
    const at = (n) => columns[n][k] + part * (columns[n][k + 1] - columns[n][k]);
    point.set(at(0), at(1), at(2));
    turn.set(at(4), at(5), at(6), at(3)).normalize();
  }

  function forceOf(run, name, t, found) {
    const columns = run.forces[name];
    if (!columns) return false;
    const place = Math.min(Math.max((t - run.start) / (run.end - run.start || 1), 0), 1) * (run.count - 1);
    const k = Math.min(Math.floor(place), run.count - 2), part = place - k;
    found.set(...columns.map((c) => c[k] + part * (c[k + 1] - c[k])));
    return Number.isFinite(found.x + found.y + found.z);
  }

  /* The mechanism of one run as objects of three.js. */
  function mechanism(drawing, run, ghost) {
    const flat = drawing.dimensions === 2, groups = {}, root = new THREE.Group(), links = [];
    const group = (body) => (groups[body] ??= root.add(new THREE.Group()).children.at(-1));
    const material = (Kind, color, order, extra = {}) => new Kind({
      color: ghost ?? color, transparent: flat || ghost !== undefined, opacity: ghost !== undefined ? 0.35 : 1, depthTest: !flat, ...extra,
    });
    const order = (points) => points.reduce((sum, p) => sum + p[2], 0) / points.length / drawing.size + (ghost !== undefined ? -100 : 0);
    const line = (points, color, dashed, pairs) => {
      const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points.flat(), 3));
      if (pairs) geometry.setIndex(pairs.flat());
      const Kind = pairs ? THREE.LineSegments : THREE.Line;
      const size = drawing.size * 0.012;
      const found = new Kind(geometry, dashed
        ? material(THREE.LineDashedMaterial, color, 0, { dashSize: size, gapSize: size * 0.6 })
        : material(THREE.LineBasicMaterial, color));
      if (dashed) found.computeLineDistances();
      return found;
    };
    drawing.parts.forEach((part, number) => {
      const into = group(part.body);
      for (const solid of part.solids) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position", new THREE.Float32BufferAttribute(solid.vertices.flat(), 3));
        geometry.setIndex(solid.triangles.flat());
        const shaded = geometry.toNonIndexed();
        shaded.computeVertexNormals();
        const mesh = new THREE.Mesh(shaded, material(flat ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial, part.color, 0, {
          side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...(flat && ghost === undefined ? { opacity: 0.92 } : {}),
        }));
        mesh.renderOrder = order(solid.vertices) + number * 1e-6;
        into.add(mesh);
        if (solid.edges.length) into.add(line(solid.vertices, part.edge, false, solid.edges));
      }
      for (const stroke of part.lines) {
        const found = line(stroke.points, part.edge, stroke.dashed);
        found.renderOrder = order(stroke.points) + 1e-3;
        into.add(found);
      }
    });
    for (const link of drawing.links) {
      for (const profile of link.profiles) {
        const found = line(profile.map(() => [0, 0, 0]), link.edge, link.dashed);
        found.frustumCulled = false;
        found.renderOrder = 1;
        root.add(found);
        links.push({ link, profile, found });
      }
    }
    const point = new THREE.Vector3(), turn = new THREE.Quaternion();
    const anchored = (anchor, t) => {
      posed(run, anchor.body, t, point, turn);
      return new THREE.Vector3(...anchor.point).applyQuaternion(turn).add(point);
    };
    const stretch = (profile, a, b, positions) => {
      const way = b.clone().sub(a), along = way.clone().normalize();
      const up = Math.abs(along.z) < 0.9 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(1, 0, 0);
      const one = new THREE.Vector3().crossVectors(up, along).normalize(), other = new THREE.Vector3().crossVectors(along, one);
      profile.forEach(([s, u, v], k) => positions.setXYZ(k,
        a.x + s * way.x + u * one.x + v * other.x, a.y + s * way.y + u * one.y + v * other.y, a.z + s * way.z + u * one.z + v * other.z));
      positions.needsUpdate = true;
    };
    const update = (t) => {
      for (const [body, found] of Object.entries(groups)) {
        if (body === "ground") continue;
        posed(run, body, t, found.position, found.quaternion);
      }
      for (const { link, profile, found } of links) {
        stretch(profile, anchored(link.i, t), anchored(link.j, t), found.geometry.attributes.position);
        if (link.dashed) found.computeLineDistances();
      }
    };
    return { root, update, anchored };
  }

  /* The path of a point over a whole run. */
  function trace(machine, run, anchor, color) {
    const points = [];
    for (let k = 0; k < run.count; k++) points.push(...machine.anchored(anchor, run.start + (k / (run.count - 1)) * (run.end - run.start)).toArray());
    const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    const found = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color, transparent: true, depthTest: false }));
    found.renderOrder = 200;
    return found;
  }

  function arrow(color, unit) {
    const found = new THREE.Group(), paint = new THREE.MeshBasicMaterial({ color, depthTest: false, transparent: true });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.15 * unit, 0.15 * unit, 1, 8).translate(0, 0.5, 0), paint);
    const head = new THREE.Mesh(new THREE.ConeGeometry(0.5 * unit, 1.5 * unit, 12).translate(0, -0.75 * unit, 0), paint);
    shaft.renderOrder = head.renderOrder = 300;
    found.add(shaft, head);
    found.pointTo = (way, length) => {
      const neck = Math.max(length - 1.5 * unit, 0.2 * length);
      shaft.scale.y = neck;
      head.position.y = length;
      head.scale.setScalar(Math.min(1, length / (2 * unit)));
      found.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
    };
    return found;
  }

  function view(place, data, time) {
    const { drawing } = data, size = drawing.size;
    const canvas = make("canvas", place, {}, { tabindex: 0, role: "img", "aria-label": `${drawing.name || "mechanism"} in motion; drag to turn it, space plays and pauses` });
    let renderer;
    try {
      renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    } catch {
      canvas.remove();
      make("p", place, { textContent: "This browser draws no WebGL; the pictures and tables below show the results.", className: "hint" });
      return null;
    }
    renderer.setClearColor(0xffffff);
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const scene = new THREE.Scene();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9aa5, 2.2), new THREE.AmbientLight(0xffffff, 0.5));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.4);
    scene.add(lamp);
    const machines = data.runs.map((run, k) => {
      const machine = mechanism(drawing, run, k ? COLORS[k % COLORS.length] : undefined);
      scene.add(machine.root);
      return machine;
    });
    const upright = drawing.dimensions === 2 || Math.abs(drawing.gravity[1]) > Math.abs(drawing.gravity[2]) ? "y" : "z";
    const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -50 * size, 50 * size);
    camera.up.set(0, upright === "y" ? 1 : 0, upright === "z" ? 1 : 0);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    const box = new THREE.Box3();
    const throughout = (act) => {
      for (let k = 0; k <= 12; k++) {
        for (const machine of machines) {
          machine.update(time.start + ((time.end - time.start) * k) / 12);
          machine.root.updateMatrixWorld(true);
          act(machine.root);
        }
      }
    };
    const framed = data.follow ? (act) => machines.forEach((machine) => { machine.update(time.start); machine.root.updateMatrixWorld(true); act(machine.root); }) : throughout;
    framed((root) => box.expandByObject(root, true));
    const middle = box.getCenter(new THREE.Vector3()), reach = box.getSize(new THREE.Vector3()).length() || size;
    const home = () => {
      controls.target.copy(middle);
      const way = drawing.dimensions === 2 ? [0, 0, 1] : upright === "z" ? [1, -1, 0.8165] : [1, 0.8165, 1];
      camera.position.copy(middle).add(new THREE.Vector3(...way).normalize().multiplyScalar(10 * size));
      camera.zoom = 1;
      controls.update();
    };
    home();
    camera.updateMatrixWorld();
    const half = new THREE.Vector3(), corner = new THREE.Vector3(), level = camera.quaternion.clone().invert();
    framed((root) => root.traverse((part) => {  // half of the width and height of the whole motion, or of the start, as it is seen first
      if (!part.geometry) return;
      part.geometry.computeBoundingBox();
      const own = part.geometry.boundingBox;
      for (let k = 0; k < 8; k++) {
        corner.set(...["x", "y", "z"].map((axis, n) => (k & (1 << n) ? own.min : own.max)[axis]));
        corner.applyMatrix4(part.matrixWorld).sub(middle).applyQuaternion(level);
        half.set(Math.max(half.x, Math.abs(corner.x)), Math.max(half.y, Math.abs(corner.y)), 0);
      }
    }));

    const loads = drawing.loads.map((load) => {
      const found = arrow(drawing.marks[load.name] ? "#e69f00" : drawing.load_color, drawing.unit);
      scene.add(found);
      return { load, found };
    });
    const names = drawing.names.map((name) => ({
      name, label: make("span", place, { textContent: name.text, className: name.role === "body" ? "name" : "name element" }, { "aria-hidden": "true" }),
    }));
    const state = { forces: data.longest.force > 0, names: drawing.names.length <= 40, follow: data.follow, traces: [] };
    const addTrace = (anchor) => data.runs.forEach((run, k) => {
      const found = trace(machines[k], run, anchor, COLORS[(state.traces.length + 1) % COLORS.length]);
      state.traces.push(found);
      scene.add(found);
    });
    const clearTraces = () => state.traces.splice(0).forEach((found) => { scene.remove(found); found.geometry.dispose(); });
    data.traces.forEach(addTrace);

    if (data.runs.length > 1 || data.longest.force > 0) {
      const legend = make("div", place, { className: "legend" });
      const entry = (color, text) => {
        const row = make("div", legend);
        make("span", row, { className: "key" }).style.background = color;
        row.append(text);
      };
      if (data.runs.length > 1) data.runs.forEach((run, k) => entry(k ? COLORS[k % COLORS.length] : "#56b4e9", run.name || "run"));
      if (data.longest.force > 0) entry(drawing.load_color, `forces, longest ${Number(data.longest.force.toPrecision(4))} N`);
      for (const mark of new Set(Object.values(drawing.marks))) entry(mark === "redundant" ? "#d55e00" : "#e69f00", mark === "redundant" ? "redundant equations" : "force not unique");
    }

    let wide = 0, high = 0, before = null;
    const force = new THREE.Vector3();
    function fit() {
      const w = place.clientWidth, h = place.clientHeight;
      if (w === wide && h === high) return;
      [wide, high] = [w, h];
      renderer.setSize(w, h, false);
      const ratio = w / h, up = 1.12 * Math.max(half.y, half.x / ratio, 0.1 * reach);
      Object.assign(camera, { left: -up * ratio, right: up * ratio, top: up, bottom: -up });
      camera.updateProjectionMatrix();
    }
    function draw() {
      fit();
      const t = time.t;
      machines.forEach((machine) => machine.update(t));
      if (state.follow) {
        const now = machines[0].anchored({ body: state.follow, point: [0, 0, 0] }, t);
        if (before) { const step = now.clone().sub(before); camera.position.add(step); controls.target.add(step); }
        before = now;
      } else before = null;
      for (const { load, found } of loads) {
        const length = state.forces && forceOf(data.runs[0], load.name, t, force) ? (force.length() / data.longest.force) * data.longest.length : 0;
        found.visible = length > 0.01 * size;
        if (found.visible) { found.position.copy(machines[0].anchored(load, t)); found.pointTo(force.normalize(), length); }
      }
      lamp.position.copy(camera.position).add(new THREE.Vector3(0.3, 0.6, 0.2).multiplyScalar(size));
      camera.updateMatrixWorld();
      renderer.render(scene, camera);
      for (const { name, label } of names) {
        label.hidden = !state.names;
        if (!state.names) continue;
        const p = machines[0].anchored(name, t).project(camera);
        label.style.transform = `translate(${((p.x + 1) / 2) * wide + 7}px, ${((1 - p.y) / 2) * high - (name.role === "body" ? 18 : -4)}px)`;
      }
    }
    controls.addEventListener("change", () => { it.stale = true; });
    const it = { draw, state, home: () => { home(); it.stale = true; }, addTrace, clearTraces, canvas, stale: true };
    new ResizeObserver(() => { it.stale = true; }).observe(place);
    return it;
  }

  /* Channels over time; the scrubber is a line in them. */
  function ticks(low, high, most) {
    const raw = (high - low) / Math.max(most, 1), base = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((f) => f * base).find((s) => s >= raw);
    const found = [];
    for (let k = Math.ceil(low / step); k * step <= high + step * 1e-9; k++) found.push(k * step);
    return found;
  }
  const short = (x) => (x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(2) : String(Number(x.toPrecision(5))));

  function plots(place, data, time) {
    const { channels } = data, T = Float64Array.from(channels.time), by = new Map(channels.columns.map((c) => [c.name, c]));
    const bar = make("div", place, { className: "controls" });
    const list = make("datalist", place, { id: "channel-names" });
    channels.columns.forEach((c) => make("option", list, { value: c.name }));
    const label = make("label", bar, { textContent: "Channel " });
    const field = make("input", label, { type: "text" }, { list: "channel-names", size: 26, autocomplete: "off" });
    const add = make("button", bar, { type: "button", textContent: "Plot" });
    const reset = make("button", bar, { type: "button", textContent: "All of the time" });
    const said = make("span", bar, { className: "hint" }, { role: "status" });
    const frame = make("div", place, { className: "plot" });
    const canvas = make("canvas", frame, {}, { tabindex: 0, role: "img" });
    const chosenList = make("ul", place, { className: "chosen" }, { "aria-label": "plotted channels" });
    make("p", place, { className: "hint", textContent: "Drag over the plot to zoom, double-click for all of the time; click sets the time. Keys: left and right move the time, + and - zoom." +
      (channels.thinned ? ` Plots show ${T.length} of ${channels.of} instants; the tables are of all.` : "") });
    const chosen = [];
    let from = time.start, to = time.end, drag = null;
    const units = () => [...new Set(chosen.map((c) => c.unit))];
    function choose(name) {
      const found = by.get(name);
      if (!found) { said.textContent = `no channel '${name}'`; return; }
      if (chosen.includes(found)) return;
      if (units().length === 2 && !units().includes(found.unit)) { said.textContent = `two units at a time: take one of ${units().join(", ")} out first`; return; }
      chosen.push(found);
      said.textContent = "";
      listed();
    }
    function listed() {
      chosenList.replaceChildren();
      chosen.forEach((c, k) => {
        const button = make("button", make("li", chosenList), { type: "button" }, { "aria-label": `take ${c.name} out of the plot` });
        const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
        svg.setAttribute("aria-hidden", "true"); svg.setAttribute("width", 26); svg.setAttribute("height", 6);
        const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
        for (const [n, v] of Object.entries({ x1: 0, x2: 26, y1: 3, y2: 3, stroke: COLORS[k % COLORS.length], "stroke-width": 2, "stroke-dasharray": DASHES[k % DASHES.length].join(" ") })) line.setAttribute(n, v);
        svg.append(line);
        button.append(svg, `${c.name}${c.unit ? ` (${c.unit})` : ""}${c.unique ? "" : ", not unique"} ×`);
        button.onclick = () => { chosen.splice(k, 1); listed(); };
      });
      canvas.setAttribute("aria-label", `plot over time of ${chosen.map((c) => c.name).join(", ") || "no channel"}`);
      it.stale = true;
    }
    const left = 64, below = 34, above = 12;
    const right = () => (units().length > 1 ? 64 : 14);
    const xOf = (t, w) => left + ((t - from) / (to - from)) * (w - left - right());
    const tOf = (x, w) => from + ((x - left) / (w - left - right())) * (to - from);
    function draw() {
      const w = frame.clientWidth, h = canvas.clientHeight, scale = Math.min(devicePixelRatio, 2);
      canvas.width = w * scale; canvas.height = h * scale;
      const c = canvas.getContext("2d");
      c.scale(scale, scale);
      c.fillStyle = "#fff"; c.fillRect(0, 0, w, h);
      c.font = "11px system-ui, sans-serif"; c.fillStyle = "#222"; c.strokeStyle = "#ddd"; c.lineWidth = 1;
      const bottom = h - below;
      c.textAlign = "center"; c.textBaseline = "top";
      for (const t of ticks(from, to, (w - left - right()) / 90)) {
        const x = xOf(t, w);
        c.beginPath(); c.moveTo(x, above); c.lineTo(x, bottom); c.stroke();
        c.fillText(short(t), x, bottom + 4);
      }
      c.fillText("time (s)", (left + w - right()) / 2, h - 14);
      units().forEach((unit, side) => {
        const own = chosen.filter((o) => o.unit === unit);
        let low = Infinity, high = -Infinity;
        for (const o of own) for (let k = 0; k < T.length; k++) if (T[k] >= from && T[k] <= to && o.values[k] === o.values[k]) { low = Math.min(low, o.values[k]); high = Math.max(high, o.values[k]); }
        if (!(low <= high)) return;
        const pad = high > low ? 0.06 * (high - low) : Math.abs(high) * 0.1 || 1;
        low -= pad; high += pad;
        const yOf = (v) => bottom - ((v - low) / (high - low)) * (bottom - above);
        c.textAlign = side ? "left" : "right"; c.textBaseline = "middle"; c.fillStyle = "#222";
        for (const v of ticks(low, high, 6)) {
          if (!side) { c.strokeStyle = "#ddd"; c.beginPath(); c.moveTo(left, yOf(v)); c.lineTo(w - right(), yOf(v)); c.stroke(); }
          c.fillText(short(v), side ? w - right() + 5 : left - 5, yOf(v));
        }
        c.save(); c.translate(side ? w - 8 : 10, (above + bottom) / 2); c.rotate(-Math.PI / 2); c.textAlign = "center"; c.fillText(unit || "1", 0, 0); c.restore();
        c.save(); c.beginPath(); c.rect(left, above, w - left - right(), bottom - above); c.clip();
        for (const o of own) {
          const n = chosen.indexOf(o);
          c.strokeStyle = COLORS[n % COLORS.length]; c.setLineDash(DASHES[n % DASHES.length]); c.lineWidth = 1.6; c.beginPath();
          let open = false;
          for (let k = 0; k < T.length; k++) {
            if (o.values[k] !== o.values[k]) { open = false; continue; }
            const x = xOf(T[k], w), y = yOf(o.values[k]);
            open ? c.lineTo(x, y) : c.moveTo(x, y);
            open = true;
          }
          c.stroke();
        }
        c.restore(); c.setLineDash([]);
      });
      const x = xOf(time.t, w);
      if (x >= left && x <= w - right()) { c.strokeStyle = "#b2182b"; c.lineWidth = 1.5; c.beginPath(); c.moveTo(x, above); c.lineTo(x, bottom); c.stroke(); }
      if (drag && Math.abs(drag.now - drag.x) > 4) { c.fillStyle = "#0072b233"; c.fillRect(Math.min(drag.x, drag.now), above, Math.abs(drag.now - drag.x), bottom - above); }
    }
    const zoom = (a, b) => { [from, to] = [Math.max(Math.min(a, b), time.start), Math.min(Math.max(a, b), time.end)]; if (!(to - from > 1e-9 * (time.end - time.start))) [from, to] = [time.start, time.end]; it.stale = true; };
    canvas.onpointerdown = (e) => { drag = { x: e.offsetX, now: e.offsetX }; canvas.setPointerCapture(e.pointerId); };
    canvas.onpointermove = (e) => { if (drag) { drag.now = e.offsetX; it.stale = true; } };
    canvas.onpointerup = () => {
      const w = frame.clientWidth;
      if (drag && Math.abs(drag.now - drag.x) > 4) zoom(tOf(drag.x, w), tOf(drag.now, w));
      else if (drag) time.set(tOf(drag.x, w));
      drag = null; it.stale = true;
    };
    canvas.ondblclick = () => zoom(time.start, time.end);
    reset.onclick = () => zoom(time.start, time.end);
    canvas.onkeydown = (e) => {
      const middle = time.t, half = (to - from) / 2;
      if (e.key === "+") zoom(middle - half / 1.5, middle + half / 1.5);
      else if (e.key === "-") zoom(middle - half * 1.5, middle + half * 1.5);
      else return;
      e.preventDefault();
    };
    add.onclick = () => choose(field.value.trim());
    field.onkeydown = (e) => { if (e.key === "Enter") choose(field.value.trim()); };
    field.onchange = () => { if (by.has(field.value)) choose(field.value); };
    const it = { draw, stale: true, choose, chosen };
    channels.shown.slice(0, 4).forEach(choose);
    if (!chosen.length && by.has("energy.total")) choose("energy.total");
    new ResizeObserver(() => { it.stale = true; }).observe(frame);
    return it;
  }

  function controls(place, data, time, shown) {
    const bar = make("div", place, { className: "controls" }, { role: "group", "aria-label": "time" });
    const play = make("button", bar, { type: "button", textContent: "Play" });
    const scrub = make("input", bar, { type: "range", min: 0, max: 1000, step: "any", value: 0 }, { "aria-label": "time" });
    const told = make("output", bar);
    const pick = (words, options, act) => {
      const label = make("label", bar, { textContent: `${words} ` });
      const select = make("select", label);
      options.forEach(([value, text]) => make("option", select, { value, textContent: text }));
      select.onchange = () => act(select.value, select);
      return select;
    };
    const speeds = [0.001, 0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10];
    const length = time.end - time.start;
    const usual = speeds.reduce((best, s) => (Math.abs(Math.log(length / s / 6)) < Math.abs(Math.log(length / best / 6)) ? s : best), 1);
    time.speed = length >= 3 && length <= 20 ? 1 : usual;
    pick("Speed", speeds.map((s) => [s, `${s} x`]), (s) => { time.speed = Number(s); }).value = time.speed;
    if (shown) {
      pick("Follow", [["", "nothing"], ...data.drawing.bodies.map((b) => [b, b])], (body) => { shown.state.follow = body; shown.stale = true; }).value = data.follow;
      pick("Trace", [["", "choose"], ["clear", "none"], ...data.drawing.names.map((n, k) => [k, n.text])], (k, select) => {
        if (k === "clear") shown.clearTraces();
        else if (k !== "") shown.addTrace(data.drawing.names[k]);
        select.value = "";
        shown.stale = true;
      });
      const box = (words, field) => {
        const label = make("label", bar);
        const input = make("input", label, { type: "checkbox", checked: shown.state[field] });
        label.append(` ${words}`);
        input.onchange = () => { shown.state[field] = input.checked; shown.stale = true; };
      };
      if (data.longest.force > 0) box("forces", "forces");
      box("names", "names");
      make("button", bar, { type: "button", textContent: "Whole mechanism" }).onclick = shown.home;
    }
    play.onclick = () => time.toggle();
    scrub.oninput = () => { time.playing = false; time.set(time.start + (scrub.value / 1000) * length); };
    const step = length / 200;
    place.addEventListener("keydown", (e) => {
      if (/^(INPUT|SELECT|BUTTON)$/.test(e.target.tagName)) return;
      if (e.key === " ") time.toggle();
      else if (e.key === "ArrowRight") time.set(time.t + step);
      else if (e.key === "ArrowLeft") time.set(time.t - step);
      else if (e.key === "Home") time.set(time.start);
      else if (e.key === "End") time.set(time.end);
      else return;
      e.preventDefault();
    });
    time.on((t) => {
      scrub.value = ((t - time.start) / (length || 1)) * 1000;
      scrub.setAttribute("aria-valuetext", `${t.toPrecision(4)} s`);
      told.textContent = `t = ${t.toFixed(Math.max(0, 3 - Math.floor(Math.log10(length || 1))))} s`;
      play.textContent = time.playing ? "Pause" : "Play";
    });
  }

  async function show(place, head, numbers) {
    const data = await read(head, numbers);
    const time = clock(Math.min(...data.runs.map((r) => r.start)), Math.max(...data.runs.map((r) => r.end)));
    const shown = view(make("div", place, { className: "viewer" }), data, time);
    controls(place, data, time, shown);
    const plotted = data.channels ? plots(place, data, time) : null;
    const drawn = [shown, plotted].filter(Boolean);
    time.on(() => drawn.forEach((part) => { part.stale = true; }));
    time.set(time.start);
    let last = null;
    const it = { time, data, shown, plotted, frames: 0 };
    const tick = (now) => {
      if (time.playing && last !== null) {
        const t = time.t + Math.min((now - last) / 1000, 0.5) * time.speed;  // no jump after a pause of the browser
        if (t >= time.end) time.playing = false;
        time.set(t);
      }
      last = now;
      for (const part of drawn) if (part.stale) { part.stale = false; part.draw(); if (part === shown) it.frames += 1; }
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    return it;
  }
  return { show };
})();
