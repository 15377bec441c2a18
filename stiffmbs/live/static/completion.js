"use strict";
/* What may stand at a place of a scene's text, by the JSON schema. */
const COMPLETION = (() => {
  const KEY = /^(\s*)((?:- )*)([\w.{}"'-]+):(?=\s|$)/;

  /* The keys above a place, whether a key or a value stands there, and the entries around it. */
  function placeAt(text, position) {
    const before = text.slice(0, position), start = before.lastIndexOf("\n") + 1, line = before.slice(start);
    if (/(^|\s)#/.test(line)) return null;
    const above = before.slice(0, start).split("\n");
    const flow = flowOf(line);
    const found = KEY.exec(line);
    const indent = /^[\s-]*/.exec(line)[0].length;
    const path = [];
    let least = indent;
    for (let k = above.length - 1; k >= 0 && least > 0; k--) {
      const match = KEY.exec(above[k]);
      if (match && match[1].length + match[2].length < least) { least = match[1].length + match[2].length; path.unshift(match[3]); }
    }
    if (flow.open) {
      const siblings = entriesOf(flow.inside + rest(text.slice(position)));
      return { path: [...path, ...flow.path], key: flow.key, word: flow.word, siblings };
    }
    const siblings = blockAround(text, start, indent);
    if (found) return { path, key: found[3], word: line.slice(found[0].length).trimStart(), siblings };
    return { path, key: null, word: line.slice(indent), siblings };
  }
  /* Braces that are open at the end of a line: the keys of each, and what is being typed. */
  function flowOf(line) {
    const stack = [];
    let key = null, word = "", from = 0;
    const first = KEY.exec(line);
    if (first) { key = first[3]; from = first[0].length; }
    const begin = from;
    for (let k = from; k < line.length; k++) {
      const sign = line[k];
      if (sign === "{" || sign === "[") { stack.push({ key, list: sign === "[", at: k + 1 }); if (sign === "{") key = null; word = ""; }
      else if (sign === "}" || sign === "]") { key = stack.pop()?.key ?? null; word = ""; }
      else if (sign === ",") { if (!stack.at(-1)?.list) key = null; word = ""; }
      else if (sign === ":" && /\s/.test(line[k + 1] ?? " ")) { key = word.trim(); word = ""; }
      else word += sign;
    }
    const braces = stack.filter((one) => !one.list);
    return { open: braces.length > 0, path: braces.map((one) => one.key).filter(Boolean), key, word: word.trimStart(), inside: line.slice(braces.at(-1)?.at ?? begin) };
  }
  const rest = (after) => /^[^}\n]*/.exec(after)[0];
  const entriesOf = (inside) => Object.fromEntries([...inside.matchAll(/([\w.-]+):\s+([^,{}[\]#]*)/g)].map((m) => [m[1], m[2].trim()]));
  function blockAround(text, start, indent) {
    const lines = text.split("\n"), here = text.slice(0, start).split("\n").length - 1, found = {};
    for (const step of [-1, 1]) {
      for (let k = here + (step > 0 ? 0 : -1); k >= 0 && k < lines.length; k += step) {
        const match = KEY.exec(lines[k]), depth = match ? match[1].length + match[2].length : Infinity;
        if (match && depth < indent && !(k === here)) break;
        if (match && depth === indent && k !== here) found[match[3]] = lines[k].slice(match[0].length).trim();
      }
    }
    return found;
  }

  function names(text, section) {
    const found = [], lines = text.split("\n");
    let inside = false, depth = null, last = null, markers = null;
    for (const line of lines) {
      const match = KEY.exec(line);
      if (!match) continue;
      const indent = match[1].length;
      if (indent === 0) { inside = match[3] === section; depth = null; continue; }
      if (!inside) continue;
      depth ??= indent;
      if (indent === depth) { last = match[3]; found.push(last); markers = null; }
      if (section !== "bodies") continue;
      const flow = /markers:\s*\{(.*)\}/.exec(line);
      if (flow) found.push(...[...flow[1].matchAll(/([\w-]+):\s*[{[]/g)].map((m) => `${last}.${m[1]}`));
      else if (match[3] === "markers") markers = indent;
      else if (markers !== null && indent > markers && indent <= markers + 4 && !["point", "angle", "axis"].includes(match[3])) found.push(`${last}.${match[3]}`);
      else if (markers !== null && indent <= markers) markers = null;
    }
    return found;
  }

  function create(schema, channels) {
    const at = (node) => (node && node.$ref ? { ...schema.$defs[node.$ref.split("/").at(-1)], ...Object.fromEntries(Object.entries(node).filter(([k]) => k !== "$ref")) } : node);
    const flat = (node) => {
      const found = at(node);
      if (!found) return [];
      const among = found.anyOf ?? found.oneOf;
      const parts = among && !found.properties ? among.flatMap(flat) : [found];
      return parts;
    };
    const root = (text) => flat(/^dimensions:\s*3/m.test(text) ? schema.then : schema.else);
    const typeOf = (node) => node.properties?.type?.const ?? node.properties?.type?.default;
    const byType = (nodes, type) => (type && nodes.some((n) => typeOf(n) === type) ? nodes.filter((n) => typeOf(n) === type) : nodes);
    const within = (nodes, key) => nodes.flatMap((node) => {
      const found = node.properties?.[key];
      if (found) return flat(found);
      return typeof node.additionalProperties === "object" ? flat(node.additionalProperties) : [];
    });
    const wordsOf = (node) => node.enum ?? (node.const !== undefined ? [node.const] : node.type === "boolean" ? ["true", "false"] : []);
    const needs = (node) => (node.required ?? []).filter((key) => key !== "type");
    const template = (node) => `{${[...(typeOf(node) ? [`type: ${typeOf(node)}`] : []), ...needs(node).map((key) => `${key}: `)].join(", ")}}`;

    return function complete(context) {
      const text = context.state.doc.toString(), place = placeAt(text, context.pos);
      if (!place) return null;
      const word = /[\w.-]*$/.exec(place.word)[0];
      if (!word && !context.explicit) return null;
      const from = context.pos - word.length;
      let nodes = root(text);
      for (const key of place.path) nodes = within(nodes, key);
      nodes = byType(nodes, place.siblings.type);
      const options = [];
      if (place.key === null) {
        for (const node of nodes) {
          for (const [key, value] of Object.entries(node.properties ?? {})) {
            if (key in place.siblings || options.some((one) => one.label === key)) continue;
            options.push({ label: key, type: "property", detail: needs(node).includes(key) ? "required" : "", info: at(value).description ?? "", apply: `${key}: `, boost: needs(node).includes(key) ? 5 : 0 });
          }
        }
        if (place.path.length === 1 && ["joints", "forces", "bodies"].includes(place.path[0])) {
          for (const node of within(nodes, "")) {
            const kind = typeOf(node) ?? "body";
            if (options.some((one) => one.label === kind)) continue;
            options.push({ label: kind, type: "class", detail: "new entry", info: (node.description ?? "").split("\n")[0], apply: `${place.path[0] === "bodies" ? "body" : kind}_1: ${template(node)}`, boost: kind === "body" ? 10 : 9 });
          }
        }
      } else {
        const values = byType(nodes, undefined).flatMap((node) => (node.properties?.[place.key] ? flat(node.properties[place.key]) : []));
        const offer = (label, type, info = "") => { if (!options.some((one) => one.label === label)) options.push({ label: String(label), type, info }); };
        values.forEach((node) => wordsOf(node).forEach((value) => offer(value, "enum", node.description ?? "")));
        if (place.key === "type") nodes.forEach((node) => typeOf(node) && offer(typeOf(node), "enum", (node.description ?? "").split("\n")[0]));
        if (["i", "j", "k", "body", "on"].includes(place.key)) ["ground", ...names(text, "bodies")].forEach((name) => offer(name, "variable"));
        if (["joint", "joints", "drop_first"].includes(place.key)) names(text, "joints").forEach((name) => offer(name, "variable"));
        if (["x", "y", "z"].includes(place.key) && place.path[0] === "figure") channels().forEach((name) => offer(name, "variable"));
        if (!options.length) names(text, "parameters").forEach((name) => offer(name, "constant"));
      }
      return options.length ? { from, options, validFor: /^[\w.-]*$/ } : null;
    };
  }
  return { create, placeAt, names };
})();
