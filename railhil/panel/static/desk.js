// The tiles of the page on a grid: gridstack moves and sizes them, this keeps the arrangements of each system.
import { element } from "./gauges.js";

const KEPT = "railhil-desks", FORM = "railhil desk 1", COLUMNS = 12;
// Rows on one screen, height of a row in px, and the size of a tile that no arrangement names.
const ROWS = 12, ROW_PX = [38, 64], OTHER = { w: 4, h: 6 };
const isTile = (one) => typeof one?.id === "string" && ["x", "y", "w", "h"].every((key) => Number.isInteger(one[key]) && one[key] >= 0)
  && one.w > 0 && one.h > 0 && one.x + one.w <= COLUMNS && one.y + one.h <= 1000;

export class Desk {
  // place: of the tiles; tools: a <details> in which they are arranged.
  constructor(place, tools) {
    this.place = place;
    this.tools = Object.fromEntries(["name", "own", "save", "reset", "export", "load", "said", "which"]
      .map((name) => [name, tools.querySelector(`[data-desk=${name}]`)]));
    this.drawer = place.parentElement.appendChild(element("div", { hidden: "" }));
    this.kept = JSON.parse(localStorage.getItem(KEPT) ?? "{}");
    this.tiles = new Map();
    this.grid = GridStack.init({ column: COLUMNS, margin: 4, animate: false, handle: ".handle", resizable: { handles: "se,s,e" },
      columnOpts: { breakpoints: [{ w: 800, c: 1 }], layout: "list" } }, place);
    for (const name of ["dragstop", "resizestop"]) this.grid.on(name, () => this.keep());
    this.watch = new MutationObserver(() => this.show(false));
    place.addEventListener("keydown", (event) => this.move(event));
    addEventListener("resize", () => this.fit());
    new ResizeObserver(() => this.fit()).observe(place.previousElementSibling);
    const { name, own, save, reset, load } = this.tools;
    name.addEventListener("change", () => { this.own.chosen = name.value; this.write(); this.show(); });
    save.addEventListener("click", () => this.saveAs(own.value.trim()));
    reset.addEventListener("click", () => { delete this.own.desks[this.own.chosen]; this.write(); this.show(); });
    this.tools.export.addEventListener("click", () => this.export());
    load.addEventListener("change", async () => { this.load(await load.files[0]?.text()); load.value = ""; });
  }

  get own() { return (this.kept[this.system] ??= { chosen: "", desks: {} }); }

  // shipped: [{name, tiles: [[id, w, h]]}]; tiles: [[id, element]]; a tile whose element is hidden has no place.
  begin(system, shipped, tiles) {
    const isNew = system !== this.system;
    this.system = system;
    this.shipped = new Map(shipped.map(({ name, tiles: named }) => [name, { tiles: named.map(([id, w, h]) => ({ id, w, h })), hidden: [] }]));
    const before = this.tiles;
    this.tiles = new Map(tiles);
    for (const [id, box] of before) if (this.tiles.get(id) !== box) box.remove();
    this.watch.disconnect();
    for (const [, box] of tiles) this.watch.observe(box, { attributeFilter: ["hidden"] });
    this.show(isNew);
  }

  // The arrangement that is chosen; its own form stands before the shipped one of the same name.
  get chosen() {
    const names = [...new Set([...this.shipped.keys(), ...Object.keys(this.own.desks)])];
    const name = names.includes(this.own.chosen) ? this.own.chosen : names[0] ?? "";
    return { names, name, desk: this.own.desks[name] ?? this.shipped.get(name) ?? { tiles: [], hidden: [] } };
  }

  // isAnew: everything takes its place in the arrangement; otherwise what is there stays where it is.
  show(isAnew = true) {
    const { names, name, desk } = this.chosen, { grid } = this;
    this.own.chosen = name;
    const there = [...this.tiles].filter(([, box]) => !box.hidden).map(([id]) => id), shown = there.filter((id) => !desk.hidden.includes(id));
    grid.batchUpdate();
    const stay = new Set();
    for (const item of grid.getGridItems()) {
      const { id } = item.gridstackNode, box = this.tiles.get(id);
      if (!isAnew && shown.includes(id) && item.contains(box)) { stay.add(id); continue; }
      if (item.contains(box)) this.drawer.append(box);
      grid.removeWidget(item);
    }
    const placed = desk.tiles.filter((one) => shown.includes(one.id));
    const rest = shown.filter((id) => !placed.some((one) => one.id === id)).map((id) => ({ id, ...OTHER }));
    for (const one of [...placed, ...rest].filter(({ id }) => !stay.has(id))) grid.makeWidget(this.place.appendChild(this.wrap(one.id)), { ...one });
    grid.batchUpdate(false);
    this.fit();
    this.tools.name.replaceChildren(...names.map((one) => element("option", { value: one },
      this.own.desks[one] && this.shipped.has(one) ? `${one} (changed)` : one)));
    this.tools.name.value = name;
    this.tools.reset.disabled = !this.own.desks[name];
    this.tools.which.replaceChildren(...there.map((id) => {
      const box = element("input", { type: "checkbox" });
      box.checked = shown.includes(id);
      box.addEventListener("change", () => this.hide(id, !box.checked));
      return element("label", {}, box, ` ${id}`);
    }));
  }

  wrap(id) {
    const away = element("button", { type: "button", "aria-label": `hide ${id}`, title: `hide ${id}` }, "×");
    away.addEventListener("click", () => this.hide(id, true));
    const head = element("div", { class: "handle" }, element("h2", {}, id), away);
    const tile = element("div", { class: "grid-stack-item-content tile", role: "group", "aria-label": id }, head, this.tiles.get(id));
    return element("div", { class: "grid-stack-item" }, tile);
  }

  // Rows so high that the first of them fill the screen.
  fit() {
    const top = this.place.getBoundingClientRect().top + scrollY, wanted = Math.floor((innerHeight - top - 8) / ROWS);
    const row = Math.min(Math.max(wanted, ROW_PX[0]), ROW_PX[1]);
    if (this.grid.getCellHeight() !== row) this.grid.cellHeight(row);
    this.grid.setStatic(this.grid.getColumn() < COLUMNS);
  }

  // With the keys: alt and arrows move a tile, with shift they size it.
  move(event) {
    const item = event.target.closest(".grid-stack-item"), way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!event.altKey || !way || !item || this.grid.getColumn() < COLUMNS) return;
    event.preventDefault();
    const { x, y, w, h } = item.gridstackNode, [across, down] = way;
    this.grid.update(item, event.shiftKey ? { w: Math.max(1, w + across), h: Math.max(1, h + down) } : { x: Math.max(0, x + across), y: Math.max(0, y + down) });
    this.keep();
  }

  hide(id, is) {
    const { hidden } = this.chosen.desk;
    this.keep(is ? [...hidden, id] : hidden.filter((one) => one !== id));
    this.show(false);
  }

  // What stands on the screen; a narrow one shows the arrangement in one column.
  get current() {
    return this.grid.save(false, false, undefined, COLUMNS).map(({ id, x = 0, y = 0, w = 1, h = 1 }) => ({ id, x, y, w, h }));
  }

  keep(hidden = this.chosen.desk.hidden) {
    this.own.desks[this.chosen.name] = { tiles: this.current.filter((one) => !hidden.includes(one.id)), hidden };
    this.write();
    this.tools.reset.disabled = false;
  }

  write() { localStorage.setItem(KEPT, JSON.stringify(this.kept)); }

  saveAs(name) {
    if (!name) { this.say("found no name, allowed a name for the layout"); return; }
    const { desk } = this.chosen;
    this.own.chosen = name;
    this.own.desks[name] = desk;
    this.keep(desk.hidden);
    this.show();
    this.say(`✓ kept as ${name} in this browser`);
  }

  export() {
    const { name, desk } = this.chosen, made = { form: FORM, system: this.system, name, tiles: this.current, hidden: desk.hidden };
    const link = element("a", { download: `${this.system}-${name}.json`, href: URL.createObjectURL(new Blob([JSON.stringify(made, null, 1)], { type: "application/json" })) });
    link.click();
    URL.revokeObjectURL(link.href);
  }

  load(text) {
    if (text === undefined) return;
    let found = null;
    try { found = JSON.parse(text); } catch { /* said below */ }
    const { form, name, tiles, hidden } = found ?? {};
    const good = form === FORM && typeof name === "string" && name && Array.isArray(tiles) && tiles.every(isTile)
      && Array.isArray(hidden) && hidden.every((one) => typeof one === "string");
    if (!good) { this.say(`✕ not a layout: found form ${JSON.stringify(form ?? null)}, allowed a file of the button "to a file"`); return; }
    this.own.chosen = name;
    this.own.desks[name] = { tiles: tiles.map(({ id, x, y, w, h }) => ({ id, x, y, w, h })), hidden };
    this.write();
    this.show();
    this.say(`✓ ${name}`);
  }

  say(text) { this.tools.said.textContent = text; }
}
