// Numbers, lamps, events and frames: the page's text.
const shownNumber = (value, isCount) => {
  if (Number.isNaN(value)) return "–";
  if (isCount && Number.isInteger(value)) return String(value);
  const digits = Math.abs(value) >= 1000 ? 0 : Math.abs(value) >= 100 ? 1 : 2;
  return value.toFixed(digits);
};

// inside: elements and texts.
export const element = (tag, attributes = {}, ...inside) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...inside);
  return made;
};

// What stands at an instant in the columns of a run: what is watched in one place, everything else in another.
export class Gauges {
  // told: called with (run, column), whether a note of the law has had a value.
  constructor(place, others, layout, runs, told) {
    this.layout = layout;
    this.boxes = [];
    this.stops = [];
    place.replaceChildren();
    others.replaceChildren();
    const { columns, speed, target, command, applied } = layout, every = columns.map((_, at) => at);
    const error = columns.findIndex((one) => one.name === "tracking_error");
    const first = [...new Set([speed, target, command, applied, error, ...layout.gauges, ...every.filter((at) => columns[at].kind === "level")])]
      .filter((at) => at >= 0);
    runs.forEach((run, which) => {
      const box = element("div", { class: "run" }), rest = element("div", { class: "run" });
      if (runs.length > 1) for (const one of [box, rest]) one.append(element("h3", {}, run.name));
      for (const at of first) {
        box.append(this.box(which, at, at === speed));
        if (at === (target >= 0 ? target : speed) && layout.places.some((one) => one.kind === "stop")) box.append(this.stopBox(which));
      }
      rest.append(...every.filter((at) => columns[at].kind !== "lamp" && !first.includes(at) && (columns[at].kind !== "note" || told(which, at)))
        .map((at) => this.box(which, at, false)));
      place.append(box);
      others.append(rest);
    });
  }

  box(which, at, large) {
    const column = this.layout.columns[at], value = element("span", { class: Object.keys(column.words).length ? "words" : "" }, "–");
    const number = element("b", {}, value, ...(column.unit ? [element("small", {}, ` ${column.unit}`)] : []));
    const box = element("div", { class: large ? "value large" : "value", "data-column": column.name }, number, element("span", {}, column.label));
    this.boxes.push({ which, at, box, value, column });
    return box;
  }

  stopBox(which) {
    const number = element("b"), what = element("span");
    this.stops.push({ which, number, what });
    return element("div", { class: "value to-go", "data-column": "to_go" }, number, what);
  }

  show(stores, rows) {
    for (const { which, at, box, value, column } of this.boxes) {
      const row = rows[which], number = row < 0 ? NaN : stores[which].values[at][row];
      const words = Object.keys(column.words).length;
      const text = words && !Number.isNaN(number) ? (column.words[number] ?? number).toString().replaceAll("_", " ")
        : shownNumber(number, !column.unit && column.kind !== "note");
      if (value.textContent !== text) value.textContent = text;
      if (column.kind === "level") box.classList.toggle("raised", number > 0);
    }
    for (const { which, number, what } of this.stops) {
      const [text, words] = saidOfStop(findStop(stores[which], this.layout, rows[which]));
      if (number.textContent !== text) number.textContent = text;
      if (what.textContent !== words) what.textContent = words;
    }
  }
}

// How near a stop is told to a centimetre, m; a train that has stood there and is this much further has left it, m.
const NEAR_M = 20, LEFT_M = 5, STANDS_KMH = 0.02;

// The stop that the train runs to or stands at, in a row; null: none is known.
export function findStop(store, layout, row) {
  const way = store.values[layout.position], speed = store.values[layout.speed];
  if (row < 0 || Number.isNaN(way[row])) return null;
  const hasLeft = (stop) => {
    for (let back = row; back >= 0 && way[back] >= stop.position - NEAR_M; back -= 1)
      if (speed[back] < STANDS_KMH && way[row] > way[back] + LEFT_M) return true;
    return false;
  };
  const stop = layout.places.find((one) => one.kind === "stop" && way[row] <= one.position + NEAR_M && !hasLeft(one));
  return stop ? { name: stop.name, leftM: stop.position - way[row], stands: speed[row] < STANDS_KMH } : null;
}

// A number and what it is: the distance to go, near the stop to a centimetre.
function saidOfStop(stop) {
  if (!stop) return ["–", "to go"];
  const { name, leftM, stands } = stop;
  if (Math.abs(leftM) > NEAR_M) return [`${leftM.toFixed(leftM < 1000 ? 1 : 0)} m`, `to ${name}`];
  const cm = Math.round(Math.abs(leftM) * 100);
  return [`${cm} cm`, !cm ? `at ${name}` : leftM < 0 ? `${stands ? "stopped " : ""}past ${name}` : stands ? `short of ${name}` : `to ${name}`];
}

// Form and words say what a lamp is, not its colour alone; a row for each run. states: of each run, of each lamp.
export function showLamps(place, lamps, states, names) {
  if (place.childElementCount !== states.length || place.firstElementChild?.dataset.lamps !== String(lamps.length)) {
    place.replaceChildren(...states.map((_, which) => {
      const run = states.length > 1 ? [element("span", {}, names[which])] : [];
      return element("div", { class: "lamps", "data-lamps": lamps.length, role: "group", "aria-label": "lamps", tabindex: "0" },
        ...run, ...lamps.map(() => element("span", { class: "lamp" })));
    }));
  }
  states.forEach((of, which) => lamps.forEach((lamp, at) => {
    const state = of[at], is = Number.isNaN(state) ? "unknown" : state === lamp.normal ? "on" : "off";
    const text = `${{ unknown: "○", on: "●", off: "✕" }[is]} ${lamp.label}${is === "off" ? ": NO" : is === "unknown" ? ": ?" : ""}`;
    const box = place.children[which].querySelectorAll(".lamp")[at];
    if (box.textContent !== text) { box.textContent = text; box.className = `lamp ${is}`; }
  }));
}

// A row of a table with cells of these classes, that is chosen by a click or by Enter.
function rowOf(classes, choose) {
  const row = element("tr", { tabindex: "0" }, ...classes.map((name) => element("td", { class: name })));
  row.addEventListener("click", () => choose(row));
  row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(row); });
  return row;
}

// The rows of a table, each an array of texts; rows that are there stay, with what a reader has chosen in them.
export function fill(place, rows, classes, choose) {
  while (place.childElementCount > rows.length) place.lastChild.remove();
  while (place.childElementCount < rows.length) place.append(rowOf(classes, choose));
  rows.forEach((cells, at) => cells.forEach((cell, which) => {
    const box = place.children[at].children[which];
    if (box.textContent !== String(cell)) box.textContent = cell;
  }));
}

export function showEvents(place, events, onPick) {
  const shown = events.slice(-300).reverse();
  fill(place, shown.map((one) => [one.time_s.toFixed(2), one.source, one.text]), ["n", "", ""], (row) => onPick(Number(row.dataset.at)));
  shown.forEach((one, at) => { place.children[at].className = `rank${one.rank}`; place.children[at].dataset.at = one.time_s; });
}

export function showFrames(place, frames, chosen, onChoose) {
  fill(place, frames.map(([id, name, count, period, age, data, text]) => [id.toString(16).padStart(3, "0"), name, count,
    period === null ? "" : period.toFixed(0), age === null ? "" : age.toFixed(0), data, text]),
  ["hex", "", "n", "n", "n", "hex", ""], (row) => onChoose(Number(row.dataset.id)));
  frames.forEach(([id], at) => { place.children[at].dataset.id = id; place.children[at].classList.toggle("chosen", id === chosen); });
}
