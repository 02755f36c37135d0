/* The part of report.html that is explored: which signals of which runs, over time or position. Data: #explore-data. */
"use strict";
(() => {
  const box = document.getElementById("explore");
  if (!box) return;
  const data = JSON.parse(document.getElementById("explore-data").textContent);
  const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer;
  const columns = new Map(data.columns.map(column => [column.name, column]));
  const DASHES = [[], [7, 3], [2, 2], [10, 3, 2, 3], [4, 4]];
  const KINDS = {signal: "", state: "", note: "reported by the law", level: "reactions"};
  const make = (name, ...inside) => { const made = document.createElement(name); made.append(...inside); return made; };

  // Rows and values of a curve as they were packed.
  const unpacked = new Map();
  function curve(run, name) {
    const key = `${data.runs.indexOf(run)} ${name}`;
    if (!unpacked.has(key)) {
      const given = run.signals[name], kind = {8: Uint8Array, 16: Uint16Array, 32: Uint32Array}[given.w];
      let row = 0;
      const rows = Array.from(new kind(bytes(given.r)), step => row += step);
      const factor = columns.get(name).factor;
      const values = Array.from(new Float32Array(bytes(given.v)), value => Number.isNaN(value) ? null : value * factor);
      unpacked.set(key, {rows, values, off: given.e * Math.abs(factor)});
    }
    return unpacked.get(key);
  }

  for (const run of data.runs) if (run.time.t) run.times = new Float64Array(bytes(run.time.t));
  const timeOf = (run, row) => run.times ? run.times[row] : Number((run.time.start + run.time.step * row).toFixed(6));

  // Between two known points of ascending xs.
  function between(xs, ys, x) {
    let low = 0, high = xs.length - 1;
    if (x <= xs[0]) return ys[0];
    if (x >= xs[high]) return ys[high];
    while (high - low > 1) { const half = low + high >> 1; if (xs[half] <= x) low = half; else high = half; }
    return ys[low] + (ys[high] - ys[low]) * (x - xs[low]) / (xs[high] - xs[low]);
  }
  let over = "";
  function xOf(run, row) {
    if (!over) return timeOf(run, row);
    const {rows, values} = curve(run, over);
    return between(rows, values, row);
  }
  function xAt(run, time) {
    if (!over) return time;
    const {rows, values} = curve(run, over);
    const step = run.times ? null : run.time.step;
    const row = step ? (time - run.time.start) / step : between(run.times, run.times.map((_, i) => i), time);
    return between(rows, values, row);
  }

  const runs = new Set(data.runs.length > 8 ? data.runs.slice(0, 8) : data.runs);
  const chosen = new Set(data.first);
  for (const run of data.runs)
    for (const [name, given] of Object.entries(run.signals)) if (given.used) chosen.add(name);
  let marks = true, charts = [];
  const place = box.querySelector(".charts");

  function series(run, column, number) {
    const alone = runs.size === 1, target = column.name === data.target;
    const label = alone || (target && !over) ? column.label : number ? `${run.label}: ${column.label}` : run.label;
    return {
      label, unit: column.unit, names: column.words,
      colour: target ? "target" : alone ? number % 7 : run.colour,
      dash: alone || target ? [] : run.dash.length && !number ? run.dash : DASHES[number % DASHES.length],
      width: target ? 2.5 : alone ? 1.3 : run.width,
      step: column.kind === "state", within: over ? null : curve(run, column.name).off,
    };
  }

  function markers() {
    if (!marks) return [];
    const many = runs.size > 1;
    return [...runs].flatMap(run => run.events.map(([at, until, text, fault]) => ({
      at: xAt(run, at), until: until == null ? undefined : xAt(run, until), fault,
      text: `${at.toFixed(2)} s ${many ? run.label + ": " : ""}${text}`,
    })));
  }

  // Charts of the chosen columns: one for each unit, notes without unit and states alone, levels as tracks.
  function groups() {
    const found = new Map();
    // What matters first: speed, command, error; then the order of signals.csv.
    const order = column => { const at = data.first.indexOf(column.name); return at < 0 ? data.first.length : at; };
    for (const column of [...data.columns].sort((one, other) => order(one) - order(other))) {
      if (!chosen.has(column.name) || ![...runs].some(run => column.name in run.signals)) continue;
      const key = column.kind === "level" ? "level" : column.name !== data.error && column.unit && column.kind !== "state" ? `unit ${column.unit}` : column.name;
      if (!found.has(key)) found.set(key, []);
      found.get(key).push(column);
    }
    return found;
  }

  function draw() {
    const kept = charts.length && charts[0].zoomed() ? charts[0].range() : null;
    for (const chart of charts) chart.destroy();
    const x = over ? {label: columns.get(over).label, unit: columns.get(over).unit} : {label: "time", unit: "s"};
    const list = markers();
    charts = [];
    for (const [key, group] of groups()) {
      // The target lies below the runs.
      group.sort((one, other) => (other.name === data.target) - (one.name === data.target));
      const tables = [], described = [];
      let number = 0;
      for (const column of group) {
        const seen = new Set();
        for (const run of runs) {
          if (!(column.name in run.signals)) continue;
          // A target that several runs followed is one line.
          const same = run.signals[column.name].v;
          if (column.name === data.target && seen.has(same)) continue;
          seen.add(same);
          const {rows, values} = curve(run, column.name), xs = rows.map(row => xOf(run, row));
          // Equal positions at standstill: the last one counts.
          const last = xs.map((value, i) => i + 1 === xs.length || xs[i + 1] > value);
          tables.push([xs.filter((_, i) => last[i]), values.filter((_, i) => last[i])]);
          described.push({...series(run, column, number), ...(key === "level" && {label: runs.size > 1 ? `${run.label}: ${column.label}` : column.label})});
        }
        if (column.name !== data.target) number += 1;
      }
      const alone = group.length === 1;
      const title = key === "level" ? "reactions" : alone ? group[0].label : group.map(column => column.label).join(", ");
      const description = {title, unit: key === "level" ? "" : group[0].unit, x, series: described, sync: "explore", markers: list};
      const joined = tables.length > 1 ? railhilCharts.join(tables) : tables[0];
      charts.push(key === "level" ? railhilCharts.tracks(place, description, joined)
        : railhilCharts.chart(place, {...description, height: group[0].name === data.speed || group.some(one => one.name === data.speed) ? 260 : 170}, joined));
    }
    if (charts.length) { if (kept && !draw.moved) charts[0].zoom(...kept); else charts[0].zoom(); }
    draw.moved = false;
    summary.textContent = `Signals (${[...chosen].length} of ${data.columns.length})`;
  }

  function choice(text, on, change, colour) {
    const input = make("input");
    input.type = "checkbox"; input.checked = on;
    input.addEventListener("change", () => { change(input.checked); draw(); });
    const label = make("label", input, ` ${text}`);
    if (colour !== undefined) label.style.borderLeft = `4px solid var(--rc-${colour})`;
    return label;
  }
  const pick = (set, item) => on => on ? set.add(item) : set.delete(item);

  const bar = box.querySelector(".bar");
  if (data.over.length) {
    const select = make("select", new Option("time", ""), ...data.over.map(name => new Option(columns.get(name).label, name)));
    select.id = "explore-over";
    select.addEventListener("change", () => { over = select.value; draw.moved = true; draw(); });
    bar.append(make("label", "over ", select));
  }
  const press = (text, work) => { const button = make("button", text); button.type = "button"; button.addEventListener("click", work); bar.append(button); };
  const around = factor => {
    if (!charts.length) return;
    const [low, high] = charts[0].range(), middle = (low + high) / 2, half = (high - low) / 2 * factor;
    charts[0].zoom(middle - half, middle + half);
  };
  const shift = side => { if (charts.length) { const [low, high] = charts[0].range(), far = (high - low) / 4 * side; charts[0].zoom(low + far, high + far); } };
  press("◀", () => shift(-1)); press("+", () => around(.5)); press("−", () => around(2)); press("▶", () => shift(1));
  press("everything", () => charts.length && charts[0].zoom());
  bar.append(choice("events", marks, on => { marks = on; }));
  press("dark / light", () => railhilCharts.setTheme(getComputedStyle(document.documentElement).colorScheme === "dark" ? "light" : "dark"));

  const summary = make("summary"), lists = make("div");
  lists.className = "lists";
  const sections = new Map();
  for (const column of data.columns) {
    if (!data.runs.some(run => column.name in run.signals)) continue;
    const kind = KINDS[column.kind] || (column.unit ? `in ${column.unit}` : "without unit");
    if (!sections.has(kind)) sections.set(kind, make("fieldset", make("legend", kind)));
    const named = column.unit && KINDS[column.kind] ? `${column.label} (${column.unit})` : column.label;
    sections.get(kind).append(choice(named, chosen.has(column.name), pick(chosen, column.name)));
  }
  lists.append(...sections.values());
  box.querySelector(".choose").append(make("details", summary, lists));
  if (data.runs.length > 1) {
    const list = make("fieldset", make("legend", "runs"));
    for (const run of data.runs) list.append(choice(run.label, runs.has(run), pick(runs, run), run.colour));
    list.className = "runs";
    box.querySelector(".choose").prepend(list);
  }
  box.hidden = false;
  draw();
  // For tests and for whoever looks with the browser's console.
  window.railhilReport = {data, curve, get charts() { return charts; }};
})();
