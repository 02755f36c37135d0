// The line with its named places: speeds over it, and the place of each train.
import { tableOver } from "./curves.js";

const DASHES = [undefined, [8, 4], [2, 3], [10, 3, 2, 3]];

export class Line {
  constructor(place, layout, runs, stores, onPick) {
    this.layout = layout;
    this.stores = stores;
    this.dirty = false;
    place.replaceChildren();
    const { columns, places, strip } = layout, many = runs.length > 1;
    place.hidden = !places.length;
    if (!places.length) return;
    const at = places.map((one) => one.position), low = Math.min(...at), high = Math.max(...at);
    // The train has room at both ends.
    const beside = 0.01 * (high - low);
    const series = runs.flatMap((run, which) => strip.map((column, number) => ({
      label: many ? `${run.name}: ${columns[column].label}` : columns[column].label, unit: columns[column].unit,
      colour: column === layout.target ? "target" : number % 7, dash: DASHES[which % DASHES.length],
    })));
    const unit = columns[strip[0]].unit, empty = [[], ...series.map(() => [])];
    this.handle = railhilCharts.chart(place, {
      title: "line", unit, series, height: 290,
      x: { label: "position", unit: columns[layout.position].unit, range: [low - beside, high + beside] },
      lines: places.map((one) => ({ at: one.position, name: one.name })),
    }, empty);
    this.handle.plot.over.addEventListener("click", (event) => {
      const value = this.handle.plot.posToVal(event.offsetX, "x");
      if (Number.isFinite(value)) onPick(this.timeAt(value));
    });
  }

  // The instant at which the first run was at a position.
  timeAt(position) {
    const store = this.stores[0], way = store.values[this.layout.position];
    let row = 0;
    while (row < store.rows - 1 && way[row] < position) row += 1;
    return store.times[row] ?? 0;
  }

  touch() {
    if (this.dirty || !this.handle) return;
    this.dirty = true;
    requestAnimationFrame(() => {
      this.dirty = false;
      const [low, high] = this.handle.zoomed() ? this.handle.range() : [-Infinity, Infinity];
      const tables = this.stores.map((store) => tableOver(store.values[this.layout.position], store, this.layout.strip, low, high));
      this.handle.setData(tables.length > 1 ? railhilCharts.join(tables) : tables[0]);
    });
  }

  // The trains where they are in some rows; -1: not known.
  show(rows) {
    if (!this.handle) return;
    this.handle.setPlaces(rows.flatMap((row, which) => (row < 0 ? [] : [this.stores[which].values[this.layout.position][row]])));
  }

  destroy() { this.handle?.destroy(); }
}
