// The live panel: one WebSocket to the server that has served this page, nothing else.
import { Store } from "./store.js";
import { Curves } from "./curves.js";
import { End } from "./end.js";
import { Orders, TOKEN } from "./orders.js";
import { Desk } from "./desk.js";
import { Line } from "./line.js";
import { showRequirements } from "./requirements.js";
import { BranchForm } from "./branch.js";
import { Gauges, element, showEvents, showFrames, showLamps } from "./gauges.js";

const APPEND = 1, REPLACE = 2;
// With this code a server closes that ends as it should (RFC 6455, 7.4.1).
const GOING_AWAY = 1001;
const byId = (id) => document.getElementById(id);
const counters = { batches: 0, rows: 0, frames: 0, since: performance.now(), closed: 0 };
const page = {
  header: null, layout: null, stores: [], curves: null, line: null, gauges: null, events: [], state: null, picked: null, watched: null, listSeen: false, lineSeen: false,
  learning: [], socket: null, pending: false, hasEvents: false,
};

// The token stands behind # and is not sent with the request; the address bar forgets it, this tab does not.
function readHash() {
  const hash = new URLSearchParams(location.hash.slice(1));
  if (hash.get("token")) {
    sessionStorage.setItem(TOKEN, hash.get("token"));
    hash.delete("token");
    history.replaceState(null, "", hash.size ? `#${hash}` : location.pathname);
  }
  orders.token = sessionStorage.getItem(TOKEN) ?? "";
  const instant = Number.parseFloat(hash.get("t") ?? "");
  return Number.isFinite(instant) ? instant : null;
}

// ---- connection

function connect() {
  const socket = new WebSocket(`ws://${location.host}${location.pathname}ws`, "railhil.panel.v1");
  socket.binaryType = "arraybuffer";
  page.socket = socket;
  socket.onopen = () => connected(true);
  socket.onclose = (event) => { counters.closed += 1; connected(false, event.code === GOING_AWAY); setTimeout(connect, 700); };
  socket.onmessage = (event) => {
    if (typeof event.data === "string") take(JSON.parse(event.data)); else takeBatch(event.data);
  };
}

// hasEnded: the server has said that it ends.
function connected(is, hasEnded = false) {
  const box = byId("connection"), phase = byId("phase");
  const over = hasEnded || end.isShown;
  // Attempts to connect again tell nothing new.
  if (!is && box.className === "over") return;
  box.className = is ? "good" : over ? "over" : "bad";
  box.textContent = is ? `● connected${counters.closed ? " again" : ""}`
    : end.isShown ? "■ the run has ended" : over ? "■ the panel has ended" : "✕ connection lost, trying again";
  if (is) return;
  if (page.state && !over) phase.textContent = `last known: ${phase.textContent}`;
  page.state = null;
  orders.show(null);
  end.lose();
}

function send(document) {
  if (page.socket?.readyState === WebSocket.OPEN) page.socket.send(JSON.stringify(document));
}

// ---- what arrives

function take(message) {
  if (message.header) begin(message.header);
  if (message.events) {
    page.events = message.replace ? message.events : [...page.events, ...message.events].slice(-1000);
    page.hasEvents = true;
    showLater();
  }
  if (message.state) { page.state = message.state; showState(message.state); }
  if (message.frames) showList(message);
  if (message.kinds) orders.form.take(message.kinds);
  if (message.requirements) showRequirements(byId("judged"), message.requirements, pick);
  if (message.branches) branches.take(message);
  if (message.learning) showLearning(message.learning);
  // Who asks for a branch has no other orders.
  if (message.stale) orders.forget();
  if (message.refused) (page.header.branches ? branches : orders).say(message.refused);
  if (message.answer) orders.answer(message.answer);
}

function begin(header) {
  page.header = header;
  page.layout = header.layout;
  page.stores = header.runs.map(() => new Store(header.layout.columns.length, header.layout.position));
  byId("title").textContent = header.runs.map((run) => run.name).join(" · ");
  document.title = `${header.runs[0].name} - railhil`;
  orders.begin(header);
  end.show(null);
  byId("judged").hidden = true;
  branches.begin(header);
  byId("frames-of").hidden = header.kind !== "live";
  byId("lamps").hidden = !page.layout.lamps.length;
  byId("axis").hidden = page.layout.position < 0;
  byId("assumed-of").hidden = !page.layout.assumptions.length;
  byId("assumed").replaceChildren(...page.layout.assumptions.map((one) => element("li", {}, one)));
  page.line?.destroy();
  page.line = new Line(byId("line"), page.layout, header.runs, page.stores, pick);
  page.curves?.destroy();
  page.curves = new Curves(page.layout, header.runs, page.stores, pick, (at) => page.stores.some((store) => store.told[at]));
  page.told = toldNotes();
  showLearning(header.learning ?? []);
  arrange();
  showLater();
  if (header.kind === "recorded") {
    const facts = header.runs.map((run) => run.facts.verdict).filter(Boolean);
    byId("phase").textContent = facts.join(" · ");
  }
  if (page.watched !== null) send({ watch: page.watched });
  tellShown();
}

// The notes that the law has told so far: what it never tells has no place on the page.
const toldNotes = () => page.layout.columns.flatMap((one, at) => (one.kind === "note" && page.stores.some((store) => store.told[at]) ? [at] : [])).join();

function arrange() {
  const { layout } = page, tables = [["values", "more"], ["events", "events-of"], ["requirements", "judged"], ["frames", "frames-of"],
    ["branch", "branch"], ["learning", "learning"], ["assumed by the scenario", "assumed-of"]];
  page.gauges = new Gauges(byId("values"), byId("more"), layout, page.header.runs, (run, at) => page.stores[run].told[at]);
  desk.begin(layout.system, layout.desks, [["line", byId("line")], ...page.curves.tiles, ...tables.map(([name, id]) => [name, byId(id)])]);
}

function rebuild() {
  page.curves.build();
  page.curves.markers(page.events);
  arrange();
}

// Of a law with a memory: its errors and what it keeps, by the number of the run.
function showLearning(charts) {
  const place = byId("learning");
  for (const one of page.learning) one.destroy();
  place.replaceChildren();
  place.hidden = !charts.length;
  page.learning = charts.map(({ title, unit, series, data }) => railhilCharts.chart(place, {
    title, unit, x: { label: "run", unit: "" }, sync: "learning",
    series: series.map((label, at) => ({ label, unit, colour: at ? "target" : 0, dash: at ? [8, 4] : undefined })),
  }, data));
}

function takeBatch(buffer) {
  const [kind, run, rows, columns] = new Uint32Array(buffer, 0, 4);
  if (kind !== APPEND && kind !== REPLACE) return;
  page.stores[run].take(kind === REPLACE, buffer, rows, columns);
  // Another run begins: an instant of the one before is none of its own.
  if (kind === REPLACE && !rows && page.picked !== null) pick(null);
  counters.batches += 1;
  counters.rows += rows;
  const told = toldNotes();
  if (told !== page.told) { page.told = told; rebuild(); }
  page.curves.touch();
  page.line.touch();
  if (page.picked !== null) requestAnimationFrame(() => page.curves.cursor(page.picked));
  showLater();
}

function showLater() {
  if (page.pending) return;
  page.pending = true;
  requestAnimationFrame(() => { page.pending = false; show(); });
}

// ---- what is shown

function show() {
  if (!page.gauges) return;
  if (page.hasEvents) {
    page.hasEvents = false;
    showEvents(byId("events"), page.events, pick);
    page.curves.markers(page.events.filter((one) => one.kind !== "start"));
    page.line.markers(page.events);
  }
  const end = Math.max(0, ...page.stores.map((store) => store.endS));
  // Beyond the last row there is no value.
  const instant = Math.min(page.picked ?? end, end);
  const rows = page.stores.map((store) => store.rowAt(instant + 1e-6));
  page.gauges.show(page.stores, rows);
  page.line.show(rows, page.lineSeen);
  const { lamps } = page.layout, states = page.stores.map((store, run) => lamps.map((lamp) => (rows[run] < 0 ? NaN : store.values[lamp.column][rows[run]])));
  showLamps(byId("lamps"), lamps, states, page.header.runs.map((run) => run.name));
  const slider = byId("instant");
  slider.max = end;
  if (document.activeElement !== slider || page.picked === null) slider.value = instant;
  byId("at").textContent = `${instant.toFixed(2)} s`;
  branches.at(instant);
  byId("live").hidden = page.picked === null || page.header.kind !== "live";
}

function pick(timeS) {
  page.picked = timeS;
  if (timeS === null) history.replaceState(null, "", location.pathname);
  else history.replaceState(null, "", `#t=${Number(timeS.toFixed(3))}`);
  show();
  page.curves.cursor(timeS);
}

function showState(state) {
  const box = byId("phase"), operator = state.operator;
  const parts = [state.time_s === null ? "time not known" : `${state.time_s.toFixed(1)} s`, state.run];
  const hasEnded = operator?.phase === "ended";
  if (operator) parts.unshift(hasEnded ? `ended: ${operator.verdict}` : operator.phase ?? "no supervisor takes orders");
  parts.push(`bus ${state.load === null ? "–" : `${(100 * state.load).toFixed(1)} %`}`);
  parts.push(`polls missed ${state.missed} of ${state.polls}`, `frames ${state.frames}`, `dropped here ${state.dropped}`);
  const late = operator?.lateness;
  if (late) parts.push(`ticks late p99 ${late.p99_ms.toFixed(2)} ms, worst ${late.worst_ms.toFixed(2)} ms`);
  box.textContent = parts.join(" · ");
  const notice = byId("notice");
  const trouble = hasEnded || operator?.phase === "waiting" ? "" : state.bus;
  const said = [trouble, ...state.notices].filter(Boolean);
  notice.hidden = !said.length;
  notice.replaceChildren(...said.map((text) => element("span", {}, text)));
  orders.show(operator);
  end.show(operator, Boolean(orders.token));
}

function showList(message) {
  showFrames(byId("frames"), message.frames, page.watched, watch);
  const raw = message.raw[page.watched];
  byId("raw").hidden = !raw;
  if (raw) byId("raw").textContent = raw.slice().reverse().map(([time, data]) => `${(time === null ? "–" : time.toFixed(2)).padStart(9)}  ${data}`).join("\n");
}

// The list of frames comes often only while it can be seen.
function tellShown() {
  send({ frames: page.listSeen && !document.hidden });
}

function watch(id) {
  page.watched = page.watched === id ? null : id;
  send({ watch: page.watched });
}

// ---- controls

const orders = new Orders(send);

const desk = new Desk(byId("tiles"), byId("arrange"));

const end = new End(byId("end"), byId("desk"), (asked) => orders.order(asked, ""));

const branches = new BranchForm(byId("branch"), (asked) => orders.order(asked, ""));

byId("instant").addEventListener("input", () => pick(Number(byId("instant").value)));
byId("live").addEventListener("click", () => pick(null));
byId("whole").addEventListener("click", () => { page.curves.whole(); page.line.whole(); page.curves.touch(); page.line.touch(); show(); });
byId("axis").addEventListener("click", () => {
  page.curves.overDistance = !page.curves.overDistance;
  byId("axis").textContent = page.curves.overDistance ? "over time" : "over distance";
  rebuild();
});
byId("theme").addEventListener("click", () => {
  const dark = document.documentElement.dataset.theme
    ? document.documentElement.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  setTheme(dark ? "light" : "dark");
});

function setTheme(name) {
  localStorage.setItem("railhil-theme", name);
  railhilCharts.setTheme(name);
}

// On paper all tiles have their curves, in the colours of paper.
addEventListener("beforeprint", () => {
  page.theme = document.documentElement.dataset.theme ?? "";
  railhilCharts.setTheme("light");
  page.curves?.draw(true);
  page.line?.draw();
});
addEventListener("afterprint", () => railhilCharts.setTheme(page.theme));

// The instant goes to the next sample, or the tenth next.
function step(event) {
  const side = { ArrowLeft: -1, ArrowRight: 1 }[event.key], store = page.stores[0];
  if (!side || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || !store?.rows) return;
  const row = store.rowAt((page.picked ?? store.endS) + 1e-6) + side * (event.shiftKey ? 10 : 1);
  pick(store.times[Math.min(Math.max(row, 0), store.rows - 1)]);
  event.preventDefault();
}
byId("instant").addEventListener("keydown", step);

const KEYS = { s: "start", p: "pause", x: "stop", e: "emergency", r: "reset", d: "axis", z: "whole", t: "theme" };
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
  step(event);
  const id = KEYS[event.key.toLowerCase()];
  if (id && !byId(id).disabled && byId(id).offsetParent) { byId(id).click(); event.preventDefault(); }
});

function countFrame() { counters.frames += 1; requestAnimationFrame(countFrame); }

// Counters since the last call, for tests and measurements.
window.stats = () => {
  const now = performance.now(), seconds = (now - counters.since) / 1000;
  const found = { fps: counters.frames / seconds, batches: counters.batches, rows: counters.rows,
    redraws: page.curves?.redraws ?? 0, kept: page.stores.map((store) => store.rows), seconds, closed: counters.closed };
  Object.assign(counters, { frames: 0, since: now });
  return found;
};

if (localStorage.getItem("railhil-theme")) railhilCharts.setTheme(localStorage.getItem("railhil-theme"));
page.picked = readHash();
addEventListener("hashchange", () => { const instant = readHash(); if (instant !== null) pick(instant); });
new IntersectionObserver((entries) => { page.listSeen = entries.at(-1).isIntersecting; tellShown(); })
  .observe(byId("frames-of"));
new IntersectionObserver((entries) => { page.lineSeen = entries.at(-1).isIntersecting; showLater(); }).observe(byId("line"));
document.addEventListener("visibilitychange", tellShown);
countFrame();
connect();
