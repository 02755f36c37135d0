// Numbers, lamps, events and frames: the page's text.
const shownNumber = (value, unit) => {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const digits = Math.abs(value) >= 1000 ? 0 : Math.abs(value) >= 100 ? 1 : 2;
  return `${value.toFixed(digits)}${unit ? ` ${unit}` : ""}`;
};

export const element = (tag, attributes = {}, text = "") => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
};

// What stands at an instant in the columns of a run.
export class Gauges {
  constructor(place, layout, runs) {
    this.layout = layout;
    this.boxes = [];
    place.replaceChildren();
    const { columns } = layout;
    const first = [layout.speed, layout.target, layout.command].filter((at) => at >= 0);
    const error = columns.findIndex((one) => one.name === "tracking_error_kmh");
    const second = [...new Set([error, layout.position, ...layout.gauges, ...columns.map((_, at) => at)
      .filter((at) => columns[at].kind === "note" || columns[at].kind === "level")])].filter((at) => at >= 0 && !first.includes(at));
    const rest = columns.map((_, at) => at).filter((at) => columns[at].kind !== "lamp" && !first.includes(at) && !second.includes(at));
    runs.forEach((run, which) => {
      const box = element("div", { class: "run" });
      if (runs.length > 1) box.append(element("h2", {}, run.name));
      for (const at of first) box.append(this.box(which, at, true));
      for (const at of second) box.append(this.box(which, at, false));
      place.append(box);
      if (!rest.length) return;
      const more = element("details"), inside = element("div", { class: "run" });
      more.append(element("summary", {}, "all values"), inside);
      for (const at of rest) inside.append(this.box(which, at, false));
      place.append(more);
    });
  }

  box(which, at, large) {
    const column = this.layout.columns[at], box = element("div", { class: large ? "value large" : "value" });
    box.dataset.column = column.name;
    const number = element("b"), value = element("span", { class: Object.keys(column.words).length ? "words" : "" }, "–");
    number.append(value);
    if (column.unit) number.append(element("small", {}, ` ${column.unit}`));
    box.append(number, element("span", {}, column.label));
    this.boxes.push({ which, at, box, value, column });
    return box;
  }

  show(stores, rows) {
    for (const { which, at, box, value, column } of this.boxes) {
      const row = rows[which], number = row < 0 ? NaN : stores[which].values[at][row];
      const words = Object.keys(column.words).length;
      const text = words && !Number.isNaN(number) ? (column.words[number] ?? number).toString().replaceAll("_", " ")
        : shownNumber(number);
      if (value.textContent !== text) value.textContent = text;
      if (column.kind === "level") box.classList.toggle("raised", number > 0);
    }
  }
}

// Form and words say what a lamp is, not its colour alone.
export function showLamps(place, lamps, states) {
  if (place.childElementCount !== lamps.length) {
    place.replaceChildren(...lamps.map(() => element("span", { class: "lamp" })));
  }
  lamps.forEach((lamp, at) => {
    const state = states[at], is = Number.isNaN(state) ? "unknown" : state === lamp.normal ? "on" : "off";
    const text = `${{ unknown: "○", on: "●", off: "✕" }[is]} ${lamp.label}${is === "off" ? ": NO" : is === "unknown" ? ": ?" : ""}`;
    const box = place.children[at];
    if (box.textContent !== text) { box.textContent = text; box.className = `lamp ${is}`; }
  });
}

export function showEvents(place, events, onPick) {
  place.replaceChildren(...events.slice(-300).reverse().map((one) => {
    const row = element("tr", { class: `rank${one.rank}`, tabindex: "0" });
    row.append(element("td", { class: "n" }, one.time_s.toFixed(2)), element("td", {}, one.source), element("td", {}, one.text));
    row.addEventListener("click", () => onPick(one.time_s));
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") onPick(one.time_s); });
    return row;
  }));
}

export function showFrames(place, frames, chosen, onChoose) {
  while (place.childElementCount > frames.length) place.lastChild.remove();
  while (place.childElementCount < frames.length) {
    const row = element("tr", { tabindex: "0" });
    for (const name of ["hex", "", "n", "n", "n", "hex", ""]) row.append(element("td", { class: name }));
    row.addEventListener("click", () => onChoose(Number(row.dataset.id)));
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") onChoose(Number(row.dataset.id)); });
    place.append(row);
  }
  frames.forEach(([id, name, count, period, age, data, text], at) => {
    const row = place.children[at];
    row.dataset.id = id;
    row.classList.toggle("chosen", id === chosen);
    const cells = [id.toString(16).padStart(3, "0"), name, count, period === null ? "" : period.toFixed(0), age === null ? "" : age.toFixed(0), data, text];
    cells.forEach((cell, place) => {
      const was = row.children[place];
      if (was.textContent !== String(cell)) was.textContent = cell;
    });
  });
}

export { shownNumber };
