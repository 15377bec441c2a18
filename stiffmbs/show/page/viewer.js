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
    if (data.channels) data.channels.columns.forEach((c) => { if ("start" in c) c.values = column(packed, c); });
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
      set(t) { it.t = Math.min(Math.max(t, it.start), it.end); listeners.forEach((f) => f(it.t)); },
      toggle() { if (!it.playing && it.t >= it.end) it.set(it.start); it.playing = !it.playing; listeners.forEach((f) => f(it.t)); },
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

  /* The load with the largest force of a run, and its instant. */
  function largest({ runs: [run], drawing }, off) {
    const found = { load: "", t: run.start, size: 0 };
    for (const { name } of drawing.loads) {
      if (off.has(name) || !run.forces[name]) continue;
      for (let k = 0; k < run.count; k++) {
        const size = Math.hypot(...run.forces[name].map((values) => values[k]));
        if (size > found.size) Object.assign(found, { load: name, size, t: run.start + (k / (run.count - 1 || 1)) * (run.end - run.start) });
      }
    }
    return found;
  }

  /* The mechanism of one run as objects of three.js. */
  function mechanism(drawing, run, ghost) {
    const flat = drawing.dimensions === 2, groups = {}, root = new THREE.Group(), links = [], bent = [];
    const group = (body) => {
      if (!groups[body]) { groups[body] = new THREE.Group(); groups[body].userData.body = body; root.add(groups[body]); }
      return groups[body];
    };
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
        const floor = part.role === "floor";
        const colored = drawing.stress > 0 && ghost === undefined && Object.keys(solid.stresses ?? {}).length > 0;
        if (colored) shaded.setAttribute("color", new THREE.Float32BufferAttribute(new Float32Array(3 * solid.triangles.length * 3), 3));
        const mesh = new THREE.Mesh(shaded, material(flat || colored ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial, colored ? "#ffffff" : part.color, 0, {
          vertexColors: colored, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...(flat && ghost === undefined ? { opacity: 0.92 } : {}),
        }));
        mesh.renderOrder = order(solid.vertices) + number * 1e-6;
        mesh.userData.floor = floor;
        mesh.receiveShadow = floor;
        mesh.castShadow = !flat && !floor && ghost === undefined;
        into.add(mesh);
        const edges = solid.edges.length ? line(solid.vertices, part.edge, false, solid.edges) : null;
        if (edges) into.add(edges);
        if (Object.keys(solid.modes).length) {
          mesh.frustumCulled = false;
          if (edges) edges.frustumCulled = false;
          bent.push({ solid, colored, index: solid.triangles.flat(), faces: shaded, edges: edges?.geometry });
        }
      }
      for (const stroke of part.lines) {
        const found = line(stroke.points, part.edge, stroke.dashed);
        found.renderOrder = order(stroke.points) + 1e-3;
        found.userData.floor = part.role === "floor";
        into.add(found);
      }
    });
    for (const link of drawing.links) {
      for (const profile of link.profiles) {
        if (!flat && !link.dashed && link.width > 1 && ghost === undefined) {
          const found = new THREE.Mesh(tube(profile.length), material(THREE.MeshLambertMaterial, link.edge, 0, { side: THREE.DoubleSide }));
          found.frustumCulled = false;
          found.castShadow = true;
          root.add(found);
          links.push({ link, profile, found, radius: 0.07 * drawing.unit * link.width });
          continue;
        }
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
    /* A tube along a stretched profile: rings about its points. */
    const center = new THREE.BufferAttribute(new Float32Array(3 * 1000), 3), ahead = new THREE.Vector3(), side = new THREE.Vector3(), over = new THREE.Vector3(), spot = new THREE.Vector3();
    const wrap = (profile, a, b, radius, geometry) => {
      stretch(profile, a, b, center);
      const n = profile.length, positions = geometry.attributes.position, fixed = b.clone().sub(a).normalize();
      for (let k = 0; k < n; k++) {
        ahead.fromBufferAttribute(center, Math.min(k + 1, n - 1)).sub(spot.fromBufferAttribute(center, Math.max(k - 1, 0)));
        side.crossVectors(ahead, fixed);
        if (side.lengthSq() < 1e-6 * ahead.lengthSq()) side.crossVectors(ahead, Math.abs(ahead.x) > Math.abs(ahead.z) ? over.set(0, 0, 1) : over.set(1, 0, 0));
        side.normalize();
        over.crossVectors(ahead, side).normalize();
        spot.fromBufferAttribute(center, k);
        for (let m = 0; m < SIDES; m++) {
          const c = radius * Math.cos((2 * Math.PI * m) / SIDES), s = radius * Math.sin((2 * Math.PI * m) / SIDES);
          positions.setXYZ(k * SIDES + m, spot.x + c * side.x + s * over.x, spot.y + c * side.y + s * over.y, spot.z + c * side.z + s * over.z);
        }
      }
      positions.needsUpdate = true;
      geometry.computeVertexNormals();
    };
    /* Color the vertices of a flexible body by von Mises stress, the norm of five components. */
    const ramp = Array.from({ length: 129 }, (_, k) => {
      const place = (k / 128) * (drawing.ramp.length - 1), low = Math.min(Math.floor(place), drawing.ramp.length - 2);
      return new THREE.Color(drawing.ramp[low]).lerp(new THREE.Color(drawing.ramp[low + 1]), place - low);
    });
    const paint = (solid, index, colors, t) => {
      const sums = solid.vertices.map(() => [0, 0, 0, 0, 0]);
      for (const [body, shapes] of Object.entries(solid.stresses)) {
        posed(run, body, t, point, turn);
        [point.x, point.y, point.z].forEach((y, k) => shapes[k].forEach((shape, n) => {
          for (let part = 0; part < 5; part++) sums[n][part] += y * shape[part];
        }));
      }
      const of = sums.map((sum) => ramp[Math.min(128, Math.round((128 * Math.hypot(...sum)) / drawing.stress))]);
      index.forEach((n, k) => colors.setXYZ(k, of[n].r, of[n].g, of[n].b));
      colors.needsUpdate = true;
    };
    /* Move the vertices of a flexible body by its modal coordinates. */
    const bend = ({ solid, colored, index, faces, edges }, t) => {
      const points = solid.vertices.map((p) => [...p]);
      for (const [body, shapes] of Object.entries(solid.modes)) {
        posed(run, body, t, point, turn);
        [point.x, point.y, point.z].forEach((y, k) => shapes[k].forEach((shape, n) => {
          for (let axis = 0; axis < 3; axis++) points[n][axis] += y * shape[axis];
        }));
      }
      index.forEach((n, k) => faces.attributes.position.setXYZ(k, ...points[n]));
      faces.attributes.position.needsUpdate = true;
      faces.computeVertexNormals();
      if (colored) paint(solid, index, faces.attributes.color, t);
      if (!edges) return;
      points.forEach((p, n) => edges.attributes.position.setXYZ(n, ...p));
      edges.attributes.position.needsUpdate = true;
    };
    const update = (t) => {
      bent.forEach((found) => bend(found, t));
      for (const [body, found] of Object.entries(groups)) {
        if (body === "ground") continue;
        posed(run, body, t, found.position, found.quaternion);
      }
      for (const { link, profile, found, radius } of links) {
        if (radius) { wrap(profile, anchored(link.i, t), anchored(link.j, t), radius, found.geometry); continue; }
        stretch(profile, anchored(link.i, t), anchored(link.j, t), found.geometry.attributes.position);
        if (link.dashed) found.computeLineDistances();
      }
    };
    return { root, update, anchored };
  }

  const SIDES = 6;
  function tube(n) {
    const geometry = new THREE.BufferGeometry(), index = [];
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * n * SIDES), 3));
    for (let k = 0; k + 1 < n; k++) {
      for (let m = 0; m < SIDES; m++) {
        const a = k * SIDES + m, b = k * SIDES + ((m + 1) % SIDES);
        index.push(a, b, b + SIDES, a, b + SIDES, a + SIDES);
      }
    }
    geometry.setIndex(index);
    return geometry;
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

  /* Left upper corner of a name from its point, for its width and height, the nearest ones first. */
  const SIDES_OF_NAMES = [7, 24, 44].flatMap((far) => [
    (w, h) => [7, -far - h + 4], () => [7, far - 3], (w, h) => [-7 - w, -far - h + 4], (w) => [-7 - w, far - 3],
    (w, h) => [far + 3, -h / 2], (w, h) => [-far - 3 - w, -h / 2], (w, h) => [-w / 2, -far - h], (w) => [-w / 2, far],
  ]);

  /* Directions from the mechanism to the camera, by the axis that points upwards; a vehicle drives along x. */
  const VIEWS = {
    z: { oblique: [1, -1, 0.8165], front: [1, 0, 0], side: [0, -1, 0], top: [0, -1e-3, 1] },
    y: { oblique: [1, 0.8165, 1], front: [1, 0, 0], side: [0, 0, 1], top: [0, 1, 1e-3] },
  };

  /* The mechanism on a canvas; `load` shows other data and keeps the camera. */
  function view(place, time) {
    const canvas = make("canvas", place, {}, { tabindex: 0, role: "img" });
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
    scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9aa5, 1.7), new THREE.AmbientLight(0xffffff, 0.3));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.8);
    const sun = new THREE.DirectionalLight(0xffffff, 1.1);
    scene.add(lamp, lamp.target, sun, sun.target);
    renderer.shadowMap.enabled = true;
    sun.shadow.mapSize.set(1024, 1024);
    sun.shadow.radius = 5;
    sun.shadow.intensity = 0.55;
    const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -50, 50);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.enableDamping = false;
    const legend = make("div", place, { className: "legend" });
    const tip = make("span", place, { className: "name tip" }, { "aria-hidden": "true" });
    const middle = new THREE.Vector3(), half = new THREE.Vector3(), force = new THREE.Vector3();
    const state = { forces: false, names: false, follow: "", from: "oblique", off: new Set(), traces: [] };
    let data = null, machines = [], loads = [], names = [], reach = 1, upright = "z", scale = null;
    let wide = 0, high = 0, before = null, pointed = null;

    const throughout = (act) => {
      for (let k = 0; k <= 12; k++) {
        for (const machine of machines) {
          machine.update(time.start + ((time.end - time.start) * k) / 12);
          machine.root.updateMatrixWorld(true);
          act(machine.root);
        }
      }
    };
    const atStart = (act) => machines.forEach((machine) => { machine.update(time.start); machine.root.updateMatrixWorld(true); act(machine.root); });
    function home() {
      const { drawing } = data;
      controls.target.copy(middle);
      const way = drawing.dimensions === 2 ? [0, 0, 1] : VIEWS[upright][state.from];
      camera.position.copy(middle).add(new THREE.Vector3(...way).normalize().multiplyScalar(10 * drawing.size));
      camera.zoom = 1;
      before = state.follow && data.runs[0].bodies[state.follow] ? machines[0].anchored({ body: state.follow, point: [0, 0, 0] }, time.start) : null;
      controls.update();
      camera.updateMatrixWorld();
    }
    /* The camera sees the whole motion, or the start if it follows a body. */
    function frame() {
      const { drawing } = data, framed = data.follow ? atStart : throughout;
      upright = drawing.dimensions === 2 || Math.abs(drawing.gravity[1]) > Math.abs(drawing.gravity[2]) ? "y" : "z";
      Object.assign(camera, { near: -50 * drawing.size, far: 50 * drawing.size });
      camera.up.set(0, upright === "y" ? 1 : 0, upright === "z" ? 1 : 0);
      const flat = drawing.dimensions === 2;  // dragging pans in the plane and orbits in space
      controls.mouseButtons.LEFT = flat ? 2 : 0;
      controls.mouseButtons.RIGHT = flat ? 0 : 2;
      controls.touches.ONE = flat ? 1 : 0;
      controls.enableRotate = !flat;
      const box = new THREE.Box3(), corner = new THREE.Vector3();
      framed((root) => root.traverse((part) => { if (part.geometry && !part.userData.floor) box.expandByObject(part, true); }));
      box.getCenter(middle);
      reach = box.getSize(new THREE.Vector3()).length() || drawing.size;
      home();
      half.set(0, 0, 0);
      const level = camera.quaternion.clone().invert();
      framed((root) => root.traverse((part) => {  // half of the width and height of what is seen first
        if (!part.geometry || part.userData.floor) return;
        part.geometry.computeBoundingBox();
        const own = part.geometry.boundingBox;
        for (let k = 0; k < 8; k++) {
          corner.set(...["x", "y", "z"].map((axis, n) => (k & (1 << n) ? own.min : own.max)[axis]));
          corner.applyMatrix4(part.matrixWorld).sub(middle).applyQuaternion(level);
          half.set(Math.max(half.x, Math.abs(corner.x)), Math.max(half.y, Math.abs(corner.y)), 0);
        }
      }));
      place.style.setProperty("--shape", half.x / Math.max(half.y, 0.1 * reach));
      wide = 0;
      sun.castShadow = !flat;
      sun.intensity = flat ? 0 : 1.0;
      const far = 0.75 * reach;
      Object.assign(sun.shadow.camera, { left: -far, right: far, top: far, bottom: -far, near: 0.1 * reach, far: 6 * reach });
      sun.shadow.camera.updateProjectionMatrix();
      sun.shadow.normalBias = 0.004 * reach;
    }
    function clear() {
      clearTraces();
      [...machines.map((machine) => machine.root), ...loads.map(({ found }) => found)].forEach((root) => {
        scene.remove(root);
        root.traverse((part) => { part.geometry?.dispose(); part.material?.dispose(); });
      });
      names.forEach(({ label }) => label.remove());
    }
    /* Show other data; `keep` leaves camera, switches and traces as they are. */
    function load(found, keep) {
      const traced = keep ? state.traces.map(({ anchor }) => anchor) : found.traces;
      if (data) clear();
      data = found;
      const { drawing } = data;
      canvas.setAttribute("aria-label", `${drawing.name || "mechanism"} in motion; drag to ${drawing.dimensions === 2 ? "move" : "turn"} it, space plays and pauses`);
      machines = data.runs.map((run, k) => {
        const machine = mechanism(run.drawing ?? drawing, run, k ? COLORS[k % COLORS.length] : undefined);
        scene.add(machine.root);
        return machine;
      });
      loads = drawing.loads.map((load) => {
        const found = arrow(drawing.marks[load.name] ? "#e69f00" : drawing.load_color, drawing.unit);
        scene.add(found);
        return { load, found };
      });
      names = drawing.names.map((name) => ({
        name, label: make("span", place, { textContent: name.text, className: name.role === "body" ? "name" : "name element", hidden: true }, { "aria-hidden": "true" }),
      }));
      if (!keep) {
        Object.assign(state, {
          forces: data.longest.force > 0 && drawing.dimensions === 2, names: drawing.names.length <= (drawing.dimensions === 2 ? 40 : 12), follow: data.follow,
        });
        frame();
      }
      traced.forEach(addTrace);
      explain();
      it.stale = true;
    }
    const addTrace = (anchor) => data.runs.forEach((run, k) => {
      if (anchor.body !== "ground" && !run.bodies[anchor.body]) return;
      const found = trace(machines[k], run, anchor, COLORS[(state.traces.length + 1) % COLORS.length]);
      state.traces.push({ found, anchor });
      scene.add(found);
    });
    const clearTraces = () => state.traces.splice(0).forEach(({ found }) => { scene.remove(found); found.geometry.dispose(); });

    function explain() {
      legend.replaceChildren();
      scale = null;
      const entry = (color, text) => {
        const row = make("div", legend);
        const key = make("span", row, { className: "key" });
        key.style.background = color;
        const words = make("span", row, { textContent: text });
        return { key, words };
      };
      if (data.runs.length > 1) data.runs.forEach((run, k) => entry(k ? COLORS[k % COLORS.length] : "#56b4e9", run.name || "run"));
      for (const mark of new Set(Object.values(data.drawing.marks))) entry(mark === "redundant" ? "#d55e00" : "#e69f00", mark === "redundant" ? "redundant equations" : "force not unique");
      for (const [body, factor] of Object.entries(data.drawing.deformations)) entry("", `${body}: deformation x ${factor}`).key.remove();
      if (data.drawing.stress > 0) {
        const [factor, unit] = data.drawing.stress >= 1e5 ? [1e6, "MPa"] : data.drawing.stress >= 1e2 ? [1e3, "kPa"] : [1, "Pa"];
        make("div", legend, { textContent: `von Mises stress (${unit})` });
        const row = make("div", legend, { className: "ramp" });
        make("span", row, { textContent: "0" });
        make("span", row, { className: "bar" }).style.background = `linear-gradient(to right, ${data.drawing.ramp.join(", ")})`;
        make("span", row, { textContent: String(Number((data.drawing.stress / factor).toPrecision(3))) });
      }
      if (state.forces && data.longest.force > 0) scale = entry(data.drawing.load_color, "");
      legend.hidden = !legend.children.length;
    }
    /* The scale of forces: the length of an arrow of a round force on the screen. */
    function measure() {
      if (!scale) return;
      const { force, length, unit, factor } = data.longest, perUnit = ((length / (force * factor)) * wide * camera.zoom) / (camera.right - camera.left);
      const base = 10 ** Math.floor(Math.log10(90 / perUnit));
      const round = [5, 2, 1].map((f) => f * base).find((f) => f * perUnit <= 90) ?? base;
      Object.assign(scale.key.style, { width: `${round * perUnit}px`, height: "4px", verticalAlign: "3px" });
      scale.words.textContent = `${Number(round.toPrecision(2))} ${unit}`;
    }
    function fit() {
      const w = place.clientWidth, h = place.clientHeight;
      if (w === wide && h === high) return;
      [wide, high] = [w, h];
      renderer.setSize(w, h, false);
      const ratio = w / h, up = 1.12 * Math.max(half.y, half.x / ratio, 0.1 * reach);
      Object.assign(camera, { left: -up * ratio, right: up * ratio, top: up, bottom: -up });
      camera.updateProjectionMatrix();
    }
    const onScreen = (anchor, t) => {
      const p = machines[0].anchored(anchor, t).project(camera);
      return [((p.x + 1) / 2) * wide, ((1 - p.y) / 2) * high];
    };
    function draw() {
      if (!data) return;
      fit();
      const t = time.t;
      machines.forEach((machine) => machine.update(t));
      if (state.follow && data.runs[0].bodies[state.follow]) {
        const now = machines[0].anchored({ body: state.follow, point: [0, 0, 0] }, t);
        if (before) { const step = now.clone().sub(before); camera.position.add(step); controls.target.add(step); }
        before = now;
      } else before = null;
      for (const { load, found } of loads) {
        const seen = state.forces && !state.off.has(load.name) && forceOf(data.runs[0], load.name, t, force);
        const length = seen ? (force.length() / data.longest.force) * data.longest.length : 0;
        found.visible = length > 0.01 * data.drawing.size;
        if (found.visible) { found.position.copy(machines[0].anchored(load, t)); found.pointTo(force.normalize(), length); }
      }
      lamp.position.copy(camera.position).add(new THREE.Vector3(0.3, 0.6, 0.2).multiplyScalar(data.drawing.size));
      sun.target.position.copy(state.follow && before ? before : middle);
      sun.position.copy(sun.target.position).add(upright === "z" ? new THREE.Vector3(-0.5, -0.7, 2.6).multiplyScalar(reach) : new THREE.Vector3(-0.5, 2.6, 0.7).multiplyScalar(reach));
      camera.updateMatrixWorld();
      renderer.render(scene, camera);
      measure();
      name(t);
      hover(t);
    }
    /* Place the names so that none covers another or the legend: each keeps its side as long as there is room, else takes
       the nearest side that is free.  A name without room is hidden, and appears under the pointer. */
    function name(t) {
      if (!state.names) { names.forEach(({ label }) => { label.hidden = true; }); return; }
      for (const one of names) {
        if (!one.size) { one.label.hidden = false; one.size = [one.label.offsetWidth, one.label.offsetHeight]; }
        one.at = onScreen(one.name, t);
      }
      const taken = legend.hidden ? [] : [[legend.offsetLeft, legend.offsetTop, legend.offsetWidth, legend.offsetHeight]];
      const free = ([x, y, w, h]) => x >= 0 && y >= 0 && x + w <= wide && y + h <= high
        && taken.every(([a, b, c, d]) => x >= a + c || a >= x + w || y >= b + d || b >= y + h);
      for (const one of names) {
        const [w, h] = one.size, box = (side) => { const [x, y] = SIDES_OF_NAMES[side](w, h); return [one.at[0] + x, one.at[1] + y, w, h]; };
        const own = one.name.role === "body" ? 0 : 1, order = [one.side ?? own, own, ...SIDES_OF_NAMES.keys()];
        one.side = order.find((side) => free(box(side)));
        one.label.hidden = one.side === undefined;
        if (one.label.hidden) continue;
        const found = box(one.side);
        taken.push(found);
        one.label.style.transform = `translate(${found[0]}px, ${found[1]}px)`;
      }
    }
    /* The name of what is nearest to the pointer: an element's point, else the body below it. */
    function hover(t) {
      tip.hidden = true;
      if (!pointed) return;
      let best = 16, text = "";
      for (const { name, label } of names) {
        if (name.role === "body" || !label.hidden) continue;
        const [x, y] = onScreen(name, t), far = Math.hypot(x - pointed.x, y - pointed.y);
        if (far < best) [best, text] = [far, name.text];
      }
      if (!text && !state.names) {
        const ray = new THREE.Raycaster();
        ray.setFromCamera(new THREE.Vector2((2 * pointed.x) / wide - 1, 1 - (2 * pointed.y) / high), camera);
        let hit = ray.intersectObject(machines[0].root, true).find(({ object }) => object.isMesh)?.object;
        while (hit && !hit.userData.body) hit = hit.parent;
        text = hit && hit.userData.body !== "ground" ? hit.userData.body : "";
      }
      if (!text) return;
      tip.hidden = false;
      tip.textContent = text;
      tip.style.transform = `translate(${pointed.x + 12}px, ${pointed.y + 10}px)`;
    }
    canvas.addEventListener("pointermove", (e) => { pointed = { x: e.offsetX, y: e.offsetY }; it.stale = true; });
    canvas.addEventListener("pointerleave", () => { pointed = null; it.stale = true; });
    controls.addEventListener("change", () => { it.stale = true; });
    const it = {
      draw, state, canvas, stale: true, load, data: () => data, addTrace: (anchor) => addTrace(anchor), clearTraces,
      home: () => { frame(); it.stale = true; }, look: (from) => { state.from = from; it.home(); }, explain: () => { explain(); it.stale = true; },
    };
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
  /* Labels of ticks with as many digits as distinguish them. */
  function labels(values) {
    const step = values.length > 1 ? Math.abs(values[1] - values[0]) : Math.abs(values[0]) || 1, largest = Math.max(...values.map(Math.abs), step);
    if (largest >= 1e5 || largest < 1e-2) {
      const digits = Math.min(Math.max(0, Math.ceil(Math.log10(largest / step) - 1e-9)), 9);
      return values.map((v) => (Math.abs(v) < step * 1e-6 ? "0" : v.toExponential(digits)));
    }
    const decimals = Math.min(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)), 9);
    return values.map((v) => (Math.abs(v) < step * 1e-6 ? 0 : v).toFixed(decimals));
  }
  const LEAST_RANGE = 1e-6;  // of an axis, relative to its values: what is less is rounding

  /* `fetch(names)` gets the values of channels that a page does not hold. */
  function plots(place, time, fetch) {
    let channels, T, by, bands = [], pinned = null;
    const bar = make("div", place, { className: "controls" });
    const list = make("datalist", place, { id: "channel-names" });
    const label = make("label", bar, { textContent: "Channel " });
    const field = make("input", label, { type: "text" }, { list: "channel-names", size: 26, autocomplete: "off" });
    const add = make("button", bar, { type: "button", textContent: "Plot" });
    const reset = make("button", bar, { type: "button", textContent: "All of the time" });
    const said = make("span", bar, { className: "hint" }, { role: "status" });
    const frame = make("div", place, { className: "plot" });
    const canvas = make("canvas", frame, {}, { tabindex: 0, role: "img" });
    const chosenList = make("ul", place, { className: "chosen" }, { "aria-label": "plotted channels" });
    const hint = make("p", place, { className: "hint" });
    function load(found, keep) {
      const names = keep ? chosen.map((c) => c.name) : found.shown.slice(0, 4), whole = from === time.start && to === time.end;
      channels = found; T = Float64Array.from(channels.time); by = new Map(channels.columns.map((c) => [c.name, c]));
      if (list.children.length !== channels.columns.length || channels.columns.some((c, k) => c.name !== list.children[k].value)) list.replaceChildren(...channels.columns.map((c) => make("option", null, { value: c.name })));
      hint.textContent = "Drag over the plot to zoom, double-click for all of the time; click sets the time. Keys: left and right move the time, + and - zoom." +
        (channels.thinned ? ` Plots show ${T.length} of ${channels.of} instants; the tables are of all.` : "");
      if (!keep || whole || !(from < T[T.length - 1])) [from, to] = [T[0], T[T.length - 1]];
      chosen.splice(0);
      names.filter((name) => by.get(name)?.values).forEach((name) => chosen.push(by.get(name)));
      if (!chosen.length && by.get("energy.total")?.values) chosen.push(by.get("energy.total"));
      listed();
    }
    const pinnedValues = (c) => pinned?.columns.find((one) => one.name === c.name && one.unit === c.unit)?.values;
    const chosen = [];
    let from = time.start, to = time.end, drag = null;
    const units = () => [...new Set(chosen.map((c) => c.unit))];
    function choose(name) {
      const found = by.get(name);
      if (!found) { said.textContent = `no channel '${name}'`; return; }
      if (chosen.includes(found)) return;
      if (!found.values) { fetch([...chosen.map((c) => c.name), name]).then((got) => { if (got) choose(name); }); return; }
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
      const instants = ticks(from, to, (w - left - right()) / 90), said = labels(instants);
      instants.forEach((t, k) => {
        const x = xOf(t, w);
        c.beginPath(); c.moveTo(x, above); c.lineTo(x, bottom); c.stroke();
        c.fillText(said[k], x, bottom + 4);
      });
      c.fillText("time (s)", (left + w - right()) / 2, h - 14);
      units().forEach((unit, side) => {
        const own = chosen.filter((o) => o.unit === unit);
        let low = Infinity, high = -Infinity;
        for (const o of own) for (let k = 0; k < T.length; k++) if (T[k] >= from && T[k] <= to && o.values[k] === o.values[k]) { low = Math.min(low, o.values[k]); high = Math.max(high, o.values[k]); }
        for (const earlier of own.map(pinnedValues)) if (earlier) for (const v of earlier) if (v === v) { low = Math.min(low, v); high = Math.max(high, v); }
        for (const band of bands.filter((one) => own.some((o) => o.name === one.channel))) { low = Math.min(low, ...band.low); high = Math.max(high, ...band.high); }
        if (!(low <= high)) return;
        const pad = high - low > LEAST_RANGE * Math.max(Math.abs(low), Math.abs(high)) ? 0.06 * (high - low) : Math.abs(high) * 0.1 || 1;
        low -= pad; high += pad;
        const yOf = (v) => bottom - ((v - low) / (high - low)) * (bottom - above);
        c.textAlign = side ? "left" : "right"; c.textBaseline = "middle"; c.fillStyle = "#222";
        const values = ticks(low, high, 6), words = labels(values);
        values.forEach((v, k) => {
          if (!side) { c.strokeStyle = "#ddd"; c.beginPath(); c.moveTo(left, yOf(v)); c.lineTo(w - right(), yOf(v)); c.stroke(); }
          c.fillText(words[k], side ? w - right() + 5 : left - 5, yOf(v));
        });
        c.save(); c.translate(side ? w - 8 : 10, (above + bottom) / 2); c.rotate(-Math.PI / 2); c.textAlign = "center"; c.fillText(unit || "1", 0, 0); c.restore();
        c.save(); c.beginPath(); c.rect(left, above, w - left - right(), bottom - above); c.clip();
        for (const band of bands) {
          const o = own.find((one) => one.name === band.channel);
          if (!o) continue;
          const paint = COLORS[chosen.indexOf(o) % COLORS.length], path = (values, k, first) => c[first ? "moveTo" : "lineTo"](xOf(band.time[k], w), yOf(values[k]));
          c.fillStyle = `${paint}2e`; c.beginPath();
          band.time.forEach((_, k) => path(band.low, k, !k));
          for (let k = band.time.length - 1; k >= 0; k--) path(band.high, k, false);
          c.fill();
          c.strokeStyle = `${paint}55`; c.lineWidth = 0.8;
          for (const values of band.curves) { c.beginPath(); band.time.forEach((_, k) => path(values, k, !k)); c.stroke(); }
        }
        const curve = (instants, values, n, width) => {
          c.strokeStyle = COLORS[n % COLORS.length]; c.setLineDash(DASHES[n % DASHES.length]); c.lineWidth = width; c.beginPath();
          let open = false;
          for (let k = 0; k < instants.length; k++) {
            if (values[k] !== values[k]) { open = false; continue; }
            const x = xOf(instants[k], w), y = yOf(values[k]);
            open ? c.lineTo(x, y) : c.moveTo(x, y);
            open = true;
          }
          c.stroke();
        };
        for (const o of own) {
          const n = chosen.indexOf(o), earlier = pinnedValues(o);
          if (earlier) { c.globalAlpha = 0.55; curve(pinned.time, earlier, n, 0.9); c.globalAlpha = 1; }
          curve(T, o.values, n, 1.6);
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
    const it = { draw, stale: true, choose, chosen, load, field, band: (found) => { bands = found; it.stale = true; }, pin: (found) => { pinned = found; it.stale = true; } };
    new ResizeObserver(() => { it.stale = true; }).observe(frame);
    return it;
  }

  /* Play, scrub, speed; and what is seen of the mechanism.  `load` shows other data. */
  function controls(place, time, shown) {
    const bar = make("div", place, { className: "controls" }, { role: "group", "aria-label": "time" });
    const play = make("button", bar, { type: "button", className: "play", textContent: "Play" });
    const scrub = make("input", bar, { type: "range", min: 0, max: 1000, step: "any", value: 0 }, { "aria-label": "time" });
    const told = make("output", bar);
    const pick = (words, act) => {
      const label = make("label", bar, { textContent: `${words} ` });
      const select = make("select", label);
      select.onchange = () => act(select.value, select);
      select.offer = (options) => {
        if (options.length === select.options.length && options.every(([, text], k) => select.options[k].textContent === text)) return;
        select.replaceChildren(...options.map(([value, textContent]) => make("option", null, { value, textContent })));
      };
      return select;
    };
    const speed = pick("Speed", (s) => { time.speed = Number(s); });
    const speeds = [1e-5, 1e-4, 0.001, 0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10];
    speed.offer(speeds.map((s) => [s, `${s} x`]));
    let names = [], load = () => {};
    if (shown) {
      const follow = pick("Follow", (body) => { shown.state.follow = body; shown.stale = true; });
      const from = pick("View", (name) => shown.look(name));
      from.offer(Object.keys(VIEWS.z).map((name) => [name, name]));
      const path = pick("Trace", (k, select) => {
        if (k === "clear") shown.clearTraces();
        else if (k !== "") shown.addTrace(names[k]);
        select.value = "";
        shown.stale = true;
      });
      const box = (words, act, into = bar) => {
        const label = make("label", into);
        const input = make("input", label, { type: "checkbox" });
        label.append(` ${words}`);
        input.onchange = () => act(input.checked);
        return input;
      };
      const forces = box("forces", (on) => { shown.state.forces = on; shown.explain(); each.hidden = !on; });
      const each = make("details", bar, { className: "each" });
      make("summary", each, { textContent: "which" });
      const switches = make("div", each);
      const named = box("names", (on) => { shown.state.names = on; shown.stale = true; });
      make("button", bar, { type: "button", textContent: "Whole mechanism" }).onclick = () => shown.home();
      const worst = make("button", bar, { type: "button", textContent: "Largest force" });
      const said = make("span", bar, { className: "hint" }, { role: "status" });
      /* Show the instant of the largest force among those that are drawn. */
      worst.onclick = () => {
        const { load, t } = largest(shown.data(), shown.state.off);
        if (!load) return;
        Object.assign(time, { playing: false });
        forces.checked = true;
        forces.onchange();
        time.set(t);
        said.textContent = `in ${load}`;
      };
      time.on(() => { said.textContent = ""; });
      load = (data, keep) => {
        names = data.drawing.names;
        follow.offer([["", "nothing"], ...data.drawing.bodies.map((b) => [b, b])]);
        path.offer([["", "choose"], ["clear", "none"], ...names.map((n, k) => [k, n.text])]);
        if (!keep) { follow.value = data.follow; path.value = ""; }
        forces.parentElement.hidden = worst.hidden = !(data.longest.force > 0);
        from.parentElement.hidden = data.drawing.dimensions === 2;
        forces.checked = shown.state.forces;
        named.checked = shown.state.names;
        each.hidden = !(forces.checked && data.drawing.loads.length > 1);
        const loads = data.drawing.loads.map((one) => one.name);
        if (switches.dataset.of !== loads.join()) {
          switches.dataset.of = loads.join();
          switches.replaceChildren();
          loads.forEach((name) => { box(name, (on) => { shown.state.off[on ? "delete" : "add"](name); shown.stale = true; }, switches).checked = !shown.state.off.has(name); });
        }
      };
    }
    play.onclick = () => time.toggle();
    scrub.oninput = () => { time.playing = false; time.set(time.start + (scrub.value / 1000) * (time.end - time.start)); };
    const writing = (e) => e.isContentEditable || /^(SELECT|BUTTON|TEXTAREA|SUMMARY)$/.test(e.tagName) || (e.tagName === "INPUT" && e.type !== "range");
    document.addEventListener("keydown", (e) => {
      if (writing(e.target) || e.ctrlKey || e.altKey || e.metaKey) return;
      const own = place.contains(e.target) && e.target.tagName !== "INPUT", step = (time.end - time.start) / 200;
      if (e.key === " " && place.offsetParent) time.toggle();
      else if (!own) return;
      else if (e.key === "ArrowRight") time.set(time.t + step);
      else if (e.key === "ArrowLeft") time.set(time.t - step);
      else if (e.key === "Home") time.set(time.start);
      else if (e.key === "End") time.set(time.end);
      else return;
      e.preventDefault();
    });
    time.on((t) => {
      const length = time.end - time.start;
      scrub.value = ((t - time.start) / (length || 1)) * 1000;
      scrub.setAttribute("aria-valuetext", `${t.toPrecision(4)} s`);
      told.textContent = `t = ${t.toFixed(Math.min(Math.max(0, 3 - Math.floor(Math.log10(length || 1))), 12))} s`;
      play.textContent = time.playing ? "Pause" : "Play";
    });
    return {
      load(data, keep) {
        const length = time.end - time.start;
        const usual = speeds.reduce((best, s) => (Math.abs(Math.log(length / s / 6)) < Math.abs(Math.log(length / best / 6)) ? s : best), 1);
        if (!keep) speed.value = time.speed = length >= 3 && length <= 20 ? 1 : usual;
        load(data, keep);
      },
    };
  }

  const spanOf = (data) => [Math.min(...data.runs.map((r) => r.start)), Math.max(...data.runs.map((r) => r.end))];

  /* `fetch` is for pages that get further channels from a server.  `replace` of the result shows another run. */
  async function show(place, head, numbers, fetch = async () => false) {
    let data = await read(head, numbers);
    const time = clock(...spanOf(data));
    const shown = view(make("div", place, { className: "viewer" }), time);
    const bar = controls(place, time, shown);
    const plotted = data.channels ? plots(place, time, fetch) : null;
    const drawn = [shown, plotted].filter(Boolean);
    let pinned = null;
    const load = (keep) => {
      if (pinned) data.runs = [data.runs[0], pinned.run];
      shown?.load(data, keep);
      bar.load(data, keep);
      plotted?.load(data.channels, keep);
      it.data = data;
    };
    if (data.choose) {
      const every = data.runs, row = make("div", null, { className: "controls" }), select = make("select", make("label", row, { textContent: `${data.choose} ` }));
      place.prepend(row);
      every.forEach((run, k) => make("option", select, { value: k, textContent: run.name }));
      time.loops = true;
      const pick = () => {
        data.runs = [every[select.value]];
        [time.start, time.end] = spanOf(data);
        shown?.load(data, true);
        bar.load(data, false);
        time.set(time.start);
      };
      select.onchange = pick;
      data.runs = [every[0]];
      [time.start, time.end] = spanOf(data);
    }
    const it = {
      time, data, shown, plotted, frames: 0, ended: false,
      end() { it.ended = true; },
      /* Keep the run that is shown, behind those that follow, or no longer. */
      pin(on) {
        const [run] = data.runs;
        pinned = on ? { run: { ...run, name: "pinned", drawing: data.drawing } } : null;
        run.name = on ? "now" : "";
        data.runs = [run];
        plotted?.pin(on ? data.channels : null);
        load(true);
      },
      async replace(head, numbers) {
        const found = await read(head, numbers), kept = found.drawing.dimensions === data.drawing.dimensions;
        data = found;
        if (!kept) { pinned = null; plotted?.pin(null); }
        if (pinned) data.runs[0].name = "now";
        [time.start, time.end] = spanOf(data);
        load(kept);
        time.set(time.t);
      },
    };
    load(false);
    time.on(() => drawn.forEach((part) => { part.stale = true; }));
    time.set(time.start);
    let last = null;
    const tick = (now) => {
      if (time.playing && last !== null) {
        const t = time.t + Math.min((now - last) / 1000, 0.5) * time.speed;  // no jump after a pause of the browser
        if (t >= time.end && !time.loops) time.playing = false;
        time.set(t >= time.end && time.loops ? time.start + ((t - time.start) % (time.end - time.start)) : t);
      }
      last = now;
      for (const part of drawn) if (part.stale) { part.stale = false; part.draw(); if (part === shown) it.frames += 1; }
      if (!it.ended) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    return it;
  }
  return { show };
})();
