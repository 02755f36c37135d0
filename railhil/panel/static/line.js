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
    const { unit } = columns[strip[0]], named = (kinds) => places.filter((one) => kinds.includes(one.kind)).map((one) => ({ at: one.position, name: one.name }));
    const add = (title, unit, series, own, lines) => {
      const box = place.appendChild(document.createElement("div"));
      const handle = railhilCharts.chart(box, {
        title, unit, bare: true, height: "fill", sync: "line", lines,
        // The train has room at both ends.
        x: { label: "position", unit: columns[position].unit, range: [low - beside, high + beside] },
        series: [...own.map((one, number) => ({ label: one.label, unit: one.unit, colour: number ? "fault" : 5,
          dash: [6, 3], step: one.is_step, filled: !series.length, end: series.length ? one.label : undefined })), ...series],
      }, [[], ...own.map(() => []), ...series.map(() => [])]);
      pickBy(handle, (value) => onPick(timeAt(stores[0], position, value)));
      this.charts.push({ handle, has: series.length, profiles: own.map(({ rows }) => [rows.map(([x]) => x), rows.map(([, y]) => y)]) });
    };
    // The first column lies above the others.
    this.strip = [...strip].reverse();
    const series = runs.flatMap((run, which) => this.strip.map((column) => {
      const label = many ? `${run.name}: ${columns[column].label}` : columns[column].label;
      return { label, unit: columns[column].unit, colour: column === layout.target ? "target" : strip.indexOf(column) % 7, end: label, dash: DASHES[which % DASHES.length] };
    }));
    add("line", unit, series, profiles.filter((one) => one.unit === unit), named(["stop", "mark"]));
    const others = profiles.filter((one) => one.unit !== unit);
    if (others.length) add(others[0].label, others[0].unit, [], others, named(["balise"]));
    for (const one of this.charts) if (!one.has) one.handle.setData(joined(one.profiles));
    this.touch();
  }

  // The rows have changed, or the range.
  touch() { this.dirty = true; }

  draw() {
    this.dirty = false;
    const { handle, profiles } = this.charts[0], [low, high] = handle.zoomed() ? handle.range() : [-Infinity, Infinity];
    const tables = this.stores.map((store) => tableOver(store.values[this.layout.position], store, this.strip, low, high));
    handle.setData(joined([...profiles, ...tables]));
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
    this.charts.forEach(({ handle }, at) => handle.setPlaces(places, at > 0 || !this.dirty));
    if (this.dirty && isSeen) this.draw();
  }

  destroy() { for (const { handle } of this.charts) handle.destroy(); }
}
