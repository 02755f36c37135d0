// The charts of the page: what they show of the runs' rows, redrawn at most once a frame.
import { thinned } from "./store.js";

// Points of a curve: two for each part, more than any chart has pixels; outside a zoom fewer.
const PARTS = 900, OUTSIDE = 150;
const DASHES = [undefined, [8, 4], [2, 3], [10, 3, 2, 3]];

export class Curves {
  constructor(place, layout, runs, stores, onPick) {
    this.layout = layout;
    this.stores = stores;
    this.overDistance = false;
    this.redraws = 0;
    this.charts = [];
    this.dirty = false;
    this.place = place;
    this.runs = runs;
    this.onPick = onPick;
    this.build();
  }

  build() {
    for (const one of this.charts) one.handle.destroy();
    this.charts = [];
    const { columns, charts, tracks } = this.layout, many = this.runs.length > 1;
    const x = this.overDistance ? { label: "distance", unit: "m" } : { label: "time", unit: "s" };
    const labels = (run, label) => (many ? `${run.name}: ${label}` : label);
    for (const chart of charts) {
      const series = this.runs.flatMap((run, which) => chart.columns.map((at, place) => ({
        label: labels(run, columns[at].label), unit: columns[at].unit, colour: this.colour(chart, at, place),
        dash: DASHES[which % DASHES.length], names: this.words(columns[at]), step: columns[at].kind === "note" || at === this.layout.command,
      })));
      this.add("chart", { title: chart.title, unit: chart.unit, x, series, sync: "panel" }, chart.columns);
    }
    const levels = tracks.filter((at) => columns[at].kind === "level");
    if (levels.length) {
      const series = this.runs.flatMap((run) => levels.map((at) => ({
        label: labels(run, columns[at].label.replace(" level", "")),
        names: Object.values(columns[at].words).map((word) => word.replaceAll("_", " ")),
      })));
      this.add("tracks", { title: "reaction ladders", x, series, sync: "panel" }, levels);
    }
    this.touch();
  }

  colour(chart, at, place) {
    if (at === this.layout.target) return "target";
    return place % 7;
  }

  words(column) {
    const words = Object.values(column.words);
    return words.length ? words : undefined;
  }

  add(kind, description, columns) {
    const places = this.runs.length > 1 ? this.runs.length * columns.length : columns.length;
    const empty = [[], ...Array.from({ length: places }, () => [])];
    const handle = railhilCharts[kind](this.place, description, empty);
    handle.plot.over.addEventListener("click", (event) => {
      const value = handle.plot.posToVal(event.offsetX, "x");
      if (Number.isFinite(value)) this.onPick(this.timeOf(value));
    });
    this.charts.push({ handle, columns });
  }

  // Over distance an instant is where the first run was.
  timeOf(value) {
    const store = this.stores[0];
    if (!this.overDistance) return value;
    const way = store.values[this.layout.position];
    let row = 0;
    while (row < store.rows - 1 && way[row] < value) row += 1;
    return store.times[row];
  }

  xOf(timeS) {
    if (!this.overDistance) return timeS;
    const store = this.stores[0], row = store.rowAt(timeS);
    return row < 0 ? 0 : store.values[this.layout.position][row];
  }

  cursor(timeS) {
    if (this.charts.length) this.charts[0].handle.cursor(timeS == null ? null : this.xOf(timeS));
  }

  markers(events) {
    const shown = events.map((one) => ({
      at: this.xOf(one.time_s), until: one.until_s == null ? undefined : this.xOf(one.until_s),
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

  zoomTo(lowS, highS) { if (this.charts.length) this.charts[0].handle.zoom(this.xOf(lowS), this.xOf(highS)); }

  draw() {
    this.redraws += 1;
    for (const { handle, columns } of this.charts) {
      const [low, high] = handle.zoomed() ? handle.range() : [-Infinity, Infinity];
      const tables = this.stores.map((store) => this.table(store, columns, low, high));
      handle.setData(tables.length > 1 ? railhilCharts.join(tables) : tables[0]);
    }
  }

  table(store, columns, low, high) {
    const x = this.overDistance ? store.values[this.layout.position] : store.times;
    return tableOver(x, store, columns, low, high);
  }
}

// The whole run over x, thinned, and less so between low and high.
export function tableOver(x, store, columns, low, high) {
  const series = columns.map((at) => store.values[at]);
  const begin = Number.isFinite(low) ? place(x, store.rows, low) : 0;
  const end = Number.isFinite(high) ? place(x, store.rows, high) : store.rows;
  const parts = [[0, begin, OUTSIDE], [begin, end, PARTS], [end, store.rows, OUTSIDE]]
    .filter(([from, to]) => to > from).map(([from, to, count]) => thinned(x, series, from, to, count));
  if (parts.length === 1) return parts[0];
  return [x, ...series].map((_, at) => parts.flatMap((part) => Array.from(part[at])));
}

function place(x, rows, value) {
  let low = 0, high = rows;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}
