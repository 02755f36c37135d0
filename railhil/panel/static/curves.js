// The charts of the page: what they show of the runs' rows, redrawn at most once a frame.
import { element } from "./gauges.js";
import { thinned } from "./store.js";

// Points of a curve: two for each part, more than any chart has pixels; outside a zoom fewer.
const PARTS = 900, OUTSIDE = 150;
export const DASHES = [undefined, [8, 4], [2, 3], [10, 3, 2, 3]];

export class Curves {
  // told: called with a column, whether a note of the law has had a value.
  constructor(layout, runs, stores, onPick, told) {
    Object.assign(this, { layout, runs, stores, onPick, told, overDistance: false, redraws: 0, charts: [], dirty: false, hosts: new Map() });
    // What nobody sees is not drawn.
    this.eye = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) for (const one of this.charts) if (one.handle.element === target) one.seen = isIntersecting;
      this.touch();
    });
    this.build();
  }

  destroy() {
    this.eye.disconnect();
    for (const one of this.charts) one.handle.destroy();
  }

  // The tiles: [[name, element]].
  get tiles() { return [...this.hosts]; }

  build() {
    this.destroy();
    this.charts = [];
    const hosts = this.hosts;
    this.hosts = new Map();
    this.host = (name) => {
      const box = hosts.get(name) ?? element("div", { class: "curves" });
      this.hosts.set(name, box);
      return box;
    };
    const { columns, charts, tracks } = this.layout, many = this.runs.length > 1;
    const x = this.overDistance ? { label: "distance", unit: "m" } : { label: "time", unit: "s" };
    const labels = (run, label) => (many ? `${run.name}: ${label}` : label);
    for (const chart of charts) {
      const shown = chart.columns.filter((at) => columns[at].kind !== "note" || this.told(at));
      if (!shown.length) continue;
      const title = charts.some((one) => one !== chart && one.title === chart.title) && chart.unit ? `${chart.title} (${chart.unit})` : chart.title;
      const series = this.runs.flatMap((run, which) => shown.map((at, place) => ({
        label: labels(run, columns[at].label), unit: columns[at].unit, colour: at === this.layout.target ? "target" : place % 7,
        // A unit of the train differs by its dashes, too.
        dash: DASHES[(many ? which : (/ (\d)$/.exec(columns[at].label)?.[1] ?? 1) - 1) % DASHES.length],
        names: Object.values(columns[at].words), step: columns[at].kind === "note" || at === this.layout.command,
        end: shown.length * this.runs.length > 1 ? labels(run, shown.length > 1 ? columns[at].label : "").replace(/: $/, "") : undefined,
      })));
      this.add("chart", title, { title: chart.title, unit: chart.unit, x, series, sync: "panel" }, shown);
    }
    const levels = tracks.filter((at) => columns[at].kind === "level");
    if (levels.length) {
      const series = this.runs.flatMap((run) => levels.map((at) => ({
        label: labels(run, columns[at].label.replace(" level", "")),
        names: Object.values(columns[at].words).map((word) => word.replaceAll("_", " ")),
      })));
      this.add("tracks", "reaction ladders", { title: "reaction ladders", x, series, sync: "panel" }, levels);
    }
    this.touch();
  }

  add(kind, name, description, columns) {
    const places = this.runs.length > 1 ? this.runs.length * columns.length : columns.length;
    const empty = [[], ...Array.from({ length: places }, () => [])];
    const handle = railhilCharts[kind](this.host(name), { ...description, bare: true, height: "fill" }, empty);
    pickBy(handle, (value) => this.onPick(this.timeOf(value)));
    // The legend goes back to the instant that is chosen.
    handle.plot.over.addEventListener("pointerleave", () => this.cursor(this.chosen));
    this.eye.observe(handle.element);
    this.charts.push({ handle, columns, seen: false });
  }

  // Over distance an instant is where the first run was.
  timeOf(value) {
    return this.overDistance ? timeAt(this.stores[0], this.layout.position, value) : value;
  }

  xOf(timeS) {
    if (!this.overDistance) return timeS;
    const store = this.stores[0], row = store.rowAt(timeS);
    return row < 0 ? 0 : store.values[this.layout.position][row];
  }

  cursor(timeS) {
    this.chosen = timeS;
    if (this.charts.length) this.charts[0].handle.cursor(timeS == null ? null : this.xOf(timeS));
  }

  markers(events) {
    const shown = events.map((one) => ({
      at: this.xOf(one.time_s), until: one.is_open ? Infinity : one.until_s == null ? undefined : this.xOf(one.until_s),
      text: `${one.source}: ${one.text}`, fault: one.kind === "fault",
    }));
    for (const one of this.charts) one.handle.setMarkers(shown);
  }

  touch() {
    if (this.dirty) return;
    this.dirty = true;
    requestAnimationFrame(() => { this.dirty = false; this.draw(); });
  }

  whole() { if (this.charts.length) this.charts[0].handle.zoom(); }

  // isAll: also what nobody sees.
  draw(isAll = false) {
    this.redraws += 1;
    for (const { handle, columns, seen } of this.charts) {
      if (!seen && !isAll) continue;
      const [low, high] = handle.zoomed() ? handle.range() : [-Infinity, Infinity];
      handle.setData(joined(this.stores.map((store) =>
        tableOver(this.overDistance ? store.values[this.layout.position] : store.times, store, columns, low, high))));
    }
  }
}

// The instant at which a run was at a position.
export const timeAt = (store, column, position) => store.times[Math.min(railhilView.before(store.values[column], position, store.rows), store.rows - 1)] ?? 0;

// A click on a chart chooses its x.
export function pickBy({ plot }, onPick) {
  plot.over.addEventListener("click", (event) => {
    const value = plot.posToVal(event.offsetX, "x");
    if (Number.isFinite(value)) onPick(value);
  });
}

// Tables of rows, over the x of all of them.
export const joined = (tables) => (tables.length > 1 ? railhilCharts.join(tables) : tables[0]);

// The whole run over x, thinned, and less so between low and high.
export function tableOver(x, store, columns, low, high) {
  const series = columns.map((at) => store.values[at]);
  const [begin, end] = [low, high].map((value) => railhilView.before(x, value, store.rows));
  const parts = [[0, begin, OUTSIDE], [begin, end, PARTS], [end, store.rows, OUTSIDE]]
    .filter(([from, to]) => to > from).map(([from, to, count]) => thinned(x, series, from, to, count));
  if (parts.length === 1) return parts[0];
  return [x, ...series].map((_, at) => parts.flatMap((part) => Array.from(part[at])));
}
