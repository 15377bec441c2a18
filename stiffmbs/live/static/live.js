"use strict";
/* The live page: text, sliders, motion, plots, verdict.  All text goes through textContent. */
const LIVE = (() => {
  const $ = (id) => document.getElementById(id);
  const page = Array.from(crypto.getRandomValues(new Uint32Array(3)), (n) => n.toString(36)).join("");
  const PAUSE = 150;  // ms of no typing before the scene is solved
  const PATIENCE = 1500;  // ms that a slider waits for the run of its last position
  const NUMBER = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?:\s+((?:1\/)?[A-Za-zµ°%][\w\s/^.*-]*))?$/;
  const SKELETON = "name: New mechanism\ngravity: [0, -9.81]\n\nbodies:\n  \n\njoints:\n  \n\nrun: {duration: 2 s}\n";
  const it = { shown: null, answers: 0, errors: [], last: null, numbers: {}, saved: "", digest: "", channels: [] };
  let editor = null, timer = null, running = false, again = null, begun = 0, lost = false, allowed = false;

  const make = (tag, parent, fields = {}, attributes = {}) => {
    const element = Object.assign(document.createElement(tag), fields);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (parent) parent.append(element);
    return element;
  };
  const text = () => editor.state.doc.toString();

  /* Server */
  const token = location.pathname.split("/")[1];
  const hex = (bytes) => Array.from(new Uint8Array(bytes), (b) => b.toString(16).padStart(2, "0")).join("");
  /* Let the server prove that it knows the token: another program may have bound the port of one that has ended. */
  async function proved() {
    const number = hex(crypto.getRandomValues(new Uint8Array(16))), bytes = new TextEncoder();
    const given = await (await fetch(`/prove/${number}`)).text();
    const key = await crypto.subtle.importKey("raw", bytes.encode(token), { name: "HMAC", hash: "SHA-256" }, false, ["sign"]);
    if (hex(await crypto.subtle.sign("HMAC", key, bytes.encode(number))) !== given) throw new Error("another server");
  }
  async function get(path) { await proved(); return fetch(path); }
  async function post(path, content) {
    await proved();
    const answer = await fetch(path, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(content) });
    found();
    return answer;
  }
  /* Ask the solver; `tell` hears of its progress. */
  async function ask(content, tell = () => {}) {
    try {
      const answer = await post("job", { page, text: text(), numbers: it.numbers, allow: allowed, ...content });
      if (!answer.ok) return { status: "error", line: 0, message: await answer.text() };
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      let rest = "", last = null;
      for (;;) {
        const { value, done } = await reader.read();
        if (done) return last ?? { status: "error", line: 0, message: "the server gave no answer" };
        const lines = (rest + value).split("\n");
        rest = lines.pop();
        for (const line of lines) { last = JSON.parse(line); if (last.status === "progress") tell(last); }
      }
    } catch {
      lose();
      return { status: "lost" };
    }
  }
  function lose() {
    if (lost) return;
    lost = true;
    banner("The server of this page has ended, so the page is no longer connected. The text is still here: download it, and run 'stiffmbs open' again for a new address.", true,
      ["Download scene", () => download("scene.yaml", text())]);
    verdict("error", "no connection to the solver");
    const retry = setInterval(async () => {
      try { await proved(); clearInterval(retry); found(); solve(); } catch { /* no connection, or another server */ }
    }, 2000);
  }
  function found() { if (lost) { lost = false; $("banner").hidden = true; } }
  function banner(words, bad, ...buttons) {
    $("banner").replaceChildren(words);
    $("banner").classList.toggle("bad", bad);
    for (const [label, act] of buttons) make("button", $("banner"), { type: "button", textContent: label }).onclick = act;
    $("banner").hidden = false;
  }
  function download(name, content, type = "text/plain") {
    const url = URL.createObjectURL(new Blob([content], { type }));
    make("a", null, { href: url, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 1000);
  }

  /* Solving: a change of the text interrupts the run; a slider waits for it, so that the motion follows. */
  function later() { clearTimeout(timer); timer = setTimeout(() => solve(), PAUSE); }
  async function solve(patient = false) {
    clearTimeout(timer);
    if (running && patient && performance.now() - begun < PATIENCE) { again = true; return; }
    const number = (it.asked = (it.asked ?? 0) + 1);
    running = true; begun = performance.now(); again = null;
    const busy = setTimeout(() => { $("verdict").classList.add("busy"); $("stop").disabled = false; }, 400);
    const reached = $("verdict").querySelector("progress");
    reached.removeAttribute("value");
    const answer = await ask({ what: "solve", channels: wanted(), preview: !it.shown }, ({ time, end, start, stage, page }) => {
      if (number !== it.asked) return;
      if (page) preview(page);
      else {
        $("headline").textContent = stage ?? `solving: t = ${Number(time.toPrecision(4))} s${end ? ` of ${Number(end.toPrecision(6))} s` : ""}`;
        if (end > start) reached.value = (time - start) / (end - start);
      }
    });
    clearTimeout(busy);
    if (number !== it.asked) return false;
    running = false;
    $("stop").disabled = true;
    $("verdict").classList.remove("busy");
    if (again) { solve(true); }
    await show(answer);
    it.answers += 1;
    it.delay = performance.now() - begun;
    return answer.status !== "error";
  }
  /* The bodies as described, until the first solution comes. */
  async function preview(page) {
    $("headline").textContent = "solving";
    const first = make("div", null);
    const found = await MOVING.show(first, page.head, page.numbers);
    if (!it.shown) { $("mechanism").replaceChildren(first); it.preview = found; }
  }
  const wanted = () => it.shown?.plotted?.chosen.map((c) => c.name) ?? [];
  async function more(channels) {  // values of channels that this page does not hold
    const answer = await ask({ what: "solve", channels });
    if (!answer.page) return false;
    await it.shown.replace(answer.page.head, answer.page.numbers);
    return true;
  }
  async function show(answer) {
    it.last = answer;
    $("empty").hidden = text().trim() !== "";
    mark(answer);
    if (answer.status === "consent") { verdict("stopped", answer.message); banner(`${answer.message} Run it only if you trust it.`, false, ["Run it", () => { allowed = true; $("banner").hidden = true; solve(); }]); return; }
    if (answer.status === "error") { verdict("error", answer.message, answer.line ? `line ${answer.line}` : ""); notes([], ""); return; }
    if (!answer.page) return;
    verdict(answer.status, answer.message, `${answer.name ? `${answer.name}, ` : ""}${Math.round(answer.seconds * 1000)} ms`);
    notes(answer.notes, answer.digits, answer.lines, answer.grave);
    document.title = `${answer.name || $("name").textContent} - stiffmbs`;
    if (it.shown) await it.shown.replace(answer.page.head, answer.page.numbers);
    else { $("mechanism").replaceChildren(); it.preview?.end(); it.shown = await MOVING.show($("mechanism"), answer.page.head, answer.page.numbers, more); window.shown = it.shown; if (!matchMedia("(prefers-reduced-motion: reduce)").matches) it.shown.time.toggle(); }
    it.channels = it.shown.data.channels.columns.map((c) => c.name);
    sliders(answer.parameters);
    choices(answer.choices);
  }
  function verdict(status, words, small = "") {
    $("verdict").className = status;
    $("headline").textContent = $("headline").title = words;
    $("verdict").querySelector("small")?.remove();
    if (small) make("small", $("verdict"), { textContent: small });
  }
  function notes(list, digits, lines = [], grave = 0) {
    const several = (count, word) => `${count} ${word}${count > 1 ? "s" : ""}`;
    const all = [...list, ...(digits ? [digits] : []), ...lines];
    $("notes").hidden = !all.length;
    $("notes").firstElementChild.textContent = 
      (grave ? `${several(grave, "note")} to check` : "nothing to check") + (list.length > grave ? `; ${several(list.length - grave, "remark")}` : "") + "; solver statistics";
    $("notes").lastElementChild.replaceChildren(...all.map((words) => make("li", null, { textContent: words })));
  }
  function mark(answer) {
    const found = [];
    if (answer.status === "error" && text().trim()) {
      const line = editor.state.doc.line(Math.min(Math.max(answer.line || lineOf(answer.message), 1), editor.state.doc.lines));
      const from = line.from + /^\s*/.exec(line.text)[0].length;
      found.push({ from: Math.min(from, line.to), to: line.to, severity: "error", message: answer.message });
    }
    it.errors = found.map((one) => ({ line: editor.state.doc.lineAt(one.from).number, message: one.message }));
    editor.dispatch(CM.setDiagnostics(editor.state, found));
  }
  /* The line of the first quoted or dotted name of a message that gives no line. */
  function lineOf(message) {
    const lines = text().split("\n");
    for (const [word] of message.matchAll(/[A-Za-z_][\w.]*/g)) {
      const name = word.replace(/\.+$/, "").split(".")[0], at = lines.findIndex((line) => new RegExp(`^\\s+${name}:`).test(line));
      if (name.length > 1 && at >= 0) return at + 1;
    }
    return 1;
  }

  /* Sliders of parameters whose value is a number with a unit in the text. */
  function written() {
    const found = new Map(), doc = editor.state.doc;
    let inside = false;
    for (let n = 1; n <= doc.lines; n++) {
      const line = doc.line(n), top = /^(\w+):/.exec(line.text);
      const flow = /^parameters:\s*\{/.exec(line.text);
      if (top) inside = top[1] === "parameters";
      const each = flow ? /([\w.]+)(:\s*)([^,{}]+?)\s*(?=[,}])()/g : inside && !top ? /^\s+([\w.]+)(:\s*)(.*?)\s*(?:#\s*(.*))?$/g : null;
      if (!each) continue;
      const start = flow ? flow[0].length : 0;
      for (const m of line.text.slice(start).matchAll(each)) {
        const raw = m[3].replace(/^(["'])(.*)\1$/, "$2"), value = NUMBER.exec(raw);
        if (!value) continue;
        const from = line.from + start + m.index + m[0].indexOf(m[3], m[0].indexOf(m[2]));
        found.set(m[1], { value: Number(value[1]), unit: (value[2] ?? "").trim(), from, to: from + m[3].length, comment: m[4] ?? "" });
      }
    }
    return found;
  }
  const shownSliders = new Map();
  function sliders(parameters) {
    const place = $("sliders"), known = new Set(parameters.map((p) => p.name)), found = written();
    for (const [name, one] of shownSliders) if (!found.has(name) || !known.has(name)) { one.row.remove(); shownSliders.delete(name); }
    for (const [name, now] of found) {
      if (!known.has(name)) continue;
      let one = shownSliders.get(name);
      if (!one) shownSliders.set(name, (one = slider(place, name)));
      one.update(now);
    }
  }
  const plain = (x) => (x !== 0 && (Math.abs(x) >= 1e6 || Math.abs(x) < 1e-3) ? String(Number(x.toPrecision(4)).toExponential()).replace("e+", "e") : String(Number(x.toPrecision(4))));
  function slider(place, name) {
    const row = make("div", place, { className: "slider" });
    const label = make("label", row, { textContent: name }, { for: `slider-${name}` });
    const range = make("input", row, { type: "range", min: 0, max: 1000, step: 1, id: `slider-${name}` });
    const field = make("input", row, { type: "text" }, { "aria-label": `value of ${name}`, inputmode: "decimal" });
    const unit = make("span", row, { className: "unit" });
    const one = { row, range, low: 0, high: 1, log: false, now: null, held: false };
    const at = () => { const s = range.value / 1000; return one.log ? one.low * (one.high / one.low) ** s : one.low + s * (one.high - one.low); };
    const put = (value) => { range.value = 1000 * (one.log ? Math.log(value / one.low) / Math.log(one.high / one.low) : (value - one.low) / (one.high - one.low)); };
    const say = (value) => { field.value = plain(value); range.setAttribute("aria-valuetext", `${plain(value)} ${one.now.unit}`); };
    /* The range is kept until the value leaves it. */
    one.update = (now) => {
      const within = one.now && now.unit === one.now.unit && now.value >= one.low && now.value <= one.high;
      one.now = now;
      label.title = now.comment || name;
      unit.textContent = now.unit;
      if (!within) {
        const v = now.value, size = Math.abs(v);
        one.log = v > 0 && (size >= 1e4 || size < 1e-3);
        if (one.log) [one.low, one.high] = [v / 30, v * 30];
        else if (/^deg|°/.test(now.unit)) [one.low, one.high] = [v - 90, v + 90];
        else [one.low, one.high] = v > 0 ? [0, 2 * v] : v < 0 ? [2 * v, 0] : [-1, 1];
      }
      if (!one.held && !(name in it.numbers)) { put(now.value); say(now.value); }
    };
    const move = (value) => { say(value); it.numbers[name] = `${plain(value)}${one.now.unit ? ` ${one.now.unit}` : ""}`; };
    /* Write the value into the text, as one step of undo. */
    const settle = (value) => {
      const now = written().get(name);
      delete it.numbers[name];
      one.held = false;
      if (!now) return;
      editor.dispatch({ changes: { from: now.from, to: now.to, insert: `${plain(value)}${now.unit ? ` ${now.unit}` : ""}` }, userEvent: "input.slider" });
    };
    range.oninput = () => { one.held = true; move(at()); solve(true); };
    range.onchange = () => settle(at());
    field.onchange = () => { const value = Number(field.value); if (Number.isFinite(value) && field.value.trim()) settle(value); else say(one.now.value); };
    return one;
  }

  /* Choices among the options of the scene: a selector writes its word into the section 'choose' of the text. */
  const WORD = /^(?!(?:true|false|yes|no|on|off|null)$)[A-Za-z_][\w.-]*$/i;
  function choices(found) {
    if ($("choices").dataset.of !== JSON.stringify(found.map(({ name, words }) => [name, words]))) {
      $("choices").dataset.of = JSON.stringify(found.map(({ name, words }) => [name, words]));
      $("choices").replaceChildren(...found.map(({ name, words }) => {
        const label = make("label", null, { textContent: `${name} ` }), select = make("select", label);
        select.append(...words.map((word) => make("option", null, { value: word, textContent: word })));
        select.onchange = () => choose(name, select.value);
        return label;
      }));
    }
    $("choices").querySelectorAll("select").forEach((select, k) => { select.value = found[k].chosen; });
  }
  function choose(name, word) {
    const doc = editor.state.doc, value = WORD.test(word) ? word : JSON.stringify(word);
    const put = (from, to, insert) => editor.dispatch({ changes: { from, to, insert }, userEvent: "input.choice" });
    for (let n = 1; n <= doc.lines; n++) {
      const line = doc.line(n), flow = /^choose:\s*\{/.exec(line.text);
      if (!/^choose:/.test(line.text)) continue;
      const own = (text, before) => new RegExp(`(${before}["']?${RegExp.escape?.(name) ?? name.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}["']?\\s*:\\s*)("[^"]*"|'[^']*'|[^,}#]*[^,}#\\s])`).exec(text);
      if (flow) {
        const at = own(line.text, "[{,]\\s*");
        if (at) put(line.from + at.index + at[1].length, line.from + at.index + at[0].length, value);
        else put(line.from + flow[0].length, line.from + flow[0].length, /^\s*\}/.test(line.text.slice(flow[0].length)) ? `${name}: ${value}` : `${name}: ${value}, `);
        return;
      }
      for (let m = n + 1; m <= doc.lines && /^(\s|#|$)/.test(doc.line(m).text); m++) {
        const entry = doc.line(m), at = own(entry.text, "^\\s+");
        if (at) { put(entry.from + at.index + at[1].length, entry.from + at.index + at[0].length, value); return; }
      }
      put(line.to, line.to, `\n  ${name}: ${value}`);
      return;
    }
    const last = doc.line(doc.lines);
    put(doc.length, doc.length, `${last.text ? "\n" : ""}choose: {${name}: ${value}}\n`);
  }

  /* Analyses and files */
  async function analyse(what, further = {}) {
    $("text").hidden = false;
    $("notes").open = false;
    const pre = $("text").querySelector("pre");
    pre.textContent = "working";
    $("stop").disabled = false;
    const answer = await ask({ what, ...further }, ({ time, stage }) => { pre.textContent = stage ?? `t = ${Number(time.toPrecision(4))} s`; });
    $("stop").disabled = true;
    pre.textContent = answer.status === "superseded" ? "cancelled: a newer request was made" : answer.text ?? answer.message ?? answer.status;
    return answer;
  }
  async function sweep(event) {
    event.preventDefault();
    const name = $("of").value, one = shownSliders.get(name);
    const answer = await analyse("sweep", {
      parameter: name, low: Number($("low").value), high: Number($("high").value), count: Number($("count").value), unit: one.now.unit, log: one.log, channels: wanted(),
    });
    if (answer.bands) it.shown.plotted.band(answer.bands.map((band) => ({ ...band, time: answer.time })));
  }
  function sweeper() {
    $("sweeper").hidden = !$("sweeper").hidden;
    $("of").replaceChildren(...[...shownSliders.keys()].map((name) => make("option", null, { value: name, textContent: name })));
    if (!shownSliders.size) { $("sweeper").hidden = true; $("text").hidden = false; $("text").querySelector("pre").textContent = "A sweep needs a parameter: a number under 'parameters:'."; }
    bounds();
  }
  function bounds() {
    const one = shownSliders.get($("of").value);
    if (!one) return;
    $("low").value = plain(one.low || 0.1 * one.high); $("high").value = plain(one.high); $("unit").textContent = one.now.unit;
  }
  async function exported(choice) {
    if (choice === "scene") { download($("name").textContent || "scene.yaml", text()); return; }
    const answer = await analyse("export", { suffix: choice });
    if (!answer.content) return;
    const bytes = Uint8Array.from(atob(answer.content), (c) => c.charCodeAt(0));
    download(`${($("name").textContent || "scene").replace(/\.ya?ml$/, "")}${choice}`, bytes, "application/octet-stream");
    $("text").hidden = true;
  }
  async function save(over = false) {
    try {
      const now = text(), answer = await post("save", { text: now, digest: it.digest, over }), content = await answer.json();
      if (!answer.ok) { banner(`${content.message}. `, true, ["Overwrite", () => save(true)], ["Read the file", reread]); return; }
      $("banner").hidden = true;
      [it.digest, it.saved] = [content.digest, now];
      changed();
    } catch { lose(); }
  }
  async function reread() {
    const start = await (await get("start")).json();
    [it.digest, it.saved] = [start.digest, start.text];
    $("banner").hidden = true;
    editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: start.text } });
  }
  const unsaved = () => editor && text() !== it.saved;
  function changed() { $("saved").textContent = unsaved() ? "not saved" : ""; }

  function edit(start, complete) {
    const { EditorView, EditorState, keymap } = CM;
    editor = new EditorView({
      parent: $("editor"),
      state: EditorState.create({
        doc: start.text,
        extensions: [
          CM.lineNumbers(), CM.foldGutter(), CM.history(), CM.drawSelection(), CM.indentOnInput(), CM.bracketMatching(), CM.closeBrackets(),
          CM.highlightActiveLine(), CM.highlightSelectionMatches(), CM.lintGutter(), CM.indentUnit.of("  "), CM.yaml(),
          CM.syntaxHighlighting(CM.defaultHighlightStyle), EditorView.contentAttributes.of({ "aria-label": "text of the scene; Escape and then Tab leaves it" }),
          CM.autocompletion({ override: [complete] }), EditorState.readOnly.of(!start.editable), EditorView.lineWrapping,
          keymap.of([
            { key: "Mod-s", run: () => { save(); return true; }, preventDefault: true },
            ...CM.closeBracketsKeymap, ...CM.completionKeymap, ...CM.defaultKeymap, ...CM.searchKeymap, ...CM.historyKeymap, ...CM.foldKeymap, ...CM.lintKeymap, CM.indentWithTab,
          ]),
          EditorView.updateListener.of((update) => { if (update.docChanged) { changed(); later(); } }),
        ],
      }),
    });
    it.editor = editor;
  }
  function divide() {
    const divider = $("divider"), left = $("left"), set = (w) => { left.style.flexBasis = `${Math.min(Math.max(w, 200), innerWidth - 320)}px`; };
    divider.onpointerdown = (e) => { divider.setPointerCapture(e.pointerId); divider.onpointermove = (m) => set(m.clientX); };
    divider.onpointerup = () => { divider.onpointermove = null; };
    divider.onkeydown = (e) => { const step = { ArrowLeft: -30, ArrowRight: 30 }[e.key]; if (step) set(left.offsetWidth + step); };
  }

  async function begin() {
    const given = await get("start"), start = await given.json();
    if (!given.ok) { banner(start.message, true); return; }
    [it.digest, it.saved] = [start.digest, start.text];
    $("name").textContent = start.name || "model";
    $("save").hidden = !start.name;
    let complete = () => null;
    edit(start, (context) => complete(context));
    get("schema").then((answer) => answer.json()).then((schema) => { it.completer = complete = COMPLETION.create(schema, () => it.channels); it.complete = true; }).catch(() => {});
    $("save").onclick = () => save();
    $("undo").onclick = () => { CM.undo(editor); editor.focus(); };
    $("redo").onclick = () => { CM.redo(editor); editor.focus(); };
    for (const what of ["check", "modes", "verify", "compare"]) $(what).onclick = () => analyse(what);
    $("sweep").onclick = sweeper;
    $("of").onchange = bounds;
    $("sweeper").onsubmit = sweep;
    $("noband").onclick = () => it.shown?.plotted.band([]);
    $("pin").onclick = () => {
      if (!it.shown) return;
      const on = $("pin").getAttribute("aria-pressed") !== "true";
      it.shown.pin(on);
      $("pin").setAttribute("aria-pressed", on);
      $("pin").textContent = on ? "Unpin" : "Pin run";
    };
    $("export").onchange = (e) => { const choice = e.target.value; e.target.value = ""; if (choice) exported(choice); };
    $("stop").onclick = () => post("job", { page, what: "stop" }).catch(lose);
    $("shut").onclick = () => { $("text").hidden = true; };
    const insert = (words) => editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: words } });
    $("first").onclick = async () => insert(await (await get("own/first_scene.yaml")).text());
    $("skeleton").onclick = () => { insert(SKELETON); editor.focus(); };
    divide();
    addEventListener("beforeunload", (e) => { if (unsaved() && start.editable && start.name) e.preventDefault(); });
    addEventListener("pagehide", () => lost || navigator.sendBeacon("close", JSON.stringify({ page })));
    await solve();
  }
  begin().catch(lose);
  return it;
})();
