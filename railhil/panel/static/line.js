// The line with its named places: speeds over it, what the scenario says of it, and the place of each train.
import { DASHES, joined, pickBy, tableOver, timeAt } from "./curves.js";

export class Line {
  constructor(place, layout, runs, stores, onPick) {
    Object.assign(this, { layout, stores, dirty: false, charts: [] });
    place.replaceChildren();
    const { columns, places, profiles, strip, position } = layout, many = runs.length > 1;
    place.hidden = !strip.length;
    if (!strip.length) return;
    const at = [...places.map((one) => one.position), ...profiles.flatMap((one) => one.rows.map(([x]) => x))];
    const low = Math.min(...at), high = Math.max(...at), beside = 0.01 * (high - low);
    const named = (kinds) => places.filter((one) => kinds.includes(one.kind)).map((one) => ({ at: one.position, name: one.name }));
    // The speeds, then what has another unit, such as the grade.
    [...new Set([...strip.map((column) => columns[column].unit), ...profiles.map((one) => one.unit)])].forEach((unit, below) => {
      const own = profiles.filter((one) => one.unit === unit);
      // The first column lies above the others.
      const drawn = strip.filter((column) => columns[column].unit === unit).reverse();
      const series = runs.flatMap((run, which) => drawn.map((column) => {
        const label = many ? `${run.name}: ${columns[column].label}` : columns[column].label;
        return { label, unit, colour: column === layout.target ? "target" : strip.indexOf(column) % 7,
          end: label, dash: DASHES[which % DASHES.length], filled: below && !own.length };
      }));
      const box = place.appendChild(document.createElement("div"));
      const handle = railhilCharts.chart(box, {
        title: below ? own[0]?.label ?? columns[drawn[0]].label : "line", unit, bare: true, height: "fill", sync: "line",
        lines: named(below ? ["balise"] : ["stop", "mark"]),
        // The train has room at both ends.
        x: { label: "position", unit: columns[position].unit, range: [low - beside, high + beside] },
        series: [...own.map((one, number) => ({ label: one.label, unit, colour: number ? "fault" : 5,
          dash: [6, 3], step: one.is_step, filled: below, end: below ? undefined : one.label })), ...series],
      }, [[], ...own.map(() => []), ...series.map(() => [])]);
      pickBy(handle, (value) => onPick(timeAt(stores[0], position, value)));
      const chart = { handle, drawn, profiles: own.map(({ rows }) => [rows.map(([x]) => x), rows.map(([, y]) => y)]) };
      if (!drawn.length) handle.setData(joined(chart.profiles));
      this.charts.push(chart);
    });
    this.touch();
  }

  // The rows have changed, or the range.
  touch() { this.dirty = true; }

  draw() {
    this.dirty = false;
    for (const { handle, drawn, profiles } of this.charts.filter((one) => one.drawn.length)) {
      const [low, high] = handle.zoomed() ? handle.range() : [-Infinity, Infinity];
      const tables = this.stores.map((store) => tableOver(store.values[this.layout.position], store, drawn, low, high));
      handle.setData(joined([...profiles, ...tables]));
    }
  }

  // Faults, from where the first train was when they began to act, to where it was when they ended or is now.
  markers(events) {
    if (!this.charts.length) return;
    this.open = events.some((one) => one.is_open) ? events : null;
    const store = this.stores[0], way = store.values[this.layout.position], at = (timeS) => way[store.rowAt(timeS)];
    const shown = events.filter((one) => one.kind === "fault").map((one) => ({ at: at(one.time_s), fault: true,
      until: one.is_open ? at(store.endS) : one.until_s == null ? undefined : at(one.until_s), text: `${one.source}: ${one.text}` })).filter((one) => one.at !== undefined);
    for (const { handle } of this.charts) handle.setMarkers(shown);
  }

  whole() { this.charts[0]?.handle.zoom(); }

  // The trains where they are in some rows; -1: not known. isSeen: what nobody sees is not drawn.
  show(rows, isSeen) {
    if (!this.charts.length) return;
    if (this.open) this.markers(this.open);
    const places = rows.flatMap((row, which) => (row < 0 ? [] : [this.stores[which].values[this.layout.position][row]]));
    // A chart that is drawn anyway is not drawn twice.
    for (const { handle, drawn } of this.charts) handle.setPlaces(places, !drawn.length || !this.dirty);
    if (this.dirty && isSeen) this.draw();
  }

  destroy() { for (const { handle } of this.charts) handle.destroy(); }
}
