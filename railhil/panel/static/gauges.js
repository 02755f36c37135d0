// Numbers, lamps, events and frames: the page's text.
const shownNumber = (value, isCount) => {
  if (Number.isNaN(value)) return "–";
  if (isCount && Number.isInteger(value)) return String(value);
  const digits = Math.abs(value) >= 1000 ? 0 : Math.abs(value) >= 100 ? 1 : 2;
  return value.toFixed(digits);
};

export const element = (tag, attributes = {}, text = "") => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
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
    const column = this.layout.columns[at], box = element("div", { class: large ? "value large" : "value" });
    box.dataset.column = column.name;
    const number = element("b"), value = element("span", { class: Object.keys(column.words).length ? "words" : "" }, "–");
    number.append(value);
    if (column.unit) number.append(element("small", {}, ` ${column.unit}`));
    box.append(number, element("span", {}, column.label));
    this.boxes.push({ which, at, box, value, column });
    return box;
  }

  stopBox(which) {
    const box = element("div", { class: "value to-go", "data-column": "to_go" }), number = element("b"), what = element("span");
    box.append(number, what);
    this.stops.push({ which, number, what });
    return box;
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
      const row = element("div", { class: "lamps", "data-lamps": lamps.length, role: "group", "aria-label": "lamps", tabindex: "0" });
      if (states.length > 1) row.append(element("span", {}, names[which]));
      row.append(...lamps.map(() => element("span", { class: "lamp" })));
      return row;
    }));
  }
  states.forEach((of, which) => lamps.forEach((lamp, at) => {
    const state = of[at], is = Number.isNaN(state) ? "unknown" : state === lamp.normal ? "on" : "off";
    const text = `${{ unknown: "○", on: "●", off: "✕" }[is]} ${lamp.label}${is === "off" ? ": NO" : is === "unknown" ? ": ?" : ""}`;
    const box = place.children[which].querySelectorAll(".lamp")[at];
    if (box.textContent !== text) { box.textContent = text; box.className = `lamp ${is}`; }
  }));
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
